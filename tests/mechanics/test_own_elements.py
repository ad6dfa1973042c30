"""Elements from outside of every kind: closed forms, every fidelity and mechanism, and what is refused by name."""

import sys
from pathlib import Path
from typing import ClassVar

import casadi
import numpy as np
import pytest
import scipy.integrate
from tests.helpers.moving import moving
from tests.helpers.runs import with_legs
from tests.trial_element.air_spring import AMBIENT, AirSpring
from tests.trial_element.ballast import Ballast
from tests.trial_element.maxwell import Maxwell
from tests.trial_element.turbulent_damper import TurbulentDamper

import flexapod as fx
from flexapod.mechanics.elements.element import registered
from flexapod.mechanics.symbolic import elementary
from flexapod.mechanics.symbolic.elementary import fabs
from flexapod.mechanics.symbolic.vocabulary import sqrt
from flexapod.model import ServoDrive
from flexapod.verification.robots import ROUND, STEEL

pytestmark = pytest.mark.consistency

AIR = AirSpring(pressure=6e5, bore=0.05, height=0.15)
DAMPER = TurbulentDamper(force=100.0, rate=0.3)
MAXWELL = Maxwell(stiffness=2e4, relaxation=0.1)
BALLAST = Ballast(mass=2.0, along=0.1)
AREA = np.pi / 4 * 0.05**2
SERVO = ServoDrive(stiffness=1e6, damping=2e3)


@pytest.fixture(autouse=True)
def known():
    """Classes that a test writes are known no longer than it."""
    before = dict(registered)
    yield
    registered.clear()
    registered.update(before)


def study(*elements, kind="6-UPS", drive=None, legs=99, **settings):
    """A robot that moves by 30 mm in a tenth of a second, with elements in its first legs."""
    given = moving(kind, drive, **({"step": None, "tolerance": 1e-8} | settings))
    found = tuple(leg.replace(elements=elements if i < legs else ()) for i, leg in enumerate(given.robot.legs))
    return given.replace(robot=given.robot.replace(legs=found))


def drive_force(*elements):
    return fx.simulate(study(*elements), fidelity="rigid").drive_force.values


@pytest.fixture(scope="module")
def plain():
    return drive_force()


def balance(data):
    kept = data.energy_kinetic + data.energy_potential + data.energy_strain + data.energy_dissipated
    return (kept - data.work_drive - data.work_external).values


def test_an_air_spring_pushes_with_the_pressure_of_its_height(plain):
    """Boyle: pressure times height is constant. The stroke follows its command: the drive takes the force."""
    data = fx.simulate(study(AIR), fidelity="rigid")
    x = data.leg_length_command.values - data.leg_length_command.values[0]
    pressure = 6e5 * 0.15 / (0.15 + x)
    np.testing.assert_allclose(data.air_spring_pressure, pressure, rtol=1e-9)
    push = AREA * (pressure - AMBIENT)
    # What both runs leave of the legs' own forces, of an ideal robot 1e-9 of the peak.
    np.testing.assert_allclose(data.drive_force - plain, -push, atol=1e-8 * np.abs(plain).max())
    assert np.ptp(push) > 50


def test_an_air_spring_is_as_stiff_as_its_pressure_over_its_height():
    """At the pressure outside it does not push at home, and is a spring of p A / h beside that of the drive."""
    weightless = study().robot.replace(gravity=[0.0, 0.0, 0.0])

    def frequencies(drive, *elements):
        legs = tuple(leg.replace(drive=drive, elements=elements) for leg in weightless.legs)
        return fx.modes(weightless.replace(legs=legs), fidelity="lumped").frequency.values

    air = AirSpring(pressure=AMBIENT, bore=0.3, height=0.02)
    k = AMBIENT * np.pi / 4 * 0.3**2 / 0.02
    assert k > 3e5
    right = frequencies(ServoDrive(stiffness=1e6 + k, damping=0.0))
    np.testing.assert_allclose(frequencies(ServoDrive(stiffness=1e6, damping=0.0), air), right, rtol=1e-9)


def test_a_turbulent_damper_brakes_with_the_square_of_the_rate(plain):
    given = study(DAMPER)
    data = fx.simulate(given, fidelity="rigid")
    v = fx.inverse_kinematics(given).leg_length_rate.values
    force = 100.0 * np.abs(v) * v / 0.3**2
    np.testing.assert_allclose(data.drive_force - plain, force, atol=1e-8 * np.abs(plain).max())
    assert np.abs(force).max() > 100


