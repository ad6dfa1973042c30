"""An element from outside of the package: a Maxwell element along the strokes, against its closed form."""

import importlib
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import scipy.interpolate
from tests.trial_element.maxwell import Maxwell
from tests.trial_element.seal import Seal

import flexapod as fx
from flexapod.app.browser.charts import charts
from flexapod.mechanics.elements.element import registered
from flexapod.model import ServoDrive, StrokeFriction, preset_text, to_toml
from flexapod.output.exchange.pose_deck import abaqus_deck
from flexapod.output.report import figures
from flexapod.output.text.parts import Bullets
from flexapod.output.text.study import study_items
from flexapod.solve.modal.at_poses import robot_modes
from flexapod.verification.engines import exudyn_robot
from flexapod.verification.engines.exudyn_integration import Integration
from flexapod.verification.engines.mujoco_forces import mjcf

pytestmark = pytest.mark.consistency

STIFFNESS, RELAXATION = 2e4, 0.1
TABLE = '[leg.maxwell]\nstiffness = "20 kN/m"\nrelaxation = "0.1 s"\n'
TWO = "".join(f'[[leg.maxwell]]\nstiffness = "{k} kN/m"\nrelaxation = "0.1 s"\n' for k in (12, 8))


def text(table=TABLE):
    return preset_text("paper-robot").replace("[motion]", f"{table}\n[motion]", 1)


def study(table=TABLE, **leg):
    found = fx.loads(text(table))
    legs = tuple(one.replace(**leg) for one in found.robot.legs)
    return found.replace(robot=found.robot.replace(legs=legs))


@pytest.fixture(autouse=True)
def known(monkeypatch):
    """Elements that a test makes known are so no longer than it."""
    for name in [name for name in registered if name != "maxwell"]:
        monkeypatch.delitem(registered, name)
    yield
    for name in [name for name in registered if name != "maxwell"]:
        del registered[name]


@pytest.fixture(scope="module")
def moved():
    return fx.simulate(study(), fidelity="lumped", duration=0.3, tolerance=1e-10)


def closed_form(data, stiffness, relaxation):
    """F' = k l' - F / tau for the commanded lengths, by Gauss' rule between output instants, (T, legs)."""
    commanded = fx.inverse_kinematics(study(""), duration=0.3, output_step=2.5e-4)
    rate = scipy.interpolate.make_interp_spline(commanded.time.values, commanded.leg_length_rate.values, k=5)
    nodes, weights = np.polynomial.legendre.leggauss(5)
    force, time = np.zeros((data.time.size, 6)), data.time.values
    for k, (begin, end) in enumerate(pairwise(time)):
        within = begin + 0.5 * (end - begin) * (1 + nodes)
        left = weights * np.exp(-(end - within) / relaxation)
        gained = 0.5 * (end - begin) * stiffness * left @ rate(within)
        force[k + 1] = force[k] * np.exp(-(end - begin) / relaxation) + gained
    return force


def test_its_force_is_that_of_the_closed_form(moved):
    """The light mass that stands for none is 1e-8 k tau^2: 1e-8 of the force in a motion that takes more than tau."""
    exact = closed_form(moved, STIFFNESS, RELAXATION)
    np.testing.assert_allclose(moved.maxwell_force, exact, rtol=0, atol=1e-8 * np.abs(exact).max())
    assert moved.maxwell_force.attrs == {"units": "N", "long_name": "force of the Maxwell element along the leg"}


def test_the_energy_balance_closes(moved):
    gained = moved.work_drive + moved.work_external
    kept = moved.energy_kinetic + moved.energy_potential + moved.energy_strain + moved.energy_dissipated
    balance = kept - gained
    assert float(moved.energy_dissipated[-1]) > 0.05
    assert float(np.abs(balance - balance[0]).max()) < 1e-7 * float(np.abs(gained).max())


def test_two_in_a_leg_are_as_one_of_both(moved):
    """The same relaxation: stiffnesses add. Each has its own coordinate, parameters and result."""
    both = fx.simulate(study(TWO), fidelity="lumped", duration=0.3, tolerance=1e-10)
    whole = float(np.abs(moved.maxwell_force).max())
    np.testing.assert_allclose(both.maxwell_force + both.maxwell_2_force, moved.maxwell_force, atol=1e-7 * whole)
    np.testing.assert_allclose(both.maxwell_2_force * 12, both.maxwell_force * 8, atol=1e-6 * whole)


def test_legs_with_and_without_it():
    given = study("")
    legs = [
        leg.replace(elements=(Maxwell(stiffness=2e4, relaxation=0.1),) if i < 2 else ())
        for i, leg in enumerate(given.robot.legs)
    ]
    mixed = given.replace(robot=given.robot.replace(legs=tuple(legs)))
    data = fx.simulate(mixed, fidelity="lumped", duration=0.05)
    np.testing.assert_array_equal(np.isnan(data.maxwell_force[-1]), [False] * 2 + [True] * 4)
    again = fx.loads(to_toml(mixed))
    assert again.robot.legs == mixed.robot.legs


