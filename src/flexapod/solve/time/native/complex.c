/* The arrow of `arrow.c` with a complex matrix A = A[0] + i A[1]: one pair of conjugate eigenvalues of an implicit
   Runge-Kutta method. The closures are real: J1inv, N1, Y1, what is held and the border's unknowns are those of the real
   arrow. Mass and stiffness are positive, so that A has its numerical range in a half-plane and needs no pivoting. */
typedef struct {
  lanes *A[2], *Binv[2], *Et[2], *C[2], *Bd[2], *Er[2];
} ComplexBlock;
typedef struct { ComplexBlock leg[GROUPS]; lanes *AN[2]; double *border, *sum; } ComplexArrow;

static void complex_room(Room *m, const Settings *s, ComplexArrow *w) {
  SIZES(s);
  long border = 4*border_size(s)*border_size(s);
  for (int group = 0; group < groups(s); group++) for (int part = 0; part < 2; part++) {
    ComplexBlock *b = &w->leg[group];
    b->A[part] = room_of_lanes(m, N*N); b->Binv[part] = room_of_lanes(m, M*M); b->Et[part] = room_of_lanes(m, M*HUB);
    b->C[part] = room_of_lanes(m, M*HUB); b->Bd[part] = room_of_lanes(m, ROWS*M);
    b->Er[part] = LOOPING ? room_of_lanes(m, M*HUB) : b->Et[part];
  }
  for (int part = 0; part < 2; part++) w->AN[part] = room_of_lanes(m, N*M);
  w->border = room_of_numbers(m, border); w->sum = room_of_numbers(m, border);
}

/* y += s A x and y += s A^T x, both complex, and with a real A */
INLINE void complex_gemv(long rows, long cols, double s, lanes *const *A, lanes *const *x, lanes *const *y) {
  lanes_gemv(rows, cols, s, A[0], x[0], y[0]); lanes_gemv(rows, cols, -s, A[1], x[1], y[0]);
  lanes_gemv(rows, cols, s, A[0], x[1], y[1]); lanes_gemv(rows, cols, s, A[1], x[0], y[1]);
}
INLINE void complex_gemv_t(long rows, long cols, double s, lanes *const *A, lanes *const *x, lanes *const *y) {
  lanes_gemv_t(rows, cols, s, A[0], x[0], y[0]); lanes_gemv_t(rows, cols, -s, A[1], x[1], y[0]);
  lanes_gemv_t(rows, cols, s, A[0], x[1], y[1]); lanes_gemv_t(rows, cols, s, A[1], x[0], y[1]);
}
#define PARTS(a, at) (lanes *const[]){(lanes *)(a)[0] + (at), (lanes *)(a)[1] + (at)}

/* Inverse of a complex matrix (m, m), in its place */
static void complex_invert(long m, lanes *re, lanes *im) {
  for (long k = 0; k < m; k++) {
    lanes pr = re[k + k*m], pi = im[k + k*m], d = 1.0/(pr*pr + pi*pi), dr = pr*d, di = -pi*d;
    for (long j = 0; j < m; j++) {
      if (j == k) continue;
      lanes tr = re[k + j*m]*dr - im[k + j*m]*di, ti = re[k + j*m]*di + im[k + j*m]*dr;
      for (long i = 0; i < m; i++) {
        lanes a = re[i + k*m], b = im[i + k*m];
        re[i + j*m] -= a*tr - b*ti; im[i + j*m] -= a*ti + b*tr;
      }
      re[k + j*m] = tr; im[k + j*m] = ti;
    }
    for (long i = 0; i < m; i++) {
      lanes a = re[i + k*m], b = im[i + k*m];
      re[i + k*m] = b*di - a*dr; im[i + k*m] = -a*di - b*dr;
    }
    re[k + k*m] = dr; im[k + k*m] = di;
  }
}

/* A complex number as a real matrix of two rows, in a border of twice the size */
static void add_complex(double *border, long size, long i, long j, double re, double im) {
  long wide = 2*size;
  border[i + j*wide] += re; border[size + i + (size + j)*wide] += re;
  border[size + i + j*wide] += im; border[i + (size + j)*wide] -= im;
}

