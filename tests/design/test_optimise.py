"""Optima against closed forms of struts, against neighbours, and what cannot be had."""

import numpy as np
import pytest
from scipy.linalg import eigh

import flexapod as fx
from flexapod.analysis.results.attributes import result_study
from flexapod.design.first_robot.catalogue import SCREWS
from flexapod.output.text.optimum import optimum_sentences

pytestmark = pytest.mark.consistency

DIAMETER = {"key": "leg.piston.diameter", "low": "15 mm", "high": "60 mm"}


def design(constraints, *variables, objective="piston_mass", **more):
    return {
        "variables": list(variables or [DIAMETER]),
        "objective": {"minimise": objective},
        "constraints": constraints,
        **more,
    }


@pytest.fixture(scope="module")
def struts():
    """Pistons without mass to speak of on a payload in the middle: springs along the legs."""
    study = fx.preset("paper-robot")
    return study.with_values({
        "payload.com": [0, 0, 0], "leg.cylinder.mass": 1e-9, "leg.cylinder.inertia": 1e-12, "robot.gravity": [0, 0, 0],
        "leg.piston.E": 200e9, "leg.piston.density": 1e-3, "simulation.fidelity": "lumped",
    })  # fmt: skip


def jacobian(robot):
    home = fx.kinematics.home_pose(robot)
    return fx.kinematics.length_jacobian(
        robot.base_joints, robot.platform_joints, home.position[0], np.eye(3), np.zeros(3)
    )


def test_lightest_struts_of_a_frequency(struts):
    """Eigenvalues of payload on springs E A / L: the diameter follows from the frequency in one step."""
    robot = struts.robot
    J = jacobian(robot)
    M = np.diag([100.0] * 3 + [17.88] * 3)
    unit = np.sqrt(eigh(J.T @ J, M, eigvals_only=True)[0]) / (2 * np.pi)  # of springs of 1 N/m
    area = (25.0 / unit) ** 2 * robot.legs[0].piston.length / 200e9
    found = fx.optimise(struts, design({"first_frequency": {"least": "25 Hz"}}))
    assert found.attrs["status"] == "kept"
    assert found.optimum.values[0] == pytest.approx(np.sqrt(4 * area / np.pi), rel=2e-6)
    assert found.attrs["calls"] <= 40


def test_a_newton_per_metre_costs_what_a_strut_says(struts):
    """Mass over stiffness of upright struts: density L^2 / (E cos^2)."""
    robot = struts.robot
    L = robot.legs[0].piston.length
    cosine = jacobian(robot)[0, 2]
    found = fx.optimise(struts, design({"stiffness_z": {"least": "300 N/um"}}))
    area = 300e6 * L / (6 * 200e9 * cosine**2)
    assert found.optimum.values[0] == pytest.approx(np.sqrt(4 * area / np.pi), rel=2e-6)
    assert found.multiplier.values[0] == pytest.approx(1e-3 * L**2 / (200e9 * cosine**2), rel=1e-5, abs=0)
    assert found.objective.item() == pytest.approx(6 * 1e-3 * L * area, rel=1e-5, abs=0)


def test_two_hundred_neighbours_are_no_better():
    """None of the tubes beside the best one is lighter and as stiff, by the public call."""
    study = fx.preset("machine-hexapod")
    inner = {"key": "leg.piston.inner_diameter", "low": "36 mm", "high": "45 mm"}
    outer = {"key": "leg.piston.diameter", "low": "50 mm", "high": "80 mm"}
    found = fx.optimise(study, design({"stiffness_least": {"least": "33 N/um"}}, outer, inner))
    best = result_study(found)
    random, tried = np.random.default_rng(5), 0
    assert least_stiffness(best) == pytest.approx(33e6, rel=2e-6)
    for _ in range(200):
        D, d = found.optimum.values * (1 + 0.02 * random.uniform(-1, 1, 2))
        if d > 45e-3 or D * D - d * d >= (1 - 1e-6) * np.diff(found.optimum.values[::-1] ** 2)[0]:
            continue
        tried += 1
        other = study.with_values({"leg.piston.diameter": float(D), "leg.piston.inner_diameter": float(d)})
        assert least_stiffness(other) < 33e6 * (1 + 1e-7)
    assert tried > 30


def least_stiffness(study):
    return 1 / np.linalg.eigvalsh(np.linalg.inv(fx.stiffness(study).stiffness.values)[:3, :3])[-1]


def test_cannot_is_an_answer():
    found = fx.optimise(fx.preset("paper-robot"), design({"first_frequency": {"least": "60 Hz"}}))
    best = fx.modes(fx.preset("paper-robot").with_values({"leg.piston.diameter": "60 mm"})).frequency.values[0]
    assert found.attrs["status"] == "cannot"
    assert found.reached.values[0] == pytest.approx(best, rel=1e-9)
    assert "Cannot: first_frequency 47.68 Hz at best, for 60 Hz at least." in list(optimum_sentences(found))