def test_written_and_read_again():
    for table in (TABLE, TWO):
        given = fx.loads(text(table))
        again = fx.loads(to_toml(given))
        assert again.robot == given.robot and again.robot.legs[0].elements


def test_modes_are_as_many_as_masses_and_damped_as_the_poles_are():
    """Undamped frequencies do not see a state without mass; the ratios are those of the whole: k s tau / (1 + s tau).

    The other side: modes of the robot without it, and the element's stiffness by the Laplace variable at its strokes.
    """
    machine = {"drive": ServoDrive(stiffness=2e6), "damping": 0.0}
    bare = study("", **machine)
    without = robot_modes(bare.robot, bare.simulation.replace(fidelity="lumped"))
    ours = fx.modes(study(**machine), fidelity="lumped")
    omega, n = 2 * np.pi * without.frequency, without.system.n
    np.testing.assert_allclose(ours.frequency, without.frequency, rtol=1e-9)
    B = without.shapes[:, [n * leg + without.system.kernel.shapes.l_index for leg in range(6)]]  # unit masses
    size, legs = B.shape
    state = np.zeros((2 * size + legs, 2 * size + legs))  # modes, their rates, forces of the elements
    state[:size, size : 2 * size] = np.eye(size)
    state[size : 2 * size, :size] = -np.diag(omega**2)
    state[size : 2 * size, 2 * size :] = -B
    state[2 * size :, size : 2 * size] = STIFFNESS * B.T
    state[2 * size :, 2 * size :] = -np.eye(legs) / RELAXATION
    poles = np.linalg.eigvals(state)
    poles = poles[poles.imag > 0]
    ratios = np.sort(-poles.real / np.abs(poles))
    assert ratios[-1] > 1e-4
    np.testing.assert_allclose(np.sort(ours.damping_ratio), ratios, rtol=1e-6, atol=1e-12)


def test_its_row_in_the_budget_is_what_its_play_moves_the_tool_by():
    """Half of the play in each leg, whichever way: the sum of the sizes, by a difference of forward kinematics."""
    given = study(TABLE + 'play = "4 um"\n')
    row = fx.budget(given).budget.sel(part="seat", kind="hysteretic").values[:3]
    home = fx.inverse_kinematics(given, duration=0.001).leg_length_command.values[0]
    step, moves = 1e-6, []
    for leg in range(6):
        there = [fx.forward_kinematics(given, home + side * step * np.eye(6)[leg]) for side in (1, -1)]
        moves.append((there[0].tool_position.values - there[1].tool_position.values).ravel() / (2 * step))
    np.testing.assert_allclose(row, 2e-6 * np.abs(moves).sum(axis=0), rtol=1e-6)


def test_a_sweep_over_its_keys(tmp_path):
    plan = {
        "vary": [{"key": "leg.maxwell.stiffness", "values": ["10 kN/m", "20 kN/m"]}],
        "keep": {"records": ["maxwell_force"]},
    }
    given = study()
    given = given.replace(simulation=given.simulation.replace(duration=0.05, fidelity="lumped"))
    forces = fx.sweep(given, plan, store=tmp_path / "s").maxwell_force.values
    np.testing.assert_allclose(forces[1], 2 * forces[0], rtol=0, atol=1e-6 * np.abs(forces).max())


@pytest.mark.parametrize(("table", "words"), [
    ('[leg.maxwell]\nstiffness = "20 kN/m"\nrelaxaton = "1 s"', "leg.maxwell.relaxaton: unknown key"),
    ('[leg.maxwell]\nstiffness = "20 kN"\nrelaxation = "1 s"', "leg.maxwell.stiffness = '20 kN': is not a stiffness"),
    ('[leg.maxwell]\nstiffness = "20 kN/m"', "leg.maxwell.relaxation: is missing"),
    ('[leg.maxwel]\nstiffness = "20 kN/m"', "Did you mean 'maxwell'"),
    (TWO.replace('stiffness = "8 kN/m"\n', ""), r"leg.maxwell\[2\].stiffness: is missing"),
])  # fmt: skip
def test_its_table_is_refused_as_others_are(table, words):
    with pytest.raises(fx.InputError, match=words):
        fx.loads(text(table))


@pytest.mark.parametrize(
    "reader",
    [fx.inverse_dynamics, abaqus_deck, lambda study: mjcf(study.robot), lambda s: fx.export(s, "mjcf", "a.xml")],
)
def test_who_does_not_know_it_says_so(reader):
    with pytest.raises(fx.InputError, match=r"leg\.maxwell: is not known to"):
        reader(study())


CONSOLE = 'import flexapod as fx\nclass Typed(fx.Element):\n    at = "typed"\n'


