"""The paper's robot by an independent engine: what is asked, kept, compared and drawn, mostly with a stand-in."""

import threading
import time
from dataclasses import replace

import numpy as np
import pytest

from flexapod import model, plot
from flexapod.analysis.results.attributes import robot_study
from flexapod.common.errors import ComputationError, InputError
from flexapod.common.quantities import text as words
from flexapod.verification.engines.engine import EXUDYN
from flexapod.verification.engines.exudyn_robot import RobotResult
from flexapod.verification.paper import engines
from flexapod.verification.paper import study as paper
from flexapod.verification.paper.engines import agreements, exudyn_flexible, exudyn_rigid, rigid_same_step, run_undamped

pytestmark = pytest.mark.unit


def quick():
    """A small roll in 0.08 s, then a rest of 0.02 s: 401 instants."""
    study = model.preset("paper-robot")
    motion = model.AxisMotion(type="roll", amplitude=0.003, duration=0.08, hold=0.02)
    return study.replace(motion=motion, simulation=study.simulation.replace(duration=0.1))


def standing_in(asked):
    """An engine with an error of first order in the distance of the rings, the same at all instants."""

    def simulate_robot(robot, motion, plan, *, elements, guide, time_limit):
        asked.append((robot, plan, elements, guide))
        count = len(plan.time)
        return RobotResult(
            time=plan.time,
            com_deviation=np.full((count, 3), [1e-6, 2e-6, -3e-6]) + guide * np.array([1e-6, 2e-6, 4e-6]),
            actuator_force=np.full((count, 6), 100.0) + guide * 50,
            tip_deflection=np.full((count, 6, 2), 4e-5) + guide * 1e-4,
            seconds=1.5,
        )

    return simulate_robot


def ignore(_):
    pass


@pytest.fixture(scope="module")
def asked():
    return []


@pytest.fixture(scope="module")
def parts(asked):
    study = quick()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(engines, "simulate_robot", standing_in(asked))
        patch.setattr(engines, "version", lambda _: "1.2.3")
        return {
            "robot-rigid-same-step": rigid_same_step(study, ignore),
            "robot-undamped": run_undamped(study, ignore),
            "robot-exudyn-rigid": exudyn_rigid(study, ignore),
            "robot-exudyn": exudyn_flexible(study, ignore),
        }


def test_engine_gets_the_same_robot_without_damping_where_it_bends(parts, asked):
    (rigid, plan, none, _), *flexible = asked
    assert none == 0 and rigid.legs[0].damping == 0.005
    assert [(elements, guide) for _, _, elements, guide in flexible] == [(30, 0.01), (60, 0.005)]
    assert all(leg.damping == 0 for robot, *_ in flexible for leg in robot.legs)
    assert plan.duration == 0.1 and plan.step == parts["robot-undamped"].attrs["step"] == 2.5e-4
    assert plan.rho_inf == parts["robot-undamped"].attrs["rho_inf"]
    for name in ("robot-undamped", "robot-exudyn"):  # the file says so
        assert all(leg.damping == 0 for leg in robot_study(parts[name]).robot.legs)


def test_two_meshes_are_extrapolated(parts):
    data = parts["robot-exudyn"]
    np.testing.assert_allclose(data.com_deviation, np.full((401, 3), [1e-6, 2e-6, -3e-6]), rtol=1e-12)
    np.testing.assert_allclose(data.actuator_force, 100.0, rtol=1e-12)
    np.testing.assert_allclose(data.com_position, data.com_position_rigid + data.com_deviation, rtol=1e-15)
    # What the finer mesh, rings 5 mm apart, is off by.
    np.testing.assert_allclose(data.attrs["refinement_com_deviation"], [5e-9, 1e-8, 2e-8])
    assert data.attrs["refinement_actuator_force"] == pytest.approx(0.25)