static void complex_leg(const Settings *s, int group, const Arrow *w, const ComplexArrow *arrow) {
  SIZES(s);
  const LegBlock *b = &w->leg[group];
  const ComplexBlock *c = &arrow->leg[group];
  lanes *const *AN = arrow->AN, AY[2][N*HUB], zero = {0};
  double *border = arrow->sum;
  long size = w->size;
  for (int part = 0; part < 2; part++) {
    lanes *B = c->Binv[part], *Et = c->Et[part];
    memcpy(AN[part], c->A[part] + ROWS*N, BYTES(lanes, N*M)); memset(AY[part], 0, BYTES(lanes, N*HUB));
    memcpy(AY[part] + 6*N, c->A[part] + (ROWS + M)*N, BYTES(lanes, COMMON*N));
    for (long j = 0; j < M; j++) lanes_gemv(N, ROWS, 1, c->A[part], b->N1 + ROWS*j, AN[part] + j*N);
    for (long j = 0; j < HUB; j++) lanes_gemv(N, ROWS, 1, c->A[part], b->Y1 + ROWS*j, AY[part] + j*N);
    for (long j = 0; j < M; j++) { memcpy(B + j*M, AN[part] + j*N + ROWS, BYTES(lanes, M)); lanes_gemv_t(ROWS, M, 1, b->N1, AN[part] + j*N, B + j*M); }
    for (long j = 0; j < HUB; j++) { memcpy(Et + j*M, AY[part] + j*N + ROWS, BYTES(lanes, M)); lanes_gemv_t(ROWS, M, 1, b->N1, AY[part] + j*N, Et + j*M); }
    for (long k = 0; k < M; k++) {
      lanes held = b->held[ROWS + k], free = 1.0 - held;
      for (long j = 0; j < M; j++) { B[k + j*M] *= free; B[j + k*M] *= free; }
      for (long j = 0; j < HUB; j++) Et[k + j*M] *= free;
      if (part == 0) B[k + k*M] += held;
    }
    if (LOOPING) for (long j = 0; j < HUB; j++) for (long k = 0; k < M; k++) {
      lanes t = {0};
      for (int p = 0; p < ROWS; p++) t += b->Y1[p + ROWS*j]*AN[part][p + k*N];
      if (j >= 6) t += AN[part][ROWS + M + j - 6 + k*N];
      c->Er[part][k + j*M] = t*(1.0 - b->held[ROWS + k]);
    }
  }
  complex_invert(M, c->Binv[0], c->Binv[1]);
  for (int part = 0; part < 2; part++) { memset(c->C[part], 0, BYTES(lanes, M*HUB)); memset(c->Bd[part], 0, BYTES(lanes, ROWS*M)); }
  for (long j = 0; j < HUB; j++) complex_gemv(M, M, 1, PARTS(c->Binv, 0), PARTS(c->Et, j*M), PARTS(c->C, j*M));
  for (long j = 0; j < HUB; j++) {
    lanes payload[2][HUB];
    for (int part = 0; part < 2; part++) memset(payload[part], 0, BYTES(lanes, HUB));
    for (int part = 0; part < 2; part++) for (int i = 6; i < HUB; i++) payload[part][i] = AY[part][ROWS + M + i - 6 + j*N];
    for (int part = 0; part < 2; part++) lanes_gemv_t(ROWS, HUB, 1, b->Y1, AY[part] + j*N, payload[part]);
    complex_gemv_t(M, HUB, -1, PARTS(c->Er, 0), PARTS(c->C, j*M), PARTS(payload, 0));
    for (int i = 0; i < HUB; i++) add_complex(border, size, i, j, sum(s, group, payload[0][i]), sum(s, group, payload[1][i]));
  }
  for (int p = 0; p < ROWS; p++) {
    if (!b->any[p]) continue;
    for (int part = 0; part < 2; part++)
      for (long j = 0; j < M; j++) for (long i = 0; i < M; i++) c->Bd[part][i + p*M] += c->Binv[part][i + j*M] * b->N1[p + ROWS*j];
    for (long j = 0; j < HUB; j++) {
      lanes force[2] = {b->Y1[p + ROWS*j], zero};
      for (int part = 0; part < 2; part++) for (long i = 0; i < M; i++) force[part] -= b->N1[p + ROWS*i] * c->C[part][i + j*M];
      lanes back[2][1] = {{-force[0]}, {-force[1]}};
      if (LOOPING) {
        back[0][0] = -b->Y1[p + ROWS*j]; back[1][0] = zero;
        complex_gemv_t(M, 1, 1, PARTS(c->Er, j*M), PARTS(c->Bd, p*M), PARTS(back, 0));
      }
      for (int i = 0; i < LANES; i++) {
        long f = b->unknown[p][i];
        if (!f || i >= used(s, group)) continue;
        add_complex(border, size, f, j, force[0][i], force[1][i]); add_complex(border, size, j, f, back[0][0][i], back[1][0][i]);
      }
    }
    for (int o = 0; o < ROWS; o++) {
      lanes own[2] = {zero, zero};
      if (!b->any[o]) continue;
      for (int part = 0; part < 2; part++) for (long i = 0; i < M; i++) own[part] += b->N1[o + ROWS*i] * c->Bd[part][i + p*M];
      for (int i = 0; i < used(s, group); i++)
        if (b->unknown[o][i] && b->unknown[p][i]) add_complex(border, size, b->unknown[o][i], b->unknown[p][i], own[0][i], own[1][i]);
    }
  }
}

