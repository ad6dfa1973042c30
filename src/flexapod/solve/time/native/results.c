/* Results over rows: instants stand side by side in the lanes. Arrays are those of Python, time first; of what is the same at
   all instants there is one row. Python fills in the structures (ctypes mirrors them field by field). */
#define INLINE static inline __attribute__((always_inline))

typedef struct { const double *at; long step; } Rows;     /* rows of numbers; `step` 0: one for all instants */
typedef struct { long first, used, row[LANES]; } Block;   /* instants of the lanes; spare lanes repeat the last one */
typedef struct { lanes x, y, z; } vector;
typedef struct { vector x, y, z; } matrix;                /* by rows */
enum { BODIES = 2, AXES = 3, SIX = 6, MOST = 9 };

#define EACH_BLOCK(b, count) for (Block b = block(0, count); b.first < (count); b = block(b.first + LANES, count))

INLINE Block block(long first, long count) {
  Block b = {first, count - first < LANES ? count - first : LANES, {0}};
  for (long i = 0; i < LANES; i++) b.row[i] = first + (i < b.used ? i : b.used - 1);
  return b;
}

INLINE lanes all(double x) { return (lanes){0} + x; }
INLINE lanes taken(Rows x, const Block *b, long k) {
  lanes found;
  for (int i = 0; i < LANES; i++) found[i] = x.at[b->row[i]*x.step + k];
  return found;
}
INLINE vector vector_of(Rows x, const Block *b, long k) {
  return (vector){taken(x, b, k), taken(x, b, k + 1), taken(x, b, k + 2)};
}
INLINE matrix matrix_of(Rows x, const Block *b) { return (matrix){vector_of(x, b, 0), vector_of(x, b, 3), vector_of(x, b, 6)}; }
INLINE vector same(const double *x) { return (vector){all(x[0]), all(x[1]), all(x[2])}; }
INLINE matrix same_matrix(const double *x) { return (matrix){same(x), same(x + 3), same(x + 6)}; }
INLINE void put(double *to, const Block *b, long width, long k, lanes x) {
  for (long i = 0; i < b->used; i++) to[(b->first + i)*width + k] = x[i];
}
INLINE void put_vector(double *to, const Block *b, long width, long k, vector x) {
  put(to, b, width, k, x.x); put(to, b, width, k + 1, x.y); put(to, b, width, k + 2, x.z);
}

INLINE lanes chosen(lane_bits which, lanes a, lanes b) { return (lanes)(((lane_bits)a & which) | ((lane_bits)b & ~which)); }
INLINE lanes lesser(lanes a, lanes b) { return chosen((lane_bits)(a < b), a, b); }
INLINE lanes larger(lanes a, lanes b) { return chosen((lane_bits)(a > b), a, b); }
INLINE lanes size_of(lanes a) { return larger(a, -a); }
INLINE int any(lane_bits which) {
  for (int i = 0; i < LANES; i++) if (which[i]) return 1;
  return 0;
}

INLINE vector plus(vector a, vector b) { return (vector){a.x + b.x, a.y + b.y, a.z + b.z}; }
INLINE vector minus(vector a, vector b) { return (vector){a.x - b.x, a.y - b.y, a.z - b.z}; }
INLINE vector times(lanes s, vector a) { return (vector){s*a.x, s*a.y, s*a.z}; }
INLINE lanes dot(vector a, vector b) { return a.x*b.x + a.y*b.y + a.z*b.z; }
INLINE lanes norm(vector a) { return lanes_sqrt(dot(a, a)); }
INLINE vector cross(vector a, vector b) { return (vector){a.y*b.z - a.z*b.y, a.z*b.x - a.x*b.z, a.x*b.y - a.y*b.x}; }
INLINE vector turned(matrix R, vector a) { return (vector){dot(R.x, a), dot(R.y, a), dot(R.z, a)}; }
INLINE vector back(matrix R, vector a) { return plus(plus(times(a.x, R.x), times(a.y, R.y)), times(a.z, R.z)); }

