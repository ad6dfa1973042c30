"""Robots of `tests.helpers.mechanisms` on a smooth path, for tests of the time integration."""

from tests.helpers.mechanisms import ROBOTS

from flexapod.model import AxisMotion, ServoDrive, Study, override, preset

#: Kinds of robots by what they exercise: held hinges, carriages, more legs than motions, attitudes that are closed,
#: free turns about the leg, a passive guide, a plane.
KINDS = (
    "8-UPS", "3-RPS", "6-PUS", "6-RUS", "3-UPU", "6-UCU", "3-SPR", "3-UPS+UP", "6-FPF", "planar 3-PRR",
)  # fmt: skip
SOFT = ServoDrive(stiffness=1e6, damping=2e3)  # some 40 Hz with the payload: steps of a millisecond resolve it


def moving(kind, drive=None, axial_modes=2, **simulation):
    """A robot that moves by 30 mm within a tenth of a second, from rest, its legs straight."""
    robot = ROBOTS[kind]()
    driven = {} if drive is None else {"drive": drive}
    changes = {"damping": 0.01, "axial_modes": axial_modes}
    legs = tuple(leg.replace(**changes, **(driven if leg.driven else {})) for leg in robot.legs)
    axis = "surge" if robot.plane else "heave"
    motion = AxisMotion(type=axis, amplitude=0.0 if robot.platform_fixed else 0.03, duration=0.1, profile="smooth")
    study = Study(robot=robot.replace(legs=legs), motion=motion, simulation=preset("paper-robot").simulation)
    study = study.replace(initial=study.initial.replace(start="straight"))
    return override(study, **{"modes": 2, "step": 0.5e-3, "output_step": 2e-3, "duration": 0.12} | simulation)
