/* Radau IIA of order 5: the closures' rates vanish at each stage, the closures themselves at each step's end. */
enum { STAGES = 3, LOAD = 12, WIDTH = LEGS*PORTS*COLUMNS + LOAD };

#define FREE 400.0     /* 1/s^2: square of the frequency that a motion without stiffness counts as */
#define NOISE 3e-16  /* m: what it adds to the estimate of a step's error */
#define CLOSED 1e-14 /* m: what rounding leaves */
#define CLOSINGS 10
#define BLURRED 2e-14 /* m: what rounding of places leaves in second differences of theirs */
#define TURNING 0.005  /* share of what is left of the tolerance that bristles which turn over may take in one step */

typedef struct {
  double horizon, tolerance;            /* of the whole; sum of the local errors that is allowed until the horizon */
  const double *weight, *hub_weight;    /* (N), (6): of displacements in errors, one over what is their unit */
  double longest, shortest, unsolved;   /* step; share of the local error allowed that corrections may leave */
  double output_first, output_step;     /* instants of records: those after the start, up to the end */
  long outputs, pieces, terms, most, stops;     /* most: steps of this call */
  const double *edges, *series;         /* (pieces + 1), (pieces, terms, width): Chebyshev series of the tables */
  const double *stop;                   /* (stops), ascending: instants on which steps end; the last ends the call */
  long along, springs;                  /* coordinates along a leg whose springs' forces are those of the leg: first, number */
  double forces;                        /* error of closure forces over their peak that is allowed; 0: they limit no step */
} Control;

typedef struct {                        /* from call to call, at the begin of the caller's memory */
  double time, h, spent, last_h, peak;  /* spent: sum of the local errors; peak: error over h^6, decaying */
  double rate, stages, rejected, recorded;      /* rate: of Newton's iteration; stages: whether those of the last step are there */
  double thrust[LEGS];                  /* sum of the local errors of the legs' forces; of rigid legs the largest one */
  double carried;                       /* peak of the forces of the closures, up to now */
} Memory;

typedef struct {
  Vector q, Z[STAGES], V[STAGES], A[STAGES], R[STAGES], v0, a0;
  Forces F[STAGES], f0;
  Vector last_A[STAGES]; Forces last_F[STAGES];         /* of the last step */
  lanes *gap[STAGES][GROUPS];
  lanes *bristles[STAGES + 1][GROUPS];                  /* the last: at the start */
  double pose[7], *row[STAGES], powers[STAGES][WORKS], held[STAGES];      /* held: power of the controller's forces */
  lanes *M[GROUPS], *D[GROUPS], *K[GROUPS];
  double *hub_M, *hub_K;
  ComplexArrow complex;
  lanes *thrust;                                        /* what errors of displacements are in the legs' forces */
  Arrow soft;                                           /* the robot at rest, where there is friction */
  lanes *slides[GROUPS], *lost[GROUPS];                 /* at the start: rates of sliding, shares lost in a second */
  Vector part[STAGES], change[STAGES], rhs, error, second, x, zero;     /* scratch; the last stays zero */
  Forces force[STAGES];
  lanes *parts[STAGES][GROUPS], *open[GROUPS], *rate[GROUPS], *closed[GROUPS];   /* scratch of closures; the last stays zero */
  lanes *slide[STAGES][GROUPS], *lose[STAGES][GROUPS];
} Radau;

/* The whole of the caller's memory: what is known from call to call first */
static Work *spaces(Room *m, const Settings *s, Memory **memory, Radau **radau) {
  SIZES(s);
  Radau none, *r;
  *memory = (Memory *)room(m, sizeof(Memory));
  *radau = r = (Radau *)room(m, sizeof(Radau));
  if (!r) r = &none;                    /* it is counted only */
  Work *w = work(m, s);
  Vector *vectors[] = {&r->q, &r->v0, &r->a0, &r->rhs, &r->error, &r->second, &r->x, &r->zero};
  Vector *of_stages[] = {r->Z, r->V, r->A, r->R, r->last_A, r->part, r->change};
  Forces *forces[] = {r->F, r->last_F, r->force};
  lanes **of_closures[] = {r->open, r->rate, r->closed, r->gap[0], r->gap[1], r->gap[2], r->parts[0], r->parts[1], r->parts[2]};
  lanes **matrices[] = {r->M, r->D, r->K};
  for (int i = 0; i < 8; i++) vector_room(m, s, 1, vectors[i]);
  for (int i = 0; i < 7; i++) vector_room(m, s, STAGES, of_stages[i]);
  for (int i = 0; i < 3; i++) forces_room(m, s, STAGES, forces[i]);
  forces_room(m, s, 1, &r->f0);
  for (int i = 0; i < 9; i++) room_of_legs(m, s, ROWS, of_closures[i]);
  for (int i = 0; i < 3; i++) room_of_legs(m, s, N*N, matrices[i]);
  for (int k = 0; k <= STAGES; k++) room_of_legs(m, s, 2*BRISTLES, r->bristles[k]);
  for (int k = 0; k < STAGES; k++) {
    r->row[k] = room_of_numbers(m, WIDTH);
    room_of_legs(m, s, BRISTLES, r->slide[k]); room_of_legs(m, s, BRISTLES, r->lose[k]);
  }
  r->hub_M = room_of_numbers(m, BODY*BODY); r->hub_K = room_of_numbers(m, BODY*BODY);
  r->thrust = room_of_lanes(m, groups(s));
  complex_room(m, s, &r->complex);
  if (BRISTLES) arrow_room(m, s, &r->soft);
  room_of_legs(m, s, BRISTLES, r->slides); room_of_legs(m, s, BRISTLES, r->lost);
  return w;
}

static const double NODE[STAGES] = {0.15505102572168219018, 0.64494897427831780982, 1};
static const double RK[STAGES][STAGES] = {
  {0.19681547722366042587, -0.065535425850198383804, 0.023770974348220152415},
  {0.39442431473908727700, 0.29207341166522846303, -0.041548752125997930220},
  {0.37640306270046727506, 0.51248582618842161384, 0.11111111111111111111}};
/* its inverse, with eigenvalues REAL and PAIR[0] +- i PAIR[1]; INTO: to the parts of each, FROM: back */
static const double INVERSE[STAGES][STAGES] = {{3.2247448713915885, 1.1678400846904056, -0.25319726474218102}, {-3.5678400846904053, 0.77525512860841106, 1.053197264742181}, {5.5319726474218109, -7.5319726474218092, 5}};
static const double REAL = 3.6378342527444958, PAIR[2] = {2.6810828736277541, 3.0504301992474123};
static const double INTO[STAGES][STAGES] = {{4.3255798900631568, 0.33919925181580912, 0.54177053993587432}, {4.5950103671960703, 0.36032719733585505, -0.52410568603675955}, {0.55296974905815688, -2.8281471315512685, 0.65541774719600132}};
static const double FROM[STAGES][STAGES] = {{0.091232394870893047, 0.12845806217830086, 0.027308654751321399}, {0.2417179327071072, -0.18563595103095715, -0.34824890439657519}, {0.96604818261509273, -0.909403517646862, -0}};
static const double EMBEDDED[STAGES] = {-10.048809399827414, 1.3821427331607481, -0.33333333333333331};

