"""Held coordinates and closed attitudes: what has to be the same robot is the same robot."""

from dataclasses import replace

import numpy as np
import pytest
from tests.helpers.mechanisms import LOWER, UPPER, built, leg, ring, rod, sliders
from tests.helpers.moving import KINDS, SOFT, moving
from tests.helpers.runs import run_robot

from flexapod import kinematics
from flexapod.common.generalized_alpha import GeneralizedAlpha
from flexapod.kinematics.leg_geometry import limbs
from flexapod.mechanics.elements.tip_body import TipBody
from flexapod.mechanics.elements.torsion import Torsion
from flexapod.mechanics.leg.layout import PAYLOAD_PARAMETERS, columns, leg_parameters
from flexapod.mechanics.leg.leg_chain import LegChain
from flexapod.mechanics.shapes import lateral_basis
from flexapod.model import AxisMotion, Cylinder, Load, Piston, Study, override, preset
from flexapod.solve import parameters, robot_system
from flexapod.solve.batch import RestStates
from flexapod.solve.kernel import kernel
from flexapod.solve.rigid_motion import rigid_state
from flexapod.solve.shapes import space_shapes
from flexapod.solve.statics.equilibrium import equilibria
from flexapod.solve.system import State, System
from flexapod.solve.time import interpreted, native
from flexapod.solve.time.command_tables import robot_law
from flexapod.solve.time.recording import Counters
from flexapod.solve.time.robot_march import prepare
from flexapod.solve.time.start import consistent_start

pytestmark = pytest.mark.consistency

METHOD, H = GeneralizedAlpha(0.9), 5e-4
PUSH = [50.0, -30, 20, 4, 5, -6]


def law_of(system, study):
    return robot_law(system, study.robot, study.load, lambda t: kinematics.rigid_poses(study.robot, study.motion, t))


def marched(system, law, state, steps, twin=native, h=H):
    """State after equal steps, from a state before the projection of its rates."""
    flow, _ = consistent_start(system, state, law, 0.0, METHOD, h)
    tables = law(np.arange(steps + 1) * h)
    flow, _ = twin.first_record(system, flow, *tables)
    found = twin.advance(system, METHOD, flow, h, tables, steps, Counters())
    assert found.status == 0
    return found.flow


@pytest.mark.parametrize("kind", KINDS)
def test_elimination_equals_the_dense_system(kind):
    study = moving(kind, SOFT if kind == "6-FPF" else None)
    system, law = prepare(study).system, law_of(prepare(study).system, study)
    start = rigid_state(system, kinematics.rigid_poses(study.robot, study.motion, np.zeros(1)))
    fast, slow = (marched(system, law, start, 10, twin) for twin in (native, interpreted))
    # Both end their Newton iterations at rounding; gaps of 1e-16 m make forces of M / (beta h^2) times that, 2e-7 N for
    # 100 kg, a hundred times more where legs are nearly parallel to what they hold.
    for name, atol in (("q", 1e-12), ("pose", 1e-12), ("v", 1e-9), ("lam", 1e-4), ("drive", 1e-4)):
        ours, theirs = getattr(fast, name), getattr(slow, name)
        np.testing.assert_allclose(ours, theirs, rtol=1e-8, atol=atol, err_msg=name)


def test_a_held_angle_is_the_limit_of_a_stiff_spring():
    study = moving("3-UPU")
    system = prepare(study).system
    layout, beta = leg_parameters(system.kernel.shapes), system.kernel.shapes.index("beta")
    start = rigid_state(system, kinematics.rigid_poses(study.robot, study.motion, np.zeros(1)))

    def pose(system):
        x = RestStates.from_state(replace(start, drive=np.zeros((3, system.ports.size))))
        command = x.q[..., system.ports]
        found = equilibria(system, x, command, np.zeros_like(command), np.array(PUSH))
        assert found.code == 0
        return found.states.pose[0]

    def sprung(k):
        leg_p = system.leg_p.copy()
        leg_p[:, columns(layout, "base_stiffness").start + 1] = k
        return pose(replace(system, leg_p=leg_p))

    held = system.held.copy()
    held[:, beta] = True
    exact, sizes = pose(replace(system, held=held)), np.array([1e6, 1e7, 1e8])
    poses = [sprung(k) for k in sizes]
    errors = [np.abs(x - exact).max() for x in poses]
    np.testing.assert_allclose(np.diff(np.log10(errors)), -1.0, atol=0.05)
    beyond = poses[2] + (poses[2] - poses[1]) / 9  # the error falls by ten: this is where it ends
    np.testing.assert_allclose(beyond, exact, rtol=0, atol=1e-9 * np.abs(start.pose[:3]).max())


