/* Generalized-alpha for constrained systems on R^n x SE(3), Eqs. (T6.1)-(T6.5), fixed step within a call. */
extern int leg_residual(const double **arg, double **res, long long *iw, double *w, int mem);
extern int leg_matrices(const double **arg, double **res, long long *iw, double *w, int mem);
extern int leg_energies(const double **arg, double **res, long long *iw, double *w, int mem);
extern int payload_residual(const double **arg, double **res, long long *iw, double *w, int mem);
extern int payload_matrices(const double **arg, double **res, long long *iw, double *w, int mem);
extern int payload_energies(const double **arg, double **res, long long *iw, double *w, int mem);

enum { MAXF = 6*MAXN + 6 };

typedef struct {
  double r[MAXF], g[18], points[18], powers[3], command[6][COMMAND];
  Arrow arrow; Single single;
} Work;

static long total(const Settings *s) { return s->legs*s->n + (s->payload ? 6 : 0); }

static void commands(const Settings *s, const State *x, const double *row, double out[6][COMMAND]) {
  for (long i = 0; i < s->legs; i++) {
    const double *t = row + i*TABLE;
    out[i][0] = t[0]; out[i][1] = t[1];
    out[i][2] = t[3] + x->drive[2*i]; out[i][3] = t[7] + x->drive[2*i + 1];
  }
}

/* Residual of every equation at the present state; wrench in world axes at the tool. */
static void residual(const Settings *s, State *x, const double *row, const double *wrench, Work *w) {
  long n = s->n;
  double tip[18], part[2];
  commands(s, x, row, w->command);
  memset(w->powers, 0, sizeof w->powers);
  for (long i = 0; i < s->legs; i++) {
    const double *arg[] = {x->q + i*n, x->v + i*n, x->v_dot + i*n, x->lam + 3*i, w->command[i], s->leg_p + i*s->leg_np};
    double *res[] = {w->r + i*n, tip + 3*i, part};
    leg_residual(arg, res, 0, 0, 0);
    w->powers[0] += part[0]; w->powers[1] += part[1];
  }
  if (!s->payload) return;
  long k = s->legs*n;
  const double *arg[] = {x->pose, x->v + k, x->v_dot + k, x->lam, wrench, s->payload_p};
  double *res[] = {w->r + k, w->points, w->powers + 2};
  payload_residual(arg, res, 0, 0, 0);
  for (int i = 0; i < 18; i++) w->g[i] = tip[i] - w->points[i];
}

/* Iteration matrix M/(...) + gamma/(beta h) D + K from the matrices at rest, Eq. (T6.5). */
static int factor(const Settings *s, State *x, const double *wrench, double c_v, double c_a, Work *w) {
  long n = s->n;
  double M[MAXN*MAXN], D[MAXN*MAXN], K[MAXN*MAXN], J[3*MAXN], A[MAXN*MAXN];
  x->factorisations++;
  for (long i = 0; i < s->legs; i++) {
    double *into = s->payload ? w->arrow.leg[i].A : A;
    const double *arg[] = {x->q + i*n, x->lam + 3*i, s->leg_p + i*s->leg_np};
    double *res[] = {M, D, K, s->payload ? w->arrow.leg[i].J : J};
    leg_matrices(arg, res, 0, 0, 0);
    for (long j = 0; j < n*n; j++) into[j] = c_a*M[j] + c_v*D[j] + K[j];
  }
  if (!s->payload) return single_factor(&w->single, s, A);
  double P[18*6], Ap[36];
  const double *arg[] = {x->pose, x->lam, wrench, s->payload_p};
  double *res[] = {M, K, P};
  payload_matrices(arg, res, 0, 0, 0);
  for (int j = 0; j < 36; j++) Ap[j] = c_a*M[j] + K[j];
  for (int i = 0; i < 6; i++) for (int j = 0; j < 6; j++) for (int a = 0; a < 3; a++) w->arrow.leg[i].P[a + 3*j] = P[3*i + a + 18*j];
  return arrow_factor(&w->arrow, s, Ap);
}

