/* Linear algebra of the robot, Eqs. (T6.6)-(T6.9): each leg is eliminated onto the payload.

   Unknowns of leg i: dq_i (n), dlam_i (3); of the border: dy (6) and one drive force per prescribed leg.
     A_i dq_i + J_i^T dlam_i - e_l df_i = -r_i
     J_i dq_i - P_i dy                  = -g_i
     A_p dy   - sum P_i^T dlam_i        = -r_p
     e_l^T dq_i                         = 0          (prescribed stroke)
   Pivot by the closure: J1 = d tip / d(alpha, beta, l) is regular for every leg (det = l^2 cos beta), whatever is
   massless, rigid or prescribed. The other coordinates see N^T A N with N = [-J1^-1 J2; I]. */
enum { MAXN = 64, BORDER = 12 }; /* coordinates of a leg: 3, up to 4 axial and twice 24 lateral shapes */

typedef struct {
  double A[MAXN*MAXN], J[3*MAXN], P[18], J1inv[9], N[MAXN*MAXN], Y[MAXN*6], AN[MAXN*MAXN], AY[MAXN*6];
  double B[MAXN*MAXN], C[MAXN*6], E[MAXN*6], d[MAXN], Bd[MAXN];
  long pivot[MAXN];
  Lu lu;
} LegBlock;

typedef struct { LegBlock leg[6]; double border[BORDER*BORDER]; long pivot[BORDER]; Lu lu; } Arrow;

static int invert3(const double *m, double *inv) {       /* column-major */
  double c0 = m[4]*m[8] - m[7]*m[5], c1 = m[7]*m[2] - m[1]*m[8], c2 = m[1]*m[5] - m[4]*m[2];
  double det = m[0]*c0 + m[3]*c1 + m[6]*c2;
  if (!(fabs(det) > 0)) return SINGULAR;
  inv[0] = c0/det; inv[1] = c1/det; inv[2] = c2/det;
  inv[3] = (m[6]*m[5] - m[3]*m[8])/det; inv[4] = (m[0]*m[8] - m[6]*m[2])/det; inv[5] = (m[3]*m[2] - m[0]*m[5])/det;
  inv[6] = (m[3]*m[7] - m[6]*m[4])/det; inv[7] = (m[6]*m[1] - m[0]*m[7])/det; inv[8] = (m[0]*m[4] - m[3]*m[1])/det;
  return OK;
}

/* Null-space basis N (n, m) and payload columns Y (n, 6) of one leg */
static int leg_bases(LegBlock *b, long n) {
  long m = n - 3;
  if (invert3(b->J, b->J1inv)) return SINGULAR;
  memset(b->N, 0, sizeof(double)*n*m); memset(b->Y, 0, sizeof(double)*n*6);
  for (long j = 0; j < m; j++) {
    double t[3] = {0, 0, 0};
    gemv(3, 3, -1, b->J1inv, b->J + 3*(3 + j), t);
    for (int i = 0; i < 3; i++) b->N[i + j*n] = t[i];
    b->N[3 + j + j*n] = 1;
  }
  for (long j = 0; j < 6; j++) {
    double t[3] = {0, 0, 0};
    gemv(3, 3, 1, b->J1inv, b->P + 3*j, t);
    for (int i = 0; i < 3; i++) b->Y[i + j*n] = t[i];
  }
  return OK;
}

