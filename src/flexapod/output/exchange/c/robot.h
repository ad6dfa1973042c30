/* A robot with elastic legs in fixed steps. All that it remembers is in the caller's memory, which may be copied, stored and put back
   by whoever owns it, also at another address; nothing is allocated, no step iterates without an end. One thread at a time for
   each memory. */
#ifndef ROBOT_H
#define ROBOT_H
#include <stddef.h>

enum { ROBOT_ALIGNMENT = 64 };          /* the memory begins at a multiple of it */

/* What a call returns: 0, or why it failed; what it had to do is then not done, and each byte of the memory is what it was */
enum { ROBOT_OK = 0, ROBOT_NOT_CONVERGED = 1, ROBOT_NOT_FINITE = 2, ROBOT_SINGULAR = 3, ROBOT_JUMPS = 6, ROBOT_BACKWARDS = 7 };

size_t robot_size(void);                /* bytes of the memory */
int robot_init(void *memory);           /* the start: at time 0 */

/* Go on by `steps` steps of ROBOT_STEP. Inputs are those of the present time and hold for all of them: forces as they are, commands
   of the drives as value, rate and acceleration, extrapolated. ROBOT_JUMPS: the command of a drive that keeps it whatever the force
   has another value than before, and no rate that leads there. ROBOT_NOT_FINITE: an input or a number of the robot is not finite.
   ROBOT_BACKWARDS: `steps` is below 0. */
int robot_step(void *memory, const double *inputs, long steps);

double robot_time(const void *memory);
void robot_outputs(const void *memory, double *outputs);
void robot_start_inputs(double *inputs);        /* those that keep the robot as it starts */
long robot_most_iterations(const void *memory); /* of one step so far */

#endif
