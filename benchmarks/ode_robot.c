/* Accelerations of a robot with given strokes or rotors in independent coordinates: those of the legs that are free, and the
   payload's pose. The closures give the dependent ones (Newton) and their rates; no multipliers, no drift, an ODE.
   Generated functions stand above: leg_tip(q, p) -> tip, J; leg_ode(q, v, p) -> M, h, J, curvature; payload_residual. */
static void cross(const double *a, const double *b, double *c) {
  c[0] = a[1]*b[2] - a[2]*b[1]; c[1] = a[2]*b[0] - a[0]*b[2]; c[2] = a[0]*b[1] - a[1]*b[0];
}
static void turn(const double *R, const double *a, double *b) {
  for (int i = 0; i < 3; i++) b[i] = R[3*i]*a[0] + R[3*i + 1]*a[1] + R[3*i + 2]*a[2];
}

/* x <- [columns of the dependent coordinates of J]^-1 x */
static void invert(const double *J, double *inv) {
  const double *a = J + 3*DEPENDENT[0], *b = J + 3*DEPENDENT[1], *c = J + 3*DEPENDENT[2];
  double r[9]; cross(b, c, r); cross(c, a, r + 3); cross(a, b, r + 6);
  double det = a[0]*r[0] + a[1]*r[1] + a[2]*r[2];
  for (int i = 0; i < 9; i++) inv[i] = r[i]/det;          /* rows of the inverse */
}

/* A dependent coordinate of a rigid leg, linear between the instants of the table */
static double guessed(const Robot *s, double t, int leg, int d) {
  long k = (long)(t/s->spacing);
  if (k < 0) k = 0;
  if (k > s->rows - 2) k = s->rows - 2;
  const double *a = s->guess + 18*k + 3*leg + d;
  return a[0] + (t/s->spacing - k)*(a[18] - a[0]);
}

typedef struct {                        /* of six legs, row by row */
  double q[6*N], v[6*N], law[6][3], tip[18], J[18*MOST], inverse[6][9], arm[6][3];
  double M[6*MOST*MOST], h[6*MOST], bend[18];
} Legs;

/* Coordinates and rates of all legs: the closures by Newton's method from rigid legs on */
static void close_legs(const Robot *s, double t, const double *z, const double *z_dot, const double *R, const double *x,
                       const double *u, Legs *w) {
  static const long rows[] = {6, 6};
  long n = N, m = COUNT;
  for (int i = 0; i < 6; i++) {
    double *q = w->q + i*n, *v = w->v + i*n;
    command(s, t, 6, i, 0, w->law[i]);
    for (int d = 0; d < 3; d++) q[DEPENDENT[d]] = guessed(s, t, i, d);
    q[GIVEN[0]] = w->law[i][0]; v[GIVEN[0]] = w->law[i][1];
    for (long j = 0; j < m; j++) { q[FREE[j]] = z[i*m + j]; v[FREE[j]] = z_dot[i*m + j]; }
    turn(R, s->joint_p + 3*i, w->arm[i]);
  }
  for (int round = 0; round < 10; round++) {
    const double *in[] = {w->q, s->leg_p}; double *out[] = {w->tip, w->J}, most = 0;
    leg_tip(6, in, rows, out);
    for (int i = 0; i < 6; i++) {
      double d[3], *r = w->inverse[i];
      for (int k = 0; k < 3; k++) { d[k] = w->tip[3*i + k] - x[k] - w->arm[i][k]; if (fabs(d[k]) > most) most = fabs(d[k]); }
      invert(w->J + 3*n*i, r);
      for (int k = 0; k < 3; k++) w->q[i*n + DEPENDENT[k]] -= r[3*k]*d[0] + r[3*k + 1]*d[1] + r[3*k + 2]*d[2];
    }
    if (most < 1e-10) break;             /* quadratic: the correction just made leaves rounding */
  }
  for (int i = 0; i < 6; i++) {
    double spin[3], d[3], *J = w->J + 3*n*i, *v = w->v + i*n, *r = w->inverse[i];
    cross(u + 3, s->joint_p + 3*i, spin); turn(R, spin, d);
    for (int k = 0; k < 3; k++) {
      d[k] += u[k] - J[3*GIVEN[0] + k]*v[GIVEN[0]];
      for (long j = 0; j < m; j++) d[k] -= J[3*FREE[j] + k]*v[FREE[j]];
    }
    for (int k = 0; k < 3; k++) v[DEPENDENT[k]] = r[3*k]*d[0] + r[3*k + 1]*d[1] + r[3*k + 2]*d[2];
  }
}