/* Values of a series at an instant */
static void evaluate_series(const Control *c, long width, double t, double *row) {
  long k = 0;
  while (k < c->pieces - 1 && t >= c->edges[k + 1]) k++;
  double a = c->edges[k], b = c->edges[k + 1], x = (2*t - a - b)/(b - a), before = 1, now = x;
  const double *term = c->series + k*c->terms*width;
  memcpy(row, term, BYTES(double, width));
  for (long j = 1; j < c->terms; j++) {
    term += width;
    for (long i = 0; i < width; i++) row[i] += now*term[i];
    double next = 2*x*now - before;
    before = now; now = next;
  }
}

/* omega from the rate of a rotation vector */
static void spin(const double *theta, const double *rate, double *omega) {
  double t2 = theta[0]*theta[0] + theta[1]*theta[1] + theta[2]*theta[2], t = sqrt(t2);
  double a = t > 1e-2 ? (1 - cos(t))/t2 : 0.5 - t2/24, b = t > 1e-2 ? (t - sin(t))/(t*t2) : 1.0/6 - t2/120;
  double c[3] = {theta[1]*rate[2] - theta[2]*rate[1], theta[2]*rate[0] - theta[0]*rate[2], theta[0]*rate[1] - theta[1]*rate[0]};
  double d[3] = {theta[1]*c[2] - theta[2]*c[1], theta[2]*c[0] - theta[0]*c[2], theta[0]*c[1] - theta[1]*c[0]};
  for (int i = 0; i < 3; i++) omega[i] = rate[i] - a*c[i] + b*d[i];
}

INLINE void blend(long count, const double *c, const lanes *x0, const lanes *x1, const lanes *x2, const lanes *shift,
                  lanes *restrict y) {
  double c0 = c[0], c1 = c[1], c2 = c[2];
  if (shift) for (long j = 0; j < count; j++) y[j] = (c0*x0[j] + c1*x1[j] + c2*x2[j]) + shift[j];
  else for (long j = 0; j < count; j++) y[j] = c0*x0[j] + c1*x1[j] + c2*x2[j];
}

/* y = sum over stages of c x */
static void combine(const Settings *s, const double *c, const Vector *x, double scale, const Vector *shift, Vector *y) {
  SIZES(s);
  double k[STAGES] = {scale*c[0], scale*c[1], scale*c[2]};
  for (int i = 0; i < groups(s); i++) blend(N, k, x[0].leg[i], x[1].leg[i], x[2].leg[i], shift ? shift->leg[i] : 0, y->leg[i]);
  const double *x0 = x[0].hub, *x1 = x[1].hub, *x2 = x[2].hub;
  double hub[6];                        /* a loop of known size, and what all legs share */
  for (int j = 0; j < 6; j++) hub[j] = k[0]*x0[j] + k[1]*x1[j] + k[2]*x2[j];
  if (shift) for (int j = 0; j < 6; j++) hub[j] += shift->hub[j];
  for (long j = 6; j < HUB; j++) {
    double t = k[0]*x0[j] + k[1]*x1[j] + k[2]*x2[j];
    y->hub[j] = shift ? t + shift->hub[j] : t;
  }
  memcpy(y->hub, hub, sizeof hub);
}

/* The same of forces; c has a fourth entry for what is at the start, if there is one */
static void combine_forces(const Settings *s, const double *c, const Forces *f, const Forces *start, Forces *y) {
  long sizes[] = {s->of->rows, s->ports};
  for (int i = 0; i < groups(s); i++) for (int part = 0; part < 2; part++) {
#define OF(x) (part ? (x).drive[i] : (x).lam[i])
    const lanes *x0 = OF(f[0]), *x1 = OF(f[1]), *x2 = OF(f[2]), *first = start ? OF(*start) : 0;
    lanes *to = OF(*y);
    for (long j = 0; j < sizes[part]; j++) {
      lanes t = c[0]*x0[j] + c[1]*x1[j] + c[2]*x2[j];
      if (first) t += c[3]*first[j];
      to[j] = t;
    }
#undef OF
  }
}

static void changes_of_rates(const Settings *s, const Radau *r, Vector *change) {
  SIZES(s);
  for (int k = 0; k < STAGES; k++) {
    for (int i = 0; i < groups(s); i++) {
      const lanes *V = r->V[k].leg[i], *v0 = r->v0.leg[i];
      lanes *to = change[k].leg[i];
      for (long j = 0; j < N; j++) to[j] = V[j] - v0[j];
    }
    for (int j = 0; j < 6; j++) change[k].hub[j] = r->V[k].hub[j] - r->v0.hub[j];
  }
}

/* Rates and accelerations of the stages out of their displacements */
static void rates_of_stages(const Settings *s, double h, Radau *r) {
  Vector *change = r->change;
  for (int k = 0; k < STAGES; k++) {
    combine(s, INVERSE[k], r->Z, 1/h, 0, &r->V[k]);
    double rate[3];
    memcpy(rate, r->V[k].hub + 3, sizeof rate);
    spin(r->Z[k].hub + 3, rate, r->V[k].hub + 3);
  }
  changes_of_rates(s, r, change);
  for (int k = 0; k < STAGES; k++) combine(s, INVERSE[k], change, 1/h, 0, &r->A[k]);
}

/* The state of a displacement from the step's start, with given rates, accelerations and forces, in the work space */
static void place(const Settings *s, const Radau *r, const Vector *Z, const Vector *V, const Vector *A, const Forces *F,
                  const double *row, Work *w) {
  SIZES(s);
  for (int i = 0; i < groups(s); i++) {
    LegState *leg = &w->leg[i];
    const lanes *q = r->q.leg[i], *moved = Z->leg[i];
    lanes *to = leg->q;
    for (long j = 0; j < N; j++) to[j] = q[j] + moved[j];
    memcpy(leg->v, V->leg[i], BYTES(lanes, N)); memcpy(leg->v_dot, A->leg[i], BYTES(lanes, N));
    memcpy(leg->lam, F->lam[i], BYTES(lanes, ROWS)); memcpy(leg->drive, F->drive[i], BYTES(lanes, s->ports));
  }
  follow_table(s, row, w);
  if (!s->hub) return;
  turned_pose(r->pose, Z->hub, w->payload.pose);
  memcpy(w->payload.u, V->hub, sizeof w->payload.u); memcpy(w->payload.u_dot, A->hub, sizeof w->payload.u_dot);
}

