"""The single actuator in Exudyn, clamped and sliding, against ours; and what its model refuses."""

import numpy as np
import pytest

from flexapod import model
from flexapod.analysis.actuator import simulate_actuator
from flexapod.common.errors import InputError
from flexapod.verification.engines.engine import EXUDYN
from flexapod.verification.engines.exudyn_actuator import simulate_actuator as exudyn_actuator
from flexapod.verification.engines.exudyn_integration import Integration, extrapolate_first_order

pytestmark = [pytest.mark.consistency, pytest.mark.skipif(not EXUDYN.is_available(), reason="needs Exudyn")]

STEP = 1e-3


def study(*, motion=None, duration=1.0, tip=5e-3, **changes):
    preset = model.preset("paper-actuator")
    return model.ActuatorStudy(
        actuator=preset.actuator.replace(**changes),
        motion=motion or preset.motion,
        initial=model.ActuatorInitial(tip_displacement=tip),
        simulation=model.Simulation(basis="clamped-free", modes=6, duration=duration, step=STEP, output_step=STEP),
    )


def tips(case, duration, *elements):
    plan = Integration(duration=duration, step=STEP, tolerance=1e-5)
    return [exudyn_actuator(case, plan, elements=n).tip_deflection for n in elements]


@pytest.mark.parametrize("settings", [{}, {"gravity": 9.81, "angle": -1.4, "hub_radius": 0.25}])
def test_a_beam_outside_its_hub_as_a_whole(settings):
    # Nothing slides: elements are of fourth order; what is left is the second order of our kinematics,
    # (v / L)^2 = 1.2e-3 with gravity.
    motion = model.ActuatorMotion(rotation=model.RateLaw(rate=0.785))
    case = study(motion=motion, length=1.83, **settings)
    (theirs,) = tips(case, 1.0, 16)
    ours = simulate_actuator(case).tip_deflection.values
    assert np.abs(theirs - ours).max() < 2e-3 * np.abs(ours).max()


def test_a_beam_that_slides_out():
    # First order in the element length: the finer mesh is wrong by the difference of the two. After extrapolation half
    # of that is allowed: the clamp passes through elements, so that the error goes up and down with its place in them.
    case = study()
    coarse, fine = tips(case, 1.0, 18, 36)
    ours = simulate_actuator(case).tip_deflection.values
    between = np.abs(fine - coarse).max()
    assert np.abs(fine - ours).max() == pytest.approx(between, rel=0.3)
    assert np.abs(extrapolate_first_order(coarse, fine) - ours).max() < between / 2
    assert between < 0.1 * np.abs(ours).max()


def test_the_start_has_the_static_shape_at_rest_in_x_over_length():
    # Fed so fast that a start at rest at fixed x would be 0.5 mm beside; tolerance as above, 0.1 mm.
    feed = model.ActuatorMotion(extension=model.RateLaw(rate=1.0))
    case = study(motion=feed, tip=0.02, duration=0.3)
    coarse, fine = tips(case, 0.3, 18, 36)
    ours = simulate_actuator(case).tip_deflection.values
    assert fine[0] == pytest.approx(0.02, abs=1e-12)
    assert np.abs(extrapolate_first_order(coarse, fine) - ours).max() < np.abs(fine - coarse).max() / 2


@pytest.mark.parametrize(
    ("changes", "settings", "key"),
    [
        ({"tip_mass": 1.0}, {}, "tip_mass"),
        ({"damping": 0.01}, {}, "damping"),
        ({}, {"elements": 0}, "elements"),
        ({}, {"axial_stiffness": 0.0}, "axial_stiffness"),
        ({"free_length": 3.6}, {}, "motion.extension"),
        (
            {"motion": model.ActuatorMotion(rotation=model.ProfileLaw(law="trapezoid", amplitude=1.0, duration=1.0))},
            {},
            "motion",
        ),
    ],
)
def test_what_its_model_lacks_is_refused_before_anything_runs(changes, settings, key):
    with pytest.raises(InputError) as refused:
        exudyn_actuator(study(**changes), Integration(duration=1.0, step=STEP), **settings)
    assert refused.value.key == key


def test_a_torque_is_refused():
    preset = model.preset("paper-actuator")
    driven = model.ActuatorStudy(
        actuator=preset.actuator.replace(hub_inertia=1.0),
        motion=model.ActuatorMotion(rotation=None),
        load=model.ActuatorLoad(torque=model.ConstantLaw(value=1.0)),
        simulation=model.Simulation(basis="clamped-free", duration=1.0),
    )
    with pytest.raises(InputError, match="prescribed motions only"):
        exudyn_actuator(driven, Integration(duration=1.0))
