/* Linear algebra of the robot, Eqs. (T6.6)-(T6.9): each leg is eliminated onto the payload.

   Unknowns of leg i: dq_i (N), dlam_i (ROWS); of the border: dy (HUB) and one force for each pivot that is held.
     A_i dq_i + J_i^T dlam_i - sum e_k df_k = -r_i
     J_i dq_i - P_i dy                      = -g_i
     A_p dy   - sum P_i^T dlam_i            = -r_p
     e_k^T dq_i                             = 0      (coordinate k is held)
   Pivots are the coordinates found from the closure: J1 = dg/d(pivots) is regular for every leg, whatever is massless,
   rigid or held. The other M coordinates z see B = N^T A N, N = [N1; I] with N1 = -J1^-1 J2; the payload
   moves them through Y = [Y1; 0], Y1 = J1^-1 P. A is symmetric, so Et = N^T A Y is the transpose of E = Y^T A N; where
   loops are closed about other places than their rotors it is not, and E has its own, Er. A held
   coordinate that is not a pivot drops out of z; its force is what is left in its own row. Legs are in `ORDER` here.
   Coordinates that all legs share belong to y: Y = [Y1; 0; 1] with Y1 = J1^-1 [P, -J_shared], and y has HUB of them. */
typedef struct {                        /* of a vector of legs */
  lanes *A, *J, *P, *J1inv, *N1, *Y1, *Binv, *Et, *C, *Bd;
  lanes *Er;                            /* that of loops, else Et */
  lanes *half;                          /* of Binv, column by column */
  lanes *held;
  int unknown[CLOSURES][LANES], any[CLOSURES];  /* the border's unknown of a held pivot; 0: it is not held; and of any leg */
} LegBlock;

typedef struct {
  LegBlock leg[GROUPS]; long size; double *border;
  lanes *AN, *B; double *sum;           /* scratch: (N, M), (M, M), that of the border */
} Arrow;

static long border_size(const Settings *s) { return 6 + s->of->common + s->legs*s->of->rows; }       /* at most */

static void arrow_room(Room *m, const Settings *s, Arrow *w) {
  SIZES(s);
  long border = border_size(s);
  for (int group = 0; group < groups(s); group++) {
    LegBlock *b = &w->leg[group];
    b->A = room_of_lanes(m, N*N); b->J = room_of_lanes(m, ROWS*N); b->P = room_of_lanes(m, ROWS*6);
    b->J1inv = room_of_lanes(m, ROWS*ROWS); b->N1 = room_of_lanes(m, ROWS*M); b->Y1 = room_of_lanes(m, ROWS*HUB);
    b->Binv = room_of_lanes(m, M*M); b->Et = room_of_lanes(m, M*HUB); b->C = room_of_lanes(m, M*HUB);
    b->Bd = room_of_lanes(m, ROWS*M); b->held = room_of_lanes(m, N);
    b->Er = LOOPING ? room_of_lanes(m, M*HUB) : b->Et;
    b->half = LARGE && !LOOPING ? room_of_lanes(m, M*(M + 1)/2) : 0;
  }
  w->border = room_of_numbers(m, border*border); w->sum = room_of_numbers(m, border*border);
  w->AN = room_of_lanes(m, N*M); w->B = room_of_lanes(m, M*M);
}

static void invert3(const lanes *m, lanes *inv) {        /* column-major */
  lanes c0 = m[4]*m[8] - m[7]*m[5], c1 = m[7]*m[2] - m[1]*m[8], c2 = m[1]*m[5] - m[4]*m[2];
  lanes d = 1.0/(m[0]*c0 + m[3]*c1 + m[6]*c2);
  inv[0] = c0*d; inv[1] = c1*d; inv[2] = c2*d;
  inv[3] = (m[6]*m[5] - m[3]*m[8])*d; inv[4] = (m[0]*m[8] - m[6]*m[2])*d; inv[5] = (m[3]*m[2] - m[0]*m[5])*d;
  inv[6] = (m[3]*m[7] - m[6]*m[4])*d; inv[7] = (m[6]*m[1] - m[0]*m[7])*d; inv[8] = (m[0]*m[4] - m[3]*m[1])*d;
}

