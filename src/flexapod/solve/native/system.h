/* Data of the compiled time integration; filled in by Python (ctypes mirrors these structures field by field). */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("O3")              /* loops of this size are worth unrolling; the generated code above has none */
#endif

enum { COMMAND = 4, TABLE = 8 };        /* table row of a leg: l, l', l'', force, beta, beta', beta'', torque */
enum { OK = 0, NOT_CONVERGED = 1, NOT_FINITE = 2, SINGULAR = 3 };
enum { LEGS = 6, MAXN = 64 };           /* coordinates of a leg: 3, up to 4 axial and twice 24 lateral shapes */

typedef struct {
  long legs, n, l_index, payload;       /* payload: 1 for a robot, 0 for a single planar actuator */
  long prescribed_l, prescribed_beta;   /* bit i: the coordinate of leg i follows its table */
  const double *leg_p, *payload_p;      /* (legs, leg_np), (payload_np) */
  long leg_np;
  double h, alpha_m, alpha_f, beta, gamma, tol_closure, tol_force, force_floor;
  long max_iterations, max_age, output_every;
} Settings;

typedef struct {                        /* flat coordinates: legs * n, then the payload's six */
  double *q, *v, *v_dot, *a, *lam, *drive, *pose;
  double *sums;                         /* dissipated energy, work of drives, work of the wrench */
  double *powers;                       /* their rates at the present time */
  double *record;                       /* next output row */
  double closure;
  long steps, iterations, factorisations, bad_leg;
} State;