/* R(t+h) = R(t) exp(theta^) as quaternions, Eq. (T6.2) */
static void turned_pose(const double *old, const double *step, double *pose) {
  for (int i = 0; i < 3; i++) pose[i] = old[i] + step[i];
  double t2 = step[3]*step[3] + step[4]*step[4] + step[5]*step[5], t = sqrt(t2);
  double c = cos(0.5*t), f = t > 1e-4 ? sin(0.5*t)/t : 0.5 - t2/48;
  double w = c, a = f*step[3], b = f*step[4], d = f*step[5];
  const double *e = old + 3;
  double q[4] = {e[0]*w - e[1]*a - e[2]*b - e[3]*d, e[0]*a + e[1]*w + e[2]*d - e[3]*b,
                 e[0]*b - e[1]*d + e[2]*w + e[3]*a, e[0]*d + e[1]*b - e[2]*a + e[3]*w};
  double norm = sqrt(q[0]*q[0] + q[1]*q[1] + q[2]*q[2] + q[3]*q[3]);
  for (int i = 0; i < 4; i++) pose[3 + i] = q[i]/norm;
}

static void follow_tables(const Settings *s, State *x, const double *row) {
  for (long i = 0; i < s->legs; i++) {
    const double *t = row + i*TABLE;
    long l = i*s->n + s->l_index;
    if (s->prescribed_l >> i & 1) { x->q[l] = t[0]; x->v[l] = t[1]; x->v_dot[l] = x->a[l] = t[2]; }
    if (s->prescribed_beta >> i & 1) { x->q[l-1] = t[4]; x->v[l-1] = t[5]; x->v_dot[l-1] = x->a[l-1] = t[6]; }
  }
}

static int converged(const Settings *s, const State *x, const Work *w, double *worst, long *leg) {
  double force = 1, closure = 0;
  long N = total(s);
  *worst = 0; *leg = -1;
  for (long i = 0; i < 3*s->legs; i++) { double f = fabs(x->lam[i]); if (f > force) force = f; }
  for (long i = 0; i < 2*s->legs; i++) { double f = fabs(x->drive[i]); if (f > force) force = f; }
  for (long i = 0; i < N; i++) { double e = fabs(w->r[i])/(force + s->force_floor/s->tol_force); if (!(e <= *worst)) { *worst = e; *leg = i/s->n; } }
  if (s->payload) for (int i = 0; i < 18; i++) { double e = fabs(w->g[i]); if (!(e <= closure)) closure = e; }
  double ratio = closure/s->tol_closure;
  *worst /= s->tol_force;
  if (!(ratio <= *worst)) *worst = ratio;
  return *worst <= 1;
}

static void write_record(const Settings *s, State *x, const double *row, Work *w) {
  long n = s->n, N = total(s), k = s->legs*n;
  double *o = x->record, part[3], e[3] = {0, 0, 0};
  commands(s, x, row, w->command);
  for (long i = 0; i < s->legs; i++) {
    const double *arg[] = {x->q + i*n, x->v + i*n, w->command[i], s->leg_p + i*s->leg_np};
    double *res[] = {part};
    leg_energies(arg, res, 0, 0, 0);
    for (int j = 0; j < 3; j++) e[j] += part[j];
  }
  if (s->payload) {
    const double *arg[] = {x->pose, x->v + k, s->payload_p};
    double *res[] = {part};
    payload_energies(arg, res, 0, 0, 0);
    for (int j = 0; j < 3; j++) e[j] += part[j];
  }
  memcpy(o, x->q, sizeof(double)*k); o += k;
  memcpy(o, x->v, sizeof(double)*N); o += N;
  memcpy(o, x->v_dot, sizeof(double)*N); o += N;
  memcpy(o, x->lam, sizeof(double)*3*s->legs); o += 3*s->legs;
  memcpy(o, x->drive, sizeof(double)*2*s->legs); o += 2*s->legs;
  memcpy(o, x->pose, sizeof(double)*7); o += 7;
  memcpy(o, e, sizeof e); o += 3;
  memcpy(o, x->sums, sizeof(double)*3); o += 3;
  *o++ = x->closure;
  x->record = o;
}

/* Record of the present state (used once, at the start); returns the largest closure through x->closure. */
void record_state(const Settings *s, State *x, const double *row, const double *wrench) {
  static Work w;
  residual(s, x, row, wrench, &w);
  x->closure = 0;
  if (s->payload) for (int i = 0; i < 18; i++) if (fabs(w.g[i]) > x->closure) x->closure = fabs(w.g[i]);
  memcpy(x->powers, w.powers, sizeof w.powers);
  write_record(s, x, row, &w);
}