def test_what_a_turbulent_damper_takes_is_lost():
    """The work of c |v| v on the commanded way, by Simpson's rule; beside a servo the balance closes."""
    given = study(DAMPER)
    data = fx.simulate(given, fidelity="rigid", output_step=5e-4)
    path = fx.inverse_kinematics(given, output_step=5e-4)
    work = scipy.integrate.simpson(100.0 / 0.3**2 * np.abs(path.leg_length_rate.values) ** 3, x=path.time, axis=0).sum()
    # Simpson's rule on |v|^3 of a law that is smooth: 1e-6 at 200 intervals; powers at the stages of the march 1e-8.
    assert float(data.energy_dissipated[-1]) == pytest.approx(work, rel=1e-5)
    soft = fx.simulate(study(DAMPER, drive=SERVO), fidelity="lumped")
    assert np.ptp(balance(soft)) < 1e-6 * float(np.abs(soft.work_drive).max())


@pytest.mark.parametrize("law", ["force", "dissipation"])
def test_a_dissipation_that_is_not_quadratic_is_its_force(law):
    """The potential c |v|^3 / 3 and the force c v |v| are one damper."""

    class Said(fx.Element):
        at: ClassVar[str] = "said"
        parameters: ClassVar = (("c", 1),)

        def numbers(self, leg, standing):
            return {"c": 100.0 / 0.3**2}

        @classmethod
        def energy(cls, p, q, v):
            return fx.Energies(dissipation=p.c * fabs(v.l) ** 3 / 3)

    one = Said() if law == "dissipation" else DAMPER
    force = drive_force(one)
    v = fx.inverse_kinematics(study(one)).leg_length_rate.values
    np.testing.assert_allclose(force - drive_force(), 100.0 * np.abs(v) * v / 0.09, atol=1e-8 * np.abs(force).max())


def test_a_ballast_is_a_heavier_cylinder():
    """Mass, centre and inertia of two bodies on one axis, by Steiner's theorem: `energy_along` has the frame."""
    given = study(BALLAST, kind="3-RPS", drive=SERVO)
    ours = fx.simulate(given, fidelity="assumed-modes", duration=0.05)
    bare = study(kind="3-RPS", drive=SERVO)
    cylinder = bare.robot.legs[0].cylinder
    mass = cylinder.mass + 2.0
    com = (cylinder.mass * cylinder.com + 2.0 * 0.1) / mass
    inertia = cylinder.inertia + cylinder.mass * (cylinder.com - com) ** 2 + 2.0 * (0.1 - com) ** 2
    heavier = cylinder.replace(mass=mass, com=com, inertia=inertia)
    legs = tuple(leg.replace(cylinder=heavier) for leg in bare.robot.legs)
    other = fx.simulate(bare.replace(robot=bare.robot.replace(legs=legs)), fidelity="assumed-modes", duration=0.05)
    for name in ("drive_force", "energy_kinetic", "energy_potential", "tool_deviation"):
        whole = np.abs(other[name].values).max()
        np.testing.assert_allclose(ours[name], other[name], atol=1e-6 * whole)


FIDELITIES = ("rigid", "lumped", "finite-segment", "assumed-modes", "beam-fem", "solid-fem")
SETS = {"with a coordinate": (MAXWELL,), "without": (AIR, DAMPER, BALLAST)}
MECHANISMS = ("6-UPS", "3-RPS", "3-PUU")


@pytest.mark.parametrize("fidelity", FIDELITIES)
@pytest.mark.parametrize("some", SETS)
@pytest.mark.parametrize("kind", MECHANISMS)
def test_every_fidelity_of_every_mechanism_has_elements_from_outside(kind, some, fidelity):
    """In all legs but the last; the delta's strokes are struts, along which nothing of them moves."""
    given = study(*SETS[some], kind=kind, legs=2, tolerance=1e-6, modes=2, axial_modes=1)
    if fidelity == "solid-fem":  # which reduces a piston that is drawn
        part = "strut" if kind == "3-PUU" else "piston"
        bar = type(getattr(given.robot.legs[0], part)).round
        drawn = bar(length=given.robot.legs[0].piston.length, section=ROUND, material=STEEL)
        given = with_legs(given, **{part: drawn})
    data = fx.simulate(given, fidelity=fidelity, duration=0.02, output_step=2e-3)
    assert not data.attrs["partial"] and all(np.isfinite(data[name]).any() for name in data.data_vars)
    # Energies are summed with the same steps: the tolerance, and stretch that begins to ring at the corner of the law.
    assert np.ptp(balance(data)) < 1e-3 * np.ptp(data.work_drive.values)
    bare = with_legs(given, elements=())
    forces = fx.simulate(bare, fidelity="rigid", duration=0.02, output_step=2e-3)
    known = forces.actuator_force_rigid if kind != "3-PUU" else forces.drive_force_rigid
    np.testing.assert_allclose(data[known.name], known, rtol=1e-12, atol=1e-9)  # without them, and said so
    assert "is not in the forces of the rigid robot" in data.attrs["warnings"]


