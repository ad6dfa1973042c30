/* The robot as a functional mock-up unit for co-simulation, FMI 3.0 (Modelica Association, Functional Mock-up Interface
   specification 3.0, 2022, chapters 2 and 4): floating-point variables, states that are copied, steps that are multiples of the
   robot's own. What it has no use for exists and fails. */
#include "robot.h"
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define PASTED(a, b) a##b
#define JOINED(a, b) PASTED(a, b)
#ifdef FMI3_FUNCTION_PREFIX
#define NAMED(name) JOINED(FMI3_FUNCTION_PREFIX, name)
#else
#define NAMED(name) name
#endif
#if defined(_WIN32)
#define FMI __declspec(dllexport) Status
#define FMI_OF(type) __declspec(dllexport) type
#else
#define FMI __attribute__((visibility("default"))) Status
#define FMI_OF(type) __attribute__((visibility("default"))) type
#endif

typedef enum { OK, WARNING, DISCARD, ERROR, FATAL } Status;
typedef uint32_t Reference;
typedef void (*Log)(void *environment, Status status, const char *category, const char *message);

typedef struct { int input, first, size; } Variable;    /* by value reference, from 1; 0 is the time */
static const Variable VARIABLE[] = VARIABLES;

typedef struct { char token[sizeof TOKEN]; double start, inputs[ROBOT_INPUTS + 1]; } Given;    /* of a state beside the robot's memory */
static const double NEAR = 1e-3*ROBOT_STEP, MOST_STEPS = 2147483647;   /* of one call */
typedef struct { void *environment; Log log; Given given; unsigned char *memory, *room; } Instance;

static size_t state_size(void) { return sizeof(Given) + robot_size(); }

static Status failed(Instance *m, Status status, const char *words) {
  if (m && m->log) m->log(m->environment, status, "logStatusError", words);
  return status;
}

/* Life */
FMI_OF(const char *) NAMED(fmi3GetVersion)(void) { return "3.0"; }
FMI NAMED(fmi3SetDebugLogging)(void *m, bool on, size_t count, const char *const *categories) {
  (void)m; (void)on; (void)count; (void)categories;
  return OK;
}
FMI_OF(void *) NAMED(fmi3InstantiateModelExchange)(const char *name, const char *token, const char *resources, bool visible, bool logging,
                                                   void *environment, Log log) {
  (void)name; (void)token; (void)resources; (void)visible; (void)logging; (void)environment; (void)log;
  return 0;
}
FMI_OF(void *) NAMED(fmi3InstantiateScheduledExecution)(const char *name, const char *token, const char *resources, bool visible, bool logging,
                                                        void *environment, Log log, void *update, void *lock, void *unlock) {
  (void)name; (void)token; (void)resources; (void)visible; (void)logging; (void)environment; (void)log; (void)update; (void)lock; (void)unlock;
  return 0;
}
FMI_OF(void *) NAMED(fmi3InstantiateCoSimulation)(const char *name, const char *token, const char *resources, bool visible, bool logging,
                                                  bool events, bool early, const Reference *required, size_t count, void *environment,
                                                  Log log, void *update) {
  (void)name; (void)resources; (void)visible; (void)logging; (void)events; (void)early; (void)required; (void)count; (void)update;
  Instance *m = calloc(1, sizeof *m);
  if (!m) return 0;
  m->environment = environment; m->log = log;
  if (!token || strcmp(token, TOKEN)) {
    failed(m, ERROR, "the instantiation token is of another unit");
    free(m);
    return 0;
  }
  m->room = malloc(robot_size() + ROBOT_ALIGNMENT);
  if (!m->room) { free(m); return 0; }
  m->memory = m->room + (ROBOT_ALIGNMENT - (uintptr_t)m->room % ROBOT_ALIGNMENT) % ROBOT_ALIGNMENT;
  memcpy(m->given.token, TOKEN, sizeof TOKEN);
  robot_start_inputs(m->given.inputs);
  robot_init(m->memory);
  return m;
}
FMI_OF(void) NAMED(fmi3FreeInstance)(void *instance) {
  Instance *m = instance;
  if (m) { free(m->room); free(m); }
}
FMI NAMED(fmi3EnterInitializationMode)(void *instance, bool tolerated, double tolerance, double start, bool ends, double stop) {
  Instance *m = instance;
  (void)tolerated; (void)tolerance; (void)ends; (void)stop;
  if (BUILT_IN && start != 0) return failed(m, ERROR, "the motion that is built in begins at time 0");
  if (!(fabs(start) < NEAR*0x1p52)) return failed(m, ERROR, "the start time is no number, or so far from 0 that steps are lost beside it");
  m->given.start = start;
  return OK;
}
FMI NAMED(fmi3ExitInitializationMode)(void *m) { (void)m; return OK; }
FMI NAMED(fmi3EnterStepMode)(void *m) { (void)m; return OK; }
FMI NAMED(fmi3Terminate)(void *m) { (void)m; return OK; }
FMI NAMED(fmi3Reset)(void *instance) {
  Instance *m = instance;
  m->given.start = 0;
  robot_start_inputs(m->given.inputs);
  robot_init(m->memory);
  return OK;
}

