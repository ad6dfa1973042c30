/* Several bodies at once: a value of a generated function is a vector with a lane for each body. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"
#endif
#include <math.h>
#include <string.h>

#if defined(__AVX512F__)
enum { LANES = 8 };
#elif defined(__AVX__)
enum { LANES = 4 };
#else
enum { LANES = 2 };
#endif
typedef double lanes __attribute__((vector_size(8 * LANES), may_alias));
typedef void (*LaneFunction)(const lanes *const *in, lanes *const *out);

static inline double double_sqrt(double x) { return sqrt(x); }
static inline double double_exp(double x) { return exp(x); }
static inline void double_turn(double x, double *sine, double *cosine) { *sine = sin(x); *cosine = cos(x); }

/* Roots of all lanes at once where the compiler has a word for that: one by one they cost as much as fifty products. */
static inline lanes lanes_sqrt(lanes x) {
#if defined(__clang__) || defined(__cplusplus) || !defined(__AVX__)
  for (int i = 0; i < LANES; i++) x[i] = sqrt(x[i]);
  return x;
#elif defined(__AVX512F__)
  return (lanes)__builtin_ia32_sqrtpd512_mask(x, x, -1, 4);
#else
  return (lanes)__builtin_ia32_sqrtpd256(x);
#endif
}

/* Sine and cosine: the angle less a multiple of pi/2, in three parts so that nothing is lost, then Taylor's series to
   round-off on [-pi/4, pi/4]. Angles of more turns than the parts allow, and what is no number, are left to libm. */
typedef long long lane_bits __attribute__((vector_size(8 * LANES)));
static const double FURTHEST = 1e5, ROUND = 0x1.8p52;   /* a sum with ROUND has no digits behind the point */
static const double QUARTER[] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2e037073p-69};
static const double ODD[] = {-1.0/6, 1.0/120, -1.0/5040, 1.0/362880, -1.0/39916800, 1.0/6227020800, -1.0/1307674368000, 1.0/355687428096000};
static const double EVEN[] = {1.0/24, -1.0/720, 1.0/40320, -1.0/3628800, 1.0/479001600, -1.0/87178291200, 1.0/20922789888000, -1.0/6402373705728000};

static void lanes_turn(lanes x, lanes *sine, lanes *cosine) {
  lanes shifted = x * 0x1.45f306dc9c883p-1 + ROUND, k = shifted - ROUND;
  lanes r = ((x - k*QUARTER[0]) - k*QUARTER[1]) - k*QUARTER[2], r2 = r*r, s = (lanes){0} + ODD[7], c = (lanes){0} + EVEN[7];
  for (int i = 6; i >= 0; i--) { s = s*r2 + ODD[i]; c = c*r2 + EVEN[i]; }
  s = r + r*(r2*s); c = (1.0 - 0.5*r2) + r2*r2*c;
  lane_bits turns = (lane_bits)shifted, odd = -(turns & 1), flip_s = (turns & 2) << 62, flip_c = ((turns + 1) & 2) << 62;
  *sine = (lanes)((((lane_bits)c & odd) | ((lane_bits)s & ~odd)) ^ flip_s);
  *cosine = (lanes)((((lane_bits)s & odd) | ((lane_bits)c & ~odd)) ^ flip_c);
  for (int i = 0; i < LANES; i++)
    if (!(fabs(x[i]) < FURTHEST)) { (*sine)[i] = sin(x[i]); (*cosine)[i] = cos(x[i]); }
}

/* The exponential: a power of two, and Taylor's series to round-off on [-ln 2 / 2, ln 2 / 2]. Outside of what normal numbers
   allow, and what is no number, is left to libm. */
static const double LN2[] = {0x1.62e42fefa0000p-1, 0x1.cf79abc9e3b39p-40};
static const double POWERS[] = {1.0/2, 1.0/6, 1.0/24, 1.0/120, 1.0/720, 1.0/5040, 1.0/40320, 1.0/362880, 1.0/3628800,
                                1.0/39916800, 1.0/479001600, 1.0/6227020800, 1.0/87178291200};

