/* Steps of a linear model along a path: Gauss' formula of two stages is one complex solve, Eqs. (T22.12)-(T22.13), (T22.25).
   Matrices are cubic polynomials of time between instants. Each is stored by the envelope: of row i the columns from `first`
   to the diagonal, of column i the same rows, and the diagonal. The matrices of LANES steps are factored side by side; mass and
   stiffness are positive, so that nothing is pivoted. */
typedef struct {
  long size, loads, steps, pieces, entries;
  const long *first, *at;               /* (size): of each row its first column, and where its entries are */
  const double *edge, *series;          /* (pieces + 1) [s]; (pieces, 4, 3, entries): of M, D, K, the highest power first */
  const double *force;                  /* (steps, 2, size, loads): at both stages */
  double h, turn[2][2], weight[2], root[2];       /* real and imaginary: eigenvalue of the formula, and what belongs to it */
  double *x;                            /* (steps + 1, 2, size, loads): places and rates; the first row is given */
  lanes *memory;                        /* as `modal_memory` says */
} ModalPath;

EXPORTED long modal_memory(const ModalPath *p) { return (long)BYTES(lanes, 4*p->entries) + (long)BYTES(double, 4*p->size*p->loads); }

/* M, K and M + l D + l^2 K at the middles of the steps from `first` on, those beyond the last one as the last one */
static void modal_matrices(const ModalPath *p, long piece, long first, long count, lanes *M, lanes *K, lanes *re, lanes *im) {
  const double *series = p->series + piece*12*p->entries;
  const double l[2] = {p->h*p->root[0], p->h*p->root[1]}, l2[2] = {l[0]*l[0] - l[1]*l[1], 2*l[0]*l[1]};
  lanes t;
  for (long i = 0; i < LANES; i++) t[i] = p->h*((double)(first + (i < count ? i : count - 1)) + 0.5) - p->edge[piece];
  for (long e = 0; e < p->entries; e++) {
    lanes of[3];
    for (int k = 0; k < 3; k++) {
      const double *c = series + k*p->entries + e;
      of[k] = ((c[0]*t + c[3*p->entries])*t + c[6*p->entries])*t + c[9*p->entries];
    }
    M[e] = of[0]; K[e] = of[2];
    re[e] = of[0] + l[0]*of[1] + l2[0]*of[2];
    im[e] = l[1]*of[1] + l2[1]*of[2];
  }
}

/* L U in the place of the matrix, the inverse of U's diagonal on the diagonal */
static void modal_factor(const ModalPath *p, lanes *re, lanes *im) {
  for (long i = 0; i < p->size; i++) {
    long f = p->first[i], w = i - f;
    lanes *a = re + p->at[i], *b = im + p->at[i], *c = a + w, *d = b + w, dr = c[w], di = d[w];
    for (long j = f; j < i; j++) {
      long g = p->first[j], v = j - g, from = f > g ? f : g;
      const lanes *q = re + p->at[j], *r = im + p->at[j], *s = q + v, *t = r + v;
      lanes lr = a[j - f], li = b[j - f], ur = c[j - f], ui = d[j - f];
      for (long k = from; k < j; k++) {
        long m = k - f, n = k - g;
        lr -= a[m]*s[n] - b[m]*t[n]; li -= a[m]*t[n] + b[m]*s[n];
        ur -= q[n]*c[m] - r[n]*d[m]; ui -= q[n]*d[m] + r[n]*c[m];
      }
      lanes er = s[v], ei = t[v], nr = lr*er - li*ei, ni = lr*ei + li*er;
      a[j - f] = nr; b[j - f] = ni; c[j - f] = ur; d[j - f] = ui;
      dr -= nr*ur - ni*ui; di -= nr*ui + ni*ur;
    }
    lanes size = 1.0/(dr*dr + di*di);
    c[w] = dr*size; d[w] = -di*size;
  }
}

#define OF_LANE(array, k) ((const double *)(array))[(k)*LANES + lane]

/* y = A x of one lane */
INLINE void modal_product(const ModalPath *p, const lanes *A, long lane, long loads, const double *x, double *y) {
  for (long i = 0; i < p->size; i++) {
    long f = p->first[i], w = i - f, at = p->at[i];
    double diagonal = OF_LANE(A, at + 2*w);
    for (long n = 0; n < loads; n++) y[i*loads + n] = diagonal*x[i*loads + n];
    for (long k = 0; k < w; k++) {
      double left = OF_LANE(A, at + k), above = OF_LANE(A, at + w + k);
      for (long n = 0; n < loads; n++) { y[i*loads + n] += left*x[(f + k)*loads + n]; y[(f + k)*loads + n] += above*x[i*loads + n]; }
    }
  }
}