/* After `arrow_factor` of a real matrix at the same state; c->leg[].A is set. A_payload: real and imaginary part (HUB, HUB) */
static int complex_factor(ComplexArrow *c, const Arrow *w, const Settings *s, const double *const *A_payload) {
  SIZES(s);
  double *border = c->sum;
  long size = w->size, wide = 2*size;
  memset(border, 0, BYTES(double, wide*wide));
  for (int j = 0; j < HUB; j++) for (int i = 0; i < HUB; i++) add_complex(border, size, i, j, A_payload[0][i + HUB*j], A_payload[1][i + HUB*j]);
  for (int i = 0; i < groups(s); i++) complex_leg(s, i, w, c);
  for (int k = 0; k < 6; k++) {
    if (s->hub_held[k] == 0) continue;
    for (int part = 0; part < 2; part++) {
      long at = k + part*size;
      for (long j = 0; j < wide; j++) border[at + j*wide] = border[j + at*wide] = 0;
      border[at + at*wide] = 1;
    }
  }
  return invert(wide, border, c->border);
}

typedef struct { lanes *leg[GROUPS]; double *hub; } Vector;     /* of all coordinates */
typedef struct { lanes *lam[GROUPS], *drive[GROUPS]; } Forces;

static void vector_room(Room *m, const Settings *s, long count, Vector *x) {
  for (long k = 0; k < count; k++) { room_of_legs(m, s, s->of->n, x[k].leg); x[k].hub = room_of_numbers(m, 6 + s->of->common); }
}
static void forces_room(Room *m, const Settings *s, long count, Forces *f) {
  for (long k = 0; k < count; k++) { room_of_legs(m, s, s->of->rows, f[k].lam); room_of_legs(m, s, PORTS, f[k].drive); }
}

