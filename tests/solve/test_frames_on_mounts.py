"""Base and platform on springs: closed forms, limits, compliances that add up, plates without mass, energy, causes."""

import base64

import numpy as np
import pytest
from scipy.linalg import eigh
from tests.helpers.layouts import layout
from tests.helpers.legs_of_all_kinds import rotation
from tests.helpers.machines import BASE, SOFT, TOP, K, light, machine, study
from tests.helpers.mechanisms import ROBOTS
from tests.helpers.runs import balance, run_robot

import flexapod as fx
from flexapod.analysis.results.attributes import result_study
from flexapod.common.errors import InputError
from flexapod.kinematics.rotations import displace_pose, quaternion
from flexapod.mechanics.elements.mount import PlatformMounting
from flexapod.mechanics.elements.slot import Slot
from flexapod.mechanics.leg.kernel_functions import payload_functions
from flexapod.mechanics.shapes import axial_basis, lateral_basis
from flexapod.mechanics.symbolic.functions import Interpreted
from flexapod.model import AxialSpring, loads, preset, to_toml
from flexapod.model.leg.joint import Joint
from flexapod.model.study.mount import BaseMotion, Mount
from flexapod.output.exchange.pose_deck import abaqus_deck, deck_omissions
from flexapod.output.report.replay import replay
from flexapod.output.scene.geometry import RobotMotion
from flexapod.solve.statics.buckling import leg_loads

pytestmark = pytest.mark.consistency

NONE = lateral_basis("clamped-free", 0)


def cross(x):
    return np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])


def carried(points):
    """Displacement of points by that of a frame and its turn about the origin, (n, 3, 6)."""
    return np.array([np.hstack([np.eye(3), -cross(x)]) for x in points])


def closed_form(robot, mounts):
    """Frequencies [Hz] of payload and plates on springs: three bodies, the legs' stretch between the plates."""
    base, top = robot.home_bases, robot.home_tips
    com = robot.home_position + robot.com
    n = robot.home_vectors / robot.home_lengths[:, None]
    k = [leg.piston.EA / leg.piston.length for leg in robot.legs]
    bodies = [("payload", com), *((name, mount.at) for name, mount in mounts.items())]
    at = {name: slice(6 * i, 6 * i + 6) for i, (name, _) in enumerate(bodies)}
    M, S = np.zeros((2, 6 * len(bodies), 6 * len(bodies)))
    M[:3, :3], M[3:6, 3:6] = robot.payload.mass * np.eye(3), robot.payload.inertia
    stretch = np.zeros((6, len(M)))
    whole = np.zeros((6, 3, len(M)))
    if "base" in mounts:
        whole[..., at["base"]] -= carried(base - mounts["base"].at)
        S[at["base"], at["base"]] = mounts["base"].stiffness
        M[at["base"], at["base"]] = inertia(mounts["base"])
    whole[..., :6] += carried(top - com)
    if "top" in mounts:  # displaced from the payload: its joints move with both
        point = robot.home_position + mounts["top"].at
        whole[..., at["top"]] += carried(top - point)
        both = np.zeros((6, len(M)))
        both[:3, :6], both[3:, 3:6], both[:, at["top"]] = carried([point - com])[0], np.eye(6)[3:, 3:], np.eye(6)
        M += both.T @ inertia(mounts["top"]) @ both
        S[at["top"], at["top"]] = mounts["top"].stiffness
    stretch = np.einsum("ix,ixk->ik", n, whole)
    return np.sqrt(eigh(S + stretch.T @ np.diag(k) @ stretch, M, eigvals_only=True)) / (2 * np.pi)


def inertia(mount):
    return np.block([[mount.mass * np.eye(3), np.zeros((3, 3))], [np.zeros((3, 3)), mount.inertia]])