/* How far legs are from closed, and how fast that changes */
static void closing(const Settings *s, const double *load, Work *w, lanes *const *gap, lanes *const *rate) {
  SIZES(s);
  lanes around[OUTSIDE], u[6];
  if (!ROWS) return;
  outside(s, w, load, around);
  for (int j = 0; j < 6; j++) u[j] = (lanes){0} + w->payload.u[j];
  for (int i = 0; i < groups(s); i++) {
    const lanes *in[] = {w->leg[i].q, w->leg[i].v, w->p[i], around, u};
    lanes *out[] = {gap[i], rate[i]};
    s->of->leg_closing(in, out);
    if (ROWS && !POSED) {
      lanes point[3], change[3];
      const lanes *joint[] = {around, u, w->joint[i]};
      lanes *at[] = {point, change};
      s->of->joint_closing(joint, at);
      for (int j = 0; j < 3; j++) { gap[i][j] -= point[j]; rate[i][j] -= change[j]; }
    }
  }
}

/* Bristles at the stages by the rates of sliding there, Eq. (T19.18) */
static void bend(const Settings *s, double h, Radau *r, Work *w) {
  SIZES(s);
  if (!BRISTLES) return;
  for (int k = 0; k < STAGES; k++) {
    place(s, r, &r->Z[k], &r->V[k], &r->A[k], &r->F[k], r->row[k], w);
    for (int i = 0; i < groups(s); i++) {
      const lanes *in[] = {w->leg[i].q, w->leg[i].v, w->p[i]};
      lanes *out[] = {r->slide[k][i], r->lose[k][i]};
      s->of->leg_sliding(in, out);
      memcpy(r->bristles[k][i] + BRISTLES, r->slide[k][i], BYTES(lanes, BRISTLES));
    }
  }
  for (int i = 0; i < groups(s); i++) for (int b = 0; b < BRISTLES; b++) {
    lanes A[9], inverse[9], bent[3];
    for (int k = 0; k < STAGES; k++) {
      bent[k] = r->bristles[STAGES][i][b];
      for (int j = 0; j < STAGES; j++) {
        A[k + 3*j] = h*RK[k][j]*r->lose[j][i][b] + (k == j);
        bent[k] += h*RK[k][j]*r->slide[j][i][b];
      }
    }
    invert3(A, inverse);
    for (int k = 0; k < STAGES; k++)
      r->bristles[k][i][b] = inverse[k]*bent[0] + inverse[k + 3]*bent[1] + inverse[k + 6]*bent[2];
  }
}

/* Stiffness of the bristles at the start of a step: their growth with the rates over a while in which a stage's rate is new */
static void stiffen(const Settings *s, int i, double h, Radau *r, Work *w) {
  SIZES(s);
  if (!BRISTLES) return;
  LegState *leg = &w->leg[i];
  lanes span = (lanes){0} + 2*h/REAL, *D = w->at_rest[0];
  const lanes *in[] = {leg->q, leg->v, leg->lam, w->bristles[i], &span, w->p[i]};
  lanes *out[] = {D};
  s->of->leg_friction_matrix(in, out);
  for (int j = 0; j < N; j++) for (int k = 0; k < N; k++) r->K[i][k + N*j] += REAL/h*D[ORDER[k] + N*ORDER[j]];
}

/* Mass, damping and stiffness at rest of legs and payload; closures' Jacobians go to the arrow */
static void rest(const Settings *s, const double *load, double h, Radau *r, Work *w) {
  SIZES(s);
  lanes around[OUTSIDE], H[36], *const *A = w->at_rest;
  outside(s, w, load, around);
  memset(r->hub_K, 0, BYTES(double, BODY*BODY));
  for (int g = 0; g < groups(s); g++) {
    legs_at_rest(s, g, around, w, H);
    for (int j = 0; j < N; j++) for (int k = 0; k < N; k++) {
      long at = ORDER[k] + N*ORDER[j], to = k + N*j;
      r->M[g][to] = A[0][at]; r->D[g][to] = A[1][at]; r->K[g][to] = A[2][at];
    }
    stiffen(s, g, h, r, w);
    add_loop(s, w, g, 1, 1, r->D[g], r->K[g]);
    if (s->hub) for (int j = 0; j < 36; j++) r->hub_K[j%6 + j/6*BODY] += sum(s, g, H[j]);
  }
  if (!s->hub) return;
  double stiffness[BODY*BODY], shared[3*COMMON + 1];
  shared_state(s, w, shared);
  const double *in[] = {w->payload.pose, load, s->payload_p, shared};
  double *out[] = {r->hub_M, stiffness};
  s->of->payload_matrices(in, out);
  for (int j = 0; j < BODY*BODY; j++) r->hub_K[j] += stiffness[j];
}

/* The robot at rest, what has no stiffness as in the estimate of errors: how far forces move it that last */
static int factor_soft(const Settings *s, Radau *r, Work *w) {
  SIZES(s);
  if (!BRISTLES) return OK;
  double hub[HUB*HUB];
  memset(hub, 0, BYTES(double, HUB*HUB));
  r->soft.size = w->arrow.size;
  for (int g = 0; g < groups(s); g++) {
    const LegBlock *from = &w->arrow.leg[g];
    LegBlock *to = &r->soft.leg[g];
    memcpy(to->J, from->J, BYTES(lanes, ROWS*N)); memcpy(to->P, from->P, BYTES(lanes, ROWS*6)); memcpy(to->held, from->held, BYTES(lanes, N));
    memcpy(to->unknown, from->unknown, sizeof to->unknown); memcpy(to->any, from->any, sizeof to->any);
    for (int j = 0; j < N*N; j++) to->A[j] = FREE*r->M[g][j] + r->K[g][j];
  }
  for (int j = 0; j < BODY; j++) for (int i = 0; i < BODY; i++) hub[i + HUB*j] = FREE*r->hub_M[i + BODY*j] + r->hub_K[i + BODY*j];
  return arrow_factor(&r->soft, s, hub);
}