/* Variables */
static const Variable *variable(Reference reference) {
  return reference > 0 && reference <= sizeof VARIABLE/sizeof *VARIABLE ? &VARIABLE[reference - 1] : 0;
}

FMI NAMED(fmi3GetFloat64)(void *instance, const Reference *references, size_t count, double *values, size_t size) {
  Instance *m = instance;
  double outputs[ROBOT_OUTPUTS];
  size_t at = 0, needed = 0;
  for (size_t k = 0; k < count; k++) {
    const Variable *v = variable(references[k]);
    needed += v ? (size_t)v->size : 1;
    if ((!v && references[k]) || needed > size) return failed(m, ERROR, "no such variable, or no room for its values");
  }
  robot_outputs(m->memory, outputs);
  for (size_t k = 0; k < count; k++) {
    const Variable *v = variable(references[k]);
    size_t length = v ? (size_t)v->size : 1;
    if (!v) values[at] = m->given.start + robot_time(m->memory);
    else memcpy(values + at, (v->input ? m->given.inputs : outputs) + v->first, sizeof(double)*length);
    at += length;
  }
  return OK;
}
FMI NAMED(fmi3SetFloat64)(void *instance, const Reference *references, size_t count, const double *values, size_t size) {
  Instance *m = instance;
  double inputs[ROBOT_INPUTS + 1];              /* all of them are set, or none */
  size_t at = 0;
  memcpy(inputs, m->given.inputs, sizeof inputs);
  for (size_t k = 0; k < count; k++) {
    const Variable *v = variable(references[k]);
    if (!v || !v->input || at + (size_t)v->size > size) return failed(m, ERROR, "this variable cannot be set, or has more values");
    for (int i = 0; i < v->size; i++) if (!isfinite(values[at + (size_t)i])) return failed(m, ERROR, "an input is no finite number");
    memcpy(inputs + v->first, values + at, sizeof(double)*(size_t)v->size);
    at += (size_t)v->size;
  }
  memcpy(m->given.inputs, inputs, sizeof inputs);
  return OK;
}

/* Time */
FMI NAMED(fmi3DoStep)(void *instance, double now, double length, bool kept, bool *events, bool *terminate, bool *early, double *reached) {
  Instance *m = instance;
  double own = m->given.start + robot_time(m->memory), steps = rint(length/ROBOT_STEP);
  (void)kept;
  *events = *terminate = *early = false;
  *reached = own;
  if (!(fabs(now - own) <= NEAR)) return failed(m, ERROR, "the communication point is not the time reached");
  if (steps > MOST_STEPS) return failed(m, ERROR, "the communication step has more steps inside than a call can make");
  if (!(steps >= 1) || !(fabs(now + length - (own + steps*ROBOT_STEP)) <= NEAR))
    return failed(m, ERROR, "the communication step is no multiple of the step inside, see fixedInternalStepSize");
  int fault = robot_step(m->memory, m->given.inputs, (long)steps);
  *reached = m->given.start + robot_time(m->memory);
  if (fault == ROBOT_JUMPS)
    return failed(m, ERROR, "drive_command of a drive that keeps it (prescribed) has changed while its rate and acceleration are 0, or "
                            "begins elsewhere than the robot: give drive_command_rate and drive_command_acceleration with it, or use "
                            "a servo or a force drive, which take any command");
  if (fault == ROBOT_NOT_FINITE) return failed(m, ERROR, "numbers became infinite: a shorter step or smaller inputs may help");
  if (fault) return failed(m, ERROR, "the equations of a step were not solved: a shorter step may help");
  return OK;
}

/* States: what was given, then the robot's memory */
FMI NAMED(fmi3GetFMUState)(void *instance, void **state) {
  Instance *m = instance;
  if (!*state) *state = malloc(state_size());
  if (!*state) return failed(m, ERROR, "no memory for a state");
  memcpy(*state, &m->given, sizeof m->given);
  memcpy((unsigned char *)*state + sizeof m->given, m->memory, robot_size());
  return OK;
}
FMI NAMED(fmi3SetFMUState)(void *instance, void *state) {
  Instance *m = instance;
  if (!state || memcmp(state, TOKEN, sizeof TOKEN)) return failed(m, ERROR, "no state, or one of another unit");
  memcpy(&m->given, state, sizeof m->given);
  memcpy(m->memory, (unsigned char *)state + sizeof m->given, robot_size());
  return OK;
}
FMI NAMED(fmi3FreeFMUState)(void *m, void **state) { (void)m; free(*state); *state = 0; return OK; }
FMI NAMED(fmi3SerializedFMUStateSize)(void *m, void *state, size_t *size) { (void)m; (void)state; *size = state_size(); return OK; }
FMI NAMED(fmi3SerializeFMUState)(void *instance, void *state, unsigned char *to, size_t size) {
  if (!state || size < state_size()) return failed(instance, ERROR, "no state, or no room for it");
  memcpy(to, state, state_size());
  return OK;
}
FMI NAMED(fmi3DeserializeFMUState)(void *instance, const unsigned char *from, size_t size, void **state) {
  if (size != state_size() || memcmp(from, TOKEN, sizeof TOKEN)) return failed(instance, ERROR, "a state of another unit");
  if (!*state) *state = malloc(size);
  if (!*state) return failed(instance, ERROR, "no memory for a state");
  memcpy(*state, from, size);
  return OK;
}

