// A number that counts what is done with it, in the place of double: the very sources of a kernel, compiled as C++.
#include <math.h>
#include <stdlib.h>
#include <string.h>

extern "C" { __attribute__((weak, visibility("default"))) long long operation_counts[6]; }
enum { ADDITIONS, MULTIPLICATIONS, DIVISIONS, ROOTS, EXPONENTIALS, CIRCULAR };

struct Counted {
  double value;
  Counted() = default;
  Counted(double x) : value(x) {}
  explicit operator long() const { return (long)value; }
  Counted &operator+=(Counted b);
  Counted &operator-=(Counted b);
  Counted &operator*=(Counted b);
  Counted &operator/=(Counted b);
};

inline Counted counted(int kind, double x) { operation_counts[kind]++; return Counted(x); }
inline Counted operator+(Counted a, Counted b) { return counted(ADDITIONS, a.value + b.value); }
inline Counted operator-(Counted a, Counted b) { return counted(ADDITIONS, a.value - b.value); }
inline Counted operator*(Counted a, Counted b) { return counted(MULTIPLICATIONS, a.value*b.value); }
inline Counted operator/(Counted a, Counted b) { return counted(DIVISIONS, a.value/b.value); }
inline Counted operator-(Counted a) { return Counted(-a.value); }
inline Counted &Counted::operator+=(Counted b) { return *this = *this + b; }
inline Counted &Counted::operator-=(Counted b) { return *this = *this - b; }
inline Counted &Counted::operator*=(Counted b) { return *this = *this*b; }
inline Counted &Counted::operator/=(Counted b) { return *this = *this/b; }
inline void operator++(Counted &a, int) { a = a + 1; }
inline bool operator<(Counted a, Counted b) { return a.value < b.value; }
inline bool operator>(Counted a, Counted b) { return a.value > b.value; }
inline bool operator<=(Counted a, Counted b) { return a.value <= b.value; }
inline bool operator>=(Counted a, Counted b) { return a.value >= b.value; }
inline bool operator==(Counted a, Counted b) { return a.value == b.value; }
inline bool operator!=(Counted a, Counted b) { return a.value != b.value; }
inline Counted sqrt(Counted a) { return counted(ROOTS, sqrt(a.value)); }
inline Counted exp(Counted a) { return counted(EXPONENTIALS, exp(a.value)); }
inline Counted sin(Counted a) { return counted(CIRCULAR, sin(a.value)); }
inline Counted cos(Counted a) { return counted(CIRCULAR, cos(a.value)); }
inline Counted fabs(Counted a) { return Counted(fabs(a.value)); }
inline Counted fmax(Counted a, Counted b) { return a > b ? a : b; }
inline Counted fmin(Counted a, Counted b) { return a < b ? a : b; }
inline Counted casadi_power(Counted a, Counted b) { return counted(MULTIPLICATIONS, pow(a.value, b.value)); }
inline Counted cbrt(Counted a) { return counted(ROOTS, cbrt(a.value)); }
inline Counted atan2(Counted a, Counted b) { return counted(CIRCULAR, atan2(a.value, b.value)); }
inline Counted rint(Counted a) { Counted b = a; b.value = rint(a.value); return b; }
inline bool isfinite(Counted a) { return isfinite(a.value); }

/* A vector of bodies has one lane here: what is counted is what the bodies need, not what lanes without a body repeat. */
typedef long long LaneBits __attribute__((vector_size(8)));
struct lanes {
  Counted value;
  lanes() = default;
  lanes(double x) : value(x) {}
  lanes(Counted x) : value(x) {}
  explicit lanes(LaneBits x) { memcpy(&value, &x, sizeof value); }
  explicit operator LaneBits() const { LaneBits x; memcpy(&x, &value, sizeof x); return x; }
  Counted &operator[](long) { return value; }
  const Counted &operator[](long) const { return value; }
  lanes &operator+=(lanes b) { value += b.value; return *this; }
  lanes &operator-=(lanes b) { value -= b.value; return *this; }
  lanes &operator*=(lanes b) { value *= b.value; return *this; }
  lanes &operator/=(lanes b) { value /= b.value; return *this; }
};
inline lanes operator+(lanes a, lanes b) { return a.value + b.value; }
inline lanes operator-(lanes a, lanes b) { return a.value - b.value; }
inline lanes operator*(lanes a, lanes b) { return a.value*b.value; }
inline lanes operator/(lanes a, lanes b) { return a.value/b.value; }
inline lanes operator-(lanes a) { return -a.value; }
inline LaneBits operator<(lanes a, lanes b) { return LaneBits{a.value < b.value ? -1 : 0}; }
inline LaneBits operator>(lanes a, lanes b) { return LaneBits{a.value > b.value ? -1 : 0}; }
struct Parts { lanes *at[2]; operator lanes *const *() const { return at; } };  // two addresses for one call

#define pow casadi_power
#define _Thread_local thread_local
#define double Counted
#define restrict __restrict__
