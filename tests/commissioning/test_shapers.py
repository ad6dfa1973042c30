"""Shapers against oscillators, published bands, and what the linear model makes of motions with closed-form answers."""

import numpy as np
import pytest
from tests.oracles import integrator
from tests.oracles.integrator import residual, residual_of_motion

import flexapod as fx
from flexapod.commissioning.feedforward.modal_path import path_vibration
from flexapod.commissioning.feedforward.shapers import KINDS, insensitivity, shaper
from flexapod.kinematics import coordinates

pytestmark = pytest.mark.analytic

# Singer & Seering 1990; Singhose, Seering & Singer 1994, 1996: printed to three digits, half a unit of the last one
BANDS = {"zv": (0.0637, 5e-5), "zvd": (0.287, 5e-4), "ei": (0.399, 5e-4), "2hei": (0.724, 6e-4)}
PERIODS = {"zv": 0.5, "mzv": 0.75, "zvd": 1.0, "ei": 1.0, "2hei": 1.5}


@pytest.mark.parametrize("kind", BANDS)
def test_the_band_in_which_a_twentieth_is_left(kind: str) -> None:
    printed, half = BANDS[kind]
    assert insensitivity(kind) == pytest.approx(printed, abs=half)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("ratio", [0.0, 0.02, 0.2])
def test_impulses_on_an_oscillator(kind: str, ratio: float) -> None:
    made = shaper(kind, 7.0, ratio)
    assert made.amplitudes.sum() == pytest.approx(1.0, abs=1e-15)
    assert (made.amplitudes > 0).all()
    assert made.duration == pytest.approx(PERIODS[kind] / (7.0 * np.sqrt(1 - ratio**2)), rel=1e-14)
    for f in (5.0, 7.0, 7.4):  # rounding of sums of cosines
        left = residual(made.amplitudes, made.times, 2 * np.pi * f, ratio)
        assert float(made.residual_share(f, ratio)) == pytest.approx(left, abs=1e-14)
    # at the mode each half period turns what an impulse leaves about and makes it K times as large: of EI's three
    # ((1 + V) / 4 - (1 - V) / 2 + (1 + V) / 4) K^2 = V K^2 are left, of the others nothing
    K, V = np.exp(-np.pi * ratio / np.sqrt(1 - ratio**2)), 0.05
    whole = (1 + V) / 4 * (1 + K**2) + (1 - V) / 2 * K
    assert float(made.residual_share(7.0, ratio)) == pytest.approx(V * K**2 / whole if kind == "ei" else 0.0, abs=1e-14)


@pytest.mark.parametrize(("name", "ratio"), [("ZV", 0.0), ("ZV", 0.1), ("ZVD", 0.0), ("ZVD", 0.1), ("EI", 0.0)])
def test_impulses_as_their_authors_write_them(name: str, ratio: float) -> None:
    sizes, places = integrator.shaper(name, ratio)
    made = shaper(name.lower(), 7.0, ratio)
    np.testing.assert_allclose(made.amplitudes, sizes, rtol=1e-14)
    np.testing.assert_allclose(made.times, places / (7.0 * np.sqrt(1 - ratio**2)), rtol=1e-14)


def test_one_after_the_other_leaves_neither_mode() -> None:
    made = shaper("zv", [3.0, 11.0], [0.01, 0.05])
    assert made.duration == pytest.approx(0.5 / (3 * np.sqrt(1 - 1e-4)) + 0.5 / (11 * np.sqrt(1 - 0.0025)))
    assert float(made.residual_share(3.0, 0.01)) < 1e-14
    assert float(made.residual_share(11.0, 0.05)) < 1e-14