def test_words_of_what_a_limit_costs():
    study = fx.preset("paper-robot")
    found = fx.optimise(study, design({"first_frequency": {"least": "25 Hz"}}))
    more = fx.optimise(study, design({"first_frequency": {"least": "25.1 Hz"}}))
    cost = found.multiplier.item()
    assert 0.1 * cost == pytest.approx((more.objective - found.objective).item(), rel=1e-2)
    assert any("1 Hz more costs 2.15" in line for line in optimum_sentences(found))
    assert fx.modes(result_study(found)).frequency.values[0] == pytest.approx(25, rel=2e-6)
    assert found.attrs["calls"] <= 20


def test_front_gives_less_sag_for_more_mass():
    front = {"output": "static_deviation_size", "count": 5}
    found = fx.optimise(fx.preset("paper-robot"), design({"first_frequency": {"least": "20 Hz"}}, front=front))
    assert np.isfinite(found.front_objective).all()
    assert (np.diff(found.front_objective) > 0).all()
    assert (found.front_output <= found.target * (1 + 1e-5)).all()
    assert found.front_optimum.values[-1, 0] == pytest.approx(60e-3, rel=1e-4)


def test_screws_of_a_catalogue():
    """The screw of the highest frequency among those that are stiff enough, as trying them one by one says."""
    study = fx.preset("machine-hexapod")
    variables = [{"catalogue": "screws"}]
    most = {
        **design({"stiffness_least": {"least": "30 N/um"}}, *variables),
        "objective": {"maximise": "first_frequency"},
    }
    found = fx.optimise(study, most)
    tried = {}
    for screw in SCREWS:
        try:
            one = study.with_values({
                "leg.drive.lead": screw.lead, "leg.drive.root_diameter": screw.root,
                "leg.drive.bearing.stiffness": screw.bearing, "leg.drive.nut.rigidity": screw.rigidity,
                "leg.drive.nut.dynamic_load": screw.dynamic_load, "leg.drive.nut.preload": 0.05 * screw.dynamic_load,
            })  # fmt: skip
        except fx.InputError:  # too thick for the bore of the piston
            continue
        if least_stiffness(one) >= 30e6:
            tried[f"screw {screw.name}"] = fx.modes(one).frequency.values[0]
    assert found.chosen.values[0] == max(tried, key=tried.get)
    assert found.objective.item() == pytest.approx(max(tried.values()), rel=1e-5)
    assert "function, follows" in found.attrs["warnings"]
    assert len(tried) > 1


def test_ties_move_in_proportion():
    study = fx.preset("machine-hexapod")
    variable = {"key": "leg.piston.diameter", "low": "50 mm", "high": "80 mm", "ties": ["leg.piston.inner_diameter"]}
    found = fx.optimise(study, design({"stiffness_least": {"least": "35 N/um"}}, variable))
    piston = result_study(found).robot.legs[0].piston
    assert piston.inner_diameter / piston.diameter == pytest.approx(2 / 3)
    assert least_stiffness(result_study(found)) == pytest.approx(35e6, rel=2e-6)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (design({}, {"key": "leg.piston.diameter", "low": "30 mm", "high": "60 mm"}), "outside of its bounds"),
        (design({}, {"key": "leg.piston.diameter", "low": "60 mm", "high": "15 mm"}), "not a range"),
        (design({}, {"key": "leg.piston.diameter", "low": "1 kg", "high": "60 mm"}), "length"),
        (design({}, {"key": "simulation.modes", "low": 1, "high": 3}), "a count or a choice"),
        (design({"first_frequency": {"least": "25 mm"}}), "frequency"),
        (design({"first_frequenc": {"least": "25 Hz"}}), "first_frequency"),
        (design({"requirement": True}), r"\[requirement\]"),
        (design({}, objective="com_deviation_peak"), "com_deviation_rms"),
        ({"variables": []}, "nothing that may change"),
        (design({}, {"catalogue": "nuts"}), "screws"),
        (design({}, {"key": "leg.piston.diameter", "low": "-15 mm", "high": "60 mm"}), "out of range"),
        (design({}, {"key": "leg.piston.diameter", "low": "15 mm", "high": 1e300}), "too far"),
        (design({}, {"key": "payload.com", "low": "0.3 m", "high": "0.5 m"}), r"payload.com\[2\]"),
        (design({}, {"key": "leg.piston.material", "values": ["steel", 5]}), "aluminium"),
        (design({"first_frequency": {}}), "limits nothing"),
        (design({"first_frequency": {"least": "50 Hz", "most": "20 Hz"}}), "not a range"),
        (design({}, *[{"key": "leg.piston.diameter", "low": "15 mm", "high": "60 mm"}] * 2), "the same value"),
        (
            design({}, {"key": "leg.piston.diameter", "low": "15 mm", "high": "60 mm", "ties": "leg.piston.length"}),
            "list of keys",
        ),
    ],
)
def test_refused(given, words):
    with pytest.raises(fx.InputError, match=words):
        fx.optimise(fx.preset("paper-robot"), given)