def test_result_names_engine_version_and_settings(parts):
    attrs = parts["robot-exudyn"].attrs
    assert (attrs["engine"], attrs["engine_version"]) == ("Exudyn", "1.2.3")
    assert (attrs["elements"], attrs["step"], attrs["seconds"]) == ([30, 60], 2.5e-4, 3.0)
    assert parts["robot-exudyn-rigid"].attrs["elements"] == 0


def test_our_runs_have_the_instants_of_the_engine(parts):
    for name in ("robot-rigid-same-step", "robot-undamped"):
        np.testing.assert_allclose(parts[name].time, parts["robot-exudyn"].time, rtol=0, atol=1e-12)
    np.testing.assert_allclose(
        parts["robot-exudyn"].com_position_rigid, parts["robot-undamped"].com_position_rigid, rtol=0, atol=1e-14
    )
    gap = parts["robot-exudyn"].actuator_force_rigid - parts["robot-undamped"].actuator_force_rigid
    assert float(np.abs(gap).max()) < 1e-9


def test_agreement_is_that_of_the_curves(parts):
    ours = parts["robot-undamped"]
    moved = ours.assign(com_deviation=ours.com_deviation + 2e-9, actuator_force=ours.actuator_force - 3.0)
    moved = moved.assign_attrs(parts["robot-exudyn"].attrs)
    rows = {row.quantity: row for row in agreements({"robot-undamped": ours, "robot-exudyn": moved})}
    assert len(rows) == 4
    in_y = rows["deviation of the centre of mass in Y"]
    assert in_y.difference == pytest.approx(2e-9, rel=1e-6) and in_y.refinement == pytest.approx(1e-8)
    assert in_y.ours == float(np.abs(ours.com_deviation.sel(axis="y")).max())
    assert rows["drive force, flexible legs"].difference == pytest.approx(3.0)
    assert rows["deflection of a piston's tip"].difference == 0.0
    assert "curves at most 2 nm apart" in in_y.words
    assert agreements({"robot-undamped": ours}) == []


def test_what_rings_after_a_jump_of_the_jerk_has_its_own_row(parts):
    known = parts["robot-exudyn-rigid"].actuator_force_rigid
    ringing = known.time <= 0.05
    rung = parts["robot-exudyn-rigid"].assign(actuator_force=known + 7.0 * ringing + 0.5)
    rows = agreements({"robot-rigid-same-step": parts["robot-rigid-same-step"], "robot-exudyn-rigid": rung})
    assert [row.difference for row in rows[1:]] == pytest.approx([7.5, 0.5])
    assert np.isnan(rows[0].refinement)


def test_progress_moves_while_the_engine_is_silent_and_stops_with_it(monkeypatch):
    seen = []

    def silent(*arguments, **settings):
        end = time.monotonic() + 300
        while len(seen) < 2:
            assert time.monotonic() < end
            time.sleep(0.01)
        raise KeyboardInterrupt

    monkeypatch.setattr(engines, "simulate_robot", silent)
    with pytest.raises(KeyboardInterrupt):
        exudyn_rigid(quick(), seen.append)
    assert seen == sorted(seen) and 0 < seen[0] and seen[-1] < 1
    assert "progress" not in {thread.name for thread in threading.enumerate()}


def test_absent_engine_is_refused_before_anything_is_computed(monkeypatch):
    monkeypatch.setattr(engines, "EXUDYN", replace(EXUDYN, module="no_such_module"))
    monkeypatch.setattr(paper, "STEPS", (paper.StudyPart(name="robot", words="", weight=1, compute=pytest.fail),))
    with pytest.raises(InputError, match="not installed") as raised:
        paper.replicate(engines=True)
    assert EXUDYN.install in str(raised.value)


def steps(*failing):
    def compute(name):
        def made(_):
            if name in failing:
                raise ComputationError(f"{name} did not converge")
            return name

        return made

    return [paper.StudyPart(name=name, words=name, weight=1, compute=compute(name)) for name in ("robot", "a", "b")]