@pytest.mark.parametrize(("names", "count"), [(("base",), 12), (("top",), 12), (("base", "top"), 18)])
def test_bodies_in_series_have_the_frequencies_of_the_closed_form(names, count):
    # Eigenvalues of the same matrices in other coordinates. Those of the dense ones have the rounding of the largest:
    # eps (f / f_1)^2, with f up to 70 times f_1 for two bodies and 150 times for three.
    mounts = {name: {"base": BASE, "top": TOP}[name] for name in names}
    robot = light(machine(), gravity=[0, 0, 0], base_mount=mounts.get("base"), platform_mount=mounts.get("top"))
    found = fx.modes(robot, fidelity="lumped").frequency.values
    assert len(found) == count
    np.testing.assert_allclose(found, closed_form(robot, mounts), rtol=1e-12 if count == 12 else 5e-12)


def test_compliances_of_mounts_and_legs_add_up_at_the_tool():
    robot = light(machine(), gravity=[0, 0, 0])
    tool = robot.home_position + robot.tool
    ours = np.linalg.inv(fx.stiffness(robot.replace(base_mount=BASE, platform_mount=TOP), fidelity="lumped").stiffness)
    legs = np.linalg.inv(fx.stiffness(robot, fidelity="lumped").stiffness)
    for mount, point in ((BASE, BASE.at), (TOP, robot.home_position + TOP.at)):
        T = np.eye(6)
        T[:3, 3:] = -cross(tool - point)
        legs = legs + T @ np.linalg.inv(mount.stiffness) @ T.T
    size = np.sqrt(np.outer(np.diag(legs), np.diag(legs)))
    np.testing.assert_allclose(ours / size, legs / size, atol=1e-12)


def test_the_sag_of_a_mount_is_weight_over_stiffness():
    # Rigid legs without mass; turning is stiff enough to add less than a millionth of what the spring sinks.
    mount = BASE.replace(stiffness=np.diag([2e6, 3e6, 5e6, 1e13, 1e13, 1e13]))
    robot = light(machine(), gravity=[0, 0, 0], base_mount=mount).replace(gravity=[0, 0, -9.81])
    weight = (robot.payload.mass + mount.mass) * np.array([0, 0, -9.81])
    found = fx.modes(robot, fidelity="rigid").com_sag.values
    np.testing.assert_allclose(found, weight / np.diag(mount.stiffness)[:3], rtol=1e-6, atol=1e-10)


@pytest.mark.parametrize("name", ["base_mount", "platform_mount"])
def test_endlessly_stiff_mounts_are_rigid_frames(name):
    # Legs of 4e8 N/m a metre away from a spring of 1e15 N m/rad, the largest that a study takes: 4e-7 each.
    stiff = Mount(stiffness=np.diag([1e17] * 3 + [1e15] * 3))
    ideal, held = machine(), machine().replace(**{name: stiff})
    for compute, value in ((fx.stiffness, "stiffness"), (fx.modes, "frequency")):
        ours, theirs = (compute(robot, fidelity="lumped")[value].values for robot in (held, ideal))
        size = np.sqrt(np.outer(np.diag(theirs), np.diag(theirs))) if theirs.ndim == 2 else theirs
        np.testing.assert_allclose(ours[: len(theirs)] / size, theirs / size, atol=2e-6)


def test_rigid_legs_on_a_mount_are_one_body():
    # Without masses in the legs: the payload and the plate, one rigid body on six springs.
    robot = light(machine(), gravity=[0, 0, 0], base_mount=BASE)
    T = np.eye(6)
    T[:3, 3:] = -cross(robot.home_position + robot.com - BASE.at)
    payload = np.zeros((6, 6))
    payload[:3, :3], payload[3:, 3:] = robot.payload.mass * np.eye(3), robot.payload.inertia
    expected = np.sqrt(eigh(BASE.stiffness, inertia(BASE) + T.T @ payload @ T, eigvals_only=True)) / (2 * np.pi)
    np.testing.assert_allclose(fx.modes(robot, fidelity="rigid").frequency.values, expected, rtol=1e-11)


@pytest.fixture(scope="module")
def shaken():
    """A run on both mounts by name of its step, the plate below the payload without mass."""
    damped = {"loss": 0.02}
    robot = machine().replace(
        base_mount=BASE.replace(**damped), platform_mount=TOP.replace(mass=0.0, inertia=np.zeros((3, 3)), **damped)
    )
    return {h: fx.run(study(robot, fidelity="lumped", step=h)) for h in (1e-3, 5e-4, 2.5e-4)}