def test_locked_carriages_are_locked_strokes():
    """Sliders that stand, rods of fixed length: pistons of that length without cylinders, their strokes held."""
    slid = sliders("PUS")
    beam = rod(0.65)
    plain = {"cylinder": Cylinder(mass=0.0, mouth=0.0)}
    plain["piston"] = Piston(length=0.65, EA=beam.EA, EI=beam.EI, rhoA=beam.rhoA)
    fixed = built("6-UPS", slid.home_bases, ring(0.15, UPPER), 0.6, [leg("UPS", **plain)] * len(LOWER))
    runs = []
    for robot in (slid, fixed):
        still = AxisMotion(type="heave", amplitude=0.0, duration=0.1, profile="smooth")
        study = Study(robot=robot, motion=still, simulation=preset("paper-robot").simulation)
        study = study.replace(
            initial=study.initial.replace(start="straight"),
            load=Load(wrench={"law": "constant", "value": PUSH}),
        )
        runs.append(run_robot(override(study, modes=2, step=H, output_step=2e-3, duration=0.05)))
    ours, theirs = runs
    assert np.ptp(ours["pose"][:, 2]) > 1e-6  # it vibrates
    np.testing.assert_allclose(ours["pose"], theirs["pose"], rtol=0, atol=1e-12)
    np.testing.assert_allclose(ours["q"][..., 1:9], theirs["q"][..., 1:], rtol=0, atol=1e-12)


def test_carriages_that_accelerate_together_are_gravity():
    """d'Alembert: all sliders moved upwards with 3 m/s^2 are sliders at rest under 3 m/s^2 more of gravity."""
    study, steps, a = moving("6-PUS"), 100, 3.0
    system = prepare(study).system
    shapes = system.kernel.shapes
    start = rigid_state(system, kinematics.rigid_poses(study.robot, study.motion, np.zeros(1)))
    start = replace(start, v=np.zeros(system.size), v_dot=np.zeros(system.size))
    rest = law_of(system, study)(np.zeros(1))[0]
    chi = list(system.ports).index(shapes.index("chi"))

    def law(accelerated):
        def table(t):
            rows = np.repeat(rest, len(t), axis=0)
            if accelerated:
                rows[:, :, chi, :3] += np.stack([a * t**2 / 2, a * t, np.full(len(t), a)], axis=-1)[:, None]
            return rows, np.zeros((len(t), 6))

        return table

    leg_p, payload_p = system.leg_p.copy(), system.payload_p.copy()
    leg_p[:, columns(leg_parameters(shapes), "gravity")] -= [0, 0, a]
    payload_p[columns(PAYLOAD_PARAMETERS, "gravity")] -= [0, 0, a]
    moved = marched(system, law(True), start, steps)
    heavy = marched(replace(system, leg_p=leg_p, payload_p=payload_p), law(False), start, steps)
    way = a * (steps * H) ** 2 / 2
    shift = np.array([0.0, 0.0, way, 0, 0, 0, 0])
    np.testing.assert_allclose(moved.pose - shift, heavy.pose, rtol=0, atol=1e-12)
    others = np.arange(system.n) != shapes.index("chi")
    np.testing.assert_allclose(moved.q[:, others], heavy.q[:, others], rtol=0, atol=1e-12)
    for name in ("lam", "drive"):  # forces of 1e3 N; their rounding as in the elimination
        np.testing.assert_allclose(getattr(moved, name), getattr(heavy, name), rtol=0, atol=1e-5)


@pytest.mark.parametrize("kind", ["8-UPS", "3-UPS+UP"])
def test_the_order_of_the_legs_does_not_matter(kind):
    study = moving(kind)
    system = prepare(study).system
    order, law = np.random.default_rng(3).permutation(system.legs), law_of(system, study)
    start = rigid_state(system, kinematics.rigid_poses(study.robot, study.motion, np.zeros(1)))
    other = replace(system, leg_p=system.leg_p[order], joint_p=system.joint_p[order], held=system.held[order])
    legs, payload = system.by_leg(start.v), start.v[-6:]
    turned = replace(start, q=start.q[order], v=np.concatenate([legs[order].ravel(), payload]))
    found = marched(system, law, start, 50)
    again = marched(other, lambda t: (law(t)[0][:, order], law(t)[1]), turned, 50)
    np.testing.assert_allclose(again.pose, found.pose, rtol=0, atol=1e-13)
    np.testing.assert_allclose(again.q, found.q[order], rtol=0, atol=1e-13)