/* y += s A B, all (3, 3); ld_A: from a column of A to the next, as the others */
static void product3(double s, const lanes *A, long ld_A, const lanes *B, long ld_B, lanes *y, long ld_y) {
  for (int j = 0; j < 3; j++) for (int k = 0; k < 3; k++) for (int i = 0; i < 3; i++) y[i + ld_y*j] += s * A[i + ld_A*k] * B[k + ld_B*j];
}

/* Inverse of J1 with three rows or six: place before attitude, and (alpha, beta, l) decide over the place */
static void invert_pivots(long ROWS, const lanes *m, lanes *inv) {
  if (ROWS == 3) invert3(m, inv);
  if (ROWS != 6) return;
  lanes corner[9], inner[9], first[9], last[9], right[9] = {0}, left[9] = {0};
  for (int j = 0; j < 3; j++) for (int i = 0; i < 3; i++) { corner[i + 3*j] = m[i + 6*j]; inner[i + 3*j] = m[21 + i + 6*j]; }
  invert3(corner, first);
  product3(1, first, 3, m + 18, 6, right, 3);
  product3(1, m + 3, 6, first, 3, left, 3);
  product3(-1, m + 3, 6, right, 3, inner, 3);
  invert3(inner, last);
  memset(inv, 0, BYTES(lanes, 36));
  product3(-1, right, 3, last, 3, inv + 18, 6);
  product3(-1, last, 3, left, 3, inv + 3, 6);
  for (int j = 0; j < 3; j++) for (int i = 0; i < 3; i++) { inv[i + 6*j] = first[i + 3*j]; inv[21 + i + 6*j] = last[i + 3*j]; }
  product3(-1, inv + 18, 6, left, 3, inv, 6);
}

/* Inverses of the matrices (M, M) of a vector of legs, leg by leg because each has its own pivots */
static int invert_each(const Settings *s, int group, const lanes *A, lanes *inverse) {
  SIZES(s);
  double one[M*M + 1], inv[M*M + 1];
  for (int i = 0; i < LANES; i++) {
    if (i < used(s, group)) {
      for (long j = 0; j < M*M; j++) one[j] = A[j][i];
      if (M && invert(M, one, inv)) return SINGULAR;
    }
    for (long j = 0; j < M*M; j++) inverse[j][i] = inv[j];
  }
  return OK;
}

/* The same for all legs at once, without seeking pivots: right where the matrices are positive, as mass and stiffness make
   them. Where one is not (a pivot vanishes or is negative: a leg buckles), each leg seeks its own. */
static int invert_legs(const Settings *s, int group, const lanes *A, lanes *inverse) {
  SIZES(s);
  lane_bits positive = ~(lane_bits){0};
  memcpy(inverse, A, BYTES(lanes, M*M));
  for (long k = 0; k < M; k++) {
    lanes pivot = inverse[k + k*M], d = 1.0/pivot;
    positive &= pivot > 1e-12*A[k + k*M];
    for (long j = 0; j < M; j++) {
      if (j == k) continue;
      lanes t = inverse[k + j*M]*d;
      for (long i = 0; i < M; i++) inverse[i + j*M] -= inverse[i + k*M]*t;
      inverse[k + j*M] = t;
    }
    for (long i = 0; i < M; i++) inverse[i + k*M] *= -d;
    inverse[k + k*M] = d;
  }
  for (int i = 0; i < LANES; i++) if (!positive[i]) return invert_each(s, group, A, inverse);
  return OK;
}

/* Which coordinates of the legs are held, and the border's unknowns of those that are pivots */
static void arrow_hold(Arrow *w, const Settings *s) {
  SIZES(s);
  w->size = HUB;
  for (int group = 0; group < groups(s); group++) {
    LegBlock *b = &w->leg[group];
    lanes held[PORTS];
    memset(b->held, 0, BYTES(lanes, N)); memset(b->unknown, 0, sizeof b->unknown);
    gather(s, group, s->held, s->ports, s->ports, held);
    for (long k = 0; k < s->ports; k++) b->held[PLACE[s->port[k]]] = held[k];
    for (int p = 0; p < ROWS; p++) {
      b->any[p] = 0;
      for (int i = 0; i < LANES; i++) {
        if (b->held[p][i] == 0) continue;
        b->unknown[p][i] = i < used(s, group) ? (int)w->size++ : b->unknown[p][used(s, group) - 1];
        b->any[p] = 1;
      }
    }
  }
}