static int factor_stages(const Settings *s, double h, Radau *r, Work *w) {
  SIZES(s);
  double c[3][3] = {{REAL*REAL/(h*h), REAL/h, 1}, {(PAIR[0]*PAIR[0] - PAIR[1]*PAIR[1])/(h*h), PAIR[0]/h, 1}, {2*PAIR[0]*PAIR[1]/(h*h), PAIR[1]/h, 0}};
  double hub[3][HUB*HUB];
  const double *pair[2] = {hub[1], hub[2]};
  for (int k = 0; k < 3; k++) memset(hub[k], 0, BYTES(double, HUB*HUB));
  for (int g = 0; g < groups(s); g++) {
    lanes *to[3] = {w->arrow.leg[g].A, r->complex.leg[g].A[0], r->complex.leg[g].A[1]};
    for (int k = 0; k < 3; k++) for (int j = 0; j < N*N; j++) to[k][j] = c[k][0]*r->M[g][j] + c[k][1]*r->D[g][j] + c[k][2]*r->K[g][j];
  }
  for (int k = 0; k < 3; k++) for (int j = 0; j < BODY; j++) for (int i = 0; i < BODY; i++)
    hub[k][i + HUB*j] = c[k][0]*r->hub_M[i + BODY*j] + c[k][2]*r->hub_K[i + BODY*j];
  if (arrow_factor(&w->arrow, s, hub[0])) return SINGULAR;
  return complex_factor(&r->complex, &w->arrow, s, pair);
}

/* y += s A x with the matrices of all coordinates; those that legs share have their row in the payload's */
static void multiply(const Settings *s, double scale, lanes *const *A, const double *hub, const Vector *x, Vector *y) {
  SIZES(s);
  for (int g = 0; g < groups(s); g++) {
    const lanes *of = x->leg[g];
    lanes from[N], to[N], *into = y->leg[g];
    for (long j = 0; j < N; j++) { from[j] = of[ORDER[j]]; to[j] = (lanes){0}; }
    lanes_gemv(N, N, scale, A[g], from, to);
    for (long j = 0; j < N; j++) into[ORDER[j]] += to[j];
  }
  double body[BODY];
  memcpy(body, x->hub, 6*sizeof(double));
  for (int k = 0; k < BODY - 6; k++) body[6 + k] = x->leg[0][ORDER[N - COMMON + k]][0];
  if (hub) gemv(BODY, BODY, scale, hub, body, y->hub);
  for (int k = 0; k < COMMON; k++) for (int g = 0; g < groups(s); g++) {
    lanes *row = &y->leg[g][ORDER[N - COMMON + k]];
    y->hub[6 + k] += sum(s, g, *row);
    *row = (lanes){0};
  }
}

/* Largest displacement in units of what counts, infinite where it is no number */
static double norm(const Settings *s, const Control *c, const Vector *x) {
  SIZES(s);
  lanes m = {0}, faults = {0};
  double most = 0, fault = 0;
  for (int g = 0; g < groups(s); g++) {
    const lanes *of = x->leg[g];
    lanes y[N];
    for (long j = 0; j < N; j++) y[j] = c->weight[j]*of[j];
    m = magnitude(N, y, m); faults += blemish(N, of);
  }
  if (s->hub) for (int j = 0; j < 6; j++) { most = fmax(most, fabs(c->hub_weight[j]*x->hub[j])); fault += 0*x->hub[j]; }
  return isfinite(fault + blemished(faults)) ? fmax(most, largest(m)) : INFINITY;
}

/* What a displacement is in the forces of the legs' springs, added to the size of what others are */
static void add_thrust(const Settings *s, const Control *c, const Vector *x, double scale, Radau *r) {
  SIZES(s);
  for (int g = 0; g < groups(s); g++) for (long k = 0; k < c->springs; k++) {
    lanes force = {0};
    for (int j = 0; j < N; j++) force += r->K[g][PLACE[c->along + k] + N*j]*x->leg[g][ORDER[j]];
    for (int i = 0; i < LANES; i++) r->thrust[g][i] += scale*fabs(force[i]);
  }
}

static void arrow_solve_vector(const Settings *s, const Arrow *a, const Vector *r, lanes *const *g, Vector *dq, Forces *df) {
  arrow_solve(a, s, r->leg, g, r->hub, dq->leg, df ? df->lam : 0, df ? df->drive : 0, dq->hub);
}

static void copy_bristles(const Settings *s, lanes *const *from, lanes *const *to) {
  for (int i = 0; i < groups(s); i++) memcpy(to[i], from[i], BYTES(lanes, 2*s->of->bristles));
}

/* Residuals of a stage */
static void evaluate_stage(const Settings *s, int k, Radau *r, Work *w) {
  SIZES(s);
  const double *row = r->row[k], *load = row + s->legs*s->ports*COLUMNS;
  place(s, r, &r->Z[k], &r->V[k], &r->A[k], &r->F[k], row, w);
  copy_bristles(s, r->bristles[k], w->bristles);
  residual(s, load, w);
  closing(s, load, w, r->open, r->gap[k]);
  for (int i = 0; i < groups(s); i++) memcpy(r->R[k].leg[i], w->r[i], BYTES(lanes, N));
  memcpy(r->R[k].hub, w->rp, BYTES(double, HUB));
  memcpy(r->powers[k], w->powers, sizeof w->powers);
}

/* One correction of all stages; its size in the units of errors */
static double correct_stages(const Settings *s, const Control *c, double h, Radau *r, Work *w) {
  SIZES(s);
  Vector *part = r->part, *change = r->change, *x = &r->x;
  Forces *force = r->force;
  lanes *(*gap)[GROUPS] = r->parts;
  double most = 0, size = PAIR[0]*PAIR[0] + PAIR[1]*PAIR[1];
  for (int k = 0; k < STAGES; k++) {
    combine(s, INTO[k], r->R, 1, 0, &part[k]);
    for (int i = 0; i < groups(s); i++) for (int j = 0; j < ROWS; j++)
      gap[k][i][j] = h*(INTO[k][0]*r->gap[0][i][j] + INTO[k][1]*r->gap[1][i][j] + INTO[k][2]*r->gap[2][i][j]);
  }
  for (int i = 0; i < groups(s); i++) for (int j = 0; j < ROWS; j++) {          /* over the eigenvalues: dq stands for dv */
    lanes re = gap[1][i][j], im = gap[2][i][j];
    gap[0][i][j] *= 1/REAL;
    gap[1][i][j] = (PAIR[0]*re + PAIR[1]*im)/size; gap[2][i][j] = (PAIR[0]*im - PAIR[1]*re)/size;
  }
  arrow_solve_vector(s, &w->arrow, &part[0], gap[0], &change[0], &force[0]);
  complex_solve(&r->complex, &w->arrow, s, part + 1, gap + 1, change + 1, force + 1);
  for (int k = 0; k < STAGES; k++) {
    double parts[4] = {FROM[k][0], FROM[k][1], FROM[k][2], 1};
    combine(s, FROM[k], change, 1, 0, x);
    combine_forces(s, parts, force, &r->F[k], &r->F[k]);
    for (int i = 0; i < groups(s); i++) add(N, x->leg[i], r->Z[k].leg[i]);
    for (int j = 0; j < 6; j++) r->Z[k].hub[j] += x->hub[j];
    most = fmax(most, norm(s, c, x));
  }
  return most;
}

