/* Data of the compiled time integration; filled in by Python (ctypes mirrors these structures field by field).
   This text knows no robot: sizes and equations come with each call, so that it is compiled once for all. */
#define INLINE static inline __attribute__((always_inline))
#define SHARED static __attribute__((noinline))  /* called from many places: a copy in each takes the compiler long */
#ifndef EXPORTED
#define EXPORTED                        /* what others call; static where all is one unit */
#endif
#define BYTES(type, count) (sizeof(type)*(size_t)(count))

enum { LEGS = 16, PORTS = 24, CLOSURES = 6 };     /* at most */
enum { COLUMNS = 4 };                   /* of a port in a table: value, rate, acceleration, force */
enum { WORKS = 4 };                     /* energies that are summed over time */
enum { OK = 0, NOT_CONVERGED = 1, NOT_FINITE = 2, SINGULAR = 3 };

typedef void (*BodyFunction)(const double *const *in, double *const *out);

typedef struct {                        /* of one kind of robot: sizes of a leg, and what `mechanics` says of it */
  long n, rows;                         /* coordinates of a leg, equations that close it */
  long leg_p, joint, command;           /* numbers that its functions read */
  long common, plate;                   /* coordinates that all legs share; of these the payload's functions know */
  long posed;                           /* whether a leg's functions know the payload */
  long floor;                           /* the first of six coordinates, the last ports, that move the base; n: none does */
  long bristles;                        /* of a leg with friction */
  long loop;                            /* its coordinate of an impulse, on which forces do no work; n: loops are symmetric */
  const long *order, *place;            /* (n): coordinates, those found from the closure first, shared ones last; and where each is there */
  LaneFunction leg_residual, leg_matrices, leg_energies, leg_closing, leg_friction, leg_friction_matrix, leg_sliding, leg_loop;
  LaneFunction joint_residual, joint_matrices, joint_closing;
  BodyFunction payload_residual, payload_matrices, payload_energies;
} Equations;

typedef struct {
  const Equations *of;
  long legs, hub;                       /* hub: 1 where the legs carry a payload */
  long ports, port[PORTS];              /* coordinates that follow tables or are pushed by them; the springs' first */
  const double *held;                   /* (legs, ports): 1 where the coordinate follows its table */
  const double *hub_held;               /* (6): 1 where a coordinate of the payload stays what it is */
  const double *leg_p, *joint_p, *payload_p;      /* (legs, leg_p), (legs, joint), (any) */
  double h, alpha_m, alpha_f, beta, gamma, tol_closure, tol_force, force_floor;
  long max_iterations, max_age, output_every;
} Settings;

typedef struct {                        /* flat coordinates: legs * n, then the payload's six */
  double *q, *v, *v_dot, *a, *lam, *drive, *pose;
  double *bristles;                     /* (legs, 2 bristles): how far they are bent, how fast what they are at slides */
  double *sums;                         /* dissipated energy, works of drives, of the wrench, on the base */
  double *powers;                       /* their rates at the present time */
  double *record;                       /* next output row */
  double closure;
  long steps, iterations, factorisations, bad_leg;
} State;

/* Sizes by their names. M: coordinates of a leg that are left when closures and shared ones are gone; HUB: those of the
   payload, and those that all legs share; LARGE: whether a leg has so many that its functions and matrices cost more
   than a better start and steps counted; LOOPING: whether loops make matrices that are not symmetric. */
#define SIZES(s) SIZES_OF(s, (s)->of->rows, (s)->of->common)
#define SIZES_OF(s, rows_of_it, common_of_it) \
  __attribute__((unused)) const long N = (s)->of->n, ROWS = rows_of_it, COMMON = common_of_it, M = N - ROWS - COMMON, HUB = 6 + COMMON, \
             BODY = 6 + (s)->of->plate, BRISTLES = (s)->of->bristles, SPRINGS = (s)->of->command/2, \
             POSED = (s)->of->posed, LARGE = N > 30, LOOPING = (s)->of->loop < N, *ORDER = (s)->of->order, *PLACE = (s)->of->place

/* A copy of `part` for each usual number of closures and shared coordinates, whose inner loops then have known sizes: twice as
   fast as one for all */
#define BY_SIZES(s, part) \
  do { \
    if ((s)->of->rows == 0 && (s)->of->common == 0) part(0, 0); \
    else if ((s)->of->rows == 3 && (s)->of->common == 0) part(3, 0); \
    else if ((s)->of->rows == 6 && (s)->of->common == 0) part(6, 0); \
    else part((s)->of->rows, (s)->of->common); \
  } while (0)
