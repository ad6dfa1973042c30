/* A sampled controller around the march: what it reads, the one linear law that it computes, what it moves, Eqs. (T26.1)-(T26.6),
   (T26.10).
   Between two samples its outputs are held. */
enum { AT_COORDINATE, AT_FORCE, AT_CLOSURE, AT_JOINT, AT_PLACE, AT_TURN, AT_ACCELERATION, AT_GEOPHONE };  /* what is read */
enum { ASKED = 5 };                     /* status: who was asked for outputs failed */

/* axis: the coordinate, of the leg or of a point on the payload; arm: to that from the centre of mass; port: whose command is
   what a coordinate is read against; along: a direction in platform axes, or where the base joint is; what a geophone's proof
   mass does from sample to sample, by its state and by what moves it at the first and at the second; gain: of its voltage */
typedef struct { long of, leg, port, axis; double arm[3], along[3], step[4], begin[4], end[4], gain; } Reading;
typedef struct { long leg, port, column; double gain; } Action;        /* gain: force by a unit of it */
typedef int (*Asked)(double t, const double *readings, double *outputs);

typedef struct {
  long readings, actions, states, delay;        /* delay: samples from a reading to what is made of it */
  long first, given;                    /* rows of `noise` and `path`: of so many samples from the first on */
  double begin, period, gravity[3];     /* instant at which a call begins; between samples */
  const Reading *reading; const Action *action;
  const double *A, *B, *C, *D;          /* row by row */
  const double *quantum, *most;         /* (readings), (actions): 0 and infinite where there is none */
  const double *noise, *path;           /* (given, readings), (given, 7): pose of the rigid robot */
  Asked asked;                          /* in place of the matrices, or 0 */
  double *memory, *record;              /* as `split` says; (outputs, readings + actions + 1), or 0 */
} Loop;

/* What a loop remembers, at the caller's */
typedef struct { double *next, *work, *power, *x, *u, *y, *zero, *ring, *proof, *ahead; } Remembered;
enum { PROOF = 5 };                     /* of a geophone: two states, what moved it, and that at the start */

static Remembered split(const Loop *c) {
  Remembered m;
  double *at = c->memory;
  m.next = at++; m.work = at++; m.power = at++;
  m.x = at; at += c->states;
  m.u = at; at += c->actions;
  m.y = at; at += c->readings;
  m.zero = at; at += c->readings;
  m.ring = at; at += (c->delay + 1)*c->readings;
  m.proof = at; at += PROOF*c->readings;
  m.ahead = at;
  return m;
}

/* What the controller holds, onto a row of the table */
static void hold(const Settings *s, const Loop *c, const double *u, double *row) {
  for (long k = 0; k < c->actions; k++) {
    const Action *a = &c->action[k];
    row[(a->leg*s->ports + a->port)*COLUMNS + a->column] += u[k];
  }
}

/* Power of its forces, by the rates of the legs */
static double power_of_loop(const Settings *s, const Loop *c, lanes *const *v, const double *u) {
  double power = 0;
  for (long k = 0; k < c->actions; k++) {
    const Action *a = &c->action[k];
    if (a->column == 3 && s->port[a->port] != s->of->loop) power += u[k]*v[a->leg/LANES][s->port[a->port]][a->leg%LANES];
  }
  return power;
}

static void cross(const double *a, const double *b, double *c) {
  c[0] = a[1]*b[2] - a[2]*b[1]; c[1] = a[2]*b[0] - a[0]*b[2]; c[2] = a[0]*b[1] - a[1]*b[0];
}

/* A vector from platform to world axes, or back where sign is -1: quaternion (w x y z) */
static void rotate(const double *e, double sign, const double *a, double *b) {
  double v[3] = {sign*e[1], sign*e[2], sign*e[3]}, t[3], u[3];
  cross(v, a, t);
  cross(v, t, u);
  for (int i = 0; i < 3; i++) b[i] = a[i] + 2*(e[0]*t[i] + u[i]);
}

/* Rotation vector from an attitude to another, world axes */
static void turn_between(const double *from, const double *to, double *vector) {
  double w = to[0]*from[0] + to[1]*from[1] + to[2]*from[2] + to[3]*from[3], v[3], c[3];
  cross(to + 1, from + 1, c);
  for (int i = 0; i < 3; i++) v[i] = from[0]*to[1 + i] - to[0]*from[1 + i] - c[i];
  double sine = sqrt(v[0]*v[0] + v[1]*v[1] + v[2]*v[2]), scale = w < 0 ? -1 : 1;
  double f = sine > 1e-9 ? 2*atan2(sine, fabs(w))/sine : 2;
  for (int i = 0; i < 3; i++) vector[i] = scale*f*v[i];
}