/* Values at theta (of the step; 0: its start) of the polynomial through start and stages, or through the stages alone */
static void through(double theta, int start, double *c) {
  double x[4] = {NODE[0], NODE[1], NODE[2], 0};
  for (int i = 0; i < 3 + start; i++) {
    c[i] = 1;
    for (int j = 0; j < 3 + start; j++) if (j != i) c[i] *= (theta - x[j])/(x[i] - x[j]);
  }
}

static void copy_vector(const Settings *s, const Vector *from, Vector *to) {
  SIZES(s);
  for (int i = 0; i < groups(s); i++) memcpy(to->leg[i], from->leg[i], BYTES(lanes, N));
  memcpy(to->hub, from->hub, BYTES(double, HUB));
}
static void copy_forces(const Settings *s, const Forces *from, Forces *to) {
  for (int i = 0; i < groups(s); i++) {
    memcpy(to->lam[i], from->lam[i], BYTES(lanes, s->of->rows)); memcpy(to->drive[i], from->drive[i], BYTES(lanes, s->ports));
  }
}
static void clear_vector(const Settings *s, Vector *x) {
  SIZES(s);
  for (int i = 0; i < groups(s); i++) memset(x->leg[i], 0, BYTES(lanes, N));
  memset(x->hub, 0, BYTES(double, HUB));
}

/* Accelerations and forces of the stages extrapolated from those of the last step (none: as at the start), and what follows */
static void predict_stages(const Settings *s, const Memory *m, double h, Radau *r) {
  for (int k = 0; k < STAGES; k++) {
    double c[4];
    if (m->stages == 0) { copy_vector(s, &r->a0, &r->A[k]); copy_forces(s, &r->f0, &r->F[k]); continue; }
    through(1 + NODE[k]*h/m->last_h, 0, c);
    combine(s, c, r->last_A, 1, 0, &r->A[k]);
    combine_forces(s, c, r->last_F, 0, &r->F[k]);
  }
  for (int k = 0; k < STAGES; k++) combine(s, RK[k], r->A, h, &r->v0, &r->V[k]);
  for (int k = 0; k < STAGES; k++) combine(s, RK[k], r->V, h, 0, &r->Z[k]);
}

/* Newton's iteration of all stages */
static int iterate_stages(const Settings *s, State *x, const Control *c, double h, double goal, double rounding, double *rate, Radau *r,
                          Work *w) {
  double before = 0;
  for (int iteration = 0; iteration < 8; iteration++) {
    rates_of_stages(s, h, r);
    bend(s, h, r, w);
    for (int k = 0; k < STAGES; k++) evaluate_stage(s, k, r, w);
    x->iterations++;
    double size = correct_stages(s, c, h, r, w);
    if (!isfinite(size)) return NOT_FINITE;
    if (iteration) {
      double now = size/fmax(before, 1e-300);
      *rate = fmax(now, 0.1 * *rate);
      if (now > 0.9 && size < rounding) { rates_of_stages(s, h, r); return OK; }
      if (now > 0.9 && size > goal) return NOT_CONVERGED;
    }
    if (size <= 1e-3*goal || (*rate < 1 && (iteration || *rate > 0) && *rate/(1 - *rate)*size <= goal)) { rates_of_stages(s, h, r); return OK; }
    before = size;
  }
  return NOT_CONVERGED;
}

/* Estimate of the local error, of order 6 in h: that of order 4 of the embedded formula, times h^2 (K + FREE M), twice filtered */
static double estimate(const Settings *s, const Control *c, double h, Radau *r, Work *w) {
  SIZES(s);
  Vector *speed = &r->part[0], *acceleration = &r->part[1], *rhs = &r->rhs, *error = &r->error, *second = &r->second;
  changes_of_rates(s, r, r->change);
  combine(s, EMBEDDED, r->Z, 1/h, &r->v0, speed);
  combine(s, EMBEDDED, r->change, 1/h, &r->a0, acceleration);
  for (int g = 0; g < groups(s); g++) for (long k = 0; k < s->ports; k++) {      /* what is given has no error */
    lanes free = 1.0 - w->hold[g][k];
    speed->leg[g][s->port[k]] *= free; acceleration->leg[g][s->port[k]] *= free;
  }
  clear_vector(s, rhs);
  for (int g = 0; g < groups(s); g++) for (int j = 0; j < N; j++) acceleration->leg[g][j] += REAL/h*speed->leg[g][j];
  for (int j = 0; j < 6; j++) acceleration->hub[j] += REAL/h*speed->hub[j];
  multiply(s, -1, r->M, s->hub ? r->hub_M : 0, acceleration, rhs);
  multiply(s, -1, r->D, 0, speed, rhs);
  arrow_solve_vector(s, &w->arrow, rhs, r->closed, error, 0);
  clear_vector(s, rhs);
  multiply(s, -1, r->K, s->hub ? r->hub_K : 0, error, rhs);
  multiply(s, -FREE, r->M, s->hub ? r->hub_M : 0, error, rhs);
  arrow_solve_vector(s, &w->arrow, rhs, r->closed, second, 0);
  memset(r->thrust, 0, BYTES(lanes, groups(s)));
  add_thrust(s, c, second, 1, r);
  return norm(s, c, second);
}

/* Largest of the forces that closures take, not their moments, by legs as well where that is asked for */
static double carried(const Settings *s, const Forces *f, double *each) {
  double most = 0;
  for (int g = 0; g < groups(s); g++) for (int i = 0; i < LANES && g*LANES + i < s->legs; i++) {
    double squares = 0;
    for (int j = 0; j < 3 && j < s->of->rows; j++) squares += f->lam[g][j][i]*f->lam[g][j][i];
    most = fmax(most, sqrt(squares));
    if (each) each[g*LANES + i] = fmax(each[g*LANES + i], sqrt(squares));
  }
  return most;
}

/* Estimate of the error of forces where nothing elastic tells it: what balances the accelerations of the embedded formula, of
   order 3 in h, Eq. (T6.35); over their peak. Accelerations that may be rounding leave none. */
