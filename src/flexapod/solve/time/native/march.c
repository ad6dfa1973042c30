/* Generalized-alpha for constrained systems on R^n x SE(3), Eqs. (T6.1)-(T6.5), fixed step within a call. */

/* What the functions of a leg may read from outside it: the payload's pose, or a load on a tip without payload */
enum { OUTSIDE = 12 };
static int load_size(const Settings *s) { return s->hub ? 6 : OUTSIDE; }
static void outside(const Settings *s, const Work *w, const double *wrench, lanes *to) {
  double x[OUTSIDE] = {0};
  if (s->hub) memcpy(x, w->payload.pose, sizeof w->payload.pose); else memcpy(x, wrench, sizeof x);
  for (int j = 0; j < OUTSIDE; j++) to[j] = (lanes){0} + x[j];
}

/* Friction at the end of the step, and the bristles there */
static void add_friction(const Settings *s, int i, Work *w, lanes *powers) {
  SIZES(s);
  if (!BRISTLES) return;
  LegState *leg = &w->leg[i];
  lanes force[N], rate[BRISTLES], energies[2], h = (lanes){0} + w->h;
  const lanes *in[] = {leg->q, leg->v, leg->lam, w->bristles[i], &h, w->p[i]};
  lanes *out[] = {force, w->bent[i], w->rubs[i], rate, energies};
  s->of->leg_friction(in, out);
  for (long j = 0; j < N; j++) w->r[i][j] += force[j];
  powers[0] += energies[0];
  w->stored += sum(s, i, energies[1]);
}

/* How friction grows with the rates, for the iteration matrix */
static void add_friction_matrix(const Settings *s, int i, double c_v, Work *w) {
  SIZES(s);
  if (!BRISTLES) return;
  LegState *leg = &w->leg[i];
  lanes h = (lanes){0} + w->h, *D = w->at_rest[0];
  const lanes *in[] = {leg->q, leg->v, leg->lam, w->bristles[i], &h, w->p[i]};
  lanes *out[] = {D};
  s->of->leg_friction_matrix(in, out);
  for (long j = 0; j < N; j++) for (long k = 0; k < N; k++) w->arrow.leg[i].A[k + j*N] += c_v*D[ORDER[k] + N*ORDER[j]];
}

/* What loops add to the matrices in the order of the arrow, times factors */
static void add_loop(const Settings *s, const Work *w, int i, double c_v, double c_q, lanes *of_D, lanes *of_K) {
  SIZES(s);
  if (!LOOPING) return;
  lanes *D = w->at_rest[0], *K = w->at_rest[1], place[1], slope[N];
  const lanes *in[] = {w->leg[i].q, w->p[i]};
  lanes *out[] = {D, K, place, slope};
  s->of->leg_loop(in, out);
  for (long j = 0; j < N; j++) for (long k = 0; k < N; k++) {
    of_D[k + j*N] += c_v*D[ORDER[k] + N*ORDER[j]]; of_K[k + j*N] += c_q*K[ORDER[k] + N*ORDER[j]];
  }
}

/* Residuals of a vector of legs, how far they are from closed, and the wrench that they put on the payload */
static void residual_of_legs(const Settings *s, int i, const lanes *around, Work *w, lanes *wrench) {
  SIZES(s);
  const long LOOP = s->of->loop, FLOOR = s->of->floor;
  LegState *leg = &w->leg[i];
  lanes powers[WORKS] = {{0}}, drive[SPRINGS + 1], tip[6], point[6];
  const lanes *in[] = {leg->q, leg->v, leg->v_dot, leg->lam, w->command[i], w->p[i], around};
  lanes *with_pose[] = {w->r[i], w->g[i], wrench, powers, drive}, *with_point[] = {w->r[i], tip, powers, drive};
  s->of->leg_residual(in, POSED ? with_pose : with_point);
  if (ROWS && !POSED) {
    const lanes *joint[] = {around, leg->lam, w->joint[i]};
    lanes *at[] = {point, wrench};
    s->of->joint_residual(joint, at);
    for (int j = 0; j < ROWS; j++) w->g[i][j] = tip[j] - point[j];
  }
  for (long k = 0; k < s->ports; k++) {
    lanes force = port_force(w, i, k);
    w->r[i][s->port[k]] -= force;
    if (s->port[k] != LOOP) powers[FLOOR < N && s->port[k] >= FLOOR ? 3 : 1] += force*leg->v[s->port[k]];
  }
  add_friction(s, i, w, powers);
  for (int j = 0; j < WORKS; j++) w->powers[j] += sum(s, i, powers[j]);
}

