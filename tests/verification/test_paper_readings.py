"""Readings of the paper: each is the robot that it says, and its numbers are those of a theory of its own."""

import numpy as np
import pytest
from tests.helpers.paper_parts import part

from flexapod import model
from flexapod.kinematics import dynamics
from flexapod.kinematics.inverse import JointTurn
from flexapod.verification.paper import computing_time, trials, variants

pytestmark = [pytest.mark.unit, pytest.mark.xdist_group("claims")]  # one process computes the parts


@pytest.fixture(scope="module")
def studies():
    return {name: variant.study for name, variant in variants.readings().items()}


@pytest.fixture(scope="module")
def table():
    return part("readings")


def peak(table, name):
    return table.deviation_peak.sel(reading=name).values


def test_the_preset_is_the_first_reading_of_the_travel(studies):
    assert next(iter(variants.TRAVELS)) == "diameters"
    for name, preset in (("diameters", "paper-robot"), ("radii", "paper-robot-radii")):
        assert studies[name].motion == model.preset(preset).motion


@pytest.mark.parametrize("name", ["paper-robot", "paper-robot-radii"])
def test_presets_say_what_is_backed_out_and_what_stretches(name):
    reasons = {value.key: value.reason for value in model.open_values(name)}
    assert "backed out" in reasons["motion.amplitude"] and "backed out" in reasons["payload.com"]
    piston = model.preset(name).robot.legs[0].piston
    for length in (piston.length, 0.6):
        assert f"{1e-6 * piston.EA / length:.0f} N/um" in reasons["leg.piston.length"]
    assert "only then" not in model.preset_text(name)


def test_inextensible_pistons_leave_nanometres(table):
    """Second order: a tip that is 48 um off at 0.6 m shortens a leg by some w^2 / s = 4 nm."""
    assert np.all(peak(table, "inextensible") < 48e-6**2 / 0.6)
    assert table.tip_peak.sel(reading="inextensible") == pytest.approx(48e-6, rel=0.02)


def test_elastic_length_scales_the_deviation(table):
    """All of it is stretch: deviations go with the length that stretches, but for the piston's lesser weight."""
    ratio = peak(table, "elastic-length") / peak(table, "diameters")
    np.testing.assert_allclose(ratio, 0.6 / 0.75, rtol=0.02)
    np.testing.assert_allclose(table.stretch_stiffness.sel(reading="elastic-length"), 1.1451e8 / 0.6, rtol=1e-4)


def test_a_tenth_of_the_modulus_is_ten_times_the_deviation(table):
    # Of vibration, not of sag, the frequency changes too.
    np.testing.assert_allclose(peak(table, "modulus-20") / peak(table, "diameters"), 10, rtol=0.03)


def test_legs_bend_before_they_collapse(table):
    shares = [float(table.load_share.sel(reading=f"modulus-{E:g}")) for E in variants.MODULI]
    assert shares == sorted(shares)
    np.testing.assert_allclose(shares[:2], np.array([0.0159, 0.0159]) * 200 / [20, 4], rtol=0.06)
    assert table.tip_peak.sel(reading="modulus-3.5") > 0.05 * 0.6
    assert "Euler load" in table.verdict.sel(reading="modulus-3.1").item()
    assert not any(table.verdict.drop_sel(reading="modulus-3.1").values)


def test_beam_of_table_2():
    piston = variants.readings()["table-2"].study.robot.legs[0].piston
    assert (piston.EI, piston.rhoA) == (756.65, 4.02)
    assert piston.EA == pytest.approx(756.65 / (0.1524 * 0.0095**3 / 12) * 0.1524 * 0.0095, rel=1e-12)


def test_cube(studies):
    """Edge 1.04 m: m a^2 / 6 = 17.88 kg m^2 at 100 kg."""
    edge = variants.cube_edge(model.preset("paper-robot").robot.payload)
    assert 100 * edge**2 / 6 == pytest.approx(17.88) and edge == pytest.approx(1.036, abs=5e-4)
    np.testing.assert_allclose(studies[variants.CUBE].robot.payload.tool, [0, 0, edge / 2])


def test_inertia_about_the_platform_belongs_to_no_body(studies):
    payload = model.preset("paper-robot").robot.payload
    moments = np.diag(variants.inertia_about_com(payload))
    np.testing.assert_allclose(moments, [17.88 - 100 * 0.373**2, 17.88, 17.88 - 100 * 0.373**2])
    assert moments[1] > moments[0] + moments[2]
    changed = studies["inertia-of-platform"].robot.payload.inertia
    np.testing.assert_allclose(changed, np.diag([moments[0], 2 * moments[0], moments[0]]), atol=1e-12)
    body = payload.replace(com=[0, 0.1, 0], tool=[0, 0.1, 0])
    np.testing.assert_allclose(
        variants.nearest_body(variants.inertia_about_com(body)), variants.inertia_about_com(body)
    )