class _Base(fx.Element):
    """A spring along the stroke; what is wrong with others stands beside it."""

    parameters: ClassVar = (("k", 1), ("home", 1))
    more: ClassVar = {}

    def numbers(self, leg, standing):
        return {"k": 1e4, "home": standing.length} | self.more

    @classmethod
    def energy(cls, p, q, v):
        return fx.Energies(strain=cls.strain(p, q, v), kinetic=cls.kinetic(p, q, v), dissipation=cls.lost(p, q, v))

    @classmethod
    def strain(cls, p, q, v):
        return 0.5 * p.k * (q.l - p.home) ** 2

    @classmethod
    def kinetic(cls, p, q, v):
        return 0.0

    lost = kinetic


def wrong(name, **hooks):
    """A class of elements with other hooks, which are class methods if they can be called."""
    made = {key: classmethod(hook) if callable(hook) else hook for key, hook in hooks.items()}
    return type(name, (_Base,), {"at": "wrong", "__module__": __name__, "__doc__": "One.", **made})


@pytest.mark.parametrize(("hooks", "words"), [
    ({"strain": lambda cls, p, q, v: p.stiff * q.l}, "Wrong.energy: fails with AttributeError"),
    ({"strain": lambda cls, p, q, v: v.l * q.l}, "Wrong.energy: gives a strain energy that depends on rates"),
    ({"kinetic": lambda cls, p, q, v: v.l**4}, "not quadratic in the rates"),
    ({"energy": lambda cls, p, q, v: 0.5 * q.l**2}, "gives no flexapod.Energies"),
    ({"strain": lambda cls, p, q, v: q.b}, "not one number"),
    ({"strain": lambda cls, p, q, v: casadi.erfinv(q.l)}, "no C text: erfinv"),
    ({"lost": lambda cls, p, q, v: p.k * v.l}, "Wrong.energy = .*has a force at rest"),
    ({"lost": lambda cls, p, q, v: p.k * fabs(v.l)}, "Wrong.energy = .*jumps where a rate changes its sign"),
    ({"damping_force": lambda cls, p, q, v: {"stroke": v.l}}, "Wrong.damping_force = 'stroke': is on a coordinate"),
    ({"damping_force": lambda cls, p, q, v: {"l": p.k}}, "Wrong.damping_force = .*has a force at rest"),
    ({"strain": lambda cls, p, q, v: sqrt(q.l - p.home)}, "strain: of leg 1 at home a value or a derivative"),
    ({"strain": lambda cls, p, q, v: q.l / p.k}, "strain: in leg 2, which is without it.*`absent`"),
    ({"more": {"stiffness": 1.0}}, "Wrong.numbers = 'stiffness': is no parameter of the element.*k, home"),
    ({"more": {"k": [1.0, 2.0]}}, "Wrong.numbers = .*gives 2 numbers for k"),
    ({"more": {"k": "stiff"}}, "Wrong.numbers: fails with ValueError"),
    ({"more": {"k": float("nan")}}, "Wrong.numbers = nan: gives k a value that is no number"),
    ({"outputs": (fx.Output("force", "N", "force", lambda p, q: p.nothing),)}, "Wrong.outputs.force: fails with"),
])  # fmt: skip
def test_what_has_no_equations_is_refused_with_class_and_file(hooks, words, tmp_path, monkeypatch):
    monkeypatch.setenv("FLEXAPOD_CACHE", str(tmp_path))  # where classes of this file and name would be one
    given = study(wrong("Wrong", **hooks)(), legs=1, kind="3-RPS")
    with pytest.raises(fx.InputError, match=words) as caught:
        fx.simulate(given, fidelity="rigid", duration=0.01).to_dict()
    assert caught.value.file == __file__


@pytest.mark.parametrize(("hooks", "words"), [
    ({"absent": {"stiffness": 1.0}}, "Wrong.absent = 'stiffness': is none of the element's own"),
    ({"parameters": (("k", 1), ("k", 2))}, "Wrong.parameters = .*no names with sizes"),
    ({"coordinates": ("z",)}, "Wrong.coordinates: fails with ValueError"),
])  # fmt: skip
def test_what_a_class_declares_is_looked_at_when_it_is_made(hooks, words):
    with pytest.raises(fx.InputError, match=words):
        wrong("Wrong", **hooks)


def test_a_quantity_that_nothing_measures_is_refused():
    with pytest.raises(fx.InputError, match="'pressure': is nothing that a Quantity can measure"):
        fx.Quantity("pressure", above=0)


@pytest.mark.parametrize("kind", [AirSpring, TurbulentDamper, Ballast])
def test_the_tutorial_shows_these_elements(kind):
    page = (Path(__file__).parents[2] / "docs" / "an-element-of-your-own.md").read_text(encoding="utf-8")
    assert Path(sys.modules[kind.__module__].__file__).read_text(encoding="utf-8") in page


def test_the_tutorial_names_every_function_that_there_is():
    page = (Path(__file__).parents[2] / "docs" / "an-element-of-your-own.md").read_text(encoding="utf-8")
    inverse = {"asin", "acos", "atan", "asinh", "acosh", "atanh"}  # "their inverses", "and theirs"
    assert not [name for name in elementary.__all__ if name not in inverse and f"`{name}" not in page]