def test_another_engine_says_so():
    given, at = study(), Integration(duration=0.1, step=1e-3)
    with pytest.raises(fx.InputError, match="maxwell: is not modelled in Exudyn"):
        exudyn_robot.simulate_robot(given.robot, given.motion, at)


def test_report_and_page_show_it(moved):
    said = [line for part in study_items(fx.loads(text()), None) if isinstance(part, Bullets) for line in part.lines]
    assert "[leg.maxwell]: stiffness 20 kN/m, relaxation 0.1 s." in said
    chart = charts(moved)["maxwell_force"]
    assert chart.unit == "N" and len(chart.names) == 6 and chart.title.startswith("Force of the Maxwell element")
    titles = {name: title for name, title, _ in figures._robot(moved)}
    assert titles["maxwell-force"] == "Force of the Maxwell element along the leg"
    drawn = fx.plot.by_leg(moved, "maxwell_force").axes[0]
    assert len(drawn.lines) >= 6 and drawn.get_ylabel() == "maxwell force [N]"


def test_a_class_without_a_file_is_refused():
    with pytest.raises(fx.InputError, match="an element without a file"):
        exec(CONSOLE, {"__name__": "console"})


def test_two_classes_cannot_have_one_table():
    with pytest.raises(fx.InputError, match="is the table of another element"):
        type("Other", (fx.Element,), {"at": "maxwell", "__module__": __name__})


def test_its_kernel_is_made_anew_when_its_equations_change_and_not_for_a_comment(tmp_path, monkeypatch):
    source = Path(sys.modules[Maxwell.__module__].__file__).read_text().replace('"maxwell"', '"changing"')
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("FLEXAPOD_CACHE", str(tmp_path / "cache"))
    file = tmp_path / "changing_element.py"
    table = TABLE.replace("maxwell", "changing")
    forces, libraries = [], []
    for factor, comment in (("0.5", ""), ("0.5", "# more words"), ("1.0", "")):
        file.write_text(f"{source}{comment}\n".replace("strain=0.5", f"strain={factor}"))
        importlib.invalidate_caches()
        module = importlib.import_module("changing_element")
        importlib.reload(module)
        assert module.Maxwell.at == "changing"
        forces.append(fx.simulate(study(table), fidelity="lumped", duration=0.05).drive_force.values)
        libraries.append({path.name for path in (tmp_path / "cache").glob("*.so")})
    np.testing.assert_array_equal(forces[1], forces[0])
    assert libraries[1] == libraries[0]
    assert np.abs(forces[2] - forces[0]).max() > 1e-3
    assert len(libraries[2] - libraries[1]) == 1


def test_an_entry_point_makes_it_known(tmp_path, monkeypatch):
    """As an installed package has it: a name in the group `flexapod.mechanics.elements`."""
    source = Path(sys.modules[Maxwell.__module__].__file__).read_text().replace('"maxwell"', '"installed"')
    (tmp_path / "installed_element.py").write_text(source)
    meta = tmp_path / "installed_element-1.0.dist-info"
    meta.mkdir()
    (meta / "METADATA").write_text("Metadata-Version: 2.1\nName: installed-element\nVersion: 1.0\n")
    (meta / "entry_points.txt").write_text("[flexapod.elements]\ninstalled = installed_element:Maxwell\n")
    monkeypatch.syspath_prepend(tmp_path)
    assert fx.loads(text(TABLE.replace("maxwell", "installed"))).robot.legs[0].elements[0].stiffness == 2e4


def test_a_tutorial_shows_this_element():
    page = (Path(__file__).parents[2] / "docs" / "an-element-of-your-own.md").read_text(encoding="utf-8")
    assert Path(sys.modules[Maxwell.__module__].__file__).read_text(encoding="utf-8") in page


def test_friction_of_an_element_is_that_of_a_drive(monkeypatch):
    # The same equation at the same place: kernels differ by the order of sums. Results of stiff legs magnify that.
    monkeypatch.setitem(registered, "seal", Seal)
    servo = ServoDrive(stiffness=1e6, damping=2e3)
    own = study('[leg.seal]\nforce = "50 N"\n', drive=servo)
    plain = study("", drive=servo.replace(friction=StrokeFriction(force=50.0)))
    found, drive = (fx.simulate(x, fidelity="lumped", duration=0.1) for x in (own, plain))
    assert list(found.slide.values) == ["seal"] and list(drive.slide.values) == ["drive"]
    np.testing.assert_allclose(found.friction.values, drive.friction.values, atol=1e-6 * 50)
    assert np.abs(found.friction.values).max() > 40
    rows = fx.budget(own).budget.sel(part="seal friction"), fx.budget(plain).budget.sel(part="drive friction")
    np.testing.assert_allclose(rows[0].values, rows[1].values, rtol=1e-6, atol=1e-12)
