/* Legs side by side: a vector holds the same number of several legs. Lanes beyond the last leg repeat it, so that they
   compute something harmless; sums leave them out. */
enum { GROUPS = (LEGS + LANES - 1)/LANES };

static long lane_leg(const Settings *s, int group, int lane) {
  long leg = group*LANES + lane;
  return leg < s->legs ? leg : s->legs - 1;
}

static int groups(const Settings *s) { return (int)((s->legs + LANES - 1)/LANES); }
static int used(const Settings *s, int group) { long k = s->legs - group*LANES; return k < LANES ? (int)k : LANES; }

/* rows of `stride` numbers, one a leg, from and to vectors of `size` */
SHARED void gather(const Settings *s, int group, const double *rows, long stride, long size, lanes *to) {
  for (int i = 0; i < LANES; i++) {
    const double *row = rows + lane_leg(s, group, i)*stride;
    for (long j = 0; j < size; j++) to[j][i] = row[j];
  }
}

SHARED void scatter(const Settings *s, int group, const lanes *from, long stride, long size, double *rows) {
  for (int i = 0; i < used(s, group); i++) for (long j = 0; j < size; j++) rows[(group*LANES + i)*stride + j] = from[j][i];
}

static double sum(const Settings *s, int group, lanes x) {
  double total = 0;
  for (int i = 0; i < used(s, group); i++) total += x[i];
  return total;
}

/* y += s A x, A (rows, cols) column-major */
static void lanes_gemv(long rows, long cols, double s, const lanes *A, const lanes *x, lanes *y) {
  for (long j = 0; j < cols; j++) { lanes t = s * x[j]; for (long i = 0; i < rows; i++) y[i] += A[i + j*rows] * t; }
}

/* y += s A^T x */
static void lanes_gemv_t(long rows, long cols, double s, const lanes *A, const lanes *x, lanes *y) {
  for (long j = 0; j < cols; j++) { lanes t = {0}; for (long i = 0; i < rows; i++) t += A[i + j*rows] * x[i]; y[j] += s * t; }
}

/* Larger of m and the magnitudes of x, lane by lane; what is no number passes unseen */
static lanes magnitude(long count, const lanes *x, lanes m) {
  for (long j = 0; j < count; j++) {
    lanes a = (lanes)((lane_bits)x[j] & 0x7fffffffffffffff);
    lane_bits larger = a > m;
    m = (lanes)(((lane_bits)a & larger) | ((lane_bits)m & ~larger));
  }
  return m;
}

/* 0, or no number if any of x is infinite or none */
static lanes blemish(long count, const lanes *x) {
  lanes t = {0};
  for (long j = 0; j < count; j++) t += x[j] * 0.0;
  return t;
}