INLINE void modal_solve(const ModalPath *p, const lanes *re, const lanes *im, long lane, long loads, double *u, double *v) {
  for (long i = 0; i < p->size; i++) {
    long f = p->first[i], at = p->at[i];
    for (long k = f; k < i; k++) {
      double r = OF_LANE(re, at + k - f), s = OF_LANE(im, at + k - f), *a = u + k*loads, *b = v + k*loads;
      for (long n = 0; n < loads; n++) { u[i*loads + n] -= r*a[n] - s*b[n]; v[i*loads + n] -= r*b[n] + s*a[n]; }
    }
  }
  for (long i = p->size - 1; i >= 0; i--) {
    long f = p->first[i], w = i - f, at = p->at[i] + w;
    double r = OF_LANE(re, at + w), s = OF_LANE(im, at + w), *a = u + i*loads, *b = v + i*loads;
    for (long n = 0; n < loads; n++) { double t = a[n]; a[n] = r*t - s*b[n]; b[n] = r*b[n] + s*t; }
    for (long k = f; k < i; k++) {
      r = OF_LANE(re, at + k - f); s = OF_LANE(im, at + k - f);
      for (long n = 0; n < loads; n++) { u[k*loads + n] -= r*a[n] - s*b[n]; v[k*loads + n] -= r*b[n] + s*a[n]; }
    }
  }
}

/* One step of one lane, Eq. (T22.25) */
INLINE void modal_step(const ModalPath *p, const lanes *const *matrices, long lane, long loads, long step, double *room) {
  long size = p->size*loads;
  const double *f = p->force + 2*step*size, *g = f + size, (*turn)[2] = p->turn;
  const double c[2] = {turn[0][0] + turn[1][0], turn[0][1] + turn[1][1]}, l[2] = {p->h*p->root[0], p->h*p->root[1]};
  double *z = p->x + 2*step*size, *v = z + size, *re = room, *im = room + size, *Mv = im + size, *Kz = Mv + size;
  modal_product(p, matrices[0], lane, loads, v, Mv);
  modal_product(p, matrices[1], lane, loads, z, Kz);
  for (long i = 0; i < size; i++) {
    double r = turn[0][0]*f[i] + turn[1][0]*g[i] - c[0]*Kz[i], s = turn[0][1]*f[i] + turn[1][1]*g[i] - c[1]*Kz[i];
    re[i] = l[0]*r - l[1]*s + c[0]*Mv[i]; im[i] = l[0]*s + l[1]*r + c[1]*Mv[i];
  }
  modal_solve(p, matrices[2], matrices[3], lane, loads, re, im);
  double scale = 1/(l[0]*l[0] + l[1]*l[1]), twice = 2*p->h;
  const double per[2] = {scale*(p->weight[0]*l[0] + p->weight[1]*l[1]), scale*(p->weight[1]*l[0] - p->weight[0]*l[1])};
  for (long i = 0; i < size; i++) {
    z[2*size + i] = z[i] + twice*(p->weight[0]*re[i] - p->weight[1]*im[i]);
    v[2*size + i] = v[i] + twice*(per[0]*(re[i] - c[0]*v[i]) - per[1]*(im[i] - c[1]*v[i]));
  }
}

EXPORTED void modal_march(const ModalPath *p) {
  lanes *M = p->memory, *K = M + p->entries, *re = K + p->entries, *im = re + p->entries;
  const lanes *const matrices[] = {M, K, re, im};
  double *room = (double *)(im + p->entries);
  for (long step = 0, piece = 0, count; step < p->steps; step += count) {
    while (piece + 1 < p->pieces && p->h*((double)step + 0.5) >= p->edge[piece + 1]) piece++;
    for (count = 1; count < LANES && step + count < p->steps; count++)
      if (piece + 1 < p->pieces && p->h*((double)(step + count) + 0.5) >= p->edge[piece + 1]) break;
    modal_matrices(p, piece, step, count, M, K, re, im);
    modal_factor(p, re, im);
    for (long lane = 0; lane < count; lane++) {
      if (p->loads == 1) modal_step(p, matrices, lane, 1, step + lane, room);
      else modal_step(p, matrices, lane, p->loads, step + lane, room);
    }
  }
}
