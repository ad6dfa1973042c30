/* The robot's steps, out of the caller's memory */
enum {
  LEG_SIZE = N_OF_LEG, ALL = LEG_COUNT*N_OF_LEG + 6*HAS_HUB, TABLE = LEG_COUNT*PORT_COUNT*COLUMNS, LOADS = HAS_HUB ? 6 : OUTSIDE,
  RECORD = LEG_COUNT*N_OF_LEG + 2*ALL + LEG_COUNT*(ROW_COUNT + PORT_COUNT) + 7 + 6 + 3 + WORKS + 1 + LEG_COUNT*BRISTLE_COUNT,
  JUMPS = 6
};
static const double JUMPED = 1e-9;      /* m, rad: a command that moves by less does not jump */

typedef struct {
  double *head, *inputs, *q, *v, *v_dot, *a, *lam, *drive, *pose, *bristles, *sums, *powers, *record, *rows, *loads;
  char *march;
  long size;                            /* of all that: the second half of a memory is the first as the last call left it */
} Instance;

enum { STEPS_DONE, STARTED, MOST, HEAD };       /* numbers at its head */

static Settings settings(void) { Settings s = SETTINGS; return s; }

/* Where the parts of a memory are; 0: they are counted */
static Instance instance(const void *memory) {
  Room m = {(char *)memory, 0};
  Instance x;
  Settings s = settings();
  double **parts[] = {&x.head, &x.inputs, &x.q, &x.v, &x.v_dot, &x.a, &x.lam, &x.drive, &x.pose, &x.bristles, &x.sums, &x.powers,
                      &x.record, &x.rows, &x.loads};
  const long sizes[] = {HEAD, ROBOT_INPUTS, LEG_COUNT*LEG_SIZE, ALL, ALL, ALL, LEG_COUNT*ROW_COUNT, LEG_COUNT*PORT_COUNT, 7,
                        LEG_COUNT*2*BRISTLE_COUNT, WORKS, WORKS, RECORD, 2*TABLE, 2*LOADS};
  for (int k = 0; k < (int)(sizeof sizes/sizeof *sizes); k++) *parts[k] = room_of_numbers(&m, sizes[k] + 1);
  long march_size = march_memory(&s);
  x.march = (char *)room(&m, march_size);
  x.size = m.used;
  return x;
}

static State state_of(const Instance *x) {
  State s = {.q = x->q, .v = x->v, .v_dot = x->v_dot, .a = x->a, .lam = x->lam, .drive = x->drive, .pose = x->pose,
             .bristles = x->bristles, .sums = x->sums, .powers = x->powers, .record = x->record};
  return s;
}

/* Table and load at an instant of the built-in motion, or as they are at the start */
static void built_in(double t, double *table, double *load) {
  if (!PIECES) { memcpy(table, BASE_TABLE, sizeof BASE_TABLE); memcpy(load, BASE_LOAD, sizeof BASE_LOAD); return; }
  double row[TABLE + LOADS], before = 1;
  long k = 0;
  t = fmin(t, EDGES[PIECES]);
  while (k < PIECES - 1 && t >= EDGES[k + 1]) k++;
  double a = EDGES[k], b = EDGES[k + 1], x = (2*t - a - b)/(b - a), now = x;
  const double *term = SERIES + k*TERMS*(TABLE + LOADS);
  memcpy(row, term, sizeof row);
  for (int j = 1; j < TERMS; j++) {
    term += TABLE + LOADS;
    for (int i = 0; i < TABLE + LOADS; i++) row[i] += now*term[i];
    double next = 2*x*now - before;
    before = now; now = next;
  }
  memcpy(table, row, sizeof(double)*TABLE); memcpy(load, row + TABLE, sizeof(double)*LOADS);
}

/* What inputs make of it, a time after they were given */
static void with_inputs(const double *inputs, double since, double *table, double *load) {
  for (int leg = 0; leg < LEG_COUNT; leg++) {
    if (DRIVE_PORT[leg] < 0) continue;
    if (COMMANDED) {                                /* (T26.8) */
      double *row = table + (leg*PORT_COUNT + DRIVE_PORT[leg])*COLUMNS;
      double turn = PER_TURN[leg], times = STRETCH[leg];                          /* as built and warm: (T16.5) */
      double value = SHIFT[leg] + (inputs[leg] - ZERO_OF_DRIVE[leg])*turn*times;
      double rate = inputs[leg + LEG_COUNT]*turn*times, change = inputs[leg + 2*LEG_COUNT]*turn*times;
      row[0] = value + since*(rate + 0.5*since*change); row[1] = rate + since*change; row[2] = change;
    }
    if (FORCE_PORT[leg] >= 0) table[(leg*PORT_COUNT + FORCE_PORT[leg])*COLUMNS + 3] += inputs[FIRST_FORCE + leg]/PER_TURN[leg];
  }
  for (int k = 0; k < 6 && HAS_HUB; k++) load[k] += inputs[FIRST_WRENCH + k];
}