def test_energy_is_kept_to_the_second_order(shaken):
    misses = []
    for data in shaken.values():
        kept = data.energy_kinetic + data.energy_potential + data.energy_strain + data.energy_dissipated
        kept = kept - data.work_drive - data.work_external
        misses.append(float(np.abs(kept - kept[0]).max()))
    assert misses[0] / misses[1] > 3
    assert misses[1] / misses[2] > 3
    assert float(shaken[5e-4].energy_dissipated[-1]) > 0


def test_causes_add_up_and_name_the_mounts(shaken):
    data = shaken[2.5e-4]
    assert {"base_mount", "platform_mount"} < set(data.cause.values)
    # Of first order in 100 um of 1 m: what is left is 1e-4 of the whole.
    assert np.abs(data.deviation_residual).max() < 1e-3 * np.abs(data.com_deviation).max()
    at = data.com_position_rigid.values - BASE.at
    moved = data.base_mount_displacement.values + np.cross(data.base_mount_rotation.values, at)
    share = data.deviation_by_cause.sel(cause="base_mount").sum("leg").values
    np.testing.assert_allclose(share, moved, atol=2e-3 * np.abs(moved).max())


def test_a_plate_without_mass_is_the_limit_of_a_light_one(shaken):
    h = 1e-3
    light_one = shaken[h].attrs and fx.run(
        study(machine().replace(base_mount=BASE.replace(loss=0.02), platform_mount=TOP.replace(
            mass=1e-3, inertia=1e-4 * np.eye(3), loss=0.02)), fidelity="lumped", step=h)
    )  # fmt: skip
    # A gram beside a ton.
    np.testing.assert_allclose(light_one.com_position, shaken[h].com_position, atol=1e-5 * 20e-6)


def test_the_readable_time_loop_does_the_same(shaken, monkeypatch):
    from flexapod.solve.time import march

    monkeypatch.setattr(march, "_loop", lambda _: march.interpreted)
    start = study(machine().replace(base_mount=BASE, platform_mount=TOP), fidelity="lumped", step=1e-3, duration=0.01)
    slow = run_robot(start)
    monkeypatch.undo()
    quick = run_robot(start)
    # Newton's method ends at other roundings: a few of the stiffest force over the softest spring.
    np.testing.assert_allclose(slow["pose"], quick["pose"], atol=1e-11)
    np.testing.assert_allclose(balance(slow), balance(quick), rtol=1e-9)


@pytest.mark.parametrize("kind", ["3-RPS", "6-RUS"])
def test_robots_of_other_kinds_stand_on_mounts(kind):
    ideal = ROBOTS[kind]()
    robot = ideal.replace(base_mount=BASE, platform_mount=TOP.replace(mass=0.0, inertia=np.zeros((3, 3))))
    soft, stiff = (fx.modes(x, fidelity="lumped").frequency.values for x in (robot, ideal))
    assert soft[0] < stiff[0]
    data = fx.run(study(robot, fidelity="lumped", step=1e-3, duration=0.05))
    kept = data.energy_kinetic + data.energy_potential + data.energy_strain + data.energy_dissipated
    kept = kept - data.work_drive - data.work_external
    assert float(np.abs(kept - kept[0]).max()) < 1e-3 * float(data.energy_kinetic.max() + data.energy_strain.max())
    assert float(data.closure_residual.max()) < 1e-13


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"stiffness": np.diag([1e8, 1e8, 0, 1e6, 1e6, 1e6])}, "is of no mount"),
        ({"stiffness": K + np.triu(K, 1)}, "is of no mount"),
        ({"stiffness": K, "damping": -K}, "is of no mount"),
        ({"stiffness": K, "loss": 0.1, "damping": 1e-4 * np.diag(np.diag(K))}, "together with damping"),
        ({"stiffness": K, "inertia": -np.eye(3)}, "is of no body"),
    ],
)
def test_what_is_no_mount_is_refused(fields, words):
    with pytest.raises(InputError, match=words):
        Mount(**fields)