def test_a_closed_attitude_with_free_angles_is_a_ball():
    study = moving("6-UPS")
    robot, plain = study.robot, prepare(study).system
    legs, shapes = limbs(robot), replace(plain.kernel.shapes, chain=LegChain(closure="pose"))
    posed = replace(
        plain,
        kernel=kernel(shapes),
        leg_p=parameters.leg_parameters(robot, legs, shapes),
        held=robot_system._held(robot, legs, shapes, at_rest=False),
    )
    path = kinematics.poses(robot, study.motion, np.zeros(1))
    ball, angles = (
        marched(system, law_of(system, study), rigid_state(system, kinematics.RigidPoses(robot, path)), 100)
        for system in (plain, posed)
    )
    np.testing.assert_allclose(angles.pose, ball.pose, rtol=0, atol=1e-12)
    np.testing.assert_allclose(angles.q[:, : plain.n], ball.q, rtol=0, atol=1e-12)
    size = np.abs(ball.lam).max()
    np.testing.assert_allclose(angles.lam[:, :3], ball.lam, rtol=0, atol=1e-8 * size)
    assert np.abs(angles.lam[:, 3:]).max() < 1e-8 * size  # no moments
    assert np.abs(angles.q[:, plain.n :]).max() > 1e-3  # though the joints turn


@pytest.mark.parametrize("carriage", ["", "slider"])
def test_a_leg_without_payload_swings_as_the_dense_equations_say(carriage):
    """In space, with a body and a load at its tip, on a carriage that a spring drives or on none; its stroke held."""
    shapes = space_shapes(
        lateral_basis("tip-load", 2), 1, Torsion, TipBody, closure="none", spin=True, carriage=carriage
    )
    layout = leg_parameters(shapes)
    given = {
        "rhoA": 2.0, "EI": 2e3, "EA": 4e7, "GJ": 1.5e3, "Lp": 0.7, "mouth": 0.2, "piston_axial_inertia": 1e-3,
        "cylinder_mass": 3.0, "cylinder_com": 0.1, "cylinder_inertia": 0.05, "cylinder_axial_inertia": 2e-3,
        "cylinder_spins": 1.0, "zeta": 0.01, "gravity": [0, 0, -9.81], "R0": np.eye(3), "tip_mass": 1.0,
        "tip_inertia": 1e-2, "tip_axial_inertia": 2e-2, "carriage_mass": 4.0, "carriage_axis": [0, 0.6, 0.8],
        "carriage_stiffness": 1e5, "carriage_damping": 50.0,
    }  # fmt: skip
    p = np.concatenate([np.ravel(given.get(name, np.zeros(size))) for name, size in layout])
    held = np.zeros((1, shapes.size), dtype=bool)
    held[0, shapes.l_index] = True
    none = np.zeros(0)
    system = System(kernel=kernel(shapes), leg_p=p[None], joint_p=none[None], payload_p=none, held=held)
    ports = system.ports.size
    table = np.zeros((1, ports, 4))
    table[0, 0, 0] = 0.6
    q = np.zeros((1, shapes.size))
    q[0, :3] = 0.5, 0.3, 0.6
    start = State(
        q=q, pose=np.zeros(7), v=np.zeros(shapes.size), v_dot=np.zeros(shapes.size), lam=np.zeros((1, 0)),
        drive=np.zeros((1, ports)),
    )  # fmt: skip

    def law(t):
        return np.repeat(table[None], len(t), axis=0), np.tile(np.append(PUSH, 0.1 * np.array(PUSH)), (len(t), 1))

    fast, slow = (marched(system, law, start, 200, twin) for twin in (native, interpreted))
    assert np.abs(fast.q[0, :2] - q[0, :2]).max() > 0.05
    for name in ("q", "v", "drive"):  # nothing magnifies rounding here; Newton ends at 1e-10 of the largest force
        np.testing.assert_allclose(getattr(fast, name), getattr(slow, name), rtol=1e-7, atol=1e-8, err_msg=name)
    energy = [system.energies(x, table)[0].sum() + x.sums[0] - x.sums[1:].sum() for x in (fast, slow)]
    np.testing.assert_allclose(energy, system.energies(start, table)[0].sum(), atol=2e-3 * np.abs(fast.sums[2]))
