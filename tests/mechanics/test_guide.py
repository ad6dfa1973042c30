"""Pistons in two bushings and cylinders that bend: exact kinematics, limits, exact beams."""

import base64
import re
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from casadi import DM
from scipy.linalg import eigh
from scipy.optimize import brentq
from tests.helpers import legs_of_all_kinds as legs
from tests.helpers.layouts import layout
from tests.helpers.machines import SCREW, machine, study
from tests.helpers.mechanisms import planar, three_rps
from tests.helpers.runs import balance, run_robot, with_legs
from tests.oracles.guided import Guided

import flexapod as fx
from flexapod.analysis.checks.estimates import buckling_load
from flexapod.analysis.description.robot_description import describe
from flexapod.analysis.error_budget.text import part_words
from flexapod.common.errors import InputError
from flexapod.kinematics.rotations import exponential, quaternion, rotation_vector
from flexapod.mechanics.elements.clearance import Clearance
from flexapod.mechanics.elements.guide import inner_turn
from flexapod.mechanics.shapes import axial_basis, lateral_basis
from flexapod.model import MATERIALS, Cylinder, ForceDrive, Guide, Mounted, PrescribedDrive, ServoDrive
from flexapod.model.leg.material import Tube
from flexapod.model.leg.spring import AxialSpring
from flexapod.output.exchange.pose_deck import abaqus_deck
from flexapod.output.report.replay import replay
from flexapod.output.scene.geometry import RobotMotion
from flexapod.output.text.answers import bodies_words
from flexapod.solve.statics.buckling import leg_loads
from flexapod.verification.engines import calculix
from flexapod.verification.engines.engine import CALCULIX
from flexapod.verification.engines.exudyn_robot import RobotProblem

pytestmark = pytest.mark.consistency

L_P, MOUTH, LENGTH = 0.75, 0.315, 0.91
TUBE = 4.0


def bare(**more):
    """Numbers of a leg of piston and cylinder alone, whose cylinder is its beam."""
    mass = TUBE * MOUTH
    still = {"piston_axial_inertia": 0.0, "cylinder_axial_inertia": 0.0, "mounted_mass": 0.0, "mounted_inertia": 0.0,
             "zeta": 0.0, "damping_time": 0.0, "base": np.zeros(3), "R0": np.eye(3), "guide_reach": L_P + MOUTH,
             "drive_stiffness": 0.0, "drive_damping": 0.0, "gravity": [1.0, 2.0, -9.0], "Lp": L_P, "mouth": MOUTH,
             "cylinder_mass": mass, "cylinder_com": MOUTH / 2, "cylinder_inertia": mass * MOUTH**2 / 12,
             "cylinder_rhoA": TUBE, "cylinder_length": MOUTH, "cylinder_turning": 0.0}  # fmt: skip
    return legs.numbers(0, **still | more)


@pytest.mark.parametrize("place", [0.1, 0.25])
def test_energies_are_right_to_second_order(place):
    # Closed forms keep terms up to second order in the amplitudes: the gap falls as their cube. The body is mounted on
    # either side of the head; rotary inertia of the tube is a hundred times what it has, to be seen.
    turning, mass, J = 0.02, 1.2, 0.006
    given = bare(cylinder_turning=turning, mounted_mass=mass, mounted_com=place, mounted_inertia=J)
    whole = given["cylinder_mass"] + mass
    about = TUBE * MOUTH**3 / 3 + turning * MOUTH + mass * place**2 + J
    com = (TUBE * MOUTH**2 / 2 + mass * place) / whole
    given |= {"cylinder_mass": whole, "cylinder_com": com, "cylinder_inertia": about - whole * com**2}
    ours = legs.shapes("point in a guide of a cylinder")
    exact = Guided(ours.layout, given, ours.beam.a.values, ours.beam.guide.values, ours.beam.cylinder.values)
    rng = np.random.default_rng(3)
    gaps = []
    for amplitude in (1e-3, 1e-4):
        rng = np.random.default_rng(3)
        q, v = amplitude * rng.uniform(-1, 1, ours.size), 30 * amplitude * rng.uniform(-1, 1, ours.size)
        for name in ("ka", "kb"):  # whose stiff shapes are steep
            q[ours.index(name) :][:4] *= [1, 0.1, 0.1, 0.3]
            v[ours.index(name) :][:4] *= [1, 0.1, 0.1, 0.3]
        q[:3], v[:3] = [0.3, -0.2, LENGTH], [0.7, -1.1, 0.4]
        x = legs.state(ours, 0, given=given) | {"q": q, "v": v}
        found = legs.call(ours, "leg_energies", x)["energies"]
        T, V = exact.energies(q, v, np.array(given["gravity"]))
        gaps.append(abs(found[0] - T))
        # Potentials are exact in these kinematics.
        assert found[1] == pytest.approx(V, rel=1e-12)
    assert gaps[0] / gaps[1] == pytest.approx(1000, rel=0.2)