def test_frames_do_not_leave_the_plane_of_a_robot():
    with pytest.raises(InputError, match="cannot leave the plane"):
        ROBOTS["planar 3-RPR"]().replace(base_mount=BASE)


@pytest.mark.parametrize("seed", range(3))
def test_the_plate_below_the_payload_keeps_the_balance_of_power(seed):
    # d(T + V)/dt is the power of what is left of the balances; differences of fourth order leave 1e-9.
    ours, rng = (
        layout(a=NONE, b=NONE, axial=axial_basis(0), elements=(Slot(PlatformMounting),)),
        np.random.default_rng(seed),
    )
    residual, _, energies = (Interpreted(f) for f in payload_functions(ours))
    J = rng.normal(size=(2, 3, 3))
    p = np.concatenate([[7.0], (J[0] @ J[0].T).ravel(), [1, 2, -9], [0.1, 0.2, 0.3], [3.0], [2.0],
                        (J[1] @ J[1].T).ravel(), [0.1, -0.2, 0.3]])  # fmt: skip
    u, u_dot, m, v, a = rng.normal(size=(5, 6))
    pose = np.concatenate([rng.normal(size=3), quaternion(rotation(rng))])

    def energy(h):
        now = u + h * u_dot
        step = np.concatenate([h * u[:3] + h**2 / 2 * u_dot[:3], h * u[3:] + h**2 / 2 * u_dot[3:]])
        return energies(displace_pose(pose, step), now, p, m + h * v + h**2 / 2 * a, v + h * a)[0].sum()

    r, _ = residual(pose, u, u_dot, np.zeros(6), np.zeros(6), p, m, v, a)
    h = 1e-3
    change = (8 * (energy(h) - energy(-h)) - (energy(2 * h) - energy(-2 * h))) / (12 * h)
    assert change == pytest.approx(np.concatenate([u, v]) @ r, rel=1e-7)


@pytest.mark.parametrize("seed", range(3))
def test_a_plate_that_holds_still_under_the_payload_is_one_body_with_it(seed):
    """Newton and Euler of both bodies by hand; the power alone does not see what is square in the rate of turning."""
    ours, rng = (
        layout(a=NONE, b=NONE, axial=axial_basis(0), elements=(Slot(PlatformMounting),)),
        np.random.default_rng(seed),
    )
    residual = Interpreted(payload_functions(ours)[0])
    J, J_plate = (x @ x.T for x in rng.normal(size=(2, 3, 3)))
    mass, plate, weighs, gravity, at = 7.0, 3.0, 2.0, np.array([1.0, 2.0, -9.0]), np.array([0.1, -0.2, 0.3])
    p = np.concatenate([[mass], J.ravel(), gravity, np.zeros(3), [plate, weighs], J_plate.ravel(), at])
    u, u_dot, R = rng.normal(size=6), rng.normal(size=6), rotation(rng)
    pose, none = np.concatenate([rng.normal(size=3), quaternion(R)]), np.zeros(6)
    r, _ = residual(pose, u, u_dot, none, none, p, none, none, none)
    w, spun = u[3:], u_dot[3:]
    # The plate's centre of mass is where the mount is; forces on the payload in world axes, all else in platform axes.
    there = R.T @ u_dot[:3] + np.cross(spun, at) + np.cross(w, np.cross(w, at))
    held = plate * there - weighs * R.T @ gravity
    own = J_plate @ spun + np.cross(w, J_plate @ w)
    force = mass * (u_dot[:3] - gravity) + R @ held
    moment = J @ spun + np.cross(w, J @ w) + own + np.cross(at, held)
    np.testing.assert_allclose(r, [*force, *moment, *held, *own], atol=1e-12 * np.abs(r).max())


def test_a_mount_is_the_same_when_read_again():
    given = preset("paper-robot")
    given = given.replace(robot=given.robot.replace(base_mount=BASE, platform_mount=TOP.replace(loss=0.01)))
    assert loads(to_toml(given)).robot == given.robot