/* Coordinates that all legs share, the payload's first: those of the first leg, their rates and accelerations */
static void shared_state(const Settings *s, const Work *w, double *x) {
  SIZES(s);
  const lanes *of_leg[] = {w->leg[0].q, w->leg[0].v, w->leg[0].v_dot};
  for (int i = 0; i < 3; i++) for (int k = 0; k < COMMON; k++) x[k + i*COMMON] = of_leg[i][ORDER[N - COMMON + k]][0];
}

/* Residuals of shared coordinates from the legs to the border */
static void fold_shared(const Settings *s, Work *w) {
  SIZES(s);
  for (int k = 0; k < COMMON; k++) for (int i = 0; i < groups(s); i++) {
    lanes *r = &w->r[i][ORDER[N - COMMON + k]];
    w->rp[6 + k] += sum(s, i, *r);
    *r = (lanes){0};
  }
}

/* Residual of every equation at the present state; wrench in world axes at the tool. */
static void residual(const Settings *s, const double *wrench, Work *w) {
  SIZES(s);
  lanes around[OUTSIDE], part[6];
  double net[6] = {0};
  set_commands(s, w);
  memset(w->powers, 0, sizeof w->powers);
  w->stored = 0;
  outside(s, w, wrench, around);
  for (int i = 0; i < groups(s); i++) {
    residual_of_legs(s, i, around, w, part);
    if (s->hub) for (int j = 0; j < 6; j++) net[j] += sum(s, i, part[j]);
  }
  if (!s->hub) return;
  double shared[3*COMMON + 1];
  shared_state(s, w, shared);
  memset(w->rp + 6, 0, BYTES(double, COMMON));
  const double *in[] = {w->payload.pose, w->payload.u, w->payload.u_dot, net, wrench, s->payload_p, shared, shared + COMMON, shared + 2*COMMON};
  double *out[] = {w->rp, w->powers + 2};
  s->of->payload_residual(in, out);
  fold_shared(s, w);
  for (int j = 0; j < 6; j++) if (s->hub_held[j] != 0) { w->reaction[j] = w->rp[j]; w->rp[j] = 0; }
}

/* Matrices of a vector of legs at rest, in the order of its functions, into scratch: mass, damping, stiffness; H is what joints
   add to the payload's stiffness; closures' Jacobians go to the arrow */
static void legs_at_rest(const Settings *s, int i, const lanes *around, Work *w, lanes *H) {
  SIZES(s);
  LegBlock *b = &w->arrow.leg[i];
  lanes *J = w->J, X[N*6];              /* by which the payload turns the legs' forces: left out of the iteration */
  const lanes *in[] = {w->leg[i].q, w->leg[i].lam, w->p[i], around};
  lanes *out[] = {w->at_rest[0], w->at_rest[1], w->at_rest[2], J, b->P, H, X};
  s->of->leg_matrices(in, out);
  if (ROWS && !POSED) {
    const lanes *joint[] = {around, w->leg[i].lam, w->joint[i]};
    lanes *at[] = {b->P, H};
    s->of->joint_matrices(joint, at);
  }
  for (long j = 0; j < N; j++) for (int k = 0; k < ROWS; k++) b->J[k + ROWS*j] = J[k + ROWS*ORDER[j]];
}