def test_what_leans_and_bends_inside_turns_with_the_leg_to_second_order():
    # Angular rates of the leg alone: what small displacements change in T is its even part, to their square. Terms of
    # third order cancel between q and -q; the fourth leaves (1e-3)^2 times stiff shapes' slopes, some 1e-5 of it.
    given = bare()
    ours = legs.shapes("point in a guide of a cylinder")
    exact = Guided(ours.layout, given, ours.beam.a.values, ours.beam.guide.values, ours.beam.cylinder.values)
    still, v = np.zeros(ours.size), np.zeros(ours.size)
    still[:3], v[:2] = [0.3, -0.2, LENGTH], [2.0, -3.0]
    rng = np.random.default_rng(8)

    def kinetic(q):
        x = legs.state(ours, 0, given=given) | {"q": q, "v": v}
        return legs.call(ours, "leg_energies", x)["energies"][0], exact.energies(q, v, np.array(given["gravity"]))[0]

    for names in (("ga",), ("gb",), ("ga", "gb", "ha", "hb"), ("ka", "kb"), ("ga", "ha", "ka", "a")):
        bent = np.zeros(ours.size)
        for name in names:
            size = dict(ours.layout)[name]
            bent[ours.index(name) :][:size] = 1e-3 * rng.uniform(0.5, 1, size) * [1, 0.3, 0.1, 0.1][:size]
        (up, up_exact), (down, down_exact), (rest, rest_exact) = map(kinetic, (still + bent, still - bent, still))
        assert up + down - 2 * rest == pytest.approx(up_exact + down_exact - 2 * rest_exact, rel=1e-4), names


def test_the_inner_part_turns_the_tip_as_a_rod_without_twist_does():
    """Rotations of the section carried along the bent rod by the least turns from one tangent to the next."""
    basis, rng, D = lateral_basis("tip-load", 3), np.random.default_rng(2), 0.4
    size, slope = 1e-3, np.array([0.7, -0.4]) * 1e-2
    a, b = size * rng.normal(size=(2, 3)) * [1, 0.3, 0.1]
    parts = SimpleNamespace(ha=DM(a), hb=DM(b), l=DM(LENGTH))
    f = SimpleNamespace(qs=parts, line=SimpleNamespace(slope=DM(slope)))
    found = float(inner_turn(f, SimpleNamespace(guide_reach=LENGTH + D), basis))
    # The head hangs below the gland: place - D zeta slope + shape(zeta), zeta = 1 at the head. Towards the tip:
    slopes = slope - (np.array([a, b]) @ basis.values(np.linspace(1, 0, 2001), 1)).T / D
    turn = exponential(np.array([-slopes[0, 1], slopes[0, 0], 0.0]))  # the head does not turn about the leg
    tangents = np.array([exponential(np.array([-y, x, 0.0]))[:, 2] for x, y in slopes])
    for one, other in pairwise(tangents):
        axis = np.cross(one, other)
        turn = exponential(axis / np.linalg.norm(axis) * np.arcsin(np.linalg.norm(axis))) @ turn
    exact = rotation_vector(quaternion(turn[None]))[0, 2]
    # Second order in slopes of 1e-2: what is left is their square times as much; 2000 pieces leave 1e-6.
    assert found == pytest.approx(exact, rel=1e-3)
    assert abs(found) > 1e-6


EI, RHO = 5217.4, 4.466
GLAND, HEAD = 4e6, 3e6