/* Advance `steps` steps; tables have steps + 1 rows (row 0 is the present time). */
int march(const Settings *s, State *x, const double *table, const double *wrench, long steps) {
  static Work w;
  long n = s->n, N = total(s), k = s->legs*n, width = s->legs*TABLE, age = s->max_age;
  double h = s->h, am = s->alpha_m, af = s->alpha_f;
  double c_q = 1/(s->beta*h*h), c_v = s->gamma/(s->beta*h), c_a = (1 - am)/((1 - af)*s->beta*h*h);
  double q0[MAXF], step[MAXF], pose0[7], dq[MAXF], dlam[18], df[12], worst, before;
  double v_dot1[MAXF], lam1[18], drive1[12];            /* of the step before: the predictor extrapolates */
  memcpy(v_dot1, x->v_dot, sizeof(double)*N); memcpy(lam1, x->lam, sizeof(double)*3*s->legs);
  memcpy(drive1, x->drive, sizeof(double)*2*s->legs);
  for (long t = 1; t <= steps; t++) {
    const double *row = table + t*width, *wr = wrench + 6*t;
    memcpy(q0, x->q, sizeof(double)*k); memcpy(pose0, x->pose, sizeof pose0);
    for (long j = 0; j < 3*s->legs; j++) { double f = x->lam[j]; x->lam[j] += f - lam1[j]; lam1[j] = f; }
    for (long j = 0; j < 2*s->legs; j++) { double f = x->drive[j]; x->drive[j] += f - drive1[j]; drive1[j] = f; }
    for (long j = 0; j < N; j++) {                      /* predictor: extrapolated v_dot, Eqs. (T6.1)-(T6.3) */
      double a0 = x->a[j], old = x->v_dot[j], a1;
      x->v_dot[j] += old - v_dot1[j]; v_dot1[j] = old;
      a1 = ((1 - af)*x->v_dot[j] + af*old - am*a0)/(1 - am);
      step[j] = h*x->v[j] + h*h*((0.5 - s->beta)*a0 + s->beta*a1);
      x->v[j] += h*((1 - s->gamma)*a0 + s->gamma*a1);
      x->a[j] = a1;
      if (j < k) x->q[j] = q0[j] + step[j];
    }
    follow_tables(s, x, row);
    if (s->payload) turned_pose(pose0, step + k, x->pose);
    before = INFINITY;
    for (long iteration = 0;; iteration++) {
      residual(s, x, row, wr, &w);
      long leg;
      int done = converged(s, x, &w, &worst, &leg);
      x->bad_leg = leg;
      if (!isfinite(worst)) { x->steps += t; return NOT_FINITE; }
      if (!done && iteration >= s->max_iterations) {
        if (worst < 100) break;                         /* rounding floor of closures or forces reached */
        x->steps += t; return NOT_CONVERGED;
      }
      if (age >= s->max_age || (iteration > 1 && worst > 0.1*before)) {
        if (factor(s, x, wr, c_v, c_a, &w)) { x->steps += t; return SINGULAR; }
        age = 0;
      }
      before = worst;
      x->iterations++;
      if (s->payload) arrow_solve(&w.arrow, s, w.r, w.g, dq, dlam, df);
      else single_solve(&w.single, s, w.r, dq, df);
      for (long j = 0; j < N; j++) {                    /* Newton update, Eq. (T6.4) */
        step[j] += dq[j]; x->v[j] += c_v*dq[j]; x->v_dot[j] += c_a*dq[j]; x->a[j] += c_q*dq[j];
        if (j < k) x->q[j] += dq[j];
      }
      if (s->payload) {
        turned_pose(pose0, step + k, x->pose);
        for (int j = 0; j < 18; j++) x->lam[j] += dlam[j];
        for (int j = 0; j < 6; j++) x->drive[2*j] += df[j];
      } else { x->drive[0] += df[0]; x->drive[1] += df[1]; }
      if (done) break;                                  /* after a last correction: index 3 magnifies what is left */
    }
    age++;
    x->closure = 0;
    if (s->payload) for (int j = 0; j < 18; j++) if (fabs(w.g[j]) > x->closure) x->closure = fabs(w.g[j]);
    for (int j = 0; j < 3; j++) { x->sums[j] += 0.5*h*(x->powers[j] + w.powers[j]); x->powers[j] = w.powers[j]; }
    if (t % s->output_every == 0) write_record(s, x, row, &w);
  }
  x->steps += steps;
  return OK;
}