def test_parts_list_what_a_mount_gives_along_each_leg():
    robot = machine().replace(base_mount=BASE, platform_mount=TOP)
    data = fx.parts(robot)
    n = robot.home_vectors / robot.home_lengths[:, None]
    C = np.linalg.inv(BASE.stiffness)
    for i, joint in enumerate(robot.home_bases):
        wrench = np.concatenate([n[i], np.cross(joint - BASE.at, n[i])])
        moved = C @ wrench
        give = n[i] @ (moved[:3] + np.cross(moved[3:], joint - BASE.at))
        assert 1 / float(data.part_stiffness.sel(part="base_mount")[i]) == pytest.approx(give, rel=1e-12)
    assert (data.part_stiffness.sel(part="platform_mount") > 0).all()
    # All legs share a mount: what a leg has in series is without them, and the words of both say so.
    np.testing.assert_allclose(data.leg_stiffness, fx.parts(machine()).leg_stiffness, rtol=1e-12)
    assert "mounts left out" in data.leg_stiffness.attrs["long_name"]
    assert "mount as if alone" in data.part_stiffness.attrs["long_name"]


def test_modes_of_a_heavy_plate_are_those_of_the_base():
    robot = machine().replace(base_mount=BASE.replace(mass=1e5, inertia=1e4 * np.eye(3)))
    found = fx.modes(robot, fidelity="lumped")
    assert list(found.kind.values[:6]).count("base") >= 5
    # Legs follow base and payload: their stretch over the first modes is what both leave between the joints.
    assert "payload" in found.kind.values


def test_the_static_budget_has_a_row_for_each_mount():
    robot = machine().replace(base_mount=BASE, platform_mount=TOP)
    ours = study(robot, fidelity="lumped")
    data = fx.budget(ours)
    assert {"base_mount", "platform_mount"} <= set(data.part.values)
    whole = data.budget_total.sel(kind="systematic").values
    ideal = fx.budget(ours.replace(robot=robot.replace(base_mount=None)))
    row = data.budget.sel(part="base_mount", kind="systematic").values
    rest = ideal.budget_total.sel(kind="systematic").values
    assert np.abs(whole - row - rest)[:3].max() < 0.02 * np.abs(row[:3]).max()
    # The same sag by modes, and by the run's start.
    assert fx.modes(robot, fidelity="lumped").com_sag.values == pytest.approx(
        fx.run(ours.replace(simulation=ours.simulation.replace(step=1e-3, tolerance=None, duration=2e-3)))
        .com_deviation.values[0], abs=1e-12)  # fmt: skip


def test_a_frame_that_gives_way_joint_by_joint_is_a_spring_of_the_joints():
    # Compliance c of each base joint in world axes: in the leg 1/k = n^T c n, to first order in what it gives.
    stiffness = np.diag([3e8, 2e8, 5e8, 0, 0, 0])
    robot = light(machine(), gravity=[0, 0, 0])
    n = robot.home_vectors / robot.home_lengths[:, None]
    soft = [leg.replace(base_joint=Joint(stiffness=stiffness)) for leg in robot.legs]
    k = 1 / np.einsum("ix,x,ix->i", n, 1 / np.diag(stiffness)[:3], n)
    springs = [leg.replace(springs=(AxialSpring(name="frame", stiffness=float(x), at="base"),))
               for leg, x in zip(robot.legs, k, strict=True)]  # fmt: skip
    ours, theirs = (fx.stiffness(robot.replace(legs=tuple(x)), fidelity="lumped").stiffness for x in (soft, springs))
    np.testing.assert_allclose(ours, theirs, atol=1e-9 * float(np.abs(theirs).max()))


