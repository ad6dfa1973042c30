"""Orders, rates and recommendation of a convergence study: on tables made up here, and on short runs."""

import re
from dataclasses import replace

import numpy as np
import pytest
from tests.helpers.runs import paper_robot
from tests.helpers.samples import MECHANISMS

import flexapod as fx
from flexapod.analysis import open_results, save
from flexapod.design.convergence import ConvergenceStopped, Trials, converge, plan
from flexapod.design.convergence import search as choice
from flexapod.design.convergence import search as halving
from flexapod.design.convergence.family import Family, finest_error, observed_order, relative_difference, shape_factor
from flexapod.design.convergence.ladder import RUNGS, ladder
from flexapod.design.convergence.search import Candidate, Discretisation, StepChoice, candidates
from flexapod.design.convergence.table import save_table
from flexapod.design.convergence.trials import Setting, Trial, setting_of
from flexapod.model import ActuatorInitial, ActuatorMotion, override
from flexapod.output.figures.convergence import convergence

pytestmark = pytest.mark.unit

TIME = np.linspace(0.0, 1.0, 11)
BASE = Setting(fidelity="assumed-modes", basis="tip-load", modes=3, step=1e-3, output_step=1e-3)


@pytest.mark.parametrize("order", [0.5, 1.5, 2.0, 4.0])
def test_order_and_error_of_the_finest_are_exact_for_a_pure_power(order):
    sizes = (1.0, 0.4, 0.25)  # any ratios
    coarse, fine = (sizes[i] ** order - sizes[2] ** order for i in (0, 1))
    found = observed_order(sizes, (coarse, fine))
    assert found == pytest.approx(order, rel=1e-9)  # bisection to rounding
    if order >= 1:
        assert finest_error(sizes[1], sizes[2], fine, found) == pytest.approx(sizes[2] ** order, rel=1e-8)
    else:  # too slow to be trusted: the difference itself
        assert finest_error(sizes[1], sizes[2], fine, found) == fine


@pytest.mark.parametrize("errors", [(1.0, 1.0), (1.0, 2.0), (1.0, 0.0), (1.1, 1.0), (np.nan, 1.0)])
def test_no_order_where_errors_do_not_fall(errors):
    # (1.1, 1.0): falls slower than any power would towards the finest, ln 4 / ln 2 = 2.
    assert np.isnan(observed_order((4.0, 2.0, 1.0), errors))


def test_rate_of_shapes():
    k = np.array([1, 2, 3, 4, 6])
    assert shape_factor(k, 20.0**-k) == pytest.approx(20.0)
    assert shape_factor(k, k**-3.0) is None
    assert shape_factor(k[:2], 20.0 ** -k[:2]) is None


def test_relative_difference_is_that_of_vectors():
    reference = np.array([[3.0, 4.0], [0.0, 0.0]])
    assert relative_difference(reference + np.array([[0.0, 0.5], [0.3, 0.4]]), reference) == pytest.approx(0.1)
    assert np.isnan(relative_difference(reference, 0 * reference))


def trial(setting, error=0.0, failure=""):
    """A curve that is off by `error` of its size."""
    curve = np.cos(TIME)[:, None] * (1 + error)
    return Trial(setting=setting, time=TIME, curves={"tip": curve}, steps=1000, seconds=0.1, failure=failure)


def test_a_family_with_a_failed_run_and_a_floor():
    power = [(h, 1e-2 * h**2) for h in (8, 4, 2, 1)]
    trials = [trial(replace(BASE, step=h), e) for h, e in power]
    trials.insert(1, trial(replace(BASE, step=6), failure="the step's equations were not solved"))
    family = Family(name="step", trials=tuple(trials), floor={"tip": 1e-9})
    assert np.isnan(family.errors("tip")[1])
    assert np.isnan(family.orders("tip")[[0, 1, 2, 4]]).all()  # after a failure, and of the reference
    # The size of the reference's curve is 1.01: orders are those of differences, which it divides alike.
    assert family.orders("tip")[3] == pytest.approx(2.0, abs=1e-6)
    assert family.own_error("tip") == pytest.approx(1e-2 / 1.01, rel=1e-5)
    assert family.rate("tip") == "observed order 2.00 (theory 2)"
    at_floor = replace(family, floor={"tip": 1e-1})
    assert np.isnan(at_floor.orders("tip")).all()
    assert "rounding floor" in at_floor.rate("tip")
    assert at_floor.own_error("tip") >= 1e-1