/* A x = B of each lane, A (6, 6) with B beside it in rows of `columns` numbers; the answers are left in the place of B. The row
   with the largest pivot is each lane's own. 1 where a pivot of one that is used is zero. */
INLINE int solved(lanes A[SIX][MOST], int columns) {
  lane_bits none = {0};
  for (int k = 0; k < SIX; k++) {
    for (int r = k + 1; r < SIX; r++) {
      lane_bits swap = (lane_bits)(size_of(A[r][k]) > size_of(A[k][k]));
      for (int c = k; c < columns; c++) {
        lanes here = A[k][c];
        A[k][c] = chosen(swap, A[r][c], here);
        A[r][c] = chosen(swap, here, A[r][c]);
      }
    }
    none |= (lane_bits)(A[k][k] == 0.0);
    lanes inverse = 1.0 / A[k][k];
    for (int c = k + 1; c < columns; c++) A[k][c] *= inverse;
    for (int r = 0; r < SIX; r++) {
      if (r == k) continue;
      for (int c = k + 1; c < columns; c++) A[r][c] -= A[r][k]*A[k][c];
    }
  }
  return any(none);
}

/* ---- legs as bodies: turns at their joints, gaps between them, Eqs. (T2.47)-(T2.48) ---- */

typedef struct {
  long legs, pairs;
  const double *platform;                 /* (legs, 3): joints from the centre of mass, platform axes */
  const double *home, *home_seen;         /* (legs, 3): directions at home, of the base and of the platform */
  const double *mouth, *radii;            /* (legs), (legs, 2) of cylinders and pistons */
  const long long *pair;                  /* (pairs, 2) */
  Rows place, rotation, base, length;     /* of the payload's centre; base joints (legs, 3), lengths (legs) */
} Drawn;

INLINE vector tip_of(const Drawn *d, const Block *b, matrix R, long i) {
  return plus(vector_of(d->place, b, 0), turned(R, same(d->platform + 3*i)));
}

/* length (count, legs) between the joints */
void leg_lengths(const Drawn *d, long count, double *length) {
  EACH_BLOCK(b, count) {
    matrix R = matrix_of(d->rotation, &b);
    for (long i = 0; i < d->legs; i++)
      put(length, &b, d->legs, i, norm(minus(tip_of(d, &b, R, i), vector_of(d->base, &b, 3*i))));
  }
}

INLINE vector axis_of(const Drawn *d, const Block *b, vector tip, long i) {
  vector s = minus(tip, vector_of(d->base, b, 3*i));
  return times(1.0 / norm(s), s);
}

INLINE lanes angle(vector a, vector b) {
  lanes across = norm(cross(a, b)), along = dot(a, b), found;
  for (int i = 0; i < LANES; i++) found[i] = atan2(across[i], along[i]);
  return found;
}

/* turns (count, legs, 2) */
void joint_turns(const Drawn *d, long count, double *turns) {
  EACH_BLOCK(b, count) {
    matrix R = matrix_of(d->rotation, &b);
    for (long i = 0; i < d->legs; i++) {
      vector axis = axis_of(d, &b, tip_of(d, &b, R, i), i);
      put(turns, &b, 2*d->legs, 2*i, angle(axis, same(d->home + 3*i)));
      put(turns, &b, 2*d->legs, 2*i + 1, angle(back(R, axis), same(d->home_seen + 3*i)));
    }
  }
}

INLINE lanes within(lanes x) { return lesser(larger(x, all(0.0)), all(1.0)); }

/* Least distance of the lines from a to b and from c to d */
INLINE lanes apart(vector a, vector b, vector c, vector d) {
  const lanes tiny = all(0x1p-1022);
  vector u = minus(b, a), v = minus(d, c), w = minus(a, c);
  lanes uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), uw = dot(u, w), vw = dot(v, w);
  lanes s = within((uv*vw - uw*vv) / larger(uu*vv - uv*uv, tiny));
  lanes t = within((uv*s + vw) / larger(vv, tiny));
  s = within((uv*t - uw) / larger(uu, tiny));   /* of where the other line ends */
  return norm(plus(w, minus(times(s, u), times(t, v))));
}

static const double ROUNDING = 1e-9;      /* of distances: of pairs that differ by less the first one is the nearest */