/* Their part of the matrix that is to be factored, and of the payload's */
static void matrices_of_legs(const Settings *s, int i, const lanes *around, const double *c, Work *w, double *Ap) {
  SIZES(s);
  lanes H[36], *const *A = w->at_rest;
  legs_at_rest(s, i, around, w, H);
  for (long j = 0; j < N; j++) for (long k = 0; k < N; k++) {
    long at = ORDER[k] + N*ORDER[j];
    w->arrow.leg[i].A[k + j*N] = c[0]*A[0][at] + c[1]*A[1][at] + c[2]*A[2][at];
  }
  if (c[1] != 0) { add_friction_matrix(s, i, c[1], w); add_loop(s, w, i, c[1], c[2], w->arrow.leg[i].A, w->arrow.leg[i].A); }
  if (s->hub) for (int j = 0; j < 36; j++) Ap[j%6 + j/6*HUB] += c[2]*sum(s, i, H[j]);
}

/* Factors of c_a M + c_v D + c_q K with the matrices at rest: the iteration matrix (T6.5), or the mass metric alone. */
static int factor(const Settings *s, const double *wrench, double c_v, double c_a, double c_q, Work *w) {
  SIZES(s);
  double mass[BODY*BODY], stiffness[BODY*BODY], Ap[HUB*HUB], shared[3*COMMON + 1], c[3] = {c_a, c_v, c_q};
  lanes around[OUTSIDE];
  memset(Ap, 0, BYTES(double, HUB*HUB));
  outside(s, w, wrench, around);
  for (int i = 0; i < groups(s); i++) matrices_of_legs(s, i, around, c, w, Ap);
  if (s->hub) {
    shared_state(s, w, shared);
    const double *in[] = {w->payload.pose, wrench, s->payload_p, shared};
    double *out[] = {mass, stiffness};
    s->of->payload_matrices(in, out);
    for (int j = 0; j < BODY; j++) for (int i = 0; i < BODY; i++) Ap[i + HUB*j] += c_a*mass[i + BODY*j] + c_q*stiffness[i + BODY*j];
  }
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

static double largest(lanes x) {
  double m = 0;
  for (int i = 0; i < LANES; i++) m = fmax(m, x[i]);
  return m;
}

/* 0 where all are finite, otherwise no number */
static double blemished(lanes x) {
  double sum = 0;
  for (int i = 0; i < LANES; i++) sum += 0*x[i];
  return sum;
}

/* Largest residual over what is tolerated (converged: at most 1), and whether every number is finite */
static double excess(const Settings *s, Work *w, int *finite) {
  SIZES(s);
  lanes force = {0}, r = {0}, g = {0}, faults = {0};
  double payload = 0, fault = 0;
  for (int i = 0; i < groups(s); i++) {
    force = magnitude(s->ports, w->leg[i].drive, magnitude(ROWS, w->leg[i].lam, force));
    r = magnitude(N, w->r[i], r); faults += blemish(N, w->r[i]);
    g = magnitude(ROWS, w->g[i], g); faults += blemish(ROWS, w->g[i]);
  }
  if (s->hub) for (int i = 0; i < HUB; i++) { payload = fmax(payload, fabs(w->rp[i])); fault += 0*w->rp[i]; }
  double scale = largest(force), worst = largest(r), gap = largest(g);
  worst = fmax(worst, payload)/(s->tol_force*fmax(scale, 1) + s->force_floor);
  w->closure = gap;
  worst = fmax(worst, gap/s->tol_closure);
  *finite = isfinite(fault + blemished(faults)) && isfinite(worst);
  return worst;
}

/* First leg with an infinite residual, else the one with the largest; the number of legs for the payload */
static long worst_leg(const Settings *s, const Work *w) {
  SIZES(s);
  double most = 0;
  long leg = s->legs;
  for (int i = 0; i < HUB; i++) most = fmax(most, fabs(w->rp[i]));
  for (long i = 0; i < s->legs; i++) for (long j = 0; j < N; j++) {
    double e = fabs(w->r[i/LANES][j][i%LANES]);
    if (!isfinite(e)) return i;
    if (e > most) { most = e; leg = i; }
  }
  return leg;
}

static void write_record(const Settings *s, State *x, const Work *w) {
  SIZES(s);
  long k = s->legs*N, all = k + (s->hub ? 6 : 0), ports = s->ports;
  double *o = x->record, part[3], e[3] = {0, 0, 0};
  for (int i = 0; i < groups(s); i++) {
    const LegState *leg = &w->leg[i];
    const lanes *in[] = {leg->q, leg->v, w->command[i], w->p[i]};
    lanes energies[3], force[PORTS], *out[] = {energies, force};
    s->of->leg_energies(in, out);                                           /* the springs' forces with them */
    for (int j = 0; j < 3; j++) e[j] += sum(s, i, energies[j]);
    for (long j = 0; j < ports; j++) force[j] = port_force(w, i, j) + (j < SPRINGS ? force[j] : (lanes){0});
    scatter(s, i, leg->q, N, N, o); scatter(s, i, leg->v, N, N, o + k); scatter(s, i, leg->v_dot, N, N, o + k + all);
    scatter(s, i, leg->lam, ROWS, ROWS, o + k + 2*all); scatter(s, i, force, ports, ports, o + k + 2*all + ROWS*s->legs);
  }
  if (s->hub) {
    double shared[3*COMMON + 1];
    shared_state(s, w, shared);
    const double *in[] = {w->payload.pose, w->payload.u, s->payload_p, shared, shared + COMMON};
    double *out[] = {part};
    s->of->payload_energies(in, out);
    for (int j = 0; j < 3; j++) e[j] += part[j];
    memcpy(o + 2*k, w->payload.u, 6*sizeof(double)); memcpy(o + 2*k + all, w->payload.u_dot, 6*sizeof(double));
  }
  o += k + 2*all + (ROWS + ports)*s->legs;
  memcpy(o, s->hub ? w->payload.pose : x->pose, 7*sizeof(double)); o += 7;
  memcpy(o, w->reaction, sizeof w->reaction); o += 6;
  e[2] += w->stored;
  memcpy(o, e, sizeof e); o += 3;
  memcpy(o, x->sums, BYTES(double, WORKS)); o[0] -= w->stored; o += WORKS;
  *o++ = w->closure;
  for (int i = 0; i < groups(s); i++) scatter(s, i, w->rubs[i], BRISTLES, BRISTLES, o);
  o += BRISTLES*s->legs;
  x->record = o;
}

/* Memory of a run with fixed steps [bytes], all zero before its first call; it begins where a cache line does */
EXPORTED long march_memory(const Settings *s) {
  Room m = {0, 0};
  work(&m, s);
  return m.used;
}

/* Record of the present state (used once, at the start); returns the largest closure through x->closure. */
EXPORTED void record_state(const Settings *s, State *x, const double *row, const double *wrench, char *memory) {
  Room m = {memory, 0};
  Work *w = work(&m, s);
  SIZES(s);
  int finite;
  load(s, x, w);
  w->h = 0;
  for (int i = 0; i < groups(s); i++) gather(s, i, row, s->ports*COLUMNS, s->ports*COLUMNS, w->table[i]);
  residual(s, wrench, w);
  excess(s, w, &finite);
  x->closure = w->closure;
  memcpy(x->powers, w->powers, sizeof w->powers);
  for (int i = 0; i < groups(s); i++) scatter(s, i, w->bent[i], 2*BRISTLES, 2*BRISTLES, x->bristles);
  write_record(s, x, w);
}

/* Legs' vectors are rows of numbers as well: what follows is the same for legs and payload. */

/* x one step on, along the straight line through it and its value before; for large legs along the cubic through the last
   four values, that of the step before last in before[gap], and so on */
INLINE void extrapolate(long LARGE, long count, double *restrict x, double *restrict before, long gap) {
  for (long j = 0; j < count; j++) {
    double now = x[j], *old = before + j;
    x[j] += LARGE ? 3*now - 6*old[0] + 4*old[gap] - old[2*gap] : now - old[0];
    if (LARGE) { old[2*gap] = old[gap]; old[gap] = old[0]; }
    old[0] = now;
  }
}

/* Predictor with extrapolated v_dot, Eqs. (T6.1)-(T6.3); `step` is the change of the coordinates */
INLINE void predict(const Settings *s, long LARGE, long count, double *restrict v, double *restrict v_dot,
                    double *restrict a, double *restrict before, long gap, double *restrict step) {
  double h = s->h, am = s->alpha_m, af = s->alpha_f;
  extrapolate(LARGE, count, v_dot, before, gap);
  for (long j = 0; j < count; j++) {
    double a1 = ((1 - af)*v_dot[j] + af*before[j] - am*a[j])/(1 - am);
    step[j] = h*v[j] + h*h*((0.5 - s->beta)*a[j] + s->beta*a1);
    v[j] += h*((1 - s->gamma)*a[j] + s->gamma*a1);
    a[j] = a1;
  }
}

/* Newton update, Eq. (T6.4) */
INLINE void update(const Settings *s, long count, const double *restrict dq, double *restrict v, double *restrict v_dot,
                   double *restrict a) {
  double c_q = 1/(s->beta*s->h*s->h), c_v = s->gamma*s->h*c_q, c_a = (1 - s->alpha_m)/(1 - s->alpha_f)*c_q;
  for (long j = 0; j < count; j++) { v[j] += c_v*dq[j]; v_dot[j] += c_a*dq[j]; a[j] += c_q*dq[j]; }
}

static void predict_body(const Settings *s, const double *row, Work *w, double *pose_step) {
  SIZES(s);
  const Past *past = &w->past;
  const long gap = w->gap;
  for (int i = 0; i < groups(s); i++) {
    LegState *leg = &w->leg[i];
    lanes step[N];
    extrapolate(LARGE, ROWS*LANES, (double *)leg->lam, (double *)past->lam[i], gap);
    extrapolate(LARGE, s->ports*LANES, (double *)leg->drive, (double *)past->drive[i], gap);
    predict(s, LARGE, N*LANES, (double *)leg->v, (double *)leg->v_dot, (double *)leg->a, (double *)past->v_dot[i], gap, (double *)step);
    add(N, step, leg->q);
  }
  follow_table(s, row, w);
  if (s->hub) predict(s, LARGE, 6, w->payload.u, w->payload.u_dot, w->payload.a, past->u_dot, gap, pose_step);
}

/* Solve the linear equations and correct the state */
static void correct(const Settings *s, const double *pose0, double *pose_step, Work *w) {
  SIZES(s);
  lanes *const *dq = w->dq, *const *dlam = w->dlam, *const *df = w->df;
  double dy[6];
  arrow_solve(&w->arrow, s, w->r, w->g, w->rp, dq, dlam, df, dy);
  if (s->hub) {
    update(s, 6, dy, w->payload.u, w->payload.u_dot, w->payload.a);
    for (int j = 0; j < 6; j++) pose_step[j] += dy[j];
    turned_pose(pose0, pose_step, w->payload.pose);
  }
  for (int i = 0; i < groups(s); i++) {
    LegState *leg = &w->leg[i];
    update(s, N*LANES, (double *)dq[i], (double *)leg->v, (double *)leg->v_dot, (double *)leg->a);
    add(N, dq[i], leg->q); add(ROWS, dlam[i], leg->lam); add(s->ports, df[i], leg->drive);
  }
}

/* Newton's iteration of one step; the age counts the steps since the matrix was made, and of large legs, whose matrix serves
   longer, each iteration above two as four. After the residuals are tolerable one
   more correction is made: index 3 magnifies what is left. */
static int iterate(const Settings *s, State *x, const double *wrench, double *pose_step, Work *w) {
  SIZES(s);
  double c_v = s->gamma/(s->beta*s->h), c_a = (1 - s->alpha_m)/((1 - s->alpha_f)*s->beta*s->h*s->h);
  double before = INFINITY, pose0[7];
  memcpy(pose0, w->payload.pose, sizeof pose0);
  if (s->hub) turned_pose(pose0, pose_step, w->payload.pose);
  for (long iteration = 0;; iteration++) {
    int finite;
    residual(s, wrench, w);
    double worst = excess(s, w, &finite);
    int done = worst <= 1;
    if (!finite) return NOT_FINITE;
    if (!done && iteration >= s->max_iterations) return worst < 100 ? OK : NOT_CONVERGED; /* OK: rounding floor reached */
    if (w->age >= s->max_age || (iteration > 1 && worst > 0.1*before)) {
      x->factorisations++;
      if (factor(s, wrench, c_v, c_a, 1, w)) return SINGULAR;
      w->age = 0;
    }
    before = worst;
    x->iterations++;
    if (LARGE && iteration > 1) w->age += 4;
    correct(s, pose0, pose_step, w);
    if (done) return OK;
  }
}

/* Shift what the predictor remembers, and what it starts from, by a jump */
INLINE void shift(long LARGE, long count, double scale, const double *jump, double *x, double *before, long gap) {
  for (long j = 0; j < count; j++) {
    x[j] += scale*jump[j];
    for (long k = 0; k < (LARGE ? PAST : 1); k++) before[k*gap + j] += scale*jump[j];
  }
}

/* A row of the table with what the controller holds: in `held`, or as it is */
static const double *held_row(const Settings *s, const Loop *c, const double *row, double *held) {
  if (!c) return row;
  memcpy(held, row, BYTES(double, s->legs*s->ports*COLUMNS));
  hold(s, c, split(c).u, held);
  return held;
}

/* Take a sample, if one is due, and jump to the accelerations and forces that belong to its outputs, (T26.5) */
static int take_sample(const Settings *s, State *x, const Loop *c, const double *row, const double *wrench, double now, Work *w) {
  SIZES(s);
  if (!is_due(c, now)) return OK;
  double change[c->actions + 1], dy[6], c_v = s->gamma/(s->beta*s->h), c_a = (1 - s->alpha_m)/((1 - s->alpha_f)*s->beta*s->h*s->h);
  double before = split(c).power[0], held[s->legs*s->ports*COLUMNS];
  const Past *past = &w->past;
  if (!foresees(c)) read_sample(s, c, w);
  int fault = hold_outputs(s, c, w, change);
  if (fault) return fault;
  follow_table(s, held_row(s, c, row, held), w);
  x->powers[1] += split(c).power[0] - before;
  if (w->age >= s->max_age) {
    x->factorisations++;
    if (factor(s, wrench, c_v, c_a, 1, w)) return SINGULAR;
    w->age = 0;
  }
  jump(s, c, change, w, dy);
  for (int i = 0; i < groups(s); i++) {
    LegState *leg = &w->leg[i];
    for (long j = 0; j < N; j++) leg->a[j] += c_a*w->dq[i][j];
    shift(LARGE, N*LANES, c_a, (double *)w->dq[i], (double *)leg->v_dot, (double *)past->v_dot[i], w->gap);
    shift(LARGE, ROWS*LANES, 1, (double *)w->dlam[i], (double *)leg->lam, (double *)past->lam[i], w->gap);
    shift(LARGE, s->ports*LANES, 1, (double *)w->df[i], (double *)leg->drive, (double *)past->drive[i], w->gap);
  }
  for (int j = 0; j < 6 && s->hub; j++) w->payload.a[j] += c_a*dy[j];
  if (s->hub) shift(LARGE, 6, c_a, dy, w->payload.u_dot, past->u_dot, w->gap);
  if (foresees(c)) read_sample(s, c, w);
  end_sample(c);
  return OK;
}

/* Work of the controller in a step, which is none of the drives' */
static void work_of_loop(const Settings *s, State *x, const Loop *c, const Work *w) {
  Remembered m = split(c);
  lanes *v[GROUPS];
  rates_of_legs(s, w, v);
  double now = power_of_loop(s, c, v, m.u), done = 0.5*s->h*(m.power[0] + now);
  m.power[0] = now; m.work[0] += done; x->sums[1] -= done;
}

/* Advance `steps` steps; tables have steps + 1 rows (row 0 is the present time). `resumed`: the call before with
   this memory ended there: all goes on from what it left, as if it were one. `loop`: a controller, or 0. */
EXPORTED int march(const Settings *s, State *x, const double *table, const double *wrench, long steps, long resumed, char *memory, Loop *loop) {
  Room m = {memory, 0};
  Work *w = work(&m, s);
  const Past *past = &w->past;
  SIZES(s);
  long width = s->legs*s->ports*COLUMNS;
  double pose_step[6], held[loop ? width : 1];
  if (!resumed) {
    w->age = s->max_age;
    load(s, x, w);
    w->h = s->h;
    for (int i = 0; i < groups(s); i++) {
      memcpy(past->v_dot[i], w->leg[i].v_dot, BYTES(lanes, N));
      memcpy(past->lam[i], w->leg[i].lam, BYTES(lanes, ROWS));
      memcpy(past->drive[i], w->leg[i].drive, BYTES(lanes, PORTS));
    }
    memcpy(past->u_dot, w->payload.u_dot, sizeof w->payload.u_dot);
    for (int k = 1; k < PAST && LARGE; k++) memcpy(past->u_dot + k*w->gap, past->u_dot, BYTES(double, w->gap));
  }
  if (loop) {
    follow_table(s, held_row(s, loop, table, held), w);
    lanes *v[GROUPS];
    rates_of_legs(s, w, v);
    split(loop).power[0] = power_of_loop(s, loop, v, split(loop).u);
  }
  for (long t = 1; t <= steps; t++) {
    const double *load = wrench + load_size(s)*t;
    int fault = loop ? take_sample(s, x, loop, table + (t - 1)*width, load - load_size(s), loop->begin + (double)(t - 1)*s->h, w) : OK;
    if (!fault) {
      predict_body(s, held_row(s, loop, table + t*width, held), w, pose_step);
      fault = iterate(s, x, load, pose_step, w);
    }
    if (fault) { x->steps += t; x->bad_leg = worst_leg(s, w); return fault; }
    w->age++;
    memcpy(w->bristles[0], w->bent[0], BYTES(lanes, groups(s)*2*BRISTLES));
    for (int j = 0; j < WORKS; j++) { x->sums[j] += 0.5*s->h*(x->powers[j] + w->powers[j]); x->powers[j] = w->powers[j]; }
    if (loop) work_of_loop(s, x, loop, w);
    if (t % s->output_every == 0) {
      set_commands(s, w); write_record(s, x, w);
      if (loop) record_loop(loop, split(loop).work[0]);
    }
  }
  x->steps += steps;
  store(s, w, x);
  return OK;
}

/* Add `share` times the part of the velocities that is normal to the closures in the mass metric, Eq. (T6.14):
   M n + J^T pi = 0, J n - P n_p = J v - P u, held coordinates apart. */
EXPORTED int scale_normal_velocity(const Settings *s, State *x, const double *wrench, double share, char *memory) {
  Room m = {memory, 0};
  Work *w = work(&m, s);
  SIZES(s);
  lanes v[N];
  double still[HUB], dy[6];
  memset(still, 0, BYTES(double, HUB));
  load(s, x, w);
  if (factor(s, wrench, 0, 1, 0, w)) return SINGULAR;
  for (int i = 0; i < groups(s); i++) {
    const LegBlock *b = &w->arrow.leg[i];
    memset(w->r[i], 0, BYTES(lanes, N)); memset(w->g[i], 0, BYTES(lanes, ROWS));
    for (long j = 0; j < N; j++) v[j] = w->leg[i].v[ORDER[j]];
    lanes_gemv(ROWS, N, -1, b->J, v, w->g[i]);
    for (int j = 0; j < 6; j++) for (int a = 0; a < ROWS; a++) w->g[i][a] += b->P[a + ROWS*j] * w->payload.u[j];
  }
  arrow_solve(&w->arrow, s, w->r, w->g, still, w->dq, w->dlam, w->df, dy);
  for (int i = 0; i < groups(s); i++) for (long j = 0; j < N; j++) w->leg[i].v[j] += share * w->dq[i][j];
  for (int j = 0; j < 6; j++) w->payload.u[j] += share * dy[j];
  store(s, w, x);
  return OK;
}