static double of_payload(const Loop *c, const Reading *r, const Work *w, const double *path) {
  const double *pose = w->payload.pose, *u = w->payload.u + 3, *turn = w->payload.u_dot + 3;
  double a[3], b[3], d[3];
  if (r->of == AT_TURN) { turn_between(path + 3, pose + 3, a); return a[r->axis]; }
  if (r->of == AT_PLACE) {
    rotate(pose + 3, 1, r->arm, a); rotate(path + 3, 1, r->arm, b);
    return (pose[r->axis] - path[r->axis]) + (a[r->axis] - b[r->axis]);
  }
  for (int i = 0; i < 3; i++) b[i] = w->payload.u_dot[i] - c->gravity[i];      /* as a body feels it, in its own axes */
  rotate(pose + 3, -1, b, d);
  cross(u, r->arm, a); cross(u, a, b); cross(turn, r->arm, a);
  double felt = 0;
  for (int i = 0; i < 3; i++) felt += r->along[i]*(d[i] + a[i] + b[i]);
  return felt;
}

/* Velocity behind a proof mass, whose states go on to the present sample, (T26.10) */
static double of_geophone(const Loop *c, const Reading *r, const Work *w, int first, double *proof) {
  const double *turn = w->payload.u + 3;
  double v[3], g[3], a[3], rate[3], in[2] = {0, 0}, old[4];
  rotate(w->payload.pose + 3, -1, w->payload.u, v);
  rotate(w->payload.pose + 3, -1, c->gravity, g);
  cross(turn, r->arm, a);
  for (int i = 0; i < 3; i++) v[i] += a[i];
  cross(turn, v, rate);
  for (int i = 0; i < 3; i++) { in[0] += r->along[i]*v[i]; in[1] += r->along[i]*(rate[i] - g[i]); }
  if (first) { proof[0] = 0; proof[1] = -in[0]; proof[4] = in[1]; }
  memcpy(old, proof, sizeof old);
  in[1] -= proof[4];
  for (int i = 0; i < 2 && !first; i++) {
    proof[i] = 0;
    for (int j = 0; j < 2; j++) proof[i] += r->step[2*i + j]*old[j] + r->begin[2*i + j]*old[2 + j] + r->end[2*i + j]*in[j];
  }
  proof[2] = in[0]; proof[3] = in[1];
  return r->gain*(in[0] + proof[1]);
}

/* Force of a leg on the platform, along the line between its joints */
static double along_leg(const Reading *r, const Work *w) {
  double arm[3], length = 0, force = 0;
  rotate(w->payload.pose + 3, 1, r->arm, arm);
  for (int i = 0; i < 3; i++) {
    double way = w->payload.pose[i] + arm[i] - r->along[i];
    length += way*way; force += way*w->leg[r->leg/LANES].lam[i][r->leg%LANES];
  }
  return force/sqrt(length);
}

/* All readings as they are, against the commanded path */
static void read_all(const Settings *s, const Loop *c, const double *path, const Remembered *m, const Work *w) {
  SIZES(s);
  double *y = m->y;
  lanes force[GROUPS][PORTS];
  int forces = 0;
  for (long k = 0; k < c->readings; k++) forces |= c->reading[k].of == AT_FORCE;
  for (int i = 0; i < groups(s) && forces; i++) {
    lanes energies[3], springs[PORTS];
    const lanes *in[] = {w->leg[i].q, w->leg[i].v, w->command[i], w->p[i]};
    lanes *out[] = {energies, springs};
    s->of->leg_energies(in, out);
    for (long j = 0; j < s->ports; j++) force[i][j] = port_force(w, i, j) + (j < SPRINGS ? springs[j] : (lanes){0});
  }
  for (long k = 0; k < c->readings; k++) {
    const Reading *r = &c->reading[k];
    long group = r->leg/LANES, lane = r->leg%LANES;
    if (r->of == AT_COORDINATE) {                       /* against the path, whatever the controller adds to that */
      y[k] = w->leg[group].q[r->axis][lane] - w->table[group][r->port*COLUMNS][lane];
      for (long j = 0; j < c->actions; j++) {
        const Action *a = &c->action[j];
        if (a->leg == r->leg && a->port == r->port && a->column == 0) y[k] += m->u[j];
      }
    }
    else if (r->of == AT_FORCE) y[k] = force[group][r->port][lane];
    else if (r->of == AT_CLOSURE) y[k] = w->leg[group].lam[r->axis][lane];
    else if (r->of == AT_JOINT) y[k] = along_leg(r, w);
    else if (r->of == AT_GEOPHONE) y[k] = of_geophone(c, r, w, m->next[0] == 0, m->proof + PROOF*k);
    else y[k] = of_payload(c, r, w, path);
  }
}