/* One leg: rows of z_ddot = -(b + C y), and its share of the payload's equations S y = rhs */
static void leg(const Robot *s, const Legs *legs, int i, const double *R, const double *u, double *C, double *b, double *S,
                double *rhs) {
  long n = N, m = COUNT, wide = m + 7;
  const double *joint = s->joint_p + 3*i, *law = legs->law[i], *J = legs->J + 3*n*i, *inv = legs->inverse[i];
  const double *M = legs->M + n*n*i, *h = legs->h + n*i, *bend = legs->bend + 3*i;
  double T[3][MOST], MT[MOST][MOST], B[MOST*MOST], G[MOST*7], spin[3], spin2[3], d[3];
  cross(u + 3, joint, spin); cross(u + 3, spin, spin2); turn(R, spin2, d);
  for (int k = 0; k < 3; k++) d[k] -= J[3*GIVEN[0] + k]*law[2] + bend[k];
  for (int k = 0; k < 3; k++) {
    const double *r = inv + 3*k; double *row = T[k], c[3];
    for (long j = 0; j < m; j++) { const double *a = J + 3*FREE[j]; row[j] = -(r[0]*a[0] + r[1]*a[1] + r[2]*a[2]); }
    for (int j = 0; j < 3; j++) row[m + j] = r[j];
    double rR[3] = {r[0]*R[0] + r[1]*R[3] + r[2]*R[6], r[0]*R[1] + r[1]*R[4] + r[2]*R[7], r[0]*R[2] + r[1]*R[5] + r[2]*R[8]};
    cross(joint, rR, c);
    for (int j = 0; j < 3; j++) row[m + 3 + j] = c[j];
    row[m + 6] = r[0]*d[0] + r[1]*d[1] + r[2]*d[2];
  }
  for (long r = 0; r < n; r++) {                           /* M T + h */
    const double *a = M + r + n*DEPENDENT[0], *e = M + r + n*DEPENDENT[1], *g = M + r + n*DEPENDENT[2];
    for (long j = 0; j < wide; j++) MT[r][j] = *a*T[0][j] + *e*T[1][j] + *g*T[2][j];
    for (long k = 0; k < m; k++) MT[r][k] += M[r + FREE[k]*n];
    MT[r][m + 6] += M[r + GIVEN[0]*n]*law[2] + h[r];
  }
  for (long k = 0; k < m; k++) for (long j = 0; j < wide; j++) {
    double f = MT[FREE[k]][j];
    for (int d = 0; d < 3; d++) f += T[d][k]*MT[DEPENDENT[d]][j];
    if (j < m) B[k*m + j] = f; else if (j < m + 6) C[6*k + j - m] = f; else b[k] = f;
  }
  cholesky(B, m);
  /* G: columns of B^-1 [C b] */
  for (int j = 0; j < 7; j++) { for (long k = 0; k < m; k++) G[j*m + k] = j < 6 ? C[6*k + j] : b[k]; solve(B, m, G + j*m); }
  for (int r = 0; r < 6; r++) for (int j = 0; j < 7; j++) {
    double f = 0;
    for (int d = 0; d < 3; d++) f += T[d][m + r]*MT[DEPENDENT[d]][m + j];
    for (long k = 0; k < m; k++) f -= C[6*k + r]*G[j*m + k];
    if (j < 6) S[6*r + j] += f; else rhs[r] -= f;
  }
  for (long k = 0; k < m; k++) { b[k] = G[6*m + k]; for (int j = 0; j < 6; j++) C[6*k + j] = G[j*m + k]; }
}

/* y = (z (6, m), pose (7), z_dot (6, m), u (6)); rates of y */
void rates(const Robot *s, double t, const double *y, double *y_dot) {
  long m = COUNT;
  const double *pose = y + 6*m, *z_dot = pose + 7, *u = z_dot + 6*m, *e = pose + 3, *p = s->payload_p;
  double w = e[0], a = e[1], b = e[2], c = e[3], norm = w*w + a*a + b*b + c*c;
  double R[9] = {1 - 2*(b*b + c*c)/norm, 2*(a*b - w*c)/norm, 2*(a*c + w*b)/norm, 2*(a*b + w*c)/norm, 1 - 2*(a*a + c*c)/norm,
                 2*(b*c - w*a)/norm, 2*(a*c - w*b)/norm, 2*(b*c + w*a)/norm, 1 - 2*(a*a + b*b)/norm};
  static const long one[] = {1, 1, 1, 1, 1, 1}, six[] = {6, 6, 6};
  static Legs legs;
  double S[36] = {0}, r[6], power[1], still[24] = {0}, C[6][6*MOST], g[6][MOST];
  const double *in[] = {pose, u, still, still, still, p}; double *out[] = {r, power};
  payload_residual(1, in, one, out);
  close_legs(s, t, y, z_dot, R, pose, u, &legs);
  const double *state[] = {legs.q, legs.v, s->leg_p}; double *found[] = {legs.M, legs.h, legs.J, legs.bend};
  leg_ode(6, state, six, found);
  for (int k = 0; k < 6; k++) r[k] = -r[k];
  for (int k = 0; k < 3; k++) S[7*k] = p[0];
  for (int k = 0; k < 3; k++) for (int j = 0; j < 3; j++) S[6*(3 + k) + 3 + j] = p[1 + k + 3*j];
  for (int i = 0; i < 6; i++) leg(s, &legs, i, R, u, C[i], g[i], S, r);
  cholesky(S, 6);
  solve(S, 6, r);
  for (long j = 0; j < 6*m; j++) y_dot[j] = z_dot[j];
  double *d = y_dot + 6*m, *W = (double *)u + 3;
  for (int k = 0; k < 3; k++) d[k] = u[k];
  d[3] = -0.5*(a*W[0] + b*W[1] + c*W[2]); d[4] = 0.5*(w*W[0] + b*W[2] - c*W[1]);
  d[5] = 0.5*(w*W[1] + c*W[0] - a*W[2]); d[6] = 0.5*(w*W[2] + a*W[1] - b*W[0]);
  double *acc = d + 7;
  for (int i = 0; i < 6; i++) for (long k = 0; k < m; k++) {
    double f = -g[i][k];
    for (int j = 0; j < 6; j++) f -= C[i][6*k + j]*r[j];
    acc[i*m + k] = f;
  }
  memcpy(acc + 6*m, r, sizeof r);
}