/* As `arrow_solve`: r and g of every coordinate and closure, real and imaginary part, to changes of them */
INLINE void complex_solve_of(long rows, long common, const ComplexArrow *c, const Arrow *w, const Settings *s, const Vector *r,
                             lanes *(*g)[GROUPS], Vector *dq, Forces *df) {
  SIZES_OF(s, rows, common);
  long size = w->size;
  lanes z[GROUPS][2][M + 1], g0[GROUPS][2][CLOSURES];
  double rhs[2*size], x[2*size];
  memset(rhs, 0, BYTES(double, 2*size)); memset(x, 0, BYTES(double, 2*size));
  for (int part = 0; part < 2; part++) for (int i = 0; i < HUB; i++) rhs[part*size + i] = -r[part].hub[i];
  for (int group = 0; group < groups(s); group++) {
    const LegBlock *b = &w->leg[group];
    const ComplexBlock *a = &c->leg[group];
    lanes t[2][N], part6[2][HUB];
    for (int part = 0; part < 2; part++) {
      memset(part6[part], 0, BYTES(lanes, HUB)); memset(g0[group][part], 0, BYTES(lanes, ROWS)); memset(z[group][part], 0, BYTES(lanes, M));
      lanes_gemv(ROWS, ROWS, -1, b->J1inv, g[part][group], g0[group][part]);
      for (long j = 0; j < N; j++) t[part][j] = r[part].leg[group][ORDER[j]];
    }
    complex_gemv(N, ROWS, 1, PARTS(a->A, 0), PARTS(g0[group], 0), PARTS(t, 0));
    for (int part = 0; part < 2; part++) {
      for (int i = 6; i < HUB; i++) part6[part][i] = -t[part][ROWS + M + i - 6];
      lanes_gemv_t(ROWS, HUB, -1, b->Y1, t[part], part6[part]);
      lanes_gemv_t(ROWS, M, 1, b->N1, t[part], t[part] + ROWS);
      for (long j = ROWS; j < N; j++) t[part][j] *= 1.0 - b->held[j];
    }
    complex_gemv(M, M, -1, PARTS(a->Binv, 0), PARTS(t, ROWS), PARTS(z[group], 0));
    complex_gemv_t(M, HUB, -1, PARTS(a->Er, 0), PARTS(z[group], 0), PARTS(part6, 0));
    for (int part = 0; part < 2; part++) {
      for (int i = 0; i < HUB; i++) rhs[part*size + i] += sum(s, group, part6[part][i]);
      for (int p = 0; p < ROWS; p++) {
        if (!b->any[p]) continue;
        lanes l = g0[group][part][p];
        for (long i = 0; i < M; i++) l += b->N1[p + ROWS*i] * z[group][part][i];
        for (int i = 0; i < LANES; i++) if (b->unknown[p][i]) rhs[part*size + b->unknown[p][i]] = -l[i];
      }
    }
  }
  for (int part = 0; part < 2; part++) for (int i = 0; i < 6; i++) if (s->hub_held[i] != 0) rhs[part*size + i] = 0;
  gemv(2*size, 2*size, 1, c->border, rhs, x);
  for (int part = 0; part < 2; part++) memcpy(dq[part].hub, x + part*size, 6*sizeof(double));
  for (int group = 0; group < groups(s); group++) {
    const LegBlock *b = &w->leg[group];
    const ComplexBlock *a = &c->leg[group];
    lanes change[2][N], t[2][CLOSURES], f[2][CLOSURES], y[2][HUB];
    for (int part = 0; part < 2; part++) {
      for (int i = 0; i < HUB; i++) y[part][i] = (lanes){0} + x[part*size + i];
      memcpy(change[part], g0[group][part], BYTES(lanes, ROWS)); memcpy(change[part] + ROWS, z[group][part], BYTES(lanes, M));
      memcpy(change[part] + ROWS + M, y[part] + 6, BYTES(lanes, COMMON));
    }
    complex_gemv(M, HUB, -1, PARTS(a->C, 0), PARTS(y, 0), PARTS(change, ROWS));
    for (int p = 0; p < ROWS; p++) {
      f[0][p] = f[1][p] = (lanes){0};
      if (!b->any[p]) continue;
      for (int part = 0; part < 2; part++)
        for (int i = 0; i < LANES; i++) if (b->unknown[p][i]) f[part][p][i] = x[part*size + b->unknown[p][i]];
      for (long i = 0; i < M; i++) {
        change[0][ROWS + i] += a->Bd[0][i + p*M]*f[0][p] - a->Bd[1][i + p*M]*f[1][p];
        change[1][ROWS + i] += a->Bd[0][i + p*M]*f[1][p] + a->Bd[1][i + p*M]*f[0][p];
      }
    }
    for (int part = 0; part < 2; part++) {
      lanes_gemv(ROWS, M, 1, b->N1, change[part] + ROWS, change[part]);
      lanes_gemv(ROWS, HUB, 1, b->Y1, y[part], change[part]);
      for (int p = 0; p < ROWS; p++) { change[part][p] *= 1.0 - b->held[p]; t[part][p] = r[part].leg[group][ORDER[p]] - f[part][p]; }
    }
    const lanes *re = a->A[0], *im = a->A[1];
    for (long j = 0; j < N; j++, re += N, im += N) for (int i = 0; i < ROWS; i++) {
      t[0][i] += re[i]*change[0][j] - im[i]*change[1][j];
      t[1][i] += re[i]*change[1][j] + im[i]*change[0][j];
    }
    for (int part = 0; part < 2; part++) {
      lanes *dlam = df[part].lam[group];
      memset(dlam, 0, BYTES(lanes, ROWS));
      lanes_gemv_t(ROWS, ROWS, -1, b->J1inv, t[part], dlam);
      for (long j = 0; j < N; j++) dq[part].leg[group][ORDER[j]] = change[part][j];
      for (long k = 0; k < s->ports; k++) {
        long at = PLACE[s->port[k]];
        if (at < ROWS) { df[part].drive[group][k] = f[part][at]; continue; }
        lanes own = r[part].leg[group][s->port[k]];
        for (long j = 0; j < N; j++) {
          own += a->A[0][at + j*N]*change[part][j];
          if (part == 0) own -= a->A[1][at + j*N]*change[1][j]; else own += a->A[1][at + j*N]*change[0][j];
        }
        for (int i = 0; i < ROWS; i++) own += b->J[i + ROWS*at] * dlam[i];
        df[part].drive[group][k] = b->held[at] * own;
      }
    }
  }
}

static void complex_solve(const ComplexArrow *c, const Arrow *w, const Settings *s, const Vector *r, lanes *(*g)[GROUPS],
                          Vector *dq, Forces *df) {
#define SOLVE(rows, common) complex_solve_of(rows, common, c, w, s, r, g, dq, df)
  BY_SIZES(s, SOLVE);
#undef SOLVE
}
