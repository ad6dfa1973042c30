"""What the benchmarks conclude from their timings: fits, errors, choices, counts. No time is measured here."""

import ctypes
import shutil
from dataclasses import replace

import casadi
import numpy as np
import pytest
from benchmarks.deviation import Curve, error
from benchmarks.fitting import fitted_polynomial, fitted_power
from benchmarks.mechanisms import count
from benchmarks.one_robot import fixed, largest_step
from benchmarks.operations import Count, casadi_count, compile_counting, counted, reader
from benchmarks.real_parts import BEFORE, EVERYTHING, tapered
from benchmarks.report import Section, goal
from benchmarks.scaling import Law, with_legs
from benchmarks.side_by_side import Family, chosen
from benchmarks.timing import Spread, interleaved
from benchmarks.tolerances import at_error

from flexapod.analysis.results.causes import cause_names
from flexapod.model import load, loads, preset
from flexapod.solve.time.robot_march import prepare

pytestmark = pytest.mark.unit

needs_cpp = pytest.mark.skipif(shutil.which("c++") is None, reason="there is no C++ compiler")


def test_power_law_is_found_with_its_uncertainty():
    x = np.array([1.0, 2, 3, 4, 6, 8])
    exact = fitted_power(x, 5 * x**1.7)
    assert exact.exponent == pytest.approx(1.7, abs=1e-12) and exact.factor == pytest.approx(5)
    assert exact.uncertainty < 1e-12
    # An error of +-e in the logarithm, alternating: the standard error of a slope is e / sqrt(sum (log x - mean)^2),
    # times sqrt(n / (n - 2)) of the estimated variance, less what the line takes up of it.
    noisy = fitted_power(x, 5 * x**1.7 * np.exp([0.1, -0.1, 0.1, -0.1, 0.1, -0.1]))
    spread = np.sqrt(np.sum((np.log(x) - np.log(x).mean()) ** 2))
    assert 0.8 * 0.1 / spread < noisy.uncertainty <= np.sqrt(6 / 4) * 0.1 / spread
    assert abs(noisy.exponent - 1.7) < 2 * noisy.uncertainty


def test_polynomial_and_its_cubic_share():
    k = np.arange(1.0, 7.0)
    found = fitted_polynomial(k, 3 + 2 * k + 0.5 * k**2 + 0.1 * k**3, 3)
    assert found.coefficients == pytest.approx([3, 2, 0.5, 0.1], rel=1e-9)  # conditioning of six points: 1e5 eps
    assert found.share(3, 6.0) == pytest.approx(21.6 / 54.6, rel=1e-9)


def test_too_few_points_have_no_uncertainty():
    with pytest.raises(ValueError, match="2 points"):
        fitted_power([1, 2], [1, 2])
    with pytest.raises(ValueError, match="4 points"):
        fitted_polynomial([1, 2, 3, 4], [1, 2, 3, 4], 3)


def test_error_is_the_largest_distance_over_the_largest_deviation():
    t = np.linspace(0, 1, 11)
    true = Curve(t, np.outer(t, [0.0, 3.0, 4.0]))  # up to 5
    off = true.deviation[::5] + np.array([[0, 0, 0], [0.3, 0, 0.4], [0, 0, 0]])
    assert error(Curve(t[::5], off), true) == pytest.approx(0.1)
    with pytest.raises(ValueError, match="between"):
        error(Curve(t[:2] + 0.04, off[:2]), true)


def test_a_step_that_is_good_by_luck_is_not_taken():
    assert largest_step({1e-3: 0.011, 4e-3: 0.009, 5e-4: 0.006, 2.5e-4: 0.004}) == 5e-4
    assert largest_step({1e-3: 0.02, 5e-4: 0.011}) is None


def test_fixed_steps_fall_on_stored_instants():
    for h in (2.5e-4, 4e-4, 1e-3, 4e-3):
        ratio = fixed(h, 0.9).simulation.output_step / h
        assert ratio == pytest.approx(round(ratio)) and ratio >= 1


def family(tool, errors, seconds):
    made = Family(tool=tool, settings=[(str(i), None) for i in range(len(errors))], own=None)
    made.errors, made.seconds = list(errors), list(seconds)
    return made


def test_the_cheapest_setting_that_also_holds_when_refined():
    lucky, steady = family("A", [0.005, 0.02, 0.004], [1, 2, 3]), family("A", [0.03, 0.009, 0.002], [2, 4, 8])
    never = family("B", [0.02, float("inf")], [1, 2])
    best = chosen([lucky, steady, never], 0.01)
    assert lucky.cheapest(0.01) is None and best == {"A": (steady, 1)}


def test_cost_at_an_error_lies_between_the_settings_tried():
    found = [(1e-2, 1.0), (1e-4, 4.0), (1e-3, 9.0), (float("inf"), 0.1)]  # the third is worse than the second
    assert at_error(found, 1e-3) == pytest.approx(2.0)  # half-way in the logarithms
    assert at_error(found, 1e-1) == 1.0 and at_error(found, 1e-5) is None and at_error([], 1.0) is None


