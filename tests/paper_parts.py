"""The parts of the paper's study at coarse steps, for tests: seconds instead of half a minute."""

from functools import cache

from flexapod.model import preset
from flexapod.paper.cost import inverse_dynamics_cost
from flexapod.paper.readings import readings, tripod
from flexapod.paper.study import ACTUATOR_MODES, STEPS, PaperStudy
from flexapod.paper.trials import trials
from flexapod.paper.variants import HALF_ANGLES, assumptions, half_angle_sweep, jump_motion, with_half_angle
from flexapod.paper.welded import welded_map
from flexapod.study import modes, simulate, simulate_actuator

ROBOT, RADII = "paper-robot", "paper-robot-radii"


def quiet(_):
    pass


def jump(name, angle=None, step=6.25e-5):
    study = preset(name) if angle is None else with_half_angle(preset(name), angle)
    return simulate(study, jump_motion(study), step=step)


@cache
def elements():
    """The single actuator by finite elements and by 8 shapes, as `replicate` computes them: a dozen seconds."""
    finite = ("actuator-free", "actuator-fine", "actuator-beam", "actuator-solid")
    return {step.name: step.compute(quiet) for step in STEPS if step.name.startswith(finite)}


def coarse_parts(angles=HALF_ANGLES):
    return _parts(angles)


@cache
def _parts(angles):
    """Every part of `replicate` by name, at some of the half-angles; steps of 1 ms where nothing rings."""
    robot, radii = preset(ROBOT), preset(RADII)
    return {
        **{f"actuator-{k}": simulate_actuator(preset("paper-actuator"), modes=k, step=5e-4) for k in ACTUATOR_MODES},
        **elements(),
        "robot": simulate(robot, step=1e-3),
        "robot-rigid": simulate(robot, fidelity="rigid", step=5e-4),
        "robot-lumped": simulate(robot, fidelity="lumped", step=1e-3),
        "modes": modes(robot, robot.motion.target),
        "robot-radii": simulate(radii, step=1e-3),
        "jump": jump(ROBOT),
        "jump-radii": jump(RADII),
        "jump-27": jump(ROBOT, 27.0),
        "half-angles": half_angle_sweep(robot, angles, quiet),
        "half-angles-radii": half_angle_sweep(radii, angles, quiet),
        "assumptions": assumptions(robot, quiet),
        "readings": trials(readings(), quiet),
        "tripod": simulate(tripod(), step=1e-3),
        "welded": welded_map(quiet),
        "cost": inverse_dynamics_cost(robot),
    }


def coarse_study(angles=HALF_ANGLES):
    return PaperStudy(parts=coarse_parts(angles))
