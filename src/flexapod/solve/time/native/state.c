/* State of the body while it moves: legs in vectors, payload in numbers. */
typedef struct { lanes *q, *v, *v_dot, *a, *lam, *drive; } LegState;
typedef struct { double pose[7], u[6], u_dot[6], a[6]; } PayloadState;

typedef struct {                        /* of a step before, for the predictor */
  lanes *v_dot[GROUPS], *lam[GROUPS], *drive[GROUPS];
  double *u_dot;
} Past;
enum { PAST = 3 };                      /* steps that the predictor remembers of large legs; of others one */

typedef struct {
  LegState leg[GROUPS]; PayloadState payload;
  lanes *p[GROUPS], *joint[GROUPS], *table[GROUPS], *hold[GROUPS], *command[GROUPS], *r[GROUPS], *g[GROUPS];
  lanes *bristles[GROUPS], *bent[GROUPS], *rubs[GROUPS];        /* at the step's begin, its end; forces */
  double h, stored;                     /* length of the step, energy of the bristles */
  double *rp, reaction[6], powers[WORKS], closure;
  long age;                             /* steps since the matrix was made */
  Arrow arrow;
  Past past; long gap;                  /* numbers from what a step left to what the one before it left */
  lanes *at_rest[3], *J;                /* scratch: matrices (N, N), closures' (ROWS, N) */
  lanes *dq[GROUPS], *dlam[GROUPS], *df[GROUPS];
} Work;

static double *past_room(Room *m, const Settings *s, Past *past) {
  SIZES(s);
  past->u_dot = room_of_numbers(m, 8);
  room_of_legs(m, s, N, past->v_dot); room_of_legs(m, s, ROWS, past->lam); room_of_legs(m, s, PORTS, past->drive);
  return past->u_dot;
}

/* The work space at the begin of the caller's memory; all of it zero before the first call */
static Work *work(Room *m, const Settings *s) {
  SIZES(s);
  Work none, *at = (Work *)room(m, sizeof(Work)), *w = at ? at : &none;      /* it is counted only */
  for (int i = 0; i < groups(s); i++) {
    LegState *leg = &w->leg[i];
    lanes **each[] = {&leg->q, &leg->v, &leg->v_dot, &leg->a};
    for (int k = 0; k < 4; k++) *each[k] = room_of_lanes(m, N);
    leg->lam = room_of_lanes(m, ROWS); leg->drive = room_of_lanes(m, PORTS);
  }
  room_of_legs(m, s, s->of->leg_p, w->p); room_of_legs(m, s, s->of->joint, w->joint);
  room_of_legs(m, s, PORTS*COLUMNS, w->table); room_of_legs(m, s, PORTS, w->hold);
  room_of_legs(m, s, s->of->command, w->command); room_of_legs(m, s, N, w->r); room_of_legs(m, s, ROWS, w->g);
  room_of_legs(m, s, 2*BRISTLES, w->bristles); room_of_legs(m, s, 2*BRISTLES, w->bent); room_of_legs(m, s, BRISTLES, w->rubs);
  w->rp = room_of_numbers(m, HUB);
  arrow_room(m, s, &w->arrow);
  for (int k = 0; k < 3; k++) w->at_rest[k] = room_of_lanes(m, N*N);
  w->J = room_of_lanes(m, ROWS*N);
  room_of_legs(m, s, N, w->dq); room_of_legs(m, s, ROWS, w->dlam); room_of_legs(m, s, PORTS, w->df);
  Past older;
  double *now = past_room(m, s, &w->past);
  for (int k = 1; k < (LARGE ? PAST : 1); k++) { double *before = past_room(m, s, &older); if (k == 1) w->gap = before - now; }
  return at;
}

static void load(const Settings *s, const State *x, Work *w) {
  SIZES(s);
  long k = s->legs*N;
  for (int i = 0; i < groups(s); i++) {
    LegState *leg = &w->leg[i];
    gather(s, i, x->q, N, N, leg->q); gather(s, i, x->v, N, N, leg->v);
    gather(s, i, x->v_dot, N, N, leg->v_dot); gather(s, i, x->a, N, N, leg->a);
    gather(s, i, x->lam, ROWS, ROWS, leg->lam); gather(s, i, x->drive, s->ports, s->ports, leg->drive);
    gather(s, i, s->leg_p, s->of->leg_p, s->of->leg_p, w->p[i]);
    gather(s, i, x->bristles, 2*BRISTLES, 2*BRISTLES, w->bristles[i]);
    gather(s, i, s->held, s->ports, s->ports, w->hold[i]);
    if (s->hub) gather(s, i, s->joint_p, s->of->joint, s->of->joint, w->joint[i]);
  }
  arrow_hold(&w->arrow, s);
  memset(w->rp, 0, BYTES(double, HUB)); memset(w->reaction, 0, sizeof w->reaction);
  if (!s->hub) return;
  memcpy(w->payload.pose, x->pose, sizeof w->payload.pose);
  memcpy(w->payload.u, x->v + k, 6*sizeof(double));
  memcpy(w->payload.u_dot, x->v_dot + k, 6*sizeof(double));
  memcpy(w->payload.a, x->a + k, 6*sizeof(double));
}

static void store(const Settings *s, const Work *w, State *x) {
  SIZES(s);
  long k = s->legs*N;
  for (int i = 0; i < groups(s); i++) {
    const LegState *leg = &w->leg[i];
    scatter(s, i, leg->q, N, N, x->q); scatter(s, i, leg->v, N, N, x->v);
    scatter(s, i, leg->v_dot, N, N, x->v_dot); scatter(s, i, leg->a, N, N, x->a);
    scatter(s, i, leg->lam, ROWS, ROWS, x->lam); scatter(s, i, leg->drive, s->ports, s->ports, x->drive);
    scatter(s, i, w->bristles[i], 2*BRISTLES, 2*BRISTLES, x->bristles);
  }
  x->closure = w->closure;
  if (!s->hub) return;
  memcpy(x->pose, w->payload.pose, sizeof w->payload.pose);
  memcpy(x->v + k, w->payload.u, 6*sizeof(double));
  memcpy(x->v_dot + k, w->payload.u_dot, 6*sizeof(double));
  memcpy(x->a + k, w->payload.a, 6*sizeof(double));
}

/* Table row of the present time; held coordinates follow it */
static void follow_table(const Settings *s, const double *row, Work *w) {
  long width = s->ports*COLUMNS;
  for (int i = 0; i < groups(s); i++) {
    LegState *leg = &w->leg[i];
    gather(s, i, row, width, width, w->table[i]);
    for (long k = 0; k < s->ports; k++) {
      lanes *t = w->table[i] + k*COLUMNS, held = w->hold[i][k];
      long at = s->port[k];
      leg->q[at] += held*(t[0] - leg->q[at]); leg->v[at] += held*(t[1] - leg->v[at]);
      leg->v_dot[at] += held*(t[2] - leg->v_dot[at]); leg->a[at] += held*(t[2] - leg->a[at]);
    }
  }
}

static void set_commands(const Settings *s, Work *w) {
  SIZES(s);                             /* drives with a spring in the equations have the first ports */
  for (int i = 0; i < groups(s); i++)
    for (int k = 0; k < SPRINGS; k++) for (int j = 0; j < 2; j++) w->command[i][2*k + j] = w->table[i][k*COLUMNS + j];
}

/* Force on a port beside its spring: what the table says, and the constraint's */
static lanes port_force(const Work *w, int group, long port) { return w->table[group][port*COLUMNS + 3] + w->leg[group].drive[port]; }