static double estimate_forces(const Settings *s, const Control *c, double h, const Memory *m, Radau *r, Work *w) {
  SIZES(s);
  if (!(c->forces > 0)) return 0;
  Vector *acceleration = &r->part[1];
  lanes most = {0};
  combine(s, EMBEDDED, r->change, 1/h, &r->a0, acceleration);
  for (int g = 0; g < groups(s); g++) for (long k = 0; k < s->ports; k++) acceleration->leg[g][s->port[k]] *= 1.0 - w->hold[g][k];
  for (int g = 0; g < groups(s); g++) most = magnitude(N, acceleration->leg[g], most);
  double size = largest(most);
  for (int j = 0; j < 6 && s->hub; j++) size = fmax(size, fabs(acceleration->hub[j]));
  clear_vector(s, &r->rhs);
  multiply(s, -1, r->M, s->hub ? r->hub_M : 0, acceleration, &r->rhs);
  arrow_solve_vector(s, &w->arrow, &r->rhs, r->closed, &r->x, &r->force[0]);
  if (size*h*h < BLURRED) return 0;
  return carried(s, &r->force[0], 0)/fmax(fmax(m->carried, carried(s, &r->F[2], 0)), 1e-300);
}

/* Estimate of the error that bristles leave, twice how far their own, of order 4 of the embedded formula, moves the robot at
   rest: it stays where they stick. Where they turn over what is twice filtered does not see it, Eq. (T19.20). */
static double estimate_bristles(const Settings *s, const Control *c, double h, Radau *r, Work *w) {
  SIZES(s);
  if (!BRISTLES) return 0;
  Vector *rhs = &r->rhs, *moved = &r->second;
  clear_vector(s, rhs);
  for (int i = 0; i < groups(s); i++) {
    LegState *leg = &w->leg[i];
    lanes bent[2*BRISTLES], wrong[N], state[2*BRISTLES], force[BRISTLES], rate[BRISTLES], energies[2], still = {0};
    memcpy(bent, r->bristles[2][i], BYTES(lanes, 2*BRISTLES));
    const lanes *in[] = {leg->q, leg->v, leg->lam, bent, &still, w->p[i]};
    lanes *out[] = {wrong, state, force, rate, energies};
    s->of->leg_friction(in, out);
    for (int j = 0; j < N; j++) rhs->leg[i][j] = -wrong[j];
    for (int b = 0; b < BRISTLES; b++) {
      lanes z = r->bristles[STAGES][i][b], e = r->slides[i][b] - r->lost[i][b]*z;
      for (int k = 0; k < STAGES; k++) e += EMBEDDED[k]/h*(r->bristles[k][i][b] - z);
      bent[b] += e/(REAL/h + r->lost[i][b]);
    }
    s->of->leg_friction(in, out);
    for (int j = 0; j < N; j++) rhs->leg[i][j] += wrong[j];
  }
  arrow_solve_vector(s, &r->soft, rhs, r->closed, moved, 0);
  add_thrust(s, c, moved, 2, r);
  return 2*norm(s, c, moved);
}

/* Correct the places of the state in the work space by how far legs are from closed, with the last matrices */
static void close_places(const Settings *s, lanes *const *gap, Radau *r, Work *w) {
  SIZES(s);
  double before[7];
  arrow_solve_vector(s, &w->arrow, &r->zero, gap, &r->x, 0);
  for (int i = 0; i < groups(s); i++) for (int j = 0; j < N; j++) w->leg[i].q[j] += r->x.leg[i][j];
  memcpy(before, w->payload.pose, sizeof before);
  turned_pose(before, r->x.hub, w->payload.pose);
}

/* The same for a record, until rounding is left, and of its rates */
static void close_record(const Settings *s, const double *load, Radau *r, Work *w) {
  SIZES(s);
  lanes *const *gap = r->open, *const *rate = r->rate;
  closing(s, load, w, gap, rate);
  arrow_solve_vector(s, &w->arrow, &r->zero, rate, &r->x, 0);
  for (int i = 0; i < groups(s); i++) for (int j = 0; j < N; j++) w->leg[i].v[j] += r->x.leg[i][j];
  for (int j = 0; j < 6; j++) w->payload.u[j] += r->x.hub[j];
  double before = INFINITY;                             /* matrices of an earlier place close by a share each time */
  for (int round = 0; round < CLOSINGS; round++, before = w->closure) {
    lanes most = {0};
    for (int i = 0; i < groups(s); i++) most = magnitude(ROWS, gap[i], most);
    w->closure = largest(most);
    if (w->closure < CLOSED || w->closure > before/2) break;
    close_places(s, gap, r, w);
    closing(s, load, w, gap, rate);
  }
}

/* The accepted state becomes the start of a step */
static void start_step(const Settings *s, const Work *w, Radau *r) {
  SIZES(s);
  for (int i = 0; i < groups(s) && BRISTLES; i++) {
    const lanes *in[] = {w->leg[i].q, w->leg[i].v, w->p[i]};
    lanes *out[] = {r->slides[i], r->lost[i]};
    s->of->leg_sliding(in, out);
  }
  for (int i = 0; i < groups(s); i++) {
    memcpy(r->q.leg[i], w->leg[i].q, BYTES(lanes, N)); memcpy(r->v0.leg[i], w->leg[i].v, BYTES(lanes, N));
    memcpy(r->a0.leg[i], w->leg[i].v_dot, BYTES(lanes, N));
    memcpy(r->f0.lam[i], w->leg[i].lam, BYTES(lanes, ROWS)); memcpy(r->f0.drive[i], w->leg[i].drive, BYTES(lanes, s->ports));
  }
  copy_bristles(s, w->bristles, r->bristles[STAGES]);
  memcpy(r->pose, w->payload.pose, sizeof r->pose);
  memcpy(r->v0.hub, w->payload.u, sizeof w->payload.u); memcpy(r->a0.hub, w->payload.u_dot, sizeof w->payload.u_dot);
}

/* The state at theta in the work space. Displacements are the integral of the rates' polynomial, which is of one degree more
   than that of the stages, and what it misses at the end. */