def test_a_family_of_failures():
    family = Family(name="shapes", trials=(trial(BASE, failure="no"),), floor={"tip": 1e-9})
    assert family.reference is None
    assert np.isnan(family.errors("tip")).all()
    assert np.isnan(family.own_error("tip"))


def test_the_recommended_setting_is_the_cheapest_that_keeps_the_accuracy():
    steps = [StepChoice(step=h, steps=round(1 / h), error=e) for h, e in ((4e-3, 2e-2), (1e-3, 5e-3), (5e-4, 1e-3))]
    steps.append(StepChoice(step=2e-3, steps=500, error=float("nan")))  # failed
    shapes = [
        Discretisation(setting=replace(BASE, modes=k), per_step=c, error=e)
        for k, c, e in ((1, 10e-6, 8e-3), (2, 20e-6, 2e-3), (3, 21e-6, 1e-5), (6, 80e-6, 1e-9))
    ]
    found = candidates(steps, shapes, 1e-2)
    allowed = [
        (s.steps * d.per_step, s.step, d.setting.modes) for s in steps for d in shapes if s.error + d.error <= 1e-2
    ]
    assert len(found) == len(allowed) == 7
    # Cheapest: one shape at 0.5 ms and two at 1 ms cost 20 ms, three at 1 ms 21 ms: alike, the most accurate is taken.
    assert (found[0].setting.step, found[0].setting.modes) == (1e-3, 3)
    assert found[0].cost <= 1.1 * min(allowed)[0]
    assert found[0].error == pytest.approx(5.01e-3)
    assert [c.setting.modes for c in found[:3]] == [3, 2, 1]
    assert candidates(steps, shapes, 1e-4) == []


def test_steps_of_a_robot_have_order_two():
    # A smooth law: the axial modes follow at rest, so that even steps of 2 ms are in the range of their order.
    study = paper_robot(profile="smooth", fidelity="lumped", output_step=4e-3, duration=1.2)
    trials, base = Trials(study), replace(setting_of(study), tolerance=None)
    runs = tuple(trials.run(replace(base, step=h)) for h in (2e-3, 1e-3, 5e-4, 2.5e-4))
    family = Family(name="step", trials=runs, floor={"deviation": 1e-9, "tip": 1e-9})
    np.testing.assert_allclose(family.orders("deviation")[1:3], 2.0, atol=0.2)
    assert np.isnan(family.errors("tip")).all()  # lumped legs do not bend


@pytest.fixture(scope="module")
def beam():
    """Half a second of the paper's actuator, damped so that late times do not count phases."""
    study = fx.preset("paper-actuator")
    study = study.replace(actuator=study.actuator.replace(damping=0.02))
    return override(study, duration=0.5, output_step=5e-3, step=1e-3)


@pytest.fixture
def short(monkeypatch):
    monkeypatch.setattr(plan, "COUNTS", {"shapes": (1, 2, 3, 4), "elements": (1, 2, 4), "segments": (1, 2, 4)})


def rows(data, family):
    return data.isel(setting=np.flatnonzero(data.family.values == family))


def test_a_whole_study(beam, short, monkeypatch, tmp_path):
    monkeypatch.setattr(plan, "COARSEST", 128)  # the first step is longer than the simulation
    told = []
    data = converge(beam, accuracy=1e-2, progress=lambda words, share: told.append(share))
    steps = rows(data, "step")
    assert "is longer than the simulation" in str(steps.failure.values[0])
    assert np.isnan(steps.error_tip[0])
    assert (steps.failure.values[1:] == "").all()
    # Second order, first damped by rho_inf: the finest pair within 0.2.
    assert float(data.order.sel(group="step")) == pytest.approx(2.0, abs=0.2)
    assert re.match(r"observed order (1\.[89]|2\.[012])\d* \(theory 2\)", str(data.rate.sel(group="step").values))
    assert 0 < float(data.own_error_tip.sel(group="step")) <= 1e-2 / halving.FINER
    chosen = rows(data, "recommended")
    assert chosen.sizes["setting"] == 1
    assert float(chosen.error_tip[0]) + data.attrs["reference_error"] <= 1e-2
    # Whoever pastes the lines gets that error.
    study = fx.loads(beam.source_text.split("[simulation]")[0] + "[simulation]\nduration = 0.5\noutput_step = 5e-3\n"
                     + data.attrs["recommended"])  # fmt: skip
    peak = float(np.abs(fx.run(study).tip_deflection).max())
    assert peak == pytest.approx(float(chosen.peak_tip[0]), rel=1e-9)
    assert rows(data, "file").sizes["setting"] == 1
    assert all(0 <= share <= 1 for share in told)
    assert data.attrs["partial"] == 0
    save(data, tmp_path / "a.nc")
    assert open_results(tmp_path / "a.nc").attrs["recommended"] == data.attrs["recommended"]
    lines = save_table(data, tmp_path / "a.csv").read_text(encoding="utf-8").splitlines()
    assert len(lines) == 1 + data.sizes["setting"]