/* Everything of a vector of legs that does not depend on residuals; its share of the border */
static int leg_factor(const Settings *s, int group, const Arrow *w) {
  SIZES(s);
  const LegBlock *b = &w->leg[group];
  lanes *AN = w->AN, *B = w->B, AY[N*HUB];
  double *border = w->sum;
  long size = w->size;
  memset(b->N1, 0, BYTES(lanes, ROWS*M)); memset(b->Y1, 0, BYTES(lanes, ROWS*HUB));
  invert_pivots(ROWS, b->J, b->J1inv);
  for (long j = 0; j < M; j++) lanes_gemv(ROWS, ROWS, -1, b->J1inv, b->J + ROWS*(ROWS + j), b->N1 + ROWS*j);
  for (long j = 0; j < 6; j++) lanes_gemv(ROWS, ROWS, 1, b->J1inv, b->P + ROWS*j, b->Y1 + ROWS*j);
  for (long j = 6; j < HUB; j++) lanes_gemv(ROWS, ROWS, -1, b->J1inv, b->J + ROWS*(ROWS + M + j - 6), b->Y1 + ROWS*j);
  for (long j = 0; j < M; j++) for (int p = 0; p < ROWS; p++) b->N1[p + ROWS*j] *= 1.0 - b->held[ROWS + j];
  memcpy(AN, b->A + ROWS*N, BYTES(lanes, N*M)); memset(AY, 0, BYTES(lanes, N*HUB));
  memcpy(AY + 6*N, b->A + (ROWS + M)*N, BYTES(lanes, COMMON*N));
  for (long j = 0; j < M; j++) lanes_gemv(N, ROWS, 1, b->A, b->N1 + ROWS*j, AN + j*N);
  for (long j = 0; j < HUB; j++) lanes_gemv(N, ROWS, 1, b->A, b->Y1 + ROWS*j, AY + j*N);
  for (long j = 0; j < M; j++) { memcpy(B + j*M, AN + j*N + ROWS, BYTES(lanes, M)); lanes_gemv_t(ROWS, M, 1, b->N1, AN + j*N, B + j*M); }
  for (long j = 0; j < HUB; j++) { memcpy(b->Et + j*M, AY + j*N + ROWS, BYTES(lanes, M)); lanes_gemv_t(ROWS, M, 1, b->N1, AY + j*N, b->Et + j*M); }
  for (long k = 0; k < M; k++) {
    lanes held = b->held[ROWS + k], free = 1.0 - held;
    for (long j = 0; j < M; j++) { B[k + j*M] *= free; B[j + k*M] *= free; }
    for (long j = 0; j < HUB; j++) b->Et[k + j*M] *= free;
    B[k + k*M] += held;
  }
  if (LOOPING) for (long j = 0; j < HUB; j++) for (long k = 0; k < M; k++) {
    lanes t = {0};
    for (int p = 0; p < ROWS; p++) t += b->Y1[p + ROWS*j]*AN[p + k*N];
    if (j >= 6) t += AN[ROWS + M + j - 6 + k*N];
    b->Er[k + j*M] = t*(1.0 - b->held[ROWS + k]);
  }
  if (invert_legs(s, group, B, b->Binv)) return SINGULAR;
  if (b->half) for (long j = 0; j < M; j++) memcpy(b->half + j*(j + 1)/2, b->Binv + j*M, BYTES(lanes, (j + 1)));
  memset(b->C, 0, BYTES(lanes, M*HUB)); memset(b->Bd, 0, BYTES(lanes, ROWS*M));
  for (long j = 0; j < HUB; j++) lanes_gemv(M, M, 1, b->Binv, b->Et + j*M, b->C + j*M);
  for (long j = 0; j < HUB; j++) {
    lanes payload[HUB];
    memset(payload, 0, BYTES(lanes, HUB));
    for (int i = 6; i < HUB; i++) payload[i] = AY[ROWS + M + i - 6 + j*N];
    lanes_gemv_t(ROWS, HUB, 1, b->Y1, AY + j*N, payload);
    lanes_gemv_t(M, HUB, -1, b->Er, b->C + j*M, payload);
    for (int i = 0; i < HUB; i++) border[i + j*size] += sum(s, group, payload[i]);
  }
  for (int p = 0; p < ROWS; p++) {
    if (!b->any[p]) continue;
    for (long j = 0; j < M; j++) for (long i = 0; i < M; i++) b->Bd[i + p*M] += b->Binv[i + j*M] * b->N1[p + ROWS*j];
    for (long j = 0; j < HUB; j++) {
      lanes force = b->Y1[p + ROWS*j];
      for (long i = 0; i < M; i++) force -= b->N1[p + ROWS*i] * b->C[i + j*M];
      lanes back = -force;
      if (LOOPING) {
        back = -b->Y1[p + ROWS*j];
        for (long i = 0; i < M; i++) back += b->Er[i + j*M] * b->Bd[i + p*M];
      }
      for (int i = 0; i < LANES; i++) {
        long f = b->unknown[p][i];
        if (f) { border[f + j*size] = force[i]; border[j + f*size] = back[i]; }
      }
    }
    for (int o = 0; o < ROWS; o++) {
      lanes own = {0};
      if (!b->any[o]) continue;
      for (long i = 0; i < M; i++) own += b->N1[o + ROWS*i] * b->Bd[i + p*M];
      for (int i = 0; i < LANES; i++) if (b->unknown[o][i] && b->unknown[p][i]) border[b->unknown[o][i] + b->unknown[p][i]*size] = own[i];
    }
  }
  return OK;
}