def test_plates_are_drawn_where_the_legs_end(shaken):
    data = shaken[5e-4]
    given = result_study(data)
    motion = RobotMotion(given, data)
    for time in data.time.values[[0, 80, -1]]:
        drawn, at = motion.instant_at(float(time), 1.0), data.sel(time=time)
        far = np.linalg.norm(drawn.flexible.platform - drawn.flexible.base, axis=1)
        # Pistons are as long as they are; turns of 1e-5 rad, squared, and what joints give way: nothing here.
        np.testing.assert_allclose(far, at.leg_length, rtol=0, atol=1e-9)
        assert not drawn.rigid.plates.any()
    first, moved = motion.instant_at(0.1, 1.0).flexible, motion.instant_at(0.1, 100.0).flexible
    np.testing.assert_allclose(moved.plates, 100 * first.plates)
    told = replay(given, data)
    base = next(trace for trace in told["traces"] if trace.get("name") == "base")["take"]
    shape = [int(n) for n in told["points"]["shape"].split(",")]
    rows = np.frombuffer(base64.b64decode(told["points"]["bdata"]), dtype="<f4").reshape(shape)
    assert np.ptp(rows[:, base], axis=0).max() > 1.0  # mm, as drawn


@pytest.mark.parametrize("name", ["base_mount", "platform_mount"])
def test_decks_and_engines_do_not_take_mounts(name):
    robot = machine().replace(**{name: BASE})
    with pytest.raises(InputError, match=f"not written to decks.*leg.{name[:-6]}_joint.stiffness"):
        abaqus_deck(robot)


def test_decks_say_what_they_leave_out():
    shake = BaseMotion(time=np.array([0.0, 1.0]), values=np.zeros((2, 6)))
    robot = machine(base_joint=SOFT.replace(play=1e-5)).replace(base_motion=shake)
    assert deck_omissions(robot) == ["damping", "play", "robot.base_motion: the base is at rest"]


def test_a_plate_without_mass_between_joints_and_mount_that_give_way():
    # Nothing has a mass between the springs of the joints and those of the mounts.
    bare = {"mass": 0.0, "inertia": np.zeros((3, 3))}
    soft = machine(base_joint=SOFT, platform_joint=SOFT)
    robot = soft.replace(base_mount=BASE.replace(**bare), platform_mount=TOP.replace(**bare))
    heavy = soft.replace(
        base_mount=BASE.replace(mass=1e-4, inertia=1e-4 * np.eye(3)),
        platform_mount=TOP.replace(mass=1e-4, inertia=1e-4 * np.eye(3)),
    )
    ours, theirs = (fx.modes(x, fidelity="lumped").frequency.values[:6] for x in (robot, heavy))
    np.testing.assert_allclose(ours, theirs, rtol=1e-6)  # 1e-4 kg of a ton
    data, other = (fx.run(study(x, fidelity="lumped", step=1e-3, duration=0.05)) for x in (robot, heavy))
    assert data.com_deviation.values[0] == pytest.approx(fx.modes(robot, fidelity="lumped").com_sag.values, abs=1e-12)
    np.testing.assert_allclose(
        data.com_deviation, other.com_deviation, atol=1e-5 * float(np.abs(other.com_deviation).max())
    )


def test_maps_take_the_plates_along():
    # The stiffness of a map is that of a pose; most of what accelerates is the payload, whose centre is the tool.
    robot = machine().replace(base_mount=BASE, platform_mount=TOP.replace(mass=0.0, inertia=np.zeros((3, 3))))
    found = fx.workspace_map(robot, {"heave": [0.0, 0.02]}, fidelity="lumped", acceleration=[0, 0, 1.0])
    here = fx.stiffness(robot, fidelity="lumped")
    C = np.linalg.inv(here.stiffness.values)
    assert float(found.stiffness[0]) == pytest.approx(1 / C[2, 2], rel=1e-9)
    payload = robot.payload.mass * np.linalg.norm(C[:3, 2])
    assert float(found.dynamic_deviation[0]) == pytest.approx(payload, rel=0.2)
    assert float(found.dynamic_deviation[0]) > payload


@pytest.mark.usefixtures("uncompiled")
def test_legs_buckle_as_without_mounts():
    """Their matrices have the coordinates of the plates, which read more; that was forgotten once."""
    robot = machine()
    length = robot.home_lengths[None]
    alone = leg_loads(robot, length)
    assert np.isfinite(alone).all()
    assert leg_loads(robot.replace(base_mount=BASE), length) == pytest.approx(alone, rel=1e-9)
    assert leg_loads(robot.replace(base_mount=BASE, platform_mount=TOP), length) == pytest.approx(alone, rel=1e-9)
