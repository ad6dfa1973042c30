/* Small dense systems, column-major. */

typedef struct { double *A; long *pivot; long n; } Lu;

/* LU factorisation with partial pivoting */
static int lu_factor(Lu *f) {
  long n = f->n; double *A = f->A;
  for (long k = 0; k < n; k++) {
    long p = k;
    for (long i = k + 1; i < n; i++) if (fabs(A[i + k*n]) > fabs(A[p + k*n])) p = i;
    f->pivot[k] = p;
    if (!(fabs(A[p + k*n]) > 0)) return SINGULAR;
    if (p != k) for (long j = 0; j < n; j++) { double t = A[k + j*n]; A[k + j*n] = A[p + j*n]; A[p + j*n] = t; }
    double inv = 1 / A[k + k*n];
    for (long i = k + 1; i < n; i++) A[i + k*n] *= inv;
    for (long j = k + 1; j < n; j++) {
      double u = A[k + j*n];
      if (u != 0) for (long i = k + 1; i < n; i++) A[i + j*n] -= A[i + k*n] * u;
    }
  }
  return OK;
}

static void lu_solve(const Lu *f, double *b) {
  long n = f->n; const double *A = f->A;
  for (long k = 0; k < n; k++) {
    long p = f->pivot[k];
    double t = b[k]; b[k] = b[p]; b[p] = t;
  }
  for (long k = 0; k < n; k++) for (long i = k + 1; i < n; i++) b[i] -= A[i + k*n] * b[k];
  for (long k = n - 1; k >= 0; k--) {
    b[k] /= A[k + k*n];
    for (long i = 0; i < k; i++) b[i] -= A[i + k*n] * b[k];
  }
}

/* Inverse of A (n, n), which is overwritten: the same matrix serves many right-hand sides, and a product has no
   recurrences to wait for. */
SHARED int invert(long n, double *A, double *inverse) {
  long pivot[n];
  Lu f = {A, pivot, n};
  if (lu_factor(&f)) return SINGULAR;
  memset(inverse, 0, BYTES(double, n*n));
  for (long j = 0; j < n; j++) { inverse[j + j*n] = 1; lu_solve(&f, inverse + j*n); }
  return OK;
}

/* y += s A x, A (rows, cols) column-major */
static void gemv(long rows, long cols, double s, const double *A, const double *x, double *y) {
  for (long j = 0; j < cols; j++) { double t = s * x[j]; for (long i = 0; i < rows; i++) y[i] += A[i + j*rows] * t; }
}