static int arrow_factor(Arrow *w, const Settings *s, const double *A_payload) {
  long n = s->n, m = n - 3, size = BORDER;
  memset(w->border, 0, sizeof w->border);
  for (int j = 0; j < 6; j++) for (int i = 0; i < 6; i++) w->border[i + j*size] = A_payload[i + 6*j];
  for (int leg = 0; leg < 6; leg++) {
    LegBlock *b = &w->leg[leg];
    if (leg_bases(b, n)) return SINGULAR;
    memset(b->AN, 0, sizeof(double)*n*m); memset(b->AY, 0, sizeof(double)*n*6);
    for (long j = 0; j < m; j++) gemv(n, n, 1, b->A, b->N + j*n, b->AN + j*n);
    for (long j = 0; j < 6; j++) gemv(n, n, 1, b->A, b->Y + j*n, b->AY + j*n);
    memset(b->B, 0, sizeof(double)*m*m); memset(b->C, 0, sizeof(double)*m*6); memset(b->E, 0, sizeof(double)*6*m);
    for (long j = 0; j < m; j++) { gemv_t(n, m, 1, b->N, b->AN + j*n, b->B + j*m); gemv_t(n, 6, 1, b->Y, b->AN + j*n, b->E + j*6); }
    for (long j = 0; j < 6; j++) gemv_t(n, m, 1, b->N, b->AY + j*n, b->C + j*m);
    for (long i = 0; i < m; i++) b->d[i] = b->Bd[i] = b->N[s->l_index + i*n];
    b->lu = (Lu){b->B, b->pivot, m};
    if (lu_factor(&b->lu)) return SINGULAR;
    for (long j = 0; j < 6; j++) lu_solve(&b->lu, b->C + j*m);            /* C <- B^-1 N^T A Y */
    lu_solve(&b->lu, b->Bd);
    for (long j = 0; j < 6; j++) {
      gemv_t(n, 6, 1, b->Y, b->AY + j*n, w->border + j*size);
      gemv(6, m, -1, b->E, b->C + j*m, w->border + j*size);
    }
    long f = 6 + leg;
    if (s->prescribed_l >> leg & 1) {
      gemv(6, m, 1, b->E, b->Bd, w->border + f*size);
      for (int i = 0; i < 6; i++) w->border[i + f*size] -= b->Y[s->l_index + i*n];
      for (int j = 0; j < 6; j++) {
        double t = b->Y[s->l_index + j*n];
        for (long i = 0; i < m; i++) t -= b->d[i] * b->C[i + j*m];
        w->border[f + j*size] = t;
      }
      for (long i = 0; i < m; i++) w->border[f + f*size] += b->d[i] * b->Bd[i];
    } else w->border[f + f*size] = 1;
  }
  w->lu = (Lu){w->border, w->pivot, size};
  return lu_factor(&w->lu);
}

/* r: residual (6 n + 6), g: closures (18). Out: dq (6 n + 6), dlam (18), df (6) */
static void arrow_solve(const Arrow *w, const Settings *s, const double *r, const double *g, double *dq, double *dlam, double *df) {
  long n = s->n, m = n - 3;
  double z[6][MAXN], g0[6][3], rhs[BORDER];
  for (int i = 0; i < 6; i++) { rhs[i] = -r[6*n + i]; rhs[6 + i] = 0; }
  for (int leg = 0; leg < 6; leg++) {
    const LegBlock *b = &w->leg[leg];
    double t[MAXN];
    memset(g0[leg], 0, sizeof g0[leg]);
    gemv(3, 3, -1, b->J1inv, g + 3*leg, g0[leg]);
    memcpy(t, r + leg*n, sizeof(double)*n);
    gemv(n, 3, 1, b->A, g0[leg], t);                                       /* r + A g0 */
    memset(z[leg], 0, sizeof(double)*m);
    gemv_t(n, m, -1, b->N, t, z[leg]);
    lu_solve(&b->lu, z[leg]);
    double part[6] = {0};
    gemv_t(n, 6, -1, b->Y, t, part);
    gemv(6, m, -1, b->E, z[leg], part);
    for (int i = 0; i < 6; i++) rhs[i] += part[i];
    if (s->prescribed_l >> leg & 1) {
      double l = g0[leg][s->l_index];
      for (long i = 0; i < m; i++) l += b->d[i] * z[leg][i];
      rhs[6 + leg] = -l;
    }
  }
  lu_solve(&w->lu, rhs);
  memcpy(dq + 6*n, rhs, 6*sizeof(double));
  for (int leg = 0; leg < 6; leg++) {
    const LegBlock *b = &w->leg[leg];
    double *x = dq + leg*n, *dz = z[leg], t[MAXN], f = df[leg] = rhs[6 + leg];
    gemv(m, 6, -1, b->C, rhs, dz);
    for (long i = 0; i < m; i++) dz[i] += b->Bd[i] * f;
    memset(x, 0, sizeof(double)*n);
    memcpy(x, g0[leg], 3*sizeof(double));
    gemv(n, m, 1, b->N, dz, x);
    gemv(n, 6, 1, b->Y, rhs, x);
    if (s->prescribed_l >> leg & 1) x[s->l_index] = 0;
    memcpy(t, r + leg*n, 3*sizeof(double));                                /* rows of alpha, beta, l give dlam */
    for (long j = 0; j < n; j++) for (int i = 0; i < 3; i++) t[i] += b->A[i + j*n] * x[j];
    t[s->l_index] -= f;
    memset(dlam + 3*leg, 0, 3*sizeof(double));
    gemv_t(3, 3, -1, b->J1inv, t, dlam + 3*leg);
  }
}