static void state_at(const Settings *s, double theta, double h, const Radau *r, const double *row, Work *w) {
  SIZES(s);
  static const double node[3] = {0.11270166537925831148, 0.5, 0.88729833462074168852}, weight[3] = {5.0/18, 8.0/18, 5.0/18};
  double part[4] = {0}, all[4] = {0}, c[4], share = theta*theta*theta, moved[6];
  for (int i = 0; i < 3; i++) {
    through(node[i]*theta, 1, c);
    for (int j = 0; j < 4; j++) part[j] += h*theta*weight[i]*c[j];
    through(node[i], 1, c);
    for (int j = 0; j < 4; j++) all[j] += h*weight[i]*c[j];
  }
  for (int j = 0; j < 4; j++) part[j] -= share*all[j];
  through(theta, 1, c);
#define BLEND(c, x, start, of) (c[0]*x[0].of + c[1]*x[1].of + c[2]*x[2].of + c[3]*start.of)
  for (int i = 0; i < groups(s); i++) {
    LegState *leg = &w->leg[i];
    for (int j = 0; j < N; j++) {
      leg->q[j] = r->q.leg[i][j] + (BLEND(part, r->V, r->v0, leg[i][j]) + share*r->Z[2].leg[i][j]);
      leg->v[j] = BLEND(c, r->V, r->v0, leg[i][j]);
      leg->v_dot[j] = BLEND(c, r->A, r->a0, leg[i][j]);
    }
    for (int j = 0; j < ROWS; j++) leg->lam[j] = BLEND(c, r->F, r->f0, lam[i][j]);
    for (long j = 0; j < s->ports; j++) leg->drive[j] = BLEND(c, r->F, r->f0, drive[i][j]);
    for (int b = 0; b < 2*BRISTLES; b++) {
      w->bristles[i][b] = c[3]*r->bristles[STAGES][i][b];
      for (int k = 0; k < STAGES; k++) w->bristles[i][b] += c[k]*r->bristles[k][i][b];
    }
  }
  follow_table(s, row, w);
  if (!s->hub) return;
  for (int j = 0; j < 6; j++) {
    double rate[STAGES], start = r->v0.hub[j];
    for (int k = 0; k < STAGES; k++) {                                          /* those of the rotation vector in displacements */
      rate[k] = j < 3 ? r->V[k].hub[j] : (INVERSE[k][0]*r->Z[0].hub[j] + INVERSE[k][1]*r->Z[1].hub[j] + INVERSE[k][2]*r->Z[2].hub[j])/h;
    }
    moved[j] = part[0]*rate[0] + part[1]*rate[1] + part[2]*rate[2] + part[3]*start + share*r->Z[2].hub[j];
    w->payload.u[j] = BLEND(c, r->V, r->v0, hub[j]);
    w->payload.u_dot[j] = BLEND(c, r->A, r->a0, hub[j]);
  }
#undef BLEND
  turned_pose(r->pose, moved, w->payload.pose);
}

/* Energies up to theta of a step, over its length: integrals of the polynomial of the powers. `work`: of a controller, or 0 */
static void powers_until(double theta, double h, const Radau *r, double *sums, double *work) {
  static const double at[3] = {0.11270166537925831148, 0.5, 0.88729833462074168852}, weight[3] = {5.0/18, 8.0/18, 5.0/18};
  for (int i = 0; i < 3; i++) {
    double c[4];
    through(at[i]*theta, 0, c);
    for (int j = 0; j < WORKS; j++) sums[j] += h*theta*weight[i]*(c[0]*r->powers[0][j] + c[1]*r->powers[1][j] + c[2]*r->powers[2][j]);
    if (!work) continue;
    double done = h*theta*weight[i]*(c[0]*r->held[0] + c[1]*r->held[1] + c[2]*r->held[2]);
    *work += done; sums[1] -= done;
  }
}

/* Record of an instant within a step */
static void record_within(const Settings *s, State *x, const Control *c, double t, double theta, double h, Loop *loop, Radau *r, Work *w) {
  double row[WIDTH], sums[WORKS], work = loop ? split(loop).work[0] : 0;
  long width = s->legs*s->ports*COLUMNS;
  evaluate_series(c, width + load_size(s), t, row);
  if (loop) hold(s, loop, split(loop).u, row);
  state_at(s, theta, h, r, row, w);
  w->closure = 0;
  if (s->of->rows) close_record(s, row + width, r, w);
  set_commands(s, w);
  int more = s->of->bristles > 0;                                          /* for friction, and for what holds the payload */
  for (int j = 0; j < 6; j++) more |= s->hub_held[j] != 0;
  if (more) residual(s, row + width, w);
  memcpy(sums, x->sums, sizeof sums);
  powers_until(theta, h, r, x->sums, loop ? &work : 0);
  write_record(s, x, w);
  if (loop) record_loop(loop, work);
  memcpy(x->sums, sums, sizeof sums);
}

/* Back to the start of the step */
static void step_back(const Settings *s, const Radau *r, const double *row, Work *w) {
  place(s, r, &r->zero, &r->v0, &r->a0, &r->f0, row, w);
  copy_bristles(s, r->bristles[STAGES], w->bristles);
  memcpy(w->payload.pose, r->pose, sizeof r->pose);
}

/* As `march_memory`; its first numbers are those of `Memory` */
long radau_memory(const Settings *s) {
  Room room = {0, 0};
  Memory *m;
  Radau *r;
  spaces(&room, s, &m, &r);
  return room.used;
}

/* The sample that is due at the start of a step: what its outputs jump by moves accelerations and forces there, (T26.5), and
   those of the last step, which the next one starts from. `row`: of the table, with what was held */
static int take_sample_within(const Settings *s, const Loop *c, double h, double *row, Radau *r, Work *w) {
  SIZES(s);
  double change[c->actions + 1], dy[6], c_a = REAL*REAL/(h*h);
  if (!foresees(c)) read_sample(s, c, w);
  int fault = hold_outputs(s, c, w, change);
  if (fault) return fault;
  hold(s, c, change, row);
  follow_table(s, row, w);
  jump(s, c, change, w, dy);
  for (int i = 0; i < groups(s); i++) {
    LegState *leg = &w->leg[i];
    for (long j = 0; j < N; j++) {
      leg->v_dot[j] += c_a*w->dq[i][j];
      for (int k = 0; k < STAGES; k++) r->last_A[k].leg[i][j] += c_a*w->dq[i][j];
    }
    for (long j = 0; j < ROWS; j++) {
      leg->lam[j] += w->dlam[i][j];
      for (int k = 0; k < STAGES; k++) r->last_F[k].lam[i][j] += w->dlam[i][j];
    }
    for (long j = 0; j < s->ports; j++) {
      leg->drive[j] += w->df[i][j];
      for (int k = 0; k < STAGES; k++) r->last_F[k].drive[i][j] += w->df[i][j];
    }
  }
  for (int j = 0; j < 6 && s->hub; j++) {
    w->payload.u_dot[j] += c_a*dy[j];
    for (int k = 0; k < STAGES; k++) r->last_A[k].hub[j] += c_a*dy[j];
  }
  if (foresees(c)) read_sample(s, c, w);
  end_sample(c);
  start_step(s, w, r);
  return OK;
}

enum { OUT_OF_REACH = 4, OLDEST = 16 }; /* steps for which the matrices at rest are kept */

/* Where a step ends that would end at a stop: at the next sample after the one that is due, unless they are one instant */
static double end_of_step(const Loop *c, double stop, int due) {
  double next = c->period*(split(c).next[0] + due);
  return next < stop - 1e-6*c->period ? next : stop;
}

/* Advance to the last stop with steps of their own, recording the instants asked for. The memory is the caller's; zero but for the
   present time and the step to try, it begins anew. `loop`: a controller, at whose samples steps end, or 0. */
