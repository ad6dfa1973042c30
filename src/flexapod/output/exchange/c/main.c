/* A run of the robot: as it starts, its inputs kept. Prints the outputs at the end, and the longest step. */
#include "robot.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double seconds(void) {
  struct timespec now;
  timespec_get(&now, TIME_UTC);
  return (double)now.tv_sec + 1e-9*(double)now.tv_nsec;
}

static _Alignas(ROBOT_ALIGNMENT) unsigned char memory[ROBOT_BYTES];

int main(int count, char **words) {
  long steps = count > 1 ? atol(words[1]) : 1000;
  double inputs[ROBOT_INPUTS + 1], outputs[ROBOT_OUTPUTS], longest = 0;
  if (robot_size() > sizeof memory) return 1;
  robot_start_inputs(inputs);
  robot_init(memory);
  for (long k = 0; k < steps; k++) {
    double begin = seconds();
    int fault = robot_step(memory, inputs, 1);
    double took = seconds() - begin;
    if (fault) { printf("step %ld failed: %d\n", k + 1, fault); return fault; }
    if (took > longest) longest = took;
  }
  robot_outputs(memory, outputs);
  for (int k = 0; k < ROBOT_OUTPUTS; k++) printf("%s %.17g\n", robot_output_names[k], outputs[k]);
  printf("time %.17g s\n", robot_time(memory));
  printf("longest step %.3g us, at most %ld iterations\n", 1e6*longest, robot_most_iterations(memory));
  return 0;
}