def test_an_interrupt_keeps_what_was_computed(beam, short):
    def stop(words, share):
        if "2 elements" in words:
            raise KeyboardInterrupt

    with pytest.raises(ConvergenceStopped) as error:
        converge(beam, progress=stop)
    data = error.value.dataset
    assert data.attrs["partial"] == 1
    assert set(data.family.values) == {"step", "shapes", "elements"}
    assert list(rows(data, "shapes").shapes.values) == [1, 2, 3, 4]
    assert list(rows(data, "elements").shapes.values) == [2]
    assert data.attrs["recommended"] == ""


def test_a_candidate_that_misses_the_accuracy_is_not_recommended(beam, short, monkeypatch):
    """Errors that are added separately are an expectation; the setting itself is run before it is recommended."""
    optimist = Candidate(setting=replace(setting_of(beam), fidelity="finite-segment", modes=1), error=0.0, cost=0.0)
    monkeypatch.setattr(choice, "candidates", lambda *given: [optimist, *candidates(*given)])
    data = converge(beam, accuracy=1e-2)
    chosen = rows(data, "recommended")
    assert chosen.fidelity.values[0] != "finite-segment"
    assert float(chosen.error_tip[0]) + data.attrs["reference_error"] <= 1e-2
    monkeypatch.setattr(choice, "candidates", lambda *given: [optimist])
    data = converge(beam, accuracy=1e-2)
    assert data.attrs["recommended"] == ""
    assert "No setting is recommended" in data.attrs["notes"]


@pytest.mark.parametrize("runs", [1, 2])
def test_figures_of_a_study_stopped_early(beam, runs):
    seen = set()

    def stop(words, share):
        seen.add(words)
        if len(seen) > runs:
            raise KeyboardInterrupt

    with pytest.raises(ConvergenceStopped) as error:
        converge(beam, progress=stop)
    assert error.value.dataset.sizes["setting"] == runs
    assert convergence(error.value.dataset).axes


@pytest.mark.parametrize("accuracy", [0, -1, 2.0, float("nan"), 1e-9, "small", True])
def test_an_accuracy_that_is_none(beam, accuracy):
    with pytest.raises(fx.InputError, match="not a relative error") as error:
        converge(beam, accuracy=accuracy)
    assert error.value.key == "accuracy"


def test_a_study_without_deflection(beam):
    still = beam.replace(initial=ActuatorInitial(), motion=ActuatorMotion())
    with pytest.raises(fx.InputError, match="deflects nothing"):
        converge(still)


def test_the_ladder_of_a_beam(beam):
    data = ladder(beam, step=2.5e-3)
    assert data.sizes["setting"] == len(RUNGS) - 5  # nothing is left of a lumped beam, and four solids lack a section
    error = dict(zip(map(str, data.label.values), data.error_tip.values, strict=True))
    assert error["rigid"] == pytest.approx(1.0)
    assert error["6 elements"] < error["3 elements"] < error["2 elements"] < error["1 element"]
    assert error["8 segments"] < error["4 segments"]
    assert data.attrs["reference"].startswith("12 tip-load shapes")
    assert (data.seconds_per_step > 0).all()


def test_a_solid_study_is_compared_with_solids_only():
    from flexapod.design.convergence.plan import base_setting, discretisations, finest_basis
    from flexapod.model import override, preset

    study = override(preset("paper-robot"), fidelity="solid-fem")
    base = base_setting(study)
    found = discretisations(study, base, 1e-3)
    assert {(family, setting.fidelity) for family, setting in found} == {("shapes", "solid-fem")}
    assert finest_basis(base).fidelity == "solid-fem"


@pytest.mark.parametrize("survey", [fx.converge, fx.ladder])
def test_a_fixed_platform_has_no_deviation_to_compare(survey):
    with pytest.raises(fx.InputError, match=r"platform.fixed = True: leaves no deviation of the platform"):
        survey(MECHANISMS / "strut.toml")