/* Gap of two legs whose axes lead through `point` (legs, 3): foot, mouth, tip; whole: of lines with the larger radii, no
   larger than the gap */
INLINE lanes gap_of(const Drawn *d, const vector *point, const long long *pair, int whole) {
  const vector *p = point + AXES*pair[0], *q = point + AXES*pair[1];
  const double *wide = d->radii + BODIES*pair[0], *width = d->radii + BODIES*pair[1];
  if (whole) return apart(p[0], p[2], q[0], q[2]) - (fmax(wide[0], wide[1]) + fmax(width[0], width[1]));
  lanes least = all(INFINITY);
  for (int i = 0; i < BODIES; i++) for (int k = 0; k < BODIES; k++)
    least = lesser(apart(p[i], p[i + 1], q[k], q[k + 1]) - (wide[i] + width[k]), least);
  return least;
}

/* gap (count), and the numbers of the two legs nearest to each other, (count, 2) */
void leg_clearance(const Drawn *d, long count, double *gap, long long *legs) {
  vector point[AXES*d->legs];
  lanes found[d->pairs];
  long guess = 0;
  EACH_BLOCK(b, count) {
    matrix R = matrix_of(d->rotation, &b);
    for (long i = 0; i < d->legs; i++) {
      vector tip = tip_of(d, &b, R, i), axis = axis_of(d, &b, tip, i), *p = point + AXES*i;
      p[2] = tip;
      p[0] = minus(tip, times(taken(d->length, &b, i), axis));
      p[1] = plus(p[0], times(all(d->mouth[i]), axis));
    }
    lanes least = found[guess] = gap_of(d, point, d->pair + 2*guess, 0);
    for (long k = 0; k < d->pairs; k++) {
      if (k == guess) continue;
      found[k] = all(INFINITY);
      if (!any((lane_bits)(gap_of(d, point, d->pair + 2*k, 1) <= least + ROUNDING))) continue;
      found[k] = gap_of(d, point, d->pair + 2*k, 0);
      least = lesser(found[k], least);
    }
    put(gap, &b, 1, 0, least);
    for (long i = 0; i < b.used; i++) {
      guess = 0;
      while (guess < d->pairs - 1 && !(found[guess][i] <= least[i] + ROUNDING)) guess++;
      for (int k = 0; k < BODIES; k++) legs[2*(b.first + i) + k] = d->pair[2*guess + k];
    }
  }
}

/* ---- balances of Newton and Euler of a payload on six legs UPS, Eqs. (T2.16)-(T2.34) ---- */

typedef struct { double mass, com, inertia, axial, piston_mass, piston_length; } LegMasses;   /* axial: of all */

typedef struct {
  const double *frames, *base, *platform; /* (6, 3, 3) of the legs at home; joints (6, 3) */
  const LegMasses *legs;
  const double *inertia, *com, *tool, *gravity;
  double mass;
  Rows position, velocity, acceleration, rotation, omega, alpha;   /* of the platform frame */
  Rows wrench;                            /* (6) at the tool */
} Balances;

typedef struct { lanes ca, sa, cb, sb; } JointTurn;
typedef struct { JointTurn at; matrix frame; } LegAxes;
typedef struct { vector side, axis; lanes piston; } LegForces;   /* across and along the leg, on the piston less weight */

INLINE vector into_leg(const LegAxes *a, vector world) {
  JointTurn t = a->at;
  vector v = back(a->frame, world);
  lanes level = t.ca*v.z - t.sa*v.y;
  return (vector){t.cb*v.x - t.sb*level, t.ca*v.y + t.sa*v.z, t.sb*v.x + t.cb*level};
}

INLINE vector out_of_leg(const LegAxes *a, vector v) {
  JointTurn t = a->at;
  lanes level = t.cb*v.z - t.sb*v.x;
  return turned(a->frame, (vector){t.cb*v.x + t.sb*v.z, t.ca*v.y - t.sa*level, t.sa*v.y + t.ca*level});
}