/* y = A x + B u, rows of matrices one after the other */
static void affine(long rows, long n, const double *A, const double *x, long m, const double *B, const double *u, double *y) {
  for (long i = 0; i < rows; i++) {
    double sum = 0;
    for (long j = 0; j < n; j++) sum += A[i*n + j]*x[j];
    for (long j = 0; j < m; j++) sum += B[i*m + j]*u[j];
    y[i] = sum;
  }
}

/* Whether a sample is due at an instant */
static int is_due(const Loop *c, double now) { return now >= c->period*(split(c).next[0] - 1e-6); }

static void rates_of_legs(const Settings *s, const Work *w, lanes **v) { for (int i = 0; i < groups(s); i++) v[i] = w->leg[i].v; }

/* Whether outputs follow from what was read before: they are held first then, and what is read is read under them */
static int foresees(const Loop *c) {
  if (c->delay > 0 || c->asked) return c->delay > 0;
  for (long k = 0; k < c->actions*c->readings; k++) if (c->D[k] != 0) return 0;
  return 1;
}

/* Readings that arrive now; zero before the first ones do */
static double *arriving(const Loop *c, const Remembered *m) {
  return m->ring + (((long)m->next[0] + 1) % (c->delay + 1))*c->readings;
}

static void read_sample(const Settings *s, const Loop *c, Work *w) {
  Remembered m = split(c);
  long number = (long)m.next[0], row = number - c->first;
  double *to = m.ring + (number % (c->delay + 1))*c->readings;
  set_commands(s, w);
  read_all(s, c, c->path + 7*row, &m, w);
  for (long k = 0; k < c->readings; k++) {
    if (number == 0) m.zero[k] = m.y[k];
    double value = m.y[k] - m.zero[k] + c->noise[c->readings*row + k], q = c->quantum[k];
    m.y[k] = to[k] = q > 0 ? q*rint(value/q) : value;
  }
}

/* Compute outputs and hold them. `change`: of them, of which the table in the work space knows nothing yet */
static int hold_outputs(const Settings *s, const Loop *c, const Work *w, double *change) {
  Remembered m = split(c);
  double u[c->actions + 1];
  lanes *v[GROUPS];
  if (c->asked) {
    if (c->asked(m.next[0]*c->period, arriving(c, &m), u)) return ASKED;
  } else affine(c->actions, c->states, c->C, m.x, c->readings, c->D, arriving(c, &m), u);
  for (long k = 0; k < c->actions; k++) {
    double most = c->most[k];
    if (u[k] > most) u[k] = most;
    if (u[k] < -most) u[k] = -most;
    change[k] = u[k] - m.u[k];
    m.u[k] = u[k];
  }
  rates_of_legs(s, w, v);
  m.power[0] = power_of_loop(s, c, v, m.u);
  return OK;
}

/* States of the law at the next sample */
static void end_sample(const Loop *c) {
  Remembered m = split(c);
  affine(c->states, c->states, c->A, m.x, c->readings, c->B, arriving(c, &m), m.ahead);
  memcpy(m.x, m.ahead, BYTES(double, c->states));
  m.next[0] += 1;
}

/* How a jump of the outputs changes accelerations and forces, by the factored matrix of the iteration, (T26.5) */
static void jump(const Settings *s, const Loop *c, const double *change, Work *w, double *dy) {
  SIZES(s);
  for (int i = 0; i < groups(s); i++) { memset(w->r[i], 0, BYTES(lanes, N)); memset(w->g[i], 0, BYTES(lanes, ROWS)); }
  memset(w->rp, 0, BYTES(double, HUB));
  for (long k = 0; k < c->actions; k++) {
    const Action *a = &c->action[k];
    w->r[a->leg/LANES][s->port[a->port]][a->leg%LANES] -= a->gain*change[k];
  }
  arrow_solve(&w->arrow, s, w->r, w->g, w->rp, w->dq, w->dlam, w->df, dy);
}

/* Record of what was read, what is held, and its work until an instant */
static void record_loop(Loop *c, double work) {
  Remembered m = split(c);
  if (!c->record) return;
  memcpy(c->record, m.y, BYTES(double, c->readings)); c->record += c->readings;
  memcpy(c->record, m.u, BYTES(double, c->actions)); c->record += c->actions;
  *c->record++ = work;
}