static inline lanes lanes_exp(lanes x) {
  lanes shifted = x * 0x1.71547652b82fep+0 + ROUND, k = shifted - ROUND;
  lanes r = (x - k*LN2[0]) - k*LN2[1], s = (lanes){0} + POWERS[12];
  for (int i = 11; i >= 0; i--) s = s*r + POWERS[i];
  lanes whole = (lanes)((((lane_bits)shifted - 0x4338000000000000 + 1023) << 52)), result = whole * (1.0 + (r + r*r*s));
  for (int i = 0; i < LANES; i++) if (!(fabs(x[i]) < 700)) result[i] = exp(x[i]);
  return result;
}

/* A function as a table: batches of a kind, a number of rows, and for each the places in w that it reads and that it writes;
   0 ends it. Below 100 kinds are sums of so many products, others one of `c_rows.py`. */
typedef struct { int of, at; double constant; } RowInput;   /* of an input, or a constant where `of` is -1 */
typedef struct { unsigned of, at, from; } RowOutput;

static void rows(const unsigned *t, long inputs, const RowInput *known, long outputs, const RowOutput *results,
                 const lanes *const *in, lanes *const *out, lanes *w) {
  for (long i = 0; i < inputs; i++) {
    if (known[i].of < 0) w[i] = (lanes){0} + known[i].constant; else w[i] = in[known[i].of][known[i].at];
  }
  for (unsigned kind, left; (kind = *t++);) {
    left = *t++;
#define PRODUCT(i) w[t[2*(i)]]*w[t[2*(i) + 1]]
#define EACH(size, value) do { w[t[size]] = value; t += (size) + 1; } while (--left)
    switch (kind) {
      case 1: EACH(2, PRODUCT(0)); break;
      case 2: EACH(4, PRODUCT(0) + PRODUCT(1)); break;
      case 3: EACH(6, PRODUCT(0) + PRODUCT(1) + PRODUCT(2)); break;
      case 4: EACH(8, PRODUCT(0) + PRODUCT(1) + PRODUCT(2) + PRODUCT(3)); break;
      case 100: EACH(2, w[t[0]]/w[t[1]]); break;
      case 101: EACH(2, lanes_sqrt(w[t[0]])); break;
      case 102: EACH(2, lanes_exp(w[t[0]])); break;
      case 103: case 104: do {
        lanes turned[2];
        lanes_turn(w[t[0]], turned, turned + 1);
        w[t[2]] = turned[kind - 103];
        t += 3;
      } while (--left); break;
      default: do {
        lanes sum = PRODUCT(0);
        for (unsigned i = 1; i < kind; i++) sum += PRODUCT(i);
        w[t[2*kind]] = sum;
        t += 2*kind + 1;
      } while (--left);
    }
  }
  for (long i = 0; i < outputs; i++) out[results[i].of][results[i].at] = (lanes){0} + w[results[i].from];
}

/* A lane function for `count` bodies. in[k]: rows[k] rows (repeated where fewer than bodies) of in_size[k] numbers;
   out[k]: count rows of out_size[k] numbers. Lanes beyond the last body repeat it. `work` holds a row of everything. */
static inline void each_body(LaneFunction f, long count, int inputs, const long *in_size, const double *const *in,
                             const long *rows, int outputs, const long *out_size, double *const *out, lanes *work) {
  const lanes *from[inputs];
  lanes *into[outputs], *next = work;
  for (int k = 0; k < inputs; k++) { from[k] = next; next += in_size[k]; }
  for (int k = 0; k < outputs; k++) { into[k] = next; next += out_size[k]; }
  for (long first = 0; first < count; first += LANES) {
    int used = count - first < LANES ? (int)(count - first) : LANES;
    for (int k = 0; k < inputs; k++) {
      double *to = (double *)from[k];
      const double *body[LANES];
      for (int i = 0; i < LANES; i++) body[i] = in[k] + (first + (i < used ? i : used - 1)) % rows[k] * in_size[k];
      for (long j = 0; j < in_size[k]; j++) for (int i = 0; i < LANES; i++) to[j*LANES + i] = body[i][j];
    }
    f(from, into);
    for (int k = 0; k < outputs; k++) {
      const double *result = (const double *)into[k];
      for (int i = 0; i < used; i++) for (long j = 0; j < out_size[k]; j++) out[k][(first + i)*out_size[k] + j] = result[j*LANES + i];
    }
  }
}
