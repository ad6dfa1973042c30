/* Data of the compiled time integration; filled in by Python (ctypes mirrors these structures field by field).
   Before this text stand the generated functions and their sizes: N coordinates of a leg, ROWS equations that close it,
   LEG_P, JOINT and COMMAND numbers that its functions read; ORDER: its coordinates, those found from the closure first;
   PLACE: where each of them stands there; COMMON: how many of them, the last there, are one coordinate of all legs;
   FLOOR: the first of six, the last ports, that move the base (N: none moves it);
   POSED: whether a leg's functions know the payload; PLATE: how many shared coordinates the payload's know;
   BRISTLES of a leg, where it has friction; LOOP: the impulse of its motor, where loops are not symmetric. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("O3")              /* loops of this size are worth unrolling; the generated code above has none */
#endif
#define SHARED static __attribute__((noinline))  /* called from many places: a copy in each takes the compiler long */

enum { LEGS = 16, PORTS = 24 };         /* at most */
enum { COLUMNS = 4 };                   /* of a port in a table: value, rate, acceleration, force */
#ifndef BRISTLES
#define BRISTLES 0
#else
#define FRICTION
#endif
#ifndef LOOP
#define LOOP N                          /* its coordinate of an impulse, on which forces do no work; N: none */
#else
#define LOOPING
#endif
enum { WORKS = 4 };                     /* energies that are summed over time */
enum { OK = 0, NOT_CONVERGED = 1, NOT_FINITE = 2, SINGULAR = 3 };

typedef struct {
  long legs, hub;                       /* hub: 1 where the legs carry a payload */
  long ports, port[PORTS];              /* coordinates that follow tables or are pushed by them; the springs' first */
  const double *held;                   /* (legs, ports): 1 where the coordinate follows its table */
  const double *hub_held;               /* (6): 1 where a coordinate of the payload stays what it is */
  const double *leg_p, *joint_p, *payload_p;      /* (legs, LEG_P), (legs, JOINT), (any) */
  double h, alpha_m, alpha_f, beta, gamma, tol_closure, tol_force, force_floor;
  long max_iterations, max_age, output_every;
} Settings;

typedef struct {                        /* flat coordinates: legs * N, then the payload's six */
  double *q, *v, *v_dot, *a, *lam, *drive, *pose;
  double *bristles;                     /* (legs, 2 BRISTLES): how far they are bent, how fast what they are at slides */
  double *sums;                         /* dissipated energy, works of drives, of the wrench, on the base */
  double *powers;                       /* their rates at the present time */
  double *record;                       /* next output row */
  double closure;
  long steps, iterations, factorisations, bad_leg;
} State;
