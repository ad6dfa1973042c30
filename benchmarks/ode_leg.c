/* Accelerations of the shapes of a single actuator whose rotation and length follow commands: M_ff z_ddot = -(h_f + M_fg g_ddot).
   The generated function stands above: leg_ode(q, v, p) -> M, h, .... */
void rates(const Robot *s, double t, const double *y, double *y_dot) {
  static const long one[] = {1, 1, 1};
  double q[N], v[N], law[GIVES][3], M[N*N], h[N], J[3*N], bend[3], B[COUNT*COUNT], *z_ddot = y_dot + COUNT;
  for (int g = 0; g < GIVES; g++) { command(s, t, 1, 0, g, law[g]); q[GIVEN[g]] = law[g][0]; v[GIVEN[g]] = law[g][1]; }
  for (int k = 0; k < COUNT; k++) { q[FREE[k]] = y[k]; v[FREE[k]] = y[COUNT + k]; }
  const double *in[] = {q, v, s->leg_p}; double *out[] = {M, h, J, bend};
  leg_ode(1, in, one, out);
  for (int k = 0; k < COUNT; k++) {
    z_ddot[k] = -h[FREE[k]];
    for (int g = 0; g < GIVES; g++) z_ddot[k] -= M[FREE[k] + N*GIVEN[g]]*law[g][2];
    for (int j = 0; j < COUNT; j++) B[k*COUNT + j] = M[FREE[k] + N*FREE[j]];
    y_dot[k] = y[COUNT + k];
  }
  cholesky(B, COUNT);
  solve(B, COUNT, z_ddot);
}