/* A leg whose tip is at s from its base joint, with velocity and acceleration, world axes */
INLINE LegForces forces_of_leg(const LegMasses *m, matrix frame, vector s, vector velocity, vector acceleration, vector gravity) {
  vector h = back(frame, s);
  lanes across = lanes_sqrt(h.y*h.y + h.z*h.z), l = lanes_sqrt(h.x*h.x + across*across);
  LegAxes axes = {{h.z/across, -h.y/across, across/l, h.x/l}, frame};
  lanes cb = axes.at.cb, sb = axes.at.sb;
  vector v = into_leg(&axes, velocity), a = into_leg(&axes, acceleration), g = into_leg(&axes, gravity);
  lanes wx = -v.y/l, wy = v.x/l, alpha = wx/cb, wz = alpha*sb;                       /* (T2.18) */
  lanes wx_dot = (-a.y - 2.0*v.z*wx)/l + wy*wz, wy_dot = (a.x - 2.0*v.z*wy)/l - wx*wz;   /* (T2.19) */
  lanes wz_dot = (wx_dot + alpha*wy*sb)/cb*sb + alpha*wy*cb, accel = a.z + l*(wx*wx + wy*wy);   /* (T2.20) */
  lanes r = l - m->piston_length/2, piston = accel - r*(wx*wx + wy*wy);
  lanes transverse = m->inertia + m->mass*m->com*m->com + m->piston_mass*(m->piston_length*m->piston_length/12 + r*r);
  lanes growth = 2.0*m->piston_mass*r*v.z, fixed = m->mass*m->com + m->piston_mass*r;
  lanes moment = -m->axial*wz_dot*sb/cb;                               /* (T2.29) */
  lanes hx = transverse*wx_dot + growth*wx + (m->axial - transverse)*wy*wz;
  lanes hy = transverse*wy_dot + growth*wy + (transverse - m->axial)*wx*wz;
  vector side = {(fixed*g.x - hy)/l, (hx + fixed*g.y - moment)/l, all(0.0)};
  return (LegForces){out_of_leg(&axes, side), times(1.0/l, s), m->piston_mass*(piston - g.z)};
}

INLINE void put_line(lanes A[SIX][MOST], long i, vector force, vector moment) {
  const lanes line[SIX] = {force.x, force.y, force.z, moment.x, moment.y, moment.z};
  for (int k = 0; k < SIX; k++) A[k][i] = line[k];
}

/* drive (count, 6) and joint (count, 6, 3): of the drives, and of the legs on the platform; 1: a pose is singular */
int rigid_forces(const Balances *d, long count, double *drive, double *joint) {
  int failed = 0;
  EACH_BLOCK(b, count) {
    lanes A[SIX][MOST];
    LegForces leg[SIX];
    matrix R = matrix_of(d->rotation, &b), inertia = same_matrix(d->inertia);
    vector p = vector_of(d->position, &b, 0), w = vector_of(d->omega, &b, 0), change = vector_of(d->alpha, &b, 0);
    vector v = vector_of(d->velocity, &b, 0), a = vector_of(d->acceleration, &b, 0), g = same(d->gravity);
    vector pull = vector_of(d->wrench, &b, 0), com = turned(R, same(d->com)), spin = back(R, w);
    vector centre = plus(a, plus(cross(change, com), cross(w, cross(w, com))));
    vector force = minus(times(all(d->mass), minus(centre, g)), pull);
    vector turning = plus(turned(inertia, back(R, change)), cross(spin, turned(inertia, spin)));
    vector lever = minus(turned(R, same(d->tool)), com);
    vector about = minus(minus(turned(R, turning), vector_of(d->wrench, &b, 3)), cross(lever, pull));
    for (long i = 0; i < SIX; i++) {
      vector r = turned(R, same(d->platform + 3*i)), whirl = cross(w, r);
      leg[i] = forces_of_leg(d->legs + i, same_matrix(d->frames + 9*i), minus(plus(p, r), same(d->base + 3*i)), plus(v, whirl),
                             plus(a, plus(cross(change, r), cross(w, whirl))), g);
      put_line(A, i, leg[i].axis, cross(minus(r, com), leg[i].axis));
      force = minus(force, leg[i].side);
      about = minus(about, cross(minus(r, com), leg[i].side));
    }
    put_line(A, SIX, force, about);
    failed |= solved(A, SIX + 1);
    for (long i = 0; i < SIX; i++) {
      put(drive, &b, SIX, i, A[i][SIX] + leg[i].piston);                /* (T2.34) */
      put_vector(joint, &b, 3*SIX, 3*i, plus(leg[i].side, times(A[i][SIX], leg[i].axis)));
    }
  }
  return failed;
}