def test_cost_laws_are_fitted_where_they_say():
    law = Law(against="x", words="w", unit="ms", x=[1, 2, 4, 8], cost=[9, 4, 16, 64], of=slice(1, None), most=2.0)
    assert law.power.exponent == pytest.approx(2.0) and law.row()[-1] == "at most 2: met"


def test_six_legs_in_pairs_are_those_of_the_paper():
    made, paper = with_legs(6).robot, preset("paper-robot").robot
    np.testing.assert_allclose(made.base_joints, paper.base_joints, atol=1e-12)
    np.testing.assert_allclose(made.platform_joints, paper.platform_joints, atol=1e-12)
    # On more legs each still stands upright: the platform's joint is as far round as on six, or nearer.
    many = with_legs(12).robot
    turn = np.cross(many.base_joints, many.platform_joints)[:, 2] / (0.25 * 0.15)
    assert np.abs(np.degrees(np.arcsin(turn))).max() < 40.01


def test_interleaved_calls_take_turns():
    order = []
    times = interleaved({"a": lambda: order.append("a") or 1.0, "b": lambda: order.append("b") or 2.0}, 3)
    assert order == list("ababab") and times["b"] == Spread((2.0, 2.0, 2.0))
    assert Spread((3.0, 1.0, 2.0)).text("ms", 1e3) == "2e+03 ms (1e+03 to 3e+03)"


def test_sections_as_text_and_markdown():
    section = Section(title="T", command="c", header=["a", "b"], rows=[["1", "22"]], remarks=["so"])
    assert section.markdown() == "## T\n\n`c`\n\n| a | b |\n| --- | --- |\n| 1 | 22 |\n\n- so"
    assert section.text() == "T   [c]\na  b\n1  22\n  so"
    assert goal(0.2, 0.3, "0.3 s") == "0.3 s: met" and goal(40, 50, "50", at_least=True) == "50: not met"


def test_operations_of_a_casadi_function():
    x, y = casadi.SX.sym("x"), casadi.SX.sym("y")
    f = casadi.Function("f", [x, y], [x * y + casadi.sqrt(x) / y - casadi.sin(x), 2 * x, x**2])
    assert casadi_count(f) == Count(additions=3, multiplications=2, divisions=1, roots=1, circular=1)
    with pytest.raises(ValueError, match="not counted"):
        casadi_count(casadi.Function("g", [x], [casadi.tan(x)]))


@needs_cpp
def test_compiled_code_counts_itself(tmp_path, monkeypatch):
    source = "double f(const double *a, long n) { double t = 0; for (long i = 0; i < n; i++) t += a[i]*a[i];\n"
    (tmp_path / "kernel.c").write_text(source + " return sqrt(t)/(1 - cos(t)) > 2 ? -t : t - 1; }")
    monkeypatch.chdir(tmp_path)
    assert compile_counting(["-O1", "-fPIC", "-shared", "-std=gnu11", "-o", "kernel.so", "kernel.c", "-lm"]) == 0
    library = ctypes.CDLL(str(tmp_path / "kernel.so"))
    numbers = (ctypes.c_double * 5)(1, 2, 3, 4, 5)
    library.f(numbers, ctypes.c_long(5))
    # Additions: five and 1 - cos; t = 55, and its root is above 2 (1 - cos), so that a sign follows, which is none.
    assert reader(library).tolist() == [6, 5, 1, 1, 0, 1]


@needs_cpp
def test_counted_residual_is_what_casadi_lists():
    from flexapod.mechanics.leg.kernel_functions import leg_functions
    from flexapod.solve.time.robot_march import prepare

    listed = leg_functions(prepare(fixed(5e-4, 0.9)).system.kernel.shapes)[0]
    ours, theirs = counted("benchmarks.counted_runs:residual_of_a_leg"), casadi_count(listed.build())
    turns = theirs.circular / 2  # sine and cosine of an angle: a series in lanes.h of 22 additions, 24 multiplications
    series = {"additions": theirs.additions + 22 * turns, "multiplications": theirs.multiplications + 24 * turns}
    assert ours == replace(theirs, **series, circular=0)


def test_robots_without_real_parts_do_not_pay_for_them():
    kernel = prepare(preset("paper-robot")).system.kernel
    for name, before in BEFORE.items():
        assert count(kernel, name) == pytest.approx(before, rel=0.03)


def test_the_robot_with_everything_on_has_every_part():
    parts = set(cause_names(load(EVERYTHING).robot))
    assert {"base_joint", "platform_joint", "screw", "nut", "bearing", "base_plate"} <= parts


def test_the_longest_compilation_has_a_taper_in_bushings():
    study = loads(tapered())
    for leg in study.robot.legs:
        assert leg.guide is not None and [section.tapered for section in leg.piston.sections] == [True, False]
