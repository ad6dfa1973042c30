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
static inline void double_turn(double x, double *sine, double *cosine) { *sine = sin(x); *cosine = cos(x); }

static inline lanes lanes_sqrt(lanes x) {
  for (int i = 0; i < LANES; i++) x[i] = sqrt(x[i]);
  return x;
}

static inline void lanes_turn(lanes x, lanes *sine, lanes *cosine) {
  for (int i = 0; i < LANES; i++) { (*sine)[i] = sin(x[i]); (*cosine)[i] = cos(x[i]); }
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