/* ---- deviation by cause of legs UPS, Eqs. (T8.1)-(T8.8), (T15.14), (T16.7), (T19.17), (T24.9) ---- */

enum { BASE, NUT, PLATFORM, PLACES };      /* of springs along a leg */
enum { AXIAL, BENDING, DRIVE };            /* causes of all robots, the first ones */
enum { OPEN, STROKE, JOINTS };             /* what the loop of a drive is closed about */
enum { FRAMES = 3 };

typedef struct {
  double softness[3], column[2][2];        /* [m/N] c0 + c1 l + c2 l^2, of columns of oil c0 + c1 l each */
  long at, cause;                          /* cause -1: of the drive */
  long yields, twist;                      /* to friction of the drive; by the twist of a screw */
} Spring;

typedef struct {
  double base[3], platform[3], fixed, share;   /* joints where they are from here on, added to the length: fixed + share l */
} Joints;

typedef struct {
  long legs, causes, stages;
  const double *com;
  const Joints *joints;                    /* (stages, legs); the first are nominal */
  const long *frame, *moved, *cause;       /* (stages): pose of the platform frame; whether joints or pose differ; cause of that */
  const Spring *spring;
  const long *first;                       /* (legs + 1): springs of each leg */
  const double *loop;                      /* (legs): compliance of the loop of a drive that rubs */
  const long *inside, *given;              /* (legs) */
  long friction;                           /* its cause, -1: none */
  long size, l, c, r, u, e;                /* coordinates of a leg, and places of some, -1: none */
  Rows q, command, played, rubs, longer;   /* (legs, size), (legs) each, (stages, legs) */
  Rows origin[FRAMES], axes[FRAMES];       /* of the platform frame */
  Rows position, rotation;                 /* on the rigid path */
  Rows turn, moves;                        /* of a base that moves; what errors do to the payload, (legs, 3), if known */
} Causes;

INLINE lanes coordinate(const Causes *d, const Block *b, long i, long k) {
  return k < 0 ? all(0.0) : taken(d->q, b, i*d->size + k);
}
INLINE lanes value(Rows x, const Block *b, long k) { return x.at ? taken(x, b, k) : all(0.0); }

INLINE vector along(const Joints *leg, vector p, matrix R) {
  return minus(plus(p, turned(R, same(leg->platform))), same(leg->base));
}

INLINE lanes straight(const Causes *d, const Block *b, long stage, long i) {
  long f = d->frame[stage];
  return norm(along(d->joints + stage*d->legs + i, vector_of(d->origin[f], b, 0), matrix_of(d->axes[f], b)));
}

INLINE lanes softness(const Spring *s, lanes l) {
  lanes found = s->softness[0] + l*(s->softness[1] + l*s->softness[2]), stiffness = all(0.0);
  if (s->column[0][1] == 0.0) return found;   /* no oil */
  for (int k = 0; k < 2; k++) stiffness += 1.0 / (s->column[k][0] + s->column[k][1]*l);
  return found + 1.0 / stiffness;
}

/* Elongations of springs out of what bending and the drive are: each has its share of what its place gives. Inside of the
   loop of a drive they are the drive's. */