@pytest.mark.parametrize(
    ("name", "travel"),
    # Distances of joints, by hand: a roll by w moves a platform joint (x, y) of home to y cos w, height + y sin w.
    [("diameters", 0.0637), ("diameters-both-sides", 0.1239), ("radii-both-sides", 0.2619), ("radii-60-deg", 0.2622)],
)
def test_travel(table, studies, name, travel):
    robot, (_, turn, both) = studies[name].robot, variants.TRAVELS[name]
    roll = np.deg2rad(np.linspace(-turn if both else 0, turn, 400))[:, None]
    x, y, _ = robot.platform_joints.T
    tips = np.stack([0 * roll + x, np.cos(roll) * y, robot.home_height + np.sin(roll) * y], axis=-1)
    lengths = np.linalg.norm(tips - robot.base_joints, axis=-1)
    found = float(table.travel.sel(reading=name))
    assert found == pytest.approx(np.ptp(lengths, axis=0).max(), abs=1e-6)
    assert found == pytest.approx(travel, abs=1e-4)


def test_a_reading_that_cannot_be_computed_says_why():
    study = model.preset("paper-robot")
    far = study.replace(motion=study.motion.replace(amplitude=1.2))
    row = trials.trial(far, ("verdict", "deviation_peak", "travel"))
    assert row["verdict"] and np.isnan(row["deviation_peak"]).all() and np.isnan(row["travel"])


def numbers(rng, *shape):
    return rng.uniform(0.5, 1.5, shape)


def test_what_is_counted_is_the_same_force_both_ways():
    """Lagrange's forces along alpha, beta, l against Newton-Euler's across and along; no inertia about the leg."""
    rng = np.random.default_rng(5)
    names = ("rhoA", "EI", "EA", "Lp", "mouth", "piston_axial", "m", "c", "I", "axial", "zeta", "time", "k", "d")
    p = dict.fromkeys(names, 0.0) | {name: float(rng.uniform(0.5, 1.5)) for name in ("rhoA", "Lp", "m", "c", "I")}
    p |= {"EI": 1.0, "EA": 1.0, "mouth": 0.4}
    (alpha, beta, length), v, v_dot, g = (numbers(rng, 3) for _ in range(4))
    flat = [*p.values(), *g, *np.zeros(3), *np.eye(3).ravel(), 0.0, 0.0]
    r = np.asarray(computing_time.lagrange_leg().build()([alpha, beta, length], v, v_dot, flat)).ravel()
    upright = {
        "cylinder_mass": p["m"], "cylinder_com": p["c"], "cylinder_inertia": p["I"], "cylinder_axial": 0.0,
        "piston_mass": p["rhoA"] * p["Lp"], "piston_length": p["Lp"], "piston_axial": 0.0,
    }  # fmt: skip
    bodies = dynamics.LegBodies(**{name: np.array([[value]]) for name, value in upright.items()})
    turn = JointTurn.from_angles(np.array([[alpha]]), np.array([[beta]]))
    state = {"length": length, "rate": v[2], "accel": v_dot[2], "alpha_dot": v[0], "beta_dot": v[1]}
    state |= {"alpha_ddot": v_dot[0], "beta_ddot": v_dot[1]}
    legs = dynamics.LegArrays(turn=turn, **{name: np.array([[value]]) for name, value in state.items()})
    gravity = turn.into_leg([np.array([[x]]) for x in g])
    motion = dynamics.leg_motion(bodies, legs)
    across, _ = dynamics.transverse_forces(bodies, legs, motion, gravity)
    along = dynamics.axial_drive_force(bodies, motion, gravity, np.zeros((1, 1)))
    expected = [-length * np.cos(beta) * across[1].item(), length * across[0].item(), along.item()]
    np.testing.assert_allclose(r, expected, rtol=1e-12)


def test_operations_are_counted_one_each():
    tally = [0]
    a, b = computing_time._numbers((2,), tally), np.array([2.0, 3.0])
    found = np.cos(a * b + b) / a[::-1] - 1.0 * a**2 + np.sin(-a)
    # times, plus, cosine, divided, squared, times one, minus, sine, plus: nine, twice; the sign is free.
    assert tally == [18]
    assert found[0].value == pytest.approx(np.cos(4.0) - 1 - np.sin(1.0))
    operations = computing_time.inverse_dynamics_cost(lambda share: None).operations
    assert operations.sel(formulation="Newton-Euler") < operations.sel(formulation="Lagrange")
