/* Linear algebra of the robot, Eqs. (T6.6)-(T6.9): each leg is eliminated onto the payload.

   Unknowns of leg i: dq_i (n), dlam_i (3); of the border: dy (6) and one drive force per prescribed leg.
     A_i dq_i + J_i^T dlam_i - e_l df_i = -r_i
     J_i dq_i - P_i dy                  = -g_i
     A_p dy   - sum P_i^T dlam_i        = -r_p
     e_l^T dq_i                         = 0          (prescribed stroke)
   Pivot by the closure: J1 = d tip / d(alpha, beta, l) is regular for every leg (det = l^2 cos beta), whatever is
   massless, rigid or prescribed. The other m = n - 3 coordinates see B = N^T A N, N = [N1; I] with N1 = -J1^-1 J2;
   the payload moves them through Y = [Y1; 0], Y1 = J1^-1 P. A is symmetric, so Et = N^T A Y is the transpose of E. */
enum { BORDER = 6 + LEGS, L = 2 };      /* L: position of l in a robot's leg */

typedef struct {                        /* of a vector of legs */
  lanes A[MAXN*MAXN], J[3*MAXN], P[18], J1inv[9], N1[3*MAXN], Y1[18], Binv[MAXN*MAXN], Et[MAXN*6], C[MAXN*6], Bd[MAXN];
  lanes prescribed;
} LegBlock;

typedef struct { LegBlock leg[GROUPS]; double border[BORDER*BORDER]; } Arrow;

static void invert3(const lanes *m, lanes *inv) {        /* column-major */
  lanes c0 = m[4]*m[8] - m[7]*m[5], c1 = m[7]*m[2] - m[1]*m[8], c2 = m[1]*m[5] - m[4]*m[2];
  lanes d = 1.0/(m[0]*c0 + m[3]*c1 + m[6]*c2);
  inv[0] = c0*d; inv[1] = c1*d; inv[2] = c2*d;
  inv[3] = (m[6]*m[5] - m[3]*m[8])*d; inv[4] = (m[0]*m[8] - m[6]*m[2])*d; inv[5] = (m[3]*m[2] - m[0]*m[5])*d;
  inv[6] = (m[3]*m[7] - m[6]*m[4])*d; inv[7] = (m[6]*m[1] - m[0]*m[7])*d; inv[8] = (m[0]*m[4] - m[3]*m[1])*d;
}

/* Inverses of B, leg by leg because each has its own pivots */
static int invert_each(const Settings *s, int group, long m, const lanes *B, lanes *inverse) {
  double one[MAXN*MAXN], inv[MAXN*MAXN];
  for (int i = 0; i < LANES; i++) {
    if (i < used(s, group)) {
      for (long j = 0; j < m*m; j++) one[j] = B[j][i];
      if (m && invert(m, one, inv)) return SINGULAR;
    }
    for (long j = 0; j < m*m; j++) inverse[j][i] = inv[j];
  }
  return OK;
}

/* Everything of a vector of legs that does not depend on residuals; its share of the border */
static int leg_factor(const Settings *s, int group, LegBlock *b, double *border) {
  static _Thread_local lanes AN[MAXN*MAXN], B[MAXN*MAXN];
  long n = s->n, m = n - 3, size = BORDER;
  lanes AY[MAXN*6];
  memset(b->N1, 0, sizeof(lanes)*3*m); memset(b->Y1, 0, sizeof b->Y1);
  invert3(b->J, b->J1inv);
  for (long j = 0; j < m; j++) lanes_gemv(3, 3, -1, b->J1inv, b->J + 3*(3 + j), b->N1 + 3*j);
  for (long j = 0; j < 6; j++) lanes_gemv(3, 3, 1, b->J1inv, b->P + 3*j, b->Y1 + 3*j);
  memcpy(AN, b->A + 3*n, sizeof(lanes)*n*m); memset(AY, 0, sizeof(lanes)*n*6);
  for (long j = 0; j < m; j++) lanes_gemv(n, 3, 1, b->A, b->N1 + 3*j, AN + j*n);
  for (long j = 0; j < 6; j++) lanes_gemv(n, 3, 1, b->A, b->Y1 + 3*j, AY + j*n);
  for (long j = 0; j < m; j++) { memcpy(B + j*m, AN + j*n + 3, sizeof(lanes)*m); lanes_gemv_t(3, m, 1, b->N1, AN + j*n, B + j*m); }
  for (long j = 0; j < 6; j++) { memcpy(b->Et + j*m, AY + j*n + 3, sizeof(lanes)*m); lanes_gemv_t(3, m, 1, b->N1, AY + j*n, b->Et + j*m); }
  if (invert_each(s, group, m, B, b->Binv)) return SINGULAR;
  memset(b->C, 0, sizeof(lanes)*m*6); memset(b->Bd, 0, sizeof(lanes)*m);
  for (long j = 0; j < 6; j++) lanes_gemv(m, m, 1, b->Binv, b->Et + j*m, b->C + j*m);
  for (long j = 0; j < m; j++) for (long i = 0; i < m; i++) b->Bd[i] += b->Binv[i + j*m] * b->N1[L + 3*j];
  for (long j = 0; j < 6; j++) {
    lanes payload[6] = {0}, force = b->Y1[L + 3*j];
    lanes_gemv_t(3, 6, 1, b->Y1, AY + j*n, payload);
    lanes_gemv_t(m, 6, -1, b->Et, b->C + j*m, payload);
    for (long i = 0; i < m; i++) force -= b->N1[L + 3*i] * b->C[i + j*m];
    for (int i = 0; i < 6; i++) border[i + j*size] += sum(s, group, payload[i]);
    for (int i = 0; i < used(s, group); i++) {
      long f = 6 + group*LANES + i;
      border[f + j*size] = b->prescribed[i] * force[i];
      border[j + f*size] = -border[f + j*size];
    }
  }
  lanes own = {0};
  for (long i = 0; i < m; i++) own += b->N1[L + 3*i] * b->Bd[i];
  for (int i = 0; i < used(s, group); i++) { long f = 6 + group*LANES + i; border[f + f*size] = b->prescribed[i] ? own[i] : 1; }
  return OK;
}

