/* Legs side by side: a vector holds the same number of several legs. Lanes beyond the last leg repeat it, so that they
   compute something harmless; sums leave them out. */
enum { GROUPS = (LEGS + LANES - 1)/LANES };     /* vectors, at most */

static long lane_leg(const Settings *s, int group, int lane) {
  long leg = group*LANES + lane;
  return leg < s->legs ? leg : s->legs - 1;
}

static int groups(const Settings *s) { return (int)((s->legs + LANES - 1)/LANES); }
static int used(const Settings *s, int group) { long k = s->legs - group*LANES; return k < LANES ? (int)k : LANES; }

/* What a run needs of memory is the caller's: it is counted where `base` is 0, and shared out in the same order each call,
   so that what a call leaves there is found by the next */
typedef struct { char *base; long used; } Room;

static void *room(Room *m, long bytes) {
  void *at = m->base ? m->base + m->used : 0;
  m->used += (bytes + 63)/64*64;
  return at;
}
static lanes *room_of_lanes(Room *m, long count) { return (lanes *)room(m, (long)BYTES(lanes, count)); }
static double *room_of_numbers(Room *m, long count) { return (double *)room(m, (long)BYTES(double, count)); }

/* `size` lanes for each vector of legs, one behind the other */
static void room_of_legs(Room *m, const Settings *s, long size, lanes **to) {
  lanes *all = room_of_lanes(m, groups(s)*size);
  for (int i = 0; i < groups(s); i++) to[i] = all ? all + i*size : 0;
}

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

/* For each number of sums up to eight a copy of `part` in which they stay in registers; `part` takes eight at a time */
#define BY_EIGHTS(count, part) \
  do { \
    long first = 0; \
    for (; first + 8 <= (count); first += 8) part(8); \
    switch ((count) - first) { \
      case 1: part(1); break; case 2: part(2); break; case 3: part(3); break; case 4: part(4); break; \
      case 5: part(5); break; case 6: part(6); break; case 7: part(7); break; \
    } \
  } while (0)

INLINE void some_rows(int some, long rows, long cols, double s, const lanes *A, const lanes *x, lanes *y) {
  lanes sum[8];
  for (int i = 0; i < some; i++) sum[i] = y[i];
  for (long j = 0; j < cols; j++, A += rows) { lanes t = s * x[j]; for (int i = 0; i < some; i++) sum[i] += A[i] * t; }
  for (int i = 0; i < some; i++) y[i] = sum[i];
}

SHARED void all_rows(long rows, long cols, double s, const lanes *A, const lanes *x, lanes *y) {
#define PART(some) some_rows(some, rows, cols, s, A + first, x, y + first)
  BY_EIGHTS(rows, PART);
#undef PART
}

INLINE void few_columns(int cols, long rows, double s, const lanes *A, const lanes *x, lanes *y) {
  lanes t[8];
  for (int j = 0; j < cols; j++) t[j] = s * x[j];
  for (long i = 0; i < rows; i++) { lanes sum = y[i]; for (int j = 0; j < cols; j++) sum += A[i + j*rows] * t[j]; y[i] = sum; }
}

/* y += s A x, A (rows, cols) column-major */
#define KNOWN(size) (__builtin_constant_p(size) && (size) <= 8)
INLINE void lanes_gemv(long rows, long cols, double s, const lanes *A, const lanes *x, lanes *y) {
  if (KNOWN(rows)) some_rows((int)rows, rows, cols, s, A, x, y);
  else if (KNOWN(cols)) few_columns((int)cols, rows, s, A, x, y);
  else all_rows(rows, cols, s, A, x, y);
}

INLINE void some_columns(int some, long rows, double s, const lanes *A, const lanes *x, lanes *y) {
  lanes sum[8];
  for (int j = 0; j < some; j++) sum[j] = (lanes){0};
  for (long i = 0; i < rows; i++) { lanes t = x[i]; for (int j = 0; j < some; j++) sum[j] += A[i + j*rows] * t; }
  for (int j = 0; j < some; j++) y[j] += s * sum[j];
}

SHARED void all_columns(long rows, long cols, double s, const lanes *A, const lanes *x, lanes *y) {
#define PART(some) some_columns(some, rows, s, A + first*rows, x, y + first)
  BY_EIGHTS(cols, PART);
#undef PART
}

INLINE void few_rows(int rows, long cols, double s, const lanes *A, const lanes *x, lanes *y) {
  for (long j = 0; j < cols; j++) { lanes t = {0}; for (int i = 0; i < rows; i++) t += A[i + j*rows] * x[i]; y[j] += s * t; }
}

/* y += s A^T x */
INLINE void lanes_gemv_t(long rows, long cols, double s, const lanes *A, const lanes *x, lanes *y) {
  if (KNOWN(cols)) some_columns((int)cols, rows, s, A, x, y);
  else if (KNOWN(rows)) few_rows((int)rows, cols, s, A, x, y);
  else all_columns(rows, cols, s, A, x, y);
}

INLINE void add(long count, const lanes *restrict x, lanes *restrict y) { for (long j = 0; j < count; j++) y[j] += x[j]; }

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