def test_engine_that_fails_costs_its_part_only(monkeypatch):
    own, *others = steps("a")
    monkeypatch.setattr(paper, "check_engine", lambda: None)
    monkeypatch.setattr(paper, "STEPS", (own,))
    monkeypatch.setattr(paper, "ENGINE_STEPS", tuple(others))
    kept, seen = [], []
    result = paper.replicate(
        engines=True, keep=lambda name, _: kept.append(name), progress=lambda words, share: seen.append(share)
    )
    assert kept == list(result.parts) == ["robot", "b"]
    assert str(result.failures["a"]) == "a did not converge."
    assert seen == sorted(seen) and seen[-1] == 1
    assert list(paper.replicate().parts) == ["robot"]
    monkeypatch.setattr(paper, "STEPS", tuple(steps("robot"))[:1])
    with pytest.raises(ComputationError):
        paper.replicate(engines=True)


def test_forces_are_drawn_with_their_differences(parts):
    ours, theirs = parts["robot-undamped"], parts["robot-undamped"] + 0.5
    figure = plot.engine_forces({"ours": ours, "Exudyn": theirs})
    labels = [label.get_text() for label in figure.legends[0].get_texts()]
    gap = float(np.abs(ours.actuator_force - ours.actuator_force_rigid).max())
    assert labels == ["Newton-Euler, rigid legs", f"ours; at most {words(gap, 'N', 2)} from Newton-Euler",
                      "Exudyn; at most 500 mN from ours"]  # fmt: skip
    assert [axes.get_ylabel() for axes in figure.axes if axes.get_ylabel()] == ["force [kN]", "difference\n[N]"] * 2
    below = figure.axes[4]  # second row of three, second leg
    np.testing.assert_allclose(below.lines[1].get_ydata(), 0.5)
    np.testing.assert_allclose(
        below.lines[0].get_ydata(), (ours.actuator_force - ours.actuator_force_rigid).sel(leg=2), atol=1e-12
    )


def test_path_is_drawn_with_deviation_and_difference(parts):
    ours = parts["robot-undamped"]
    theirs = ours.assign(com_deviation=ours.com_deviation + 2e-9)
    figure = plot.engine_path({"ours": ours, "Exudyn": theirs})
    assert [axes.get_title(loc="left") for axes in figure.axes[4:]] == ["Difference from ours, Y",
                                                                       "Difference from ours, Z"]  # fmt: skip
    assert [text.get_text() for text in figure.axes[5].texts] == ["Exudyn at most 2 nm apart"]
    np.testing.assert_allclose(figure.axes[5].lines[0].get_ydata(), 2.0, rtol=1e-6)
    np.testing.assert_allclose(figure.axes[2].lines[1].get_ydata(), 1e6 * theirs.com_deviation.sel(axis="y"))
    assert [axes.get_ylabel() for axes in figure.axes[::2]][1:] == ["deviation [µm]", "difference [nm]"]


@pytest.mark.parametrize("draw", [plot.engine_forces, plot.engine_path])
def test_results_that_cannot_be_compared_are_refused(draw, parts):
    ours = parts["robot-undamped"]
    with pytest.raises(InputError, match="instants differ"):
        draw({"ours": ours, "Exudyn": ours.isel(time=slice(0, 100))})
    with pytest.raises(InputError, match="told apart"):
        draw({name: ours for name in "abcd"})
    with pytest.raises(InputError, match="cannot be drawn"):
        draw({})
    assert draw({"ours": ours}) is not None


@pytest.mark.skipif(not EXUDYN.is_available(), reason="needs Exudyn")
def test_real_engine_agrees_with_us(parts):
    theirs = {"robot-exudyn-rigid": exudyn_rigid(quick(), ignore), "robot-exudyn": exudyn_flexible(quick(), ignore)}
    rows = agreements(parts | theirs)
    # Rings and mesh are of first order: extrapolated, what is left is a part of the last refinement's change.
    assert all(row.difference < row.refinement for row in rows[3:])
    # Where the jerk jumps both ring about Newton-Euler, of first order in the step. Integrator and step are the same:
    # so is what rings, but for the second order and for how they start.
    ring, apart = rows[1].difference, rows[0].difference
    assert apart < ring / 10
