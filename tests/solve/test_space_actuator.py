"""The single actuator in space against closed forms and against the planar one."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigvals
from scipy.optimize import brentq
from tests.oracles.stretching_rotor import lag_frequency

import flexapod as fx
from flexapod.common.errors import InputError
from flexapod.model import (
    Actuator,
    ActuatorInitial,
    ActuatorLoad,
    ActuatorMotion,
    ActuatorStudy,
    ConstantLaw,
    ConstantWrench,
    ProfileLaw,
    RateLaw,
    Simulation,
    SpinUpLaw,
)
from flexapod.solve.modal.actuator_modes import actuator_modes, stretching_lag
from flexapod.solve.shapes import places
from flexapod.solve.time.actuator_march import actuator_system, prepare_actuator

pytestmark = pytest.mark.analytic

BEAM = {"length": 3.66, "rhoA": 4.02, "EI": 756.65, "free_length": 1.83}
BODY = {"tip_mass": 1.0, "tip_inertia": 0.02, "hub_inertia": 2.0, "hub_radius": 0.1}
PARTS = {"EA": 4e6, "GJ": 600.0, "axial_inertia": 2e-3, "tip_axial_inertia": 0.03, "hub_axial_inertia": 0.4}
TURN = ProfileLaw(law="quintic", amplitude=1.0, duration=0.4)
STATIC = Actuator(length=2.0, free_length=2.0, rhoA=1.0, EI=500.0, space=True, damping=0.9, **PARTS)


def simulate(beam, *, modes=2, step=1e-3, duration=0.5, fidelity="assumed-modes", basis="tip-load", **parts):
    settings = {"modes": modes, "basis": basis} if fidelity == "assumed-modes" else {}
    simulation = Simulation(fidelity=fidelity, duration=duration, step=step, tolerance=None, **settings)
    return fx.simulate_actuator(ActuatorStudy(actuator=beam, simulation=simulation, **parts))


def same(ours, theirs, names, along):
    for name in names:
        assert_allclose(ours[name], theirs[name], rtol=0, atol=1e-10 * max(1.0, np.abs(theirs[name]).max()))
    bent = ours.tip_deflection.sel(direction=along)
    assert_allclose(bent, theirs.tip_deflection, rtol=0, atol=1e-10 * np.abs(bent).max())


SHARED = ("length", "force", "energy_kinetic", "energy_potential", "energy_strain", "work_drive")


def test_turning_about_the_vertical_is_the_planar_actuator():
    parts = {
        "motion": ActuatorMotion(rotation=TURN, extension=RateLaw(rate=0.2)),
        "initial": ActuatorInitial(tip_displacement=5e-3),
    }
    flat, ours = (simulate(Actuator(space=x, **BEAM, **BODY), basis="clamped-free", **parts) for x in (False, True))
    same(ours, flat, (*SHARED, "angle", "angle_rate", "torque"), "rotation")
    assert_allclose(ours.tip_position[:, :2], flat.tip_position, atol=1e-12)
    assert np.abs(flat.tip_deflection).max() > 0.1
    assert not np.abs(ours.tip_deflection.sel(direction="elevation")).any()


def test_an_elevation_under_gravity_is_the_planar_actuator():
    # Driven by a torque, from a rate; the plane of gravity is upright in both.
    torque = ConstantLaw(value=30.0)
    beam = BEAM | BODY | {"gravity": 9.81}
    flat = simulate(
        Actuator(angle=0.3, **beam),
        basis="clamped-free",
        motion=ActuatorMotion(rotation=None),
        load=ActuatorLoad(torque=torque),
        initial=ActuatorInitial(tip_displacement=5e-3, angle_rate=0.2),
    )
    ours = simulate(
        Actuator(space=True, angle=0.7, elevation=0.3, **beam),
        basis="clamped-free",
        motion=ActuatorMotion(elevation=None),
        load=ActuatorLoad(elevation_torque=torque),
        initial=ActuatorInitial(elevation_displacement=5e-3, elevation_rate=0.2),
    )
    same(ours, flat, SHARED, "elevation")
    assert_allclose(ours.elevation, flat.angle, atol=1e-10)
    assert_allclose(ours.elevation_torque, flat.torque, atol=1e-9)
    x, y = flat.tip_position.values.T
    assert_allclose(ours.tip_position, np.stack([x * np.cos(0.7), x * np.sin(0.7), y], axis=1), atol=1e-10)


def rigid_inertias():
    """Of a rigid beam with its bodies about the pivot: across and along the beam [kg m^2]."""
    outer = BODY["hub_radius"] + BEAM["free_length"]
    rod = BEAM["rhoA"] * (outer**3 - (outer - BEAM["length"]) ** 3) / 3
    across = BODY["hub_inertia"] + rod + BODY["tip_mass"] * outer**2 + BODY["tip_inertia"]
    return across, PARTS["hub_axial_inertia"] + PARTS["tip_axial_inertia"] + PARTS["axial_inertia"]


def test_a_rigid_hub_about_two_axes_needs_the_torques_of_euler():
    # L_z = (A cos^2 b + C sin^2 b) a', its rate is the torque about Z; A b'' + (A - C) a'^2 sin b cos b the other.
    law = ProfileLaw(law="quintic", amplitude=1.2, duration=0.5)
    data = simulate(
        Actuator(space=True, **BEAM, **BODY, **PARTS),
        fidelity="rigid",
        motion=ActuatorMotion(rotation=RateLaw(rate=3.0), elevation=law),
    )
    A, C = rigid_inertias()
    a, b, rate = 3.0, data.elevation.values, data.elevation_rate.values
    assert_allclose(data.torque, (C - A) * np.sin(2 * b) * rate * a, atol=1e-9 * A * a * 5)
    s = np.clip(data.time.values / 0.5, 0, 1)
    accel = 1.2 / 0.25 * (60 * s - 180 * s**2 + 120 * s**3)
    assert_allclose(data.elevation_torque, A * accel + (A - C) * a**2 * np.sin(b) * np.cos(b), atol=1e-8 * A * 30)


def test_a_free_hub_keeps_its_angular_momentum_while_the_beam_is_lifted():
    law = ProfileLaw(law="quintic", amplitude=1.2, duration=0.5)
    (A, C), gaps = rigid_inertias(), []
    for step in (1e-3, 5e-4):  # the error is that of the steps, of second order
        data = simulate(
            Actuator(space=True, **BEAM, **BODY, **PARTS),
            fidelity="rigid",
            step=step,
            motion=ActuatorMotion(rotation=None, elevation=law),
            load=ActuatorLoad(torque=ConstantLaw(value=0.0)),
            initial=ActuatorInitial(angle_rate=2.0),
        )
        inertia = A * np.cos(data.elevation) ** 2 + C * np.sin(data.elevation) ** 2
        gaps.append(float(np.abs(inertia * data.angle_rate / (2.0 * A) - 1).max()))
        assert float(data.angle_rate[-1]) > 2 * 2.0  # a skater
    assert gaps[1] < 1e-5
    assert gaps[0] / gaps[1] == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize("follow", [False, True])
def test_forces_and_moments_at_the_tip_deflect_as_cantilevers_say(follow):
    # Small: squares of slopes stay below 1e-6, and tension stiffens by 0.4 F L^2 / EI = 1e-4; damped at 0.9 until
    # nothing of 4 Hz is left (e^-40). The hub stands askew: what follows has the axes of the beam, what is fixed is
    # turned into them.
    F, M = np.array([3e-2, 2e-3, -1e-3]), np.array([5e-2, 2e-3, 3e-3])
    a, e = 0.7, 0.4
    (c, s), (d, f) = (np.cos(a), np.sin(a)), (np.cos(e), np.sin(e))
    axes = np.array([[c * d, s * d, f], [-s, c, 0], [-c * f, -s * f, d]])  # along, to larger a, to larger e
    given = np.append(F, M) if follow else np.append(axes.T @ F, axes.T @ M)
    data = simulate(
        STATIC.replace(angle=a, elevation=e),
        load=ActuatorLoad(wrench=ConstantWrench(value=given), follow=follow),
        step=2e-3,
        duration=4.0,
    )
    L, EI = 2.0, STATIC.EI
    # The moment about z (axis 3) bends towards larger a, about -y towards larger e.
    expected = np.array([F[1] * L**3 / 3 + M[2] * L**2 / 2, F[2] * L**3 / 3 - M[1] * L**2 / 2]) / EI
    assert_allclose(data.tip_deflection[-1], expected, rtol=1e-3)
    assert_allclose(data.tip_stretch[-1], F[0] * L / STATIC.EA, rtol=1e-3)
    assert_allclose(data.tip_twist[-1], M[0] * L / STATIC.GJ, rtol=1e-3)


def stiffness_under(push, follow):
    """Frequencies squared of a clamped beam of unit length, mass and stiffness under a push at its tip, one plane."""
    beam = Actuator(length=1.0, free_length=1.0, rhoA=1.0, EI=1.0, space=True)
    study = ActuatorStudy(
        actuator=beam,
        load=ActuatorLoad(wrench=ConstantWrench(value=[-push, 0, 0, 0, 0, 0]), follow=follow),
        simulation=Simulation(basis="tip-load", modes=8, duration=1e-3, step=1e-3, tolerance=None),
    )
    march = prepare_actuator(study)
    shapes, load = march.system.kernel.shapes, np.zeros(12)
    load[6 * follow + (2 if follow else 0)] = -push
    m = march.system.matrices(march.start, load)
    k = slice(shapes.index("b"), shapes.index("b") + shapes.beam.b.count)
    return np.sort_complex(eigvals(m.K[k, k], m.M[k, k]))


def test_a_dead_push_buckles_at_eulers_load():
    euler = np.pi**2 / 4
    low, high = (stiffness_under(share * euler, False)[0].real for share in (1 - 1e-4, 1 + 1e-4))
    assert low > 0 > high


def test_a_following_push_flutters_at_becks_load():
    # 20.0509 EI / L^2; eight shapes are right to 1e-3. Below it all frequencies are real, above two are a complex
    # pair; and never a static loss.
    below, above = (stiffness_under(push, True) for push in (20.0, 20.1))
    assert np.abs(below.imag).max() == 0
    assert below.real.min() > 0
    assert np.abs(above[:2].imag).min() > 1e-2


def test_a_beam_spun_up_stretches_as_a_linear_rod():
    # Simo & Vu-Quoc's beam; L (tan a / a - 1), a = rate L sqrt(rhoA / EA). Bending is over after the spin-up: 4 mm of
    # lag shorten by 1e-6 m and are not part of the stretch.
    beam = Actuator(length=10.0, free_length=10.0, rhoA=1.2, EI=1.4e4, EA=2.8e7, space=True)
    motion = ActuatorMotion(rotation=SpinUpLaw(rate=6.0, duration=15.0))
    data = simulate(beam, motion=motion, step=5e-3, duration=16.0)
    a = 6.0 * 10.0 * np.sqrt(1.2 / 2.8e7)
    steady = 10.0 * (np.tan(a) / a - 1)
    assert steady == pytest.approx(5.143e-4, rel=1e-4)
    assert data.tip_stretch[-1] == pytest.approx(steady, rel=2e-3)


WHOLE = {
    "motion": ActuatorMotion(
        rotation=None, elevation=None, extension=ProfileLaw(law="smooth", amplitude=0.3, duration=0.2)
    ),
    "load": ActuatorLoad(
        torque=ConstantLaw(value=40.0),
        elevation_torque=ConstantLaw(value=100.0),
        wrench=ConstantWrench(value=[1, 5, -8, 2, 3, -1]),
        follow=True,
    ),
    "initial": ActuatorInitial(tip_displacement=5e-3, elevation_displacement=-2e-3, angle_rate=0.5, elevation_rate=0.3),
}


def whole(step):
    beam = Actuator(space=True, gravity=9.81, damping=0.01, elevation=0.2, **BEAM, **BODY, **PARTS)
    return simulate(beam, step=step, duration=0.1, **WHOLE)


def test_energy_balances_and_steps_are_of_second_order():
    runs = [whole(step) for step in (1e-4, 5e-5, 2.5e-5)]
    gaps = []
    for data in runs:
        stored = data.energy_kinetic + data.energy_potential + data.energy_strain + data.energy_dissipated
        balance = stored - data.work_drive - data.work_external
        gaps.append(float(np.abs(balance - balance[0]).max()))
        assert np.abs(data.work_external).max() > 0.1
    assert gaps[-1] < 1e-4 * float(np.abs(runs[-1].work_drive).max())
    ends = [np.append(data.tip_position[-1], data.tip_deflection[-1]) for data in runs]
    ratio = np.linalg.norm(ends[0] - ends[1]) / np.linalg.norm(ends[1] - ends[2])
    assert ratio == pytest.approx(4.0, rel=0.15)


REFUSED = [
    ({"EA": 1e6}, {}, "EA"),
    ({}, {"motion": ActuatorMotion(elevation=RateLaw(rate=1.0))}, "motion.elevation"),
    ({}, {"load": ActuatorLoad(wrench=ConstantWrench(value=np.ones(6)))}, "load.wrench"),
    ({}, {"initial": ActuatorInitial(elevation_rate=1.0)}, "initial.elevation_rate"),
    ({"space": True, "GJ": 10.0}, {}, "GJ"),
    ({"space": True, "axial_modes": 3}, {}, "axial_modes"),
    (
        {"space": True, "elevation": np.pi / 2},
        {"motion": ActuatorMotion(rotation=None), "load": ActuatorLoad(torque=ConstantLaw(value=1.0))},
        "actuator.elevation",
    ),
    ({"space": True}, {"initial": ActuatorInitial(elevation_rate=1.0)}, "initial.elevation_rate"),
    ({"space": True}, {"motion": ActuatorMotion(elevation=None)}, "load.elevation_torque"),
]


@pytest.mark.parametrize(("beam", "parts", "key"), REFUSED)
def test_what_does_not_fit_is_refused_in_words(beam, parts, key):
    with pytest.raises(InputError) as caught:
        simulate(Actuator(**BEAM, **beam), **parts)
    assert key in str(caught.value)


def test_ports_are_the_coordinates_that_motions_drive():
    system = actuator_system(Actuator(space=True, **BEAM), Simulation(basis="tip-load", modes=1))
    assert list(system.ports) == list(places(system.kernel.shapes).values())


def test_modes_of_both_planes_of_the_rod_and_of_the_shaft():
    # Both planes are the planar beam's; a rod with a mass at its end has x tan x = rod / mass (the error of the static
    # shape and m - 1 sines falls as the cube of m: 4e-3 at two, 1.5e-4 at six), a shaft whose twist is linear the
    # inertia of its tip and a third of its own.
    settings = Simulation(basis="tip-load", modes=3)
    shared = BEAM | {"tip_mass": 1.0, "tip_inertia": 0.02, "gravity": 9.81, "damping": 0.01}
    ours = actuator_modes(Actuator(space=True, elevation=0.3, axial_modes=6, **shared, **PARTS), settings)
    flat = actuator_modes(Actuator(angle=0.3, **shared), settings)
    kinds = np.array(ours.kind)
    for kind in ("bending (rotation)", "bending (elevation)"):
        assert_allclose(ours.frequency[kinds == kind], flat.frequency, rtol=1e-9)
        assert_allclose(ours.damping_ratio[kinds == kind], flat.damping_ratio, rtol=1e-6)
    assert set(flat.kind) == {"bending"}
    mass, L = BEAM["rhoA"] * BEAM["length"], BEAM["length"]
    x = brentq(lambda x: x * np.tan(x) - mass / 1.0, 1e-3, np.pi / 2 - 1e-6)
    rod = x / L * np.sqrt(PARTS["EA"] / BEAM["rhoA"]) / (2 * np.pi)
    assert ours.frequency[kinds == "axial"][0] == pytest.approx(rod, rel=5e-4)
    inertia = PARTS["tip_axial_inertia"] + PARTS["axial_inertia"] / 3
    assert_allclose(ours.frequency[kinds == "twisting"], np.sqrt(PARTS["GJ"] / L / inertia) / (2 * np.pi))
    assert (np.diff(ours.frequency) >= 0).all()


def test_a_rod_that_only_stretches_has_axial_modes():
    found = actuator_modes(Actuator(space=True, EA=4e6, **BEAM), Simulation(fidelity="lumped", duration=1.0))
    assert set(found.kind) == {"axial"}


def test_twist_that_moves_nothing_costs_no_steps():
    # 1e-5 rad of ringing, 5e-5 of the bending at the tip: seven times the steps before it was measured beside that.
    # Half a tolerance of 1e-4 is its error in each step that passes over it, so it costs some; but who takes fewer than
    # two steps more for each of its 84 periods (GJ over length and inertia) does not follow it.
    study = ActuatorStudy(
        actuator=Actuator(space=True, gravity=9.81, elevation=0.2, tip_mass=1.0, tip_inertia=0.02, **BEAM),
        motion=ActuatorMotion(rotation=TURN),
        simulation=Simulation(basis="tip-load", modes=2, duration=0.4),
    )
    twists = study.replace(actuator=study.actuator.replace(GJ=2e4, axial_inertia=2e-3, tip_axial_inertia=0.005))
    plain, twisting = (fx.simulate_actuator(x) for x in (study, twists))
    assert 0 < np.abs(twisting.tip_twist).max() < 1e-3 * np.abs(twisting.tip_deflection).max()
    periods = 0.4 * np.sqrt(2e4 / (1.83 * (0.005 + 2e-3 * 1.83 / 3))) / (2 * np.pi)
    assert twisting.attrs["steps"] - plain.attrs["steps"] < 2 * periods


@pytest.mark.parametrize("speed", [2.0, 10.0])
def test_stretch_and_lag_act_on_each_other_by_coriolis_forces(speed):
    # Eight lateral shapes are right to 1e-6 (T9), six axial ones to 1e-5: their error falls as the cube (1.3e-3,
    # 1e-4).
    beam = Actuator(length=1.0, free_length=1.0, rhoA=1.0, EI=1.0, EA=70.0**2, axial_modes=6, space=True)
    found = stretching_lag(beam, Simulation(basis="tip-load", modes=8), speed)
    assert found[0] == pytest.approx(lag_frequency(speed, 70.0), rel=2e-5)
