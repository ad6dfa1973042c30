/* What the equations of robots (ode_robot.c) and of a single actuator (ode_leg.c) share. Sizes stand above: N coordinates of a
   leg, of which FREE[COUNT] are states, GIVEN[GIVES] follow commands and DEPENDENT[3] follow from the closure. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("O3")
#endif
#include <math.h>
#include <string.h>
enum { MOST = 32 };                     /* coordinates of a leg */

typedef struct {
  long rows, leg_np;                    /* instants of the table */
  const double *leg_p, *joint_p, *payload_p;
  const double *table; double spacing;  /* (rows, legs, GIVES, 3): value, rate, acceleration */
  const double *guess;                  /* (rows, legs, 3): dependent coordinates of rigid legs */
} Robot;

/* Quintic through value, rate and acceleration at both ends of an interval */
static void command(const Robot *s, double t, int legs, int leg, int which, double *out) {
  long k = (long)(t/s->spacing);
  if (k < 0) k = 0;
  if (k > s->rows - 2) k = s->rows - 2;
  double d = s->spacing, x = t/d - k;
  const double *a = s->table + 3*((k*legs + leg)*GIVES + which), *b = a + 3*legs*GIVES;
  double c0 = a[0], c1 = a[1]*d, c2 = 0.5*a[2]*d*d;
  double e0 = b[0] - c0 - c1 - c2, e1 = b[1]*d - c1 - 2*c2, e2 = b[2]*d*d - 2*c2;
  double c3 = 10*e0 - 4*e1 + 0.5*e2, c4 = -15*e0 + 7*e1 - e2, c5 = 6*e0 - 3*e1 + 0.5*e2;
  out[0] = c0 + x*(c1 + x*(c2 + x*(c3 + x*(c4 + x*c5))));
  out[1] = (c1 + x*(2*c2 + x*(3*c3 + x*(4*c4 + x*5*c5))))/d;
  out[2] = (2*c2 + x*(6*c3 + x*(12*c4 + x*20*c5)))/(d*d);
}

static void cholesky(double *B, long m) {                 /* lower triangle, row-major */
  for (long j = 0; j < m; j++) {
    for (long i = j; i < m; i++) {
      double t = B[i*m + j];
      for (long k = 0; k < j; k++) t -= B[i*m + k]*B[j*m + k];
      B[i*m + j] = i == j ? sqrt(t) : t/B[j*m + j];
    }
  }
}
static void solve(const double *B, long m, double *x) {
  for (long i = 0; i < m; i++) { for (long k = 0; k < i; k++) x[i] -= B[i*m + k]*x[k]; x[i] /= B[i*m + i]; }
  for (long i = m - 1; i >= 0; i--) { for (long k = i + 1; k < m; k++) x[i] -= B[k*m + i]*x[k]; x[i] /= B[i*m + i]; }
}

void rates(const Robot *s, double t, const double *y, double *y_dot);

/* Derivatives of the rates by differences, column by column; the first `count` of `size` numbers move by dq, the others by dv */
void jacobian(const Robot *s, double t, const double *y, long size, long count, double dq, double dv, double *J) {
  double here[size], moved[size];
  rates(s, t, y, here);
  memcpy(moved, y, size*sizeof(double));
  for (long j = 0; j < size; j++) {
    double d = j < count ? dq : dv;
    moved[j] += d;
    rates(s, t, moved, J + j*size);
    for (long i = 0; i < size; i++) J[i + j*size] = (J[i + j*size] - here[i])/d;
    moved[j] = y[j];
  }
}