static int arrow_factor(Arrow *w, const Settings *s, const double *A_payload) {
  double border[BORDER*BORDER] = {0};
  for (int j = 0; j < 6; j++) for (int i = 0; i < 6; i++) border[i + j*BORDER] = A_payload[i + 6*j];
  for (int group = 0; group < groups(s); group++) if (leg_factor(s, group, &w->leg[group], border)) return SINGULAR;
  return invert(BORDER, border, w->border);
}

/* r, g, dq, dlam, df: a row of n, 3, n, 3, 1 vectors a group; rp, dy: of the payload */
static void arrow_solve(const Arrow *w, const Settings *s, lanes (*r)[MAXN], lanes (*g)[3], const double *rp,
                        lanes (*dq)[MAXN], lanes (*dlam)[3], lanes *df, double *dy) {
  long n = s->n, m = n - 3;
  lanes g0[GROUPS][3];
  double rhs[BORDER] = {0}, x[BORDER] = {0};
  for (int i = 0; i < 6; i++) rhs[i] = -rp[i];
  for (int group = 0; group < groups(s); group++) {
    const LegBlock *b = &w->leg[group];
    lanes t[MAXN], *z = dq[group] + 3, part[6] = {0}, l;
    memset(g0[group], 0, sizeof g0[group]);
    lanes_gemv(3, 3, -1, b->J1inv, g[group], g0[group]);
    memcpy(t, r[group], sizeof(lanes)*n);
    lanes_gemv(n, 3, 1, b->A, g0[group], t);                               /* r + A g0 */
    lanes_gemv_t(3, 6, -1, b->Y1, t, part);
    lanes_gemv_t(3, m, 1, b->N1, t, t + 3);
    memset(z, 0, sizeof(lanes)*m);
    lanes_gemv(m, m, -1, b->Binv, t + 3, z);
    lanes_gemv_t(m, 6, -1, b->Et, z, part);
    l = g0[group][L];
    for (long i = 0; i < m; i++) l += b->N1[L + 3*i] * z[i];
    for (int i = 0; i < 6; i++) rhs[i] += sum(s, group, part[i]);
    for (int i = 0; i < used(s, group); i++) rhs[6 + group*LANES + i] = -b->prescribed[i] * l[i];
  }
  gemv(BORDER, BORDER, 1, w->border, rhs, x);
  memcpy(dy, x, 6*sizeof(double));
  for (int group = 0; group < groups(s); group++) {
    const LegBlock *b = &w->leg[group];
    lanes *change = dq[group], *dz = change + 3, t[3], f, y[6];
    for (int i = 0; i < LANES; i++) f[i] = x[6 + lane_leg(s, group, i)];
    for (int i = 0; i < 6; i++) y[i] = (lanes){0} + x[i];
    df[group] = f;
    lanes_gemv(m, 6, -1, b->C, y, dz);
    for (long i = 0; i < m; i++) dz[i] += b->Bd[i] * f;
    memcpy(change, g0[group], sizeof g0[group]);
    lanes_gemv(3, m, 1, b->N1, dz, change);
    lanes_gemv(3, 6, 1, b->Y1, y, change);
    change[L] *= 1.0 - b->prescribed;
    memcpy(t, r[group], sizeof t);                                         /* rows of alpha, beta, l give dlam */
    for (long j = 0; j < n; j++) for (int i = 0; i < 3; i++) t[i] += b->A[i + j*n] * change[j];
    t[L] -= f;
    memset(dlam[group], 0, sizeof dlam[group]);
    lanes_gemv_t(3, 3, -1, b->J1inv, t, dlam[group]);
  }
}