static int arrow_factor(Arrow *w, const Settings *s, const double *A_payload) {
  SIZES(s);
  double *border = w->sum;
  long size = w->size;
  memset(border, 0, BYTES(double, size*size));
  for (int j = 0; j < HUB; j++) for (int i = 0; i < HUB; i++) border[i + j*size] = A_payload[i + HUB*j];
  for (int group = 0; group < groups(s); group++) if (leg_factor(s, group, w)) return SINGULAR;
  for (int k = 0; k < 6; k++) {
    if (s->hub_held[k] == 0) continue;
    for (long j = 0; j < size; j++) border[k + j*size] = border[j + k*size] = 0;
    border[k + k*size] = 1;
  }
  return invert(size, border, w->border);
}

/* z -= B^-1 t. Of large legs, whose inverse does not fit into the nearest cache, half of it is read */
static void times_inverse(long M, const LegBlock *b, const lanes *restrict t, lanes *restrict z) {
  if (b->half) {
    const lanes *a = b->half;
    for (long j = 0; j < M; j++) {
      lanes along = {0}, own = t[j];
      for (long i = 0; i < j; i++, a++) { z[i] -= *a*own; along += *a*t[i]; }
      z[j] -= along + *a++*own;
    }
    return;
  }
  lanes_gemv(M, M, -1, b->Binv, t, z);
}

/* r, g, dq, dlam: N, ROWS, N, ROWS vectors a group; df: of a force for each port; rp (HUB), dy (6): of the payload.
   In r and rp those of shared coordinates are in rp alone. Without dlam no forces are sought. */