/* Whether the command of a drive that keeps it has moved, and nothing said that it moves; at the start, whether it is elsewhere */
static int jumps(const double *before, const double *inputs, int starts) {
  if (!COMMANDED) return 0;
  for (int leg = 0; leg < LEG_COUNT; leg++) {
    const double *was = before + leg, *is = inputs + leg;
    if (!KEEPS[leg]) continue;
    if (!starts && (was[LEG_COUNT] != 0 || was[2*LEG_COUNT] != 0 || is[LEG_COUNT] != 0 || is[2*LEG_COUNT] != 0)) continue;
    if (!(fabs(is[0] - was[0]) <= JUMPED)) return 1;
  }
  return 0;
}

/* A call ends: done, or as if it had never been. What was factored lies between the matrices of the first leg and what they
   are solved for: where nothing was factored anew it is there already. */
static int ended(const Instance *x, void *memory, int fault, int factored) {
  char *now = memory, *left = now + x->size;
  const Work *w = (const Work *)x->march;
  long size = x->size, from = factored ? size : (char *)w->arrow.leg[0].A - now, to = factored ? size : (char *)w->dq[0] - now;
  if (fault) { memcpy(now, left, (size_t)size); return fault; }
  memcpy(left, now, (size_t)from); memcpy(left + to, now + to, (size_t)(size - to));
  return ROBOT_OK;
}

static int all_finite(const double *x, long count) {
  double sum = 0;
  for (long k = 0; k < count; k++) sum += 0*x[k];
  return isfinite(sum);
}

size_t robot_size(void) { return 2*(size_t)instance(0).size; }
void robot_start_inputs(double *inputs) { memcpy(inputs, START_INPUTS, sizeof(double)*ROBOT_INPUTS); }
double robot_time(const void *memory) { return instance(memory).head[STEPS_DONE]*ROBOT_STEP; }
long robot_most_iterations(const void *memory) { return (long)instance(memory).head[MOST]; }

int robot_init(void *memory) {
  memset(memory, 0, robot_size());
  Instance x = instance(memory);
  Settings s = settings();
  State state = state_of(&x);
  memcpy(x.inputs, START_INPUTS, sizeof(double)*ROBOT_INPUTS);
  memcpy(x.q, START_Q, sizeof START_Q); memcpy(x.v, START_V, sizeof START_V); memcpy(x.v_dot, START_V_DOT, sizeof START_V_DOT);
  memcpy(x.a, START_A, sizeof START_A); memcpy(x.lam, START_LAM, sizeof START_LAM); memcpy(x.drive, START_DRIVE, sizeof START_DRIVE);
  memcpy(x.pose, START_POSE, sizeof START_POSE); memcpy(x.bristles, START_BRISTLES, sizeof START_BRISTLES);
  memcpy(x.sums, START_SUMS, sizeof START_SUMS);
  built_in(0, x.rows, x.loads);
  record_state(&s, &state, x.rows, x.loads, x.march);
  return ended(&x, memory, ROBOT_OK, 1);
}

int robot_step(void *memory, const double *inputs, long steps) {
  Instance x = instance(memory);
  Settings s = settings();
  if (steps <= 0) return steps ? ROBOT_BACKWARDS : ROBOT_OK;
  if (!all_finite(inputs, ROBOT_INPUTS)) return ROBOT_NOT_FINITE;
  if (jumps(x.inputs, inputs, !(x.head[STEPS_DONE] > 0))) return ROBOT_JUMPS;
  memcpy(x.inputs, inputs, sizeof(double)*ROBOT_INPUTS);
  int factored = !(x.head[STARTED] > 0);
  for (long k = 1; k <= steps; k++) {
    State state = state_of(&x);
    double *row = x.rows + TABLE, *load = x.loads + LOADS;
    built_in((x.head[STEPS_DONE] + 1)*ROBOT_STEP, row, load);
    with_inputs(inputs, (double)k*ROBOT_STEP, row, load);
    s.output_every = k == steps ? 1 : 2;
    int fault = march(&s, &state, x.rows, x.loads, 1, x.head[STARTED] > 0, x.march, 0);
    if (!fault && k == steps && !all_finite(x.record, RECORD)) fault = ROBOT_NOT_FINITE;
    if (fault) return ended(&x, memory, fault, 1);
    x.head[STARTED] = 1;
    x.head[STEPS_DONE] += 1;
    x.head[MOST] = fmax(x.head[MOST], (double)state.iterations);
    factored |= state.factorisations > 0;
  }
  return ended(&x, memory, ROBOT_OK, factored);
}

void robot_outputs(const void *memory, double *outputs) {
  Instance x = instance(memory);
  const double *o = x.record, *pose = o + POSE_AT, *e = pose + 3;
  memcpy(outputs, OFFSETS, sizeof OFFSETS);
  for (int k = 0; k < PARTS; k++) outputs[PART[k].output] += PART[k].times*o[PART[k].at];
  if (!HAS_HUB) return;
  double arm[3], sign = e[0] < 0 ? -1 : 1;
  rotate(e, 1, TOOL_ARM, arm);
  for (int i = 0; i < 3; i++) outputs[TOOL_AT + i] = pose[i] + arm[i];
  for (int i = 0; i < 4; i++) outputs[QUATERNION_AT + i] = sign*e[i];
  rotate(e, 1, o + TURN_AT, outputs + VELOCITY_AT);
}