static void share_out(const Causes *d, const Block *b, long i, lanes l, lanes *error) {
  long first = d->first[i], count = d->first[i + 1] - first;
  const Spring *spring = d->spring + first;
  lanes soft[count + 1], give[PLACES], whole[PLACES] = {all(0.0), all(0.0), all(0.0)}, lag = value(d->rubs, b, i);
  lanes before = all(0.0), twist = all(0.0);
  for (long k = 0; k < count; k++) {
    soft[k] = softness(spring + k, l);
    whole[spring[k].at] += soft[k];
    if (spring[k].at == NUT && spring[k].cause >= 0) before += soft[k];
    if (spring[k].twist) twist = soft[k];
  }
  give[BASE] = coordinate(d, b, i, d->u);
  give[PLATFORM] = coordinate(d, b, i, d->e);
  give[NUT] = all(0.0);
  if (d->r >= 0) give[NUT] = l - coordinate(d, b, i, d->r) - value(d->played, b, i);
  for (long k = 0; k < count; k++) {
    if (spring[k].cause < 0) continue;
    lanes own = soft[k] / whole[spring[k].at] * give[spring[k].at];
    long of = spring[k].at == NUT ? DRIVE : BENDING, within = d->inside[i] == JOINTS || (of == DRIVE && d->inside[i] == STROKE);
    error[of] -= own;
    error[within ? DRIVE : spring[k].cause] += own;
  }
  if (d->friction < 0) return;
  lanes part = d->loop[i]*lag;
  error[DRIVE] += part;
  error[d->friction] -= part;
  for (long k = 0; k < count; k++) {
    if (!spring[k].yields) continue;
    part = lag*soft[k];
    if (spring[k].yields > 1) part *= twist/before;
    error[spring[k].cause] += part;
    error[d->friction] -= part;
  }
}

/* Errors of a leg's length by cause, its length on the rigid path given */
static void errors_of_leg(const Causes *d, const Block *b, long i, lanes command, lanes *error) {
  for (long k = 0; k < d->causes; k++) error[k] = all(0.0);
  if (!d->given[i]) return;
  lanes l = coordinate(d, b, i, d->l), stretch = coordinate(d, b, i, d->c), before = straight(d, b, 0, i), drive = l - command;
  for (long s = 1; s < d->stages; s++) {
    const Joints *leg = d->joints + s*d->legs + i;
    lanes after = d->moved[s] ? straight(d, b, s, i) : before, longer = leg->fixed + leg->share*command + value(d->longer, b, s*d->legs + i);
    error[d->cause[s]] += before - after + longer;
    before = after;
    drive -= longer;
  }
  error[BENDING] = before - (l + stretch);
  error[d->inside[i] == JOINTS ? DRIVE : AXIAL] = stretch;
  error[DRIVE] += drive;
  share_out(d, b, i, l, error);
}

/* shares (count, causes, legs, 3) and their sums (count, 3); 1: a pose is singular */
int deviation_by_cause(const Causes *d, long count, double *shares, double *sum) {
  long width = 3*d->causes*d->legs, failed = 0;
  EACH_BLOCK(b, count) {
    lanes A[SIX][MOST] = {{{0}}}, error[d->causes];
    vector p = vector_of(d->position, &b, 0), whole = {all(0.0), all(0.0), all(0.0)}, com = same(d->com);
    matrix R = matrix_of(d->rotation, &b);
    for (long i = 0; i < d->legs; i++) {
      vector s = along(d->joints + i, p, R);
      if (d->moves.at) continue;
      vector axis = times(1.0 / norm(s), s);
      put_line(A, i, axis, cross(turned(R, minus(same(d->joints[i].platform), com)), axis));
    }
    if (!d->moves.at) {
      for (int k = 0; k < AXES; k++) A[k][SIX + k] = all(1.0);
      failed |= solved(A, MOST);
    }
    for (long i = 0; i < d->legs; i++) {
      vector move = d->moves.at ? vector_of(d->moves, &b, 3*i) : (vector){A[i][SIX], A[i][SIX + 1], A[i][SIX + 2]};
      if (d->turn.at) move = turned(matrix_of(d->turn, &b), move);
      errors_of_leg(d, &b, i, taken(d->command, &b, i), error);
      for (long k = 0; k < d->causes; k++) {
        vector own = times(error[k], move);
        put_vector(shares, &b, width, 3*(k*d->legs + i), own);
        whole = plus(whole, own);
      }
    }
    put_vector(sum, &b, 3, 0, whole);
  }
  return (int)failed;
}