INLINE void arrow_solve_of(long rows, long common, const Arrow *w, const Settings *s, lanes *const *r, lanes *const *g,
                           const double *rp, lanes *const *dq, lanes *const *dlam, lanes *const *df, double *dy) {
  SIZES_OF(s, rows, common);
  lanes z[GROUPS][M + 1], g0[GROUPS][CLOSURES];
  double rhs[w->size], x[w->size];
  memset(rhs, 0, BYTES(double, w->size)); memset(x, 0, BYTES(double, w->size));
  for (int i = 0; i < HUB; i++) rhs[i] = -rp[i];
  for (int group = 0; group < groups(s); group++) {
    const LegBlock *b = &w->leg[group];
    lanes t[N], part[HUB];
    memset(part, 0, BYTES(lanes, HUB)); memset(g0[group], 0, BYTES(lanes, ROWS)); memset(z[group], 0, BYTES(lanes, M));
    lanes_gemv(ROWS, ROWS, -1, b->J1inv, g[group], g0[group]);
    for (long j = 0; j < N; j++) t[j] = r[group][ORDER[j]];
    lanes_gemv(N, ROWS, 1, b->A, g0[group], t);                            /* r + A g0 */
    for (int i = 6; i < HUB; i++) part[i] = -t[ROWS + M + i - 6];
    lanes_gemv_t(ROWS, HUB, -1, b->Y1, t, part);
    lanes_gemv_t(ROWS, M, 1, b->N1, t, t + ROWS);
    for (long j = ROWS; j < N; j++) t[j] *= 1.0 - b->held[j];
    times_inverse(M, b, t + ROWS, z[group]);
    lanes_gemv_t(M, HUB, -1, b->Er, z[group], part);
    for (int i = 0; i < HUB; i++) rhs[i] += sum(s, group, part[i]);
    for (int p = 0; p < ROWS; p++) {
      if (!b->any[p]) continue;
      lanes l = g0[group][p];
      for (long i = 0; i < M; i++) l += b->N1[p + ROWS*i] * z[group][i];
      for (int i = 0; i < LANES; i++) if (b->unknown[p][i]) rhs[b->unknown[p][i]] = -l[i];
    }
  }
  for (int i = 0; i < 6; i++) if (s->hub_held[i] != 0) rhs[i] = 0;
  gemv(w->size, w->size, 1, w->border, rhs, x);
  memcpy(dy, x, 6*sizeof(double));
  for (int group = 0; group < groups(s); group++) {
    const LegBlock *b = &w->leg[group];
    lanes change[N], f[CLOSURES], y[HUB], *dz = change + ROWS;
    for (int i = 0; i < HUB; i++) y[i] = (lanes){0} + x[i];
    memcpy(change + ROWS + M, y + 6, BYTES(lanes, COMMON));
    memcpy(change, g0[group], BYTES(lanes, ROWS)); memcpy(dz, z[group], BYTES(lanes, M));
    lanes_gemv(M, HUB, -1, b->C, y, dz);
    for (int p = 0; p < ROWS; p++) {
      f[p] = (lanes){0};
      if (!b->any[p]) continue;
      for (int i = 0; i < LANES; i++) if (b->unknown[p][i]) f[p][i] = x[b->unknown[p][i]];
      for (long i = 0; i < M; i++) dz[i] += b->Bd[i + p*M] * f[p];
    }
    lanes_gemv(ROWS, M, 1, b->N1, dz, change);
    lanes_gemv(ROWS, HUB, 1, b->Y1, y, change);
    for (int p = 0; p < ROWS; p++) change[p] *= 1.0 - b->held[p];
    for (long j = 0; j < N; j++) dq[group][ORDER[j]] = change[j];
    if (!dlam) continue;
    lanes left[CLOSURES];
    for (int p = 0; p < ROWS; p++) left[p] = r[group][ORDER[p]];
    for (long j = 0; j < N; j++) for (int p = 0; p < ROWS; p++) left[p] += b->A[p + j*N] * change[j];
    for (int p = 0; p < ROWS; p++) left[p] -= f[p];
    memset(dlam[group], 0, BYTES(lanes, ROWS));
    lanes_gemv_t(ROWS, ROWS, -1, b->J1inv, left, dlam[group]);             /* rows of the pivots give dlam */
    for (long k = 0; k < s->ports; k++) {
      long at = PLACE[s->port[k]];
      if (ROWS && at < ROWS) { df[group][k] = f[at]; continue; }
      lanes own = r[group][s->port[k]];
      for (long j = 0; j < N; j++) own += b->A[at + j*N] * change[j];
      for (int i = 0; i < ROWS; i++) own += b->J[i + ROWS*at] * dlam[group][i];
      df[group][k] = b->held[at] * own;
    }
  }
}

static void arrow_solve(const Arrow *w, const Settings *s, lanes *const *r, lanes *const *g, const double *rp,
                        lanes *const *dq, lanes *const *dlam, lanes *const *df, double *dy) {
#define SOLVE(rows, common) arrow_solve_of(rows, common, w, s, r, g, rp, dq, dlam, df, dy)
  BY_SIZES(s, SOLVE);
#undef SOLVE
}
