/* Linear algebra of a single planar actuator: the free coordinates among (beta, l, c, a), dense. */
typedef struct { double A[MAXN*MAXN], full[MAXN*MAXN]; long pivot[MAXN], free[MAXN]; Lu lu; } Single;

static int single_factor(Single *w, const Settings *s, const double *A) {
  long n = s->n, m = 0;
  for (long i = 0; i < n; i++) {
    int held = (i == s->l_index && s->prescribed_l) || (i == s->l_index - 1 && s->prescribed_beta);
    if (!held) w->free[m++] = i;
  }
  for (long j = 0; j < m; j++) for (long i = 0; i < m; i++) w->A[i + j*m] = A[w->free[i] + n*w->free[j]];
  memcpy(w->full, A, sizeof(double)*n*n);
  w->lu = (Lu){w->A, w->pivot, m};
  return lu_factor(&w->lu);
}

/* Held coordinates give their drive force and torque: df = (force along l, torque about beta). */
static void single_solve(const Single *w, const Settings *s, const double *r, double *dq, double *df) {
  long n = s->n, m = w->lu.n;
  double x[MAXN], row[MAXN];
  for (long i = 0; i < m; i++) x[i] = -r[w->free[i]];
  lu_solve(&w->lu, x);
  memset(dq, 0, sizeof(double)*n);
  for (long i = 0; i < m; i++) dq[w->free[i]] = x[i];
  memcpy(row, r, sizeof(double)*n);
  gemv(n, n, 1, w->full, dq, row);
  df[0] = s->prescribed_l ? row[s->l_index] : 0;
  df[1] = s->prescribed_beta ? row[s->l_index - 1] : 0;
}