def test_a_motion_alone_is_its_law_delayed_and_added_up() -> None:
    motion = fx.model.CombinedMotion(amplitudes={"heave": 0.1, "roll": 0.2}, duration=0.4, hold=0.2)
    shaped = fx.shape(motion, "zvd", modes=[12.5])
    assert shaped.end_time == pytest.approx(motion.end_time + 0.08)
    t = np.linspace(0.0, 0.5, 97)

    def quintic(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x = np.clip(t / 0.4, 0, 1)
        return 10 * x**3 - 15 * x**4 + 6 * x**5, (60 * x - 180 * x**2 + 120 * x**3) / 0.16

    place, bend = (
        sum(a * part for a, part in zip((0.25, 0.5, 0.25), parts, strict=True))
        for parts in zip(*(quintic(t - late) for late in (0.0, 0.04, 0.08)), strict=True)
    )
    law = coordinates(shaped, t)
    # the table meets accelerations to 1e-5 in the mean; beside jumps of the jerk for a millisecond more
    np.testing.assert_allclose(law.position[:, [2, 3]], place[:, None] * [0.1, 0.2], rtol=0, atol=1e-9)
    np.testing.assert_allclose(law.acceleration[:, [2, 3]], bend[:, None] * [0.1, 0.2], rtol=0, atol=2e-3 * 0.2)


def heaving(profile: str, periods: float) -> tuple[fx.Study, float]:
    """A symmetric hexapod of six springs that heaves by a micrometre; its frequency in heave [rad/s], by hand."""
    study = fx.preset("paper-robot")
    leg, payload = study.robot.legs[0], study.robot.payload
    bare = leg.replace(
        piston=fx.model.leg.piston.Piston(length=leg.piston.length, EA=leg.piston.EA, EI=leg.piston.EI, rhoA=0.0),
        cylinder=leg.cylinder.replace(mass=0.0, inertia=0.0),
        damping=0.0,
    )
    robot = study.robot.replace(legs=(bare,) * 6, payload=payload.replace(com=[0, 0, 0]), gravity=[0, 0, 0])
    axes = robot.platform_joints + robot.home_position - robot.base_joints
    sine = axes[:, 2] / np.linalg.norm(axes, axis=1)
    w = np.sqrt((leg.piston.EA / leg.piston.length * sine**2).sum() / payload.mass)
    motion = fx.model.AxisMotion(type="heave", amplitude=1e-6, duration=periods * 2 * np.pi / w, profile=profile)
    return study.replace(robot=robot, motion=motion, simulation=fx.model.Simulation(fidelity="lumped")), w


@pytest.mark.parametrize("profile", ["quintic", "cycloidal"])
def test_the_linear_model_leaves_what_an_oscillator_has_left(profile: str) -> None:
    study, w = heaving(profile, 2.3)
    moving = study.motion.duration
    found = path_vibration(study, moving, moving + 10 / w)
    # Gauss' formula of order 4 with 55 steps in the motion, 24 and more in a period: (w h)^4 / 720 = 7e-6
    # of a deviation of 1, of which 0.1 is left; looked at 100 times in a period: 5e-4
    assert found.largest_after(moving) / 1e-6 == pytest.approx(residual_of_motion(profile, w * moving), rel=2e-3)


def test_ramps_of_whole_periods_leave_nothing() -> None:
    ramp = fx.kinematics.laws.TRAPEZOID_FRACTIONS[0]
    whole, half = (path_vibration(*timed(periods / ramp)) for periods in (1.0, 1.5))
    after = [x.largest_after(y[1]) for x, y in ((whole, timed(1.0 / ramp)), (half, timed(1.5 / ramp)))]
    assert after[0] < 1e-3 * after[1]


def timed(periods: float) -> tuple[fx.Study, float, float]:
    study, w = heaving("trapezoid", periods)
    return study, study.motion.duration, study.motion.duration + 10 / w


@pytest.mark.parametrize(("kind", "most"), [("zv", 12), ("zvd", 7), ("2hei", 6)])
def test_more_impulses_than_anybody_can_add_up_are_refused(kind, most):
    """Twenty modes were a million impulses, and took all memory."""
    assert shaper(kind, np.linspace(10, 20, most)).times.size <= 4096
    with pytest.raises(fx.InputError, match=rf"at most {most} at once") as refused:
        shaper(kind, np.linspace(10, 20, most + 1))
    assert refused.value.key == "modes"
