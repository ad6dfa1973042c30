/* State of the body while it moves: legs in vectors, payload in numbers. */
enum { MAXP = 128 };                    /* parameters of a leg */

typedef struct { lanes q[MAXN], v[MAXN], v_dot[MAXN], a[MAXN], lam[3], drive[2]; } LegState;
typedef struct { double pose[7], u[6], u_dot[6], a[6]; } PayloadState;

typedef struct {
  LegState leg[GROUPS]; PayloadState payload;
  lanes p[GROUPS][MAXP], table[GROUPS][TABLE], hold_l[GROUPS], hold_beta[GROUPS];
  lanes command[GROUPS][COMMAND], r[GROUPS][MAXN], g[GROUPS][3];
  double rp[6], powers[3], closure;
  Arrow arrow; Single single;
} Work;

static void load(const Settings *s, const State *x, Work *w) {
  long n = s->n, k = s->legs*n;
  for (int i = 0; i < groups(s); i++) {
    LegState *leg = &w->leg[i];
    gather(s, i, x->q, n, n, leg->q); gather(s, i, x->v, n, n, leg->v);
    gather(s, i, x->v_dot, n, n, leg->v_dot); gather(s, i, x->a, n, n, leg->a);
    gather(s, i, x->lam, 3, 3, leg->lam); gather(s, i, x->drive, 2, 2, leg->drive);
    gather(s, i, s->leg_p, s->leg_np, s->leg_np, w->p[i]);
    w->hold_l[i] = w->arrow.leg[i].prescribed = mask(s, i, s->prescribed_l);
    w->hold_beta[i] = mask(s, i, s->prescribed_beta);
  }
  if (!s->payload) return;
  memcpy(w->payload.pose, x->pose, sizeof w->payload.pose);
  memcpy(w->payload.u, x->v + k, 6*sizeof(double));
  memcpy(w->payload.u_dot, x->v_dot + k, 6*sizeof(double));
  memcpy(w->payload.a, x->a + k, 6*sizeof(double));
}

static void store(const Settings *s, const Work *w, State *x) {
  long n = s->n, k = s->legs*n;
  for (int i = 0; i < groups(s); i++) {
    const LegState *leg = &w->leg[i];
    scatter(s, i, leg->q, n, n, x->q); scatter(s, i, leg->v, n, n, x->v);
    scatter(s, i, leg->v_dot, n, n, x->v_dot); scatter(s, i, leg->a, n, n, x->a);
    scatter(s, i, leg->lam, 3, 3, x->lam); scatter(s, i, leg->drive, 2, 2, x->drive);
  }
  x->closure = w->closure;
  if (!s->payload) return;
  memcpy(x->pose, w->payload.pose, sizeof w->payload.pose);
  memcpy(x->v + k, w->payload.u, 6*sizeof(double));
  memcpy(x->v_dot + k, w->payload.u_dot, 6*sizeof(double));
  memcpy(x->a + k, w->payload.a, 6*sizeof(double));
}

/* Table row of the present time; prescribed coordinates follow it */
static void follow_table(const Settings *s, const double *row, Work *w) {
  for (int i = 0; i < groups(s); i++) {
    LegState *leg = &w->leg[i];
    lanes *t = w->table[i], l = w->hold_l[i], beta = w->hold_beta[i];
    long at = s->l_index;
    gather(s, i, row, TABLE, TABLE, t);
    leg->q[at] += l*(t[0] - leg->q[at]); leg->v[at] += l*(t[1] - leg->v[at]);
    leg->v_dot[at] += l*(t[2] - leg->v_dot[at]); leg->a[at] += l*(t[2] - leg->a[at]);
    at--;
    leg->q[at] += beta*(t[4] - leg->q[at]); leg->v[at] += beta*(t[5] - leg->v[at]);
    leg->v_dot[at] += beta*(t[6] - leg->v_dot[at]); leg->a[at] += beta*(t[6] - leg->a[at]);
  }
}

static void set_commands(const Settings *s, Work *w) {
  for (int i = 0; i < groups(s); i++) {
    const lanes *t = w->table[i], *drive = w->leg[i].drive;
    lanes *c = w->command[i];
    c[0] = t[0]; c[1] = t[1]; c[2] = t[3] + drive[0]; c[3] = t[7] + drive[1];
  }
}

static void joint_forces(const Settings *s, const Work *w, double *lam) {
  for (int i = 0; i < groups(s); i++) scatter(s, i, w->leg[i].lam, 3, 3, lam);
}