int radau(const Settings *s, State *x, const Control *c, char *memory, Loop *loop) {
  SIZES(s);
  Room room = {memory, 0};
  Memory *m;
  Radau *r;
  Work *w = spaces(&room, s, &m, &r);
  long tables = s->legs*s->ports*COLUMNS, width = tables + load_size(s), age = OLDEST, fresh = 0, next = 0, stop = 0;
  int status = OK;
  double factored = 0, doubt = INFINITY, row[WIDTH], unit = fmax(c->hub_weight[0], 0);
  for (int j = 0; j < N; j++) unit = fmax(unit, c->weight[j]);
  load(s, x, w);
  w->h = w->stored = 0;
  evaluate_series(c, width, m->time, row);
  if (loop) { hold(s, loop, split(loop).u, row); follow_table(s, row, w); }
  start_step(s, w, r);
  while (status == OK) {
    while (stop < c->stops && c->stop[stop] <= m->time) stop++;
    if (stop == c->stops) break;
    int due = loop && is_due(loop, m->time);
    double end = loop ? end_of_step(loop, c->stop[stop], due) : c->stop[stop];
    double left = end - m->time, h = fmin(m->h, c->longest), rest_of_it = fmax(c->tolerance - m->spent, 0.1*c->tolerance);
    double allowed = fmin(rest_of_it/fmax(c->horizon - m->time, left), 3*c->tolerance/c->horizon), rounding = 1e-15*unit;
    if (h >= left*(1 - 1e-9)) h = left; else if (h > 0.5*left) h = 0.5*left;
    int renewed = age >= OLDEST;
    if (renewed) { rest(s, row + tables, h, r, w); age = 0; fresh = 1; factored = 0; }
    if (fabs(factored - h) > 1e-9*h) {
      x->factorisations++;
      m->rate = 0;
      if ((renewed && factor_soft(s, r, w)) || factor_stages(s, h, r, w)) { x->bad_leg = s->legs; status = SINGULAR; break; }
      factored = h;
    }
    if (due && (status = take_sample_within(s, loop, h, row, r, w))) { x->bad_leg = s->legs; break; }
    double until = h < left ? m->time + h : end;
    for (int k = 0; k < STAGES; k++) {
      evaluate_series(c, width, k < 2 ? m->time + NODE[k]*h : until, r->row[k]);
      if (loop) hold(s, loop, split(loop).u, r->row[k]);
    }
    predict_stages(s, m, h, r);
    double goal = c->unsolved*allowed*h/(1 + REAL/(h*sqrt(FREE)));          /* rates are off by REAL/h of it, for 1/sqrt(FREE) */
    int fault = iterate_stages(s, x, c, h, goal, rounding, &m->rate, r, w);
    if (++x->steps > c->most) { step_back(s, r, row, w); x->bad_leg = s->legs; status = OUT_OF_REACH; break; }
    if (fault) {                        /* with newer matrices, then with shorter steps */
      long leg = worst_leg(s, w);
      step_back(s, r, row, w);
      if (!fresh) { age = OLDEST; continue; }
      m->h = 0.5*h; m->stages = 0;
      if (m->h < c->shortest) { x->bad_leg = leg; status = fault; }
      continue;
    }
    double error = estimate(s, c, h, r, w), wrong = estimate_forces(s, c, h, m, r, w), h5 = h*h*h*h*h, peak = fmax(error/(h5*h), 0.9*m->peak);
    double rubbed = estimate_bristles(s, c, h, r, w), turning = fmax(allowed*h, TURNING*rest_of_it);
    if (error > fmax(2*allowed*h, rounding) || rubbed > fmax(2*turning, rounding) || (wrong > c->forces && wrong < doubt/2)) {
      step_back(s, r, row, w);
      m->rejected++;
      m->h = h*fmin(0.8, fmax(0.2, 0.9*fmin(pow(allowed*h/error, 0.2), cbrt(turning/fmax(rubbed, 1e-300)))));
      if (wrong > c->forces) {          /* what shorter steps do not lessen was left by the last one */
        m->h = fmin(m->h, h*fmin(0.5, fmax(0.2, cbrt(0.25*c->forces/wrong))));
        doubt = wrong;
      }
      if (m->h < c->shortest) { x->bad_leg = s->legs; status = OUT_OF_REACH; }
      continue;
    }
    for (int k = 0; k < STAGES && loop; k++) r->held[k] = power_of_loop(s, loop, r->V[k].leg, split(loop).u);
    for (; next < c->outputs; next++) {
      double t = c->output_first + (double)next*c->output_step;
      if (t > until + 1e-6*c->output_step) break;
      record_within(s, x, c, fmin(t, until), fmin((t - m->time)/h, 1), h, loop, r, w);
    }
    memcpy(row, r->row[2], sizeof row);
    place(s, r, &r->Z[2], &r->V[2], &r->A[2], &r->F[2], row, w);
    copy_bristles(s, r->bristles[2], w->bristles);
    if (ROWS) { closing(s, row + tables, w, r->open, r->rate); close_places(s, r->open, r, w); }
    powers_until(1, h, r, x->sums, loop ? split(loop).work : 0);
    memcpy(x->powers, r->powers[2], sizeof r->powers[2]);
    for (int k = 0; k < STAGES; k++) { copy_vector(s, &r->A[k], &r->last_A[k]); copy_forces(s, &r->F[k], &r->last_F[k]); }
    m->stages = 1; m->last_h = h; m->time = until; m->spent += error + rubbed;
    for (long i = 0; i < s->legs; i++) m->thrust[i] += r->thrust[i/LANES][i%LANES];
    if (c->forces > 0) {
      carried(s, &r->force[0], m->thrust);
      m->carried = fmax(m->carried, carried(s, &r->F[2], 0));
    }
    start_step(s, w, r);
    age++; fresh = 0;
    double share = fmax(allowed, NOISE*unit/h);   /* shorter steps have no less rounding */
    double factor = fmin(pow(share/fmax(peak*h5, 1e-300), 0.2), cbrt(share*h/fmax(rubbed, 1e-300)));
    if (wrong > 0) factor = fmin(factor, fmin(cbrt(0.25*c->forces/wrong), 2));
    doubt = INFINITY;
    double wanted = h*fmin(4, fmax(0.2, 0.9*factor));
    m->peak = wanted < 4*h ? peak : 0;              /* what limits no step is not remembered: it may be rounding */
    if (h < left && (wanted < 0.9*h || wanted > 1.2*h)) m->h = wanted;      /* another step costs another factorisation */
    if (h == left && wanted > m->h) m->h = wanted;
  }
  m->recorded = (double)next;
  store(s, w, x);
  return status;
}
