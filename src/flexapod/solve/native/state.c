/* State of the body while it moves: legs in vectors, payload in numbers. */
enum { SPRINGS = COMMAND/2 };           /* drives with a spring in the kernel: the first ports */

typedef struct { lanes q[N], v[N], v_dot[N], a[N], lam[ROWS], drive[PORTS]; } LegState;
typedef struct { double pose[7], u[6], u_dot[6], a[6]; } PayloadState;

typedef struct {
  LegState leg[GROUPS]; PayloadState payload;
  lanes p[GROUPS][LEG_P], joint[GROUPS][JOINT], table[GROUPS][PORTS*COLUMNS], hold[GROUPS][PORTS];
  lanes command[GROUPS][COMMAND], r[GROUPS][N], g[GROUPS][ROWS];
  lanes bristles[GROUPS][2*BRISTLES], bent[GROUPS][2*BRISTLES], rubs[GROUPS][BRISTLES];  /* at the step's begin, its end; forces */
  double h, stored;                     /* length of the step, energy of the bristles */
  double rp[HUB], reaction[6], powers[WORKS], closure;
  Arrow arrow;
} Work;

static void load(const Settings *s, const State *x, Work *w) {
  long k = s->legs*N;
  for (int i = 0; i < groups(s); i++) {
    LegState *leg = &w->leg[i];
    gather(s, i, x->q, N, N, leg->q); gather(s, i, x->v, N, N, leg->v);
    gather(s, i, x->v_dot, N, N, leg->v_dot); gather(s, i, x->a, N, N, leg->a);
    gather(s, i, x->lam, ROWS, ROWS, leg->lam); gather(s, i, x->drive, s->ports, s->ports, leg->drive);
    gather(s, i, s->leg_p, LEG_P, LEG_P, w->p[i]);
    gather(s, i, x->bristles, 2*BRISTLES, 2*BRISTLES, w->bristles[i]);
    gather(s, i, s->held, s->ports, s->ports, w->hold[i]);
    if (s->hub) gather(s, i, s->joint_p, JOINT, JOINT, w->joint[i]);
  }
  arrow_hold(&w->arrow, s);
  memset(w->rp, 0, sizeof w->rp); memset(w->reaction, 0, sizeof w->reaction);
  if (!s->hub) return;
  memcpy(w->payload.pose, x->pose, sizeof w->payload.pose);
  memcpy(w->payload.u, x->v + k, 6*sizeof(double));
  memcpy(w->payload.u_dot, x->v_dot + k, 6*sizeof(double));
  memcpy(w->payload.a, x->a + k, 6*sizeof(double));
}

static void store(const Settings *s, const Work *w, State *x) {
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
  for (int i = 0; i < groups(s); i++)
    for (int k = 0; k < SPRINGS; k++) for (int j = 0; j < 2; j++) w->command[i][2*k + j] = w->table[i][k*COLUMNS + j];
}

/* Force on a port beside its spring: what the table says, and the constraint's */
static lanes port_force(const Work *w, int group, long port) { return w->table[group][port*COLUMNS + 3] + w->leg[group].drive[port]; }
