"""Names, units and meanings of values at a pose: of maps, sensitivities and optimisations."""

from __future__ import annotations

from flexapod.analysis.results.variables import Variable

#: Values by name; dimensions of a grid of poses come before those that stand here.
GRID_VARIABLES = {
    "reason": Variable((), "1", "why a pose is not reached: a code, 0 where it is"),
    "frequency": Variable(("mode",), "Hz", "undamped natural frequency, commands of the drives held"),
    "stiffness": Variable((), "N m-1", "stiffness at the tool against a force in the chosen direction"),
    "stiffness_least": Variable((), "N m-1", "stiffness at the tool against a force in the weakest direction"),
    "softest_direction": Variable(("axis",), "1", "weakest direction at the tool, world axes"),
    "condition": Variable((), "1", "condition of the scaled Jacobian of the rigid robot"),
    "smallest_singular_value": Variable((), "1", "smallest singular value of the scaled Jacobian of the rigid robot"),
    "static_deviation": Variable(("axis",), "m", "deviation of the tool at rest, flexible minus rigid"),
    "static_deviation_size": Variable((), "m", "deviation of the tool at rest"),
    "dynamic_deviation": Variable((), "m", "quasi-static deviation of the tool in an acceleration"),
    "actuator_force": Variable(("leg",), "N", "force of the drive on the piston at rest, positive pushes out"),
    "largest_force": Variable((), "N", "largest drive force of a leg at rest"),
    "stroke_margin": Variable((), "m", "least distance of a leg from the ends of its stroke"),
    "guided_length": Variable((), "m", "least length of a piston in its cylinder"),
    "base_joint_angle": Variable((), "rad", "largest turn of a leg at its base joint from home"),
    "platform_joint_angle": Variable((), "rad", "largest turn of a leg at its platform joint from home"),
    "leg_clearance": Variable((), "m", "least distance between cylinders and pistons of two legs"),
    "nearest_legs": Variable(("pair",), "1", "numbers of the two legs"),
    "euler_share": Variable((), "1", "largest axial thrust of a leg at rest over its Euler load"),
}

#: Those of joints that have a largest angle, of loops that can be unstable, and where error budgets are asked for.
FURTHER_VARIABLES = {
    "joint_margin": Variable((), "rad", "least angle left at a joint whose largest turn is given"),
    "loop_growth": Variable((), "s-1", "rate at which deviations by unstable loops of drives grow, 0 where none does"),
    "error_worst": Variable((), "m", "worst case of the tool's place at rest, all parts that have a size"),
    "error_by_part": Variable(("part",), "m", "size of the worst that a part does to the tool's place at rest"),
}