def leg_of(overlap, modes=6, **more):
    """A pinned leg without gravity, 0.6 m free, and its numbers."""
    s = 0.6
    length = MOUTH + s
    given = bare(Lp=s + overlap, guide_reach=length + overlap, gravity=np.zeros(3), guide_stiffness=[GLAND, HEAD],
                 EI=EI, guide_EI=EI, rhoA=RHO, guide_rhoA=RHO, **more)  # fmt: skip
    ours = layout(a=lateral_basis("tip-load", modes), b=lateral_basis("tip-load", modes), axial=axial_basis(0),
                  guide=lateral_basis("tip-load", modes // 2))  # fmt: skip
    return ours, given, length


def pinned(ours, given, length, thrust=0.0):
    """M and K of a leg whose ends do not move across it, at rest under a thrust."""
    x = legs.state(ours, 0, given=given)
    x["q"], x["lam"] = np.zeros(ours.size), np.array([0, 0, thrust])
    x["q"][ours.l_index] = length
    found = legs.call(ours, "leg_matrices", x)
    J = np.vstack([found["J"][:2], np.eye(ours.size)[ours.l_index]])
    N = np.linalg.svd(J)[2][3:].T
    return N.T @ found["M"] @ N, N.T @ found["K"] @ N


def beam(x, rate, P, order):
    """Four solutions of EI v'''' + P v'' = rhoA rate^2 v at x, or their derivatives."""
    if not rate:
        k = np.sqrt(P / EI)
        turn = k**order * np.array([np.cos(k * x + order * np.pi / 2), np.sin(k * x + order * np.pi / 2)])
        return np.array([*([1.0, x] if order == 0 else [0.0, float(order == 1)]), *turn])
    k = (RHO * rate**2 / EI) ** 0.25
    turn = [np.cos(k * x + order * np.pi / 2), np.sin(k * x + order * np.pi / 2)]
    return k**order * np.array(
        [*turn, *((np.sinh(k * x), np.cosh(k * x)) if order % 2 else (np.cosh(k * x), np.sinh(k * x)))]
    )


def exact(given, length, rate=0.0, P=0.0):
    """Determinant of a beam in two bushings of a rigid cylinder: shears, moments, slopes, places; scaled."""
    head, mouth = length - given["Lp"], given["mouth"]
    J = given["cylinder_inertia"] + given["cylinder_mass"] * given["cylinder_com"] ** 2
    A = np.zeros((9, 9))  # inner part, outer part, cylinder's angle

    def v(x, order):
        return beam(x - mouth, rate, P, order)

    def shear(x):
        return EI * v(x, 3) + P * v(x, 1)

    gap_h, gap_g = np.array([*v(head, 0), *np.zeros(4), -head]), np.array([*v(mouth, 0), *np.zeros(4), -mouth])
    A[0, :4] = v(head, 2)
    A[1, :4] = shear(head)
    A[1] += HEAD * gap_h
    A[1, 8] -= P  # the thrust acts along the cylinder, wherever in it the head is
    for row, order in ((2, 0), (3, 1), (4, 2)):
        A[row, :4], A[row, 4:8] = v(mouth, order), -v(mouth, order)
    A[5, :4], A[5, 4:8] = -shear(mouth), shear(mouth)
    A[5] += GLAND * gap_g
    A[6, 4:8], A[7, 4:8] = v(length, 0), v(length, 2)
    A[8] = -HEAD * head * gap_h - GLAND * mouth * gap_g
    A[8, :4] -= P * v(head, 0)
    A[8, 8] += P * head - rate**2 * J
    A /= np.abs(A).max(axis=0)
    A /= np.abs(A).max(axis=1)[:, None]
    return np.linalg.det(A)


def root_near(f, x, width):
    """The root of f within a relative width of x."""
    return brentq(f, x * (1 - width), x * (1 + width), xtol=1e-12 * x)


@pytest.mark.parametrize(("overlap", "modes", "count"), [(0.12, 6, 2), (0.12, 8, 3), (0.3, 8, 3)])
def test_frequencies_of_a_piston_in_two_bushings(overlap, modes, count):
    # Overlaps of a fifth of the free length and of half of it; the third frequency asks for more than six shapes of
    # the free length, as it does without a guide.
    ours, given, length = leg_of(overlap, modes)
    M, K = pinned(ours, given, length)
    found = np.sqrt(eigh(K, M, eigvals_only=True)[::2][:count])  # both planes alike
    theirs = [root_near(lambda w: exact(given, length, rate=w), w, 1e-3) for w in found]
    np.testing.assert_allclose(found, theirs, rtol=1e-6)


@pytest.mark.parametrize("overlap", [0.12, 0.3])
def test_the_thrust_at_which_a_guided_piston_buckles(overlap):
    ours, given, length = leg_of(overlap)
    K = pinned(ours, given, length)[1]
    G = K - pinned(ours, given, length, 1.0)[1]
    found = 1 / eigh(G, K, eigvals_only=True)[-1]
    assert found == pytest.approx(root_near(lambda P: exact(given, length, P=P), found, 1e-3), rel=1e-6)


TUBE_SECTION = Tube(diameter=0.09, inner_diameter=0.07)
MOTOR = Mounted(mass=3.0, com=0.2, inertia=0.01)
BENDING = Cylinder.tube(mouth=0.6, section=TUBE_SECTION, material=MATERIALS["steel"], body=MOTOR)


def bushings(k, **more):
    return Guide(gland=k, head=k, **more)


def test_the_rotation_that_stiff_bushings_leave():
    # (T25.8): the gland's slope per moment at the gland, by the rod between the bushings and by the springs.
    for k, overlap in ((1e12, 0.12), (3e6, 0.12), (3e6, 0.3)):
        ours, given, length = leg_of(overlap)
        x = legs.state(ours, 0, given=given | {"guide_stiffness": [k, 1.3 * k]})
        x["q"], x["lam"] = np.zeros(ours.size), np.zeros(3)
        x["q"][ours.l_index] = length
        own = [ours.index("ga"), ours.index("ga") + 1, *range(ours.index("ha"), ours.index("ha") + 3)]
        K = legs.call(ours, "leg_matrices", x)["K"][np.ix_(own, own)]
        theirs = overlap / (3 * EI) + (1 / k + 1 / (1.3 * k)) / overlap**2
        assert np.linalg.inv(K)[1, 1] == pytest.approx(theirs, rel=1e-9 if k < 1e9 else 1e-6)


def test_stiff_bushings_of_a_stiff_rod_between_them_are_the_clamp():
    # d / (3 EI) of a rod 1e7 times as stiff is 1e-7 of what the rod outside gives. Periods, as rounding is relative to
    # the largest of what is asked for: of K that would be the bushings'.
    ours, given, length = leg_of(0.12, 4)
    stiff = given | {"guide_EI": 1e7 * EI, "guide_stiffness": [1e14, 1e14]}
    clamped = layout(a=ours.beam.a, b=ours.beam.b, axial=ours.beam.axial)
    found, theirs = (
        np.sqrt(eigh(*pinned(shapes, x, length), eigvals_only=True)[::-1])
        for shapes, x in ((ours, stiff), (clamped, given))
    )
    np.testing.assert_allclose(found[: len(theirs)], theirs, rtol=1e-6)


def test_short_overlaps_in_springs_are_a_hinge():
    # Their rotation grows as 1 / d^2: what a pinned leg bears falls with it.
    loads = []
    for overlap in (0.02, 0.01):
        ours, given, length = leg_of(overlap, 3)
        K = pinned(ours, given, length)[1]
        loads.append(1 / eigh(K - pinned(ours, given, length, 1.0)[1], K, eigvals_only=True)[-1])
    assert loads[0] / loads[1] == pytest.approx(4, rel=0.05)


def test_a_cylinder_without_end_of_stiffness_is_rigid():
    stiff = Cylinder.tube(
        mouth=0.6, section=TUBE_SECTION, material=MATERIALS["steel"].replace(name="given", E=2e17), body=MOTOR
    )
    masses = {name: getattr(stiff, name) for name in ("mass", "com", "inertia", "axial_inertia", "mouth")}
    robots = machine(cylinder=stiff), machine(cylinder=Cylinder(**masses))
    ours, theirs = (fx.modes(robot, fidelity="assumed-modes").frequency.values[:30] for robot in robots)
    np.testing.assert_allclose(ours, theirs, rtol=1e-6)


def test_legs_without_a_guide_beside_others():
    plain = machine()
    mixed = plain.replace(legs=(plain.legs[0].replace(guide=bushings(1e8), cylinder=BENDING), *plain.legs[1:]))
    ours, theirs = (fx.stiffness(robot).stiffness_share.values[1:] for robot in (mixed, plain))
    size = np.sqrt(np.einsum("nii,njj->nij", theirs, theirs))
    np.testing.assert_allclose(ours / size, theirs / size, atol=1e-3)  # the platform sags a little otherwise


@pytest.mark.parametrize("fidelity", ["rigid", "assumed-modes"])
def test_energy_balances(fidelity):
    # The error of the balance falls with the square of the step.
    robot = machine(guide=bushings(2e8, loss=0.02), cylinder=BENDING, drive=SCREW)
    errors = []
    for step in (5e-4, 2.5e-4):
        found = balance(run_robot(study(robot, fidelity=fidelity, step=step)))
        errors.append(np.abs(found - found[0]).max())
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.2)


def test_forces_of_the_bushings_balance_the_piston():
    # At rest, across a leg between ideal joints: bushings, weight and the platform's force; their moments about the
    # gland. A thrust of 2 kN at deflections of 0.1 mm is 0.2 N m of 30.
    robot = machine(guide=bushings(2e8), cylinder=BENDING)
    run = fx.run(study(robot, step=1e-3, duration=0.01))
    data = run.isel(time=0)
    # What check says of the pose is what a run begins with, and both find the largest of them
    pressed = np.linalg.norm(data.guide_force.values, axis=-1)
    np.testing.assert_allclose(describe(study(robot)).poses[0].bushings, pressed, rtol=1e-6)
    words = bodies_words(run)[-1]
    assert re.fullmatch(r"The glands bear up to [\d.]+ k?N across \(leg \d at t = .*?\), heads bear .*\.", words)
    told = replay(study(robot, step=1e-3, duration=0.01), run)
    (heads,) = (trace["take"] for trace in told["traces"] if trace.get("name") == "pistons in bushings")
    shape = [int(n) for n in told["points"]["shape"].split(",")]
    rows = np.frombuffer(base64.b64decode(told["points"]["bdata"]), dtype="<f4").reshape(shape)
    ends = rows[0, [take for take in heads if take >= 0]].reshape(6, 2, 3)
    motion = RobotMotion(study(robot), run)
    drawn = motion.instant_at(0.0, motion.automatic_scale()).flexible.heads
    np.testing.assert_allclose(ends, 1e3 * drawn, atol=1e-3)  # 32 bit floats of 1 m in mm
    turning = fx.parts(robot).guide_turning.values[0]
    d, EI = float(data.guide_overlap[0]), robot.legs[0].piston.EI
    assert turning == pytest.approx(1 / (d / (3 * EI) + 2 / 2e8 / d**2), rel=1e-3)  # the leg sags by some micrometres
    piston, length = robot.legs[0].piston, data.leg_length.values
    limbs = fx.kinematics.rigid_limbs(robot)
    for i in range(6):
        base, tip = limbs.base[i], limbs.platform[i]
        R = fx.kinematics.rotations.matrix(data.platform_quaternion.values)
        centre = data.com_position.values - R @ robot.com
        axis = centre + R @ tip - base
        axis /= np.linalg.norm(axis)
        turn = limbs.frames[i]
        alpha, beta = data.leg_angle.values[i]
        x = turn @ [np.cos(beta), np.sin(alpha) * np.sin(beta), -np.cos(alpha) * np.sin(beta)]
        y = turn @ [0.0, np.cos(alpha), np.sin(alpha)]
        weight = piston.mass * robot.gravity
        gland, head = data.guide_force.values[i]
        d, s = float(data.guide_overlap[i]), length[i] - 0.6
        for k, way in enumerate((x, y)):
            end = -data.joint_force.values[i] @ way
            assert gland[k] + head[k] + end + weight @ way == pytest.approx(0, abs=0.05)
            assert -d * head[k] + s * end + (s - piston.length / 2) * (weight @ way) == pytest.approx(0, abs=0.2)


@pytest.mark.parametrize("part", ["guide", "cylinder"])
def test_a_part_made_ideal_takes_its_row_along(part):
    # 3-RPS: hinges load their legs across, so both parts count at first order. What is left but second order is the
    # bending of the rod between the bushings, which turns the thrust: below 2 % of the row.
    alone = {"guide": bushings(2e7)}
    if part == "cylinder":
        tube, rigid = Tube(diameter=0.05, inner_diameter=0.045), three_rps().legs[0].cylinder
        alone["cylinder"] = Cylinder.tube(mouth=rigid.mouth, section=tube, material=MATERIALS["aluminium"])
    robot = with_legs(three_rps(), **alone)
    off = alone["cylinder"].replace(diameter=None, inner_diameter=None, material=None) if part == "cylinder" else None
    whole, without = (fx.budget(x).budget.sel(kind="systematic") for x in (robot, with_legs(robot, **{part: off})))
    gone = whole.sel(part=part).values[:3]
    np.testing.assert_allclose(
        whole.sum("part").values[:3] - gone, without.sum("part").values[:3], atol=0.02 * np.abs(gone).max()
    )


def test_loads_at_many_lengths_lie_between_those_of_some():
    # Between 17 lengths loads are interpolated: Delta^2 / 8 of a load that falls as one over the square of s, 6 / s^2
    # of itself, at a free length of 0.4 m: 6e-4. Every leg has lengths of its own.
    robot = machine(guide=bushings(1e8))
    length = np.linspace(robot.home_lengths - 0.1, robot.home_lengths + 0.1, 40) + 0.002 * np.arange(6)
    one_by_one = np.concatenate([leg_loads(robot, row[None]) for row in length[::7]])
    np.testing.assert_allclose(leg_loads(robot, length)[::7], one_by_one, rtol=1e-3)
    assert np.ptp(one_by_one[:, 0]) > 0.2 * one_by_one[0, 0]


@pytest.mark.parametrize(
    ("change", "area", "length", "on"),
    [
        ({"mouth": 0.3}, 0.05**2 - 0.045**2, 0.3, 2.0),
        ({"diameter": 0.055}, 0.055**2 - 0.045**2, 0.25, 2.0),
        ({"body": Mounted(mass=1.0, com=0.1)}, 0.05**2 - 0.045**2, 0.25, 1.0),
    ],
)
def test_a_tube_has_the_masses_of_its_section(change, area, length, on):
    tube = Tube(diameter=0.05, inner_diameter=0.045)
    whole = Cylinder.tube(mouth=0.25, section=tube, material=MATERIALS["aluminium"], body=Mounted(mass=2.0, com=0.1))
    assert Cylinder(**{name: getattr(whole, name) for name in type(whole).model_fields}) == whole
    found, own = whole.replace(**change), 2700.0 * np.pi / 4 * area * length
    assert found.mass == pytest.approx(own + on, rel=1e-14)  # rounding
    assert found.com == pytest.approx((own * length / 2 + on * 0.1) / (own + on), rel=1e-14)
    with pytest.raises(InputError, match="the section, with what is mounted"):
        whole.replace(mass=3.0)


def test_clearance_lets_a_pinned_leg_lean():
    # (T25.17) against the exact distance of the joints of two rigid bodies with a kink; and its row of the budget.
    robot = machine(guide=bushings(1e8, clearance=1e-3))
    leg, length = robot.legs[0], robot.home_lengths[0]
    d, m = leg.overlap(length), leg.cylinder.mouth
    lean = np.arcsin(1e-3 / d)
    tip = np.array([-0.5e-3, length - leg.piston.length]) + leg.piston.length * np.array([np.sin(lean), np.cos(lean)])
    exact = np.linalg.norm(tip) - length
    assert abs(exact) == pytest.approx(Clearance.of(leg).shorter(leg, length), rel=1e-3)
    assert m - d == pytest.approx(length - leg.piston.length)
    row = fx.budget(robot).budget.sel(part="guide play", kind="hysteretic").values
    assert 0 < np.abs(row[:3]).max() < 10 * 6 * abs(exact)
    assert part_words("guide play") == "play of the guides"
    with pytest.raises(InputError, match=r"across.*Leave clearance out"):
        with_legs(three_rps(), guide=bushings(1e8, clearance=1e-5))


@pytest.mark.parametrize("parts", [{"guide": bushings(1e8)}, {"cylinder": BENDING}])
def test_decks_and_engines_refuse_what_they_do_not_write(parts):
    with pytest.raises(InputError, match="decks"):
        abaqus_deck(machine(**parts))
    with pytest.raises(InputError, match="Exudyn"):
        RobotProblem(robot=machine(**parts), motion=None, integration=None, elements=0, guide=0.0)


def test_whole_legs_buckle_as_their_parts_say():
    # Clamped in a rigid cylinder: the closed form of (T8.11), at three shapes to 2e-5.
    plain = machine()
    length = plain.home_lengths[None]
    theirs = np.array(
        [buckling_load(leg, x - np.array([0.6]))[0] for leg, x in zip(plain.legs, length[0], strict=True)]
    )
    np.testing.assert_allclose(leg_loads(plain, length)[0], theirs, rtol=2e-5)
    loads = [leg_loads(machine(**more), length)[0, 0] for more in (
        {"guide": bushings(1e12)}, {"guide": bushings(1e8)}, {"guide": bushings(1e8), "cylinder": BENDING},
    )]  # fmt: skip
    assert theirs[0] > loads[0] > loads[1] > loads[2]
    described = describe(study(machine(guide=bushings(1e8), cylinder=BENDING)))
    assert described.legs[0].euler_load == pytest.approx(loads[2], rel=0.1)  # along the path, legs get longer


def test_a_planar_robot_in_bushings_runs():
    robot = with_legs(planar(), guide=bushings(2e7), cylinder=Cylinder.tube(
        mouth=0.1, section=Tube(diameter=0.04, inner_diameter=0.03), material=MATERIALS["steel"]))  # fmt: skip
    found = fx.modes(robot).frequency.values
    assert np.isfinite(found).all() and found[0] > 0


@pytest.mark.parametrize(("table", "key"), [
    ('guide = { gland = "-1 N/um", head = "1 N/um" }', "guide.gland"),
    ('guide = { gland = "1 N/um" }', "guide.head"),
    ('guide = { gland = "1 N/um", head = "1 N/um", damping = 1, loss = 0.1 }', "guide.loss"),
    ('guide = { gland = "1 N/um", head = "1 N/um", clearance = "-1 um" }', "guide.clearance"),
    ('cylinder = { mass = "3 kg", mouth = "315 mm", diameter = "60 mm", material = "steel" }', "cylinder.mass"),
    ('cylinder = { mouth = "315 mm", diameter = "60 mm", inner_diameter = "60 mm", material = "steel" }',
     "cylinder.inner_diameter"),
    ('cylinder = { mouth = "50 mm", diameter = "60 mm", material = "steel" }', "cylinder.diameter"),
    ('cylinder = { mouth = "315 mm", material = "steel" }', "cylinder.diameter"),
])  # fmt: skip
def test_bad_input_is_refused(tmp_path, table, key):
    text = fx.model.preset_text("paper-robot")
    lines = [line for line in text.splitlines() if not line.startswith(table.split(" =")[0])]
    at = next(i for i, line in enumerate(lines) if line.startswith("[leg]"))
    path = tmp_path / "robot.toml"
    path.write_text("\n".join([*lines[: at + 1], table, *lines[at + 1 :]]), encoding="utf-8")
    with pytest.raises(InputError, match=key.split(".")[1]):
        fx.load(path)


def test_an_overlap_that_is_gone_at_full_stroke_is_refused():
    leg = machine().legs[0]
    with pytest.raises(InputError, match=r"-0\.05 m"):
        leg.replace(guide=bushings(1e8), stroke=fx.model.Stroke(min=0.9, max=1.4))


@pytest.mark.parametrize("drive", [PrescribedDrive(), ServoDrive(stiffness=2e8)])
def test_a_tube_stretches_up_to_where_its_drive_pushes(drive):
    # Its bottom is where the piston's inner end is at the least stroke: 0.9 less 0.75 m. As a spring of E A / 0.15 m.
    robot = machine(drive=drive, cylinder=BENDING, stroke=fx.model.Stroke(min=0.9, max=1.4))
    stiffness = MATERIALS["steel"].E * TUBE_SECTION.area / 0.15
    np.testing.assert_allclose(fx.parts(robot).part_stiffness.sel(part="cylinder"), stiffness, rtol=1e-12)
    spring = AxialSpring(name="tube", stiffness=stiffness)
    same = machine(drive=drive, cylinder=BENDING, springs=(spring,))
    found, theirs = (fx.stiffness(study(x, fidelity="lumped")).stiffness for x in (robot, same))
    np.testing.assert_allclose(found, theirs, rtol=1e-9, atol=1e-9 * float(np.abs(theirs).max()))
    assert machine(drive=ForceDrive(feedback=None), cylinder=BENDING, stroke=robot.legs[0].stroke).legs[0].pressed == 0


TUBE_EI, TUBE_RHO = 3e4, 6.0
SIDE = 4e-3  # of the bars that stand for tube and rod: no shear, no rotary inertia


def deck(given, length, elements):
    """Two beams of bars, pinned at both ends, in springs: in one plane."""
    mouth, head = given["mouth"], length - given["Lp"]
    tube = np.concatenate([np.linspace(0, head, elements), np.linspace(head, mouth, elements // 3)[1:]])
    rod = np.concatenate([np.linspace(head, mouth, elements // 3), np.linspace(mouth, length, elements)[1:]])
    k, lines = tube.size, ["*NODE,NSET=ALL"]
    lines += [f"{i + 1},0,0,{z:.12g}" for i, z in enumerate([*tube, *rod])]
    for name, first, count, stiffness, mass in (("TUBE", 1, k, TUBE_EI, TUBE_RHO), ("ROD", k + 1, rod.size, EI, RHO)):
        lines += [f"*ELEMENT,TYPE=B31,ELSET={name}", *(f"{i},{i},{i + 1}" for i in range(first, first + count - 1)),
                  f"*MATERIAL,NAME={name}", "*ELASTIC", f"{12 * stiffness / SIDE**4:.9g},0", "*DENSITY",
                  f"{mass / SIDE**2:.9g}", f"*BEAM SECTION,ELSET={name},MATERIAL={name},SECTION=RECT",
                  f"{SIDE},{SIDE}", "1,0,0"]  # fmt: skip
    for j, (of_tube, of_rod, stiffness) in enumerate(((k, k + elements // 3, GLAND), (elements, k + 1, HEAD))):
        lines += [f"*ELEMENT,TYPE=SPRING2,ELSET=S{j}", f"{9000 + j},{of_tube},{of_rod}", f"*SPRING,ELSET=S{j}", "1,1",
                  f"{stiffness}"]  # fmt: skip
    lines += ["*BOUNDARY", "ALL,2,2", "ALL,4,4", "ALL,6,6", "1,1,3", f"{k + rod.size},1,1", f"{k + 1},3,3",
              "*STEP", "*FREQUENCY", "5", "*END STEP"]  # fmt: skip
    return "\n".join(lines) + "\n"


@pytest.mark.skipif(not CALCULIX.is_available(), reason="needs CalculiX")
@pytest.mark.parametrize("overlap", [0.12, 0.2])
def test_a_cylinder_that_bends_by_calculix(overlap):
    # Straight elements bend too stiffly by some (length of an element)^2: 5e-4 of a frequency with sixty of them; ours
    # are right to 1e-5 (`test_flexible_cylinder.py`).
    length, mass = MOUTH + 0.6, TUBE_RHO * MOUTH
    given = bare(
        Lp=0.6 + overlap, guide_reach=length + overlap, gravity=np.zeros(3), guide_stiffness=[GLAND, HEAD], EI=EI,
        guide_EI=EI, rhoA=RHO, guide_rhoA=RHO, cylinder_EI=TUBE_EI, cylinder_rhoA=TUBE_RHO, cylinder_mass=mass,
        cylinder_inertia=mass * MOUTH**2 / 12,
    )  # fmt: skip
    lateral, tube = lateral_basis("tip-load", 6), lateral_basis("tip-load", 4, moment=True)
    ours = layout(a=lateral, b=lateral, axial=axial_basis(0), guide=lateral_basis("tip-load", 3), cylinder=tube)
    found = np.sqrt(eigh(*pinned(ours, given, length)[::-1], eigvals_only=True)[::2][:4]) / (2 * np.pi)
    np.testing.assert_allclose(found, calculix.run(deck(given, length, 60)).frequencies()[:4], rtol=1e-3)


def test_a_cylinder_without_mass_in_its_guides_is_named():
    """It turns beside its piston: modes said that "a leg bends so far under its load", of a leg that hardly does."""
    light = Cylinder(mass=0.0, inertia=0.0, com=0.0, mouth=0.6)
    robot = machine(guide=Guide(gland=2e8, head=2e8), cylinder=light)
    with pytest.raises(
        fx.ComputationError, match="the cylinder of leg 1 has no mass, and turns in its guide"
    ) as refused:
        fx.modes(study(robot))
    assert "leg.cylinder a mass and an inertia" in refused.value.next_step
    many = fx.modes(study(robot), {"heave": [0.0, 0.02]})
    assert set(many.reason.values) == {many.reason.attrs["flag_meanings"].split().index("no_mass")}
    assert np.isfinite(fx.modes(study(machine(guide=Guide(gland=2e8, head=2e8)))).frequency).all()