/* What it has no use for */
#define NONE(name, taken) FMI NAMED(name) taken { return ERROR; }
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
#define VALUES(type, kind) \
  NONE(fmi3Get##kind, (void *m, const Reference *r, size_t n, type *v, size_t size)) \
  NONE(fmi3Set##kind, (void *m, const Reference *r, size_t n, const type *v, size_t size))
VALUES(float, Float32) VALUES(int8_t, Int8) VALUES(uint8_t, UInt8) VALUES(int16_t, Int16) VALUES(uint16_t, UInt16)
VALUES(int32_t, Int32) VALUES(uint32_t, UInt32) VALUES(int64_t, Int64) VALUES(uint64_t, UInt64) VALUES(bool, Boolean)
VALUES(char *, String)
NONE(fmi3GetBinary, (void *m, const Reference *r, size_t n, size_t *sizes, const uint8_t **v, size_t size))
NONE(fmi3SetBinary, (void *m, const Reference *r, size_t n, const size_t *sizes, const uint8_t *const *v, size_t size))
NONE(fmi3GetClock, (void *m, const Reference *r, size_t n, bool *v))
NONE(fmi3SetClock, (void *m, const Reference *r, size_t n, const bool *v))
NONE(fmi3GetNumberOfVariableDependencies, (void *m, Reference r, size_t *n))
NONE(fmi3GetVariableDependencies, (void *m, Reference r, size_t *of, Reference *on, size_t *at, int *kinds, size_t n))
NONE(fmi3GetDirectionalDerivative, (void *m, const Reference *r, size_t n, const Reference *of, size_t k, const double *s, size_t a, double *v, size_t b))
NONE(fmi3GetAdjointDerivative, (void *m, const Reference *r, size_t n, const Reference *of, size_t k, const double *s, size_t a, double *v, size_t b))
NONE(fmi3EnterConfigurationMode, (void *m))
NONE(fmi3ExitConfigurationMode, (void *m))
NONE(fmi3GetIntervalDecimal, (void *m, const Reference *r, size_t n, double *v, int *q))
NONE(fmi3GetIntervalFraction, (void *m, const Reference *r, size_t n, uint64_t *v, uint64_t *of, int *q))
NONE(fmi3GetShiftDecimal, (void *m, const Reference *r, size_t n, double *v))
NONE(fmi3GetShiftFraction, (void *m, const Reference *r, size_t n, uint64_t *v, uint64_t *of))
NONE(fmi3SetIntervalDecimal, (void *m, const Reference *r, size_t n, const double *v))
NONE(fmi3SetIntervalFraction, (void *m, const Reference *r, size_t n, const uint64_t *v, const uint64_t *of))
NONE(fmi3SetShiftDecimal, (void *m, const Reference *r, size_t n, const double *v))
NONE(fmi3SetShiftFraction, (void *m, const Reference *r, size_t n, const uint64_t *v, const uint64_t *of))
NONE(fmi3EvaluateDiscreteStates, (void *m))
NONE(fmi3UpdateDiscreteStates, (void *m, bool *again, bool *ends, bool *nominals, bool *values, bool *timed, double *next))
NONE(fmi3EnterEventMode, (void *m))
NONE(fmi3EnterContinuousTimeMode, (void *m))
NONE(fmi3CompletedIntegratorStep, (void *m, bool kept, bool *event, bool *ends))
NONE(fmi3SetTime, (void *m, double t))
NONE(fmi3SetContinuousStates, (void *m, const double *x, size_t n))
NONE(fmi3GetContinuousStateDerivatives, (void *m, double *x, size_t n))
NONE(fmi3GetEventIndicators, (void *m, double *z, size_t n))
NONE(fmi3GetContinuousStates, (void *m, double *x, size_t n))
NONE(fmi3GetNominalsOfContinuousStates, (void *m, double *x, size_t n))
NONE(fmi3GetNumberOfEventIndicators, (void *m, size_t *n))
NONE(fmi3GetNumberOfContinuousStates, (void *m, size_t *n))
NONE(fmi3GetOutputDerivatives, (void *m, const Reference *r, size_t n, const int32_t *orders, double *v, size_t size))
NONE(fmi3ActivateModelPartition, (void *m, Reference clock, double t))
