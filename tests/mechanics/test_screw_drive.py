"""Screws as drives: limits, frequencies in closed form, sag, causes, energy, one number from every solver."""

import numpy as np
import pytest
from tests.helpers.machines import (
    BEARING,
    EVERYTHING,
    NUT,
    SCREW,
    SOFT,
    STILL,
    light,
    machine,
    stiffness,
    study,
    symmetric,
)
from tests.helpers.mechanisms import ROBOTS, three_rps
from tests.helpers.runs import balance, run_robot

import flexapod as fx
from flexapod.common.errors import InputError
from flexapod.model import AxialSpring, AxisMotion, Feedback, Joint, PrescribedDrive, ServoDrive, Simulation, Study

pytestmark = pytest.mark.consistency

NEVER = 1e17  # N/m


def endless(**more):
    """A screw that does not give way."""
    stiff = {"root_diameter": 1e3, "bearing": BEARING.replace(stiffness=NEVER), "nut": NUT.replace(stiffness=NEVER)}
    return SCREW.replace(**stiff | more)


@pytest.mark.parametrize("fidelity", ["lumped", "assumed-modes"])
def test_an_endlessly_stiff_screw_is_a_prescribed_stroke(fidelity):
    # Shares in a leg's compliance: 4.4e8 over a fifth of 1e17 N/m; and rounding of these.
    for compute, name in ((fx.stiffness, "stiffness"), (fx.modes, "frequency")):
        ours, theirs = (compute(machine(**more), fidelity=fidelity)[name].values for more in ({"drive": endless()}, {}))
        size = np.sqrt(np.outer(np.diag(theirs), np.diag(theirs))) if theirs.ndim == 2 else theirs
        np.testing.assert_allclose(ours[: len(theirs)] / size, theirs / size, atol=3e-8)


def test_five_springs_at_the_nut_are_one():
    five = tuple(AxialSpring(name=f"s{k}", stiffness=5e8, damping=5e3) for k in range(5))
    one = (AxialSpring(name="one", stiffness=1e8, damping=1e3),)
    runs = [run_robot(study(machine(springs=x), fidelity="lumped", step=1e-3)) for x in (five, one)]
    # Parameters differ by rounding; the vibrations of 0.2 s leave that small.
    np.testing.assert_allclose(runs[0]["pose"], runs[1]["pose"], rtol=0, atol=1e-13)


@pytest.mark.parametrize("at", ["base", "nut", "platform"])
def test_a_spring_is_the_same_wherever_it_stands_beside_legs_without_mass(at):
    robot = light(machine(springs=(AxialSpring(name="one", stiffness=1e8, at=at),)), **STILL)
    ideal = fx.modes(light(machine(), **STILL), fidelity="lumped").frequency.values[:6]
    factor = np.sqrt(1 + 3.3e8 / 0.75 / 1e8)
    np.testing.assert_allclose(fx.modes(robot, fidelity="lumped").frequency.values[:6] * factor, ideal, rtol=1e-9)


def test_a_servo_and_springs_are_one_spring():
    servo = ServoDrive(stiffness=2e8, damping=4e4)
    springs = (AxialSpring(name="one", stiffness=2e8, damping=4e4),)
    series = ServoDrive(stiffness=1e8, damping=2e4)
    runs = [run_robot(study(machine(**x), fidelity="lumped", step=1e-3)) for x in
            ({"drive": servo, "springs": springs}, {"drive": series})]  # fmt: skip
    # The unknowns differ, and with them where Newton's method stops: below its tolerance for closures of 1e-12 m.
    np.testing.assert_allclose(runs[0]["pose"], runs[1]["pose"], rtol=0, atol=2e-12)
    # 4e-13 m times spring forces of 1e5 N.
    np.testing.assert_allclose(runs[0]["energy"], runs[1]["energy"], rtol=0, atol=1e-7)


def heave(robot):
    """Stiffness of the six legs against heave [N/m]."""
    return 6 / robot.home_lengths[0] ** 2 / (1 / stiffness(robot) + 0.75 / 3.3e8)


def test_a_locked_and_a_free_rotor():
    # All six rotors and the platform in heave: one axis with the leg's travel cos dz. k (1/M + 1/m), a brake locked:
    # k / M. The loop of the free one is next to nothing: 1e-4 N m/rad beside 6e7 N/m times (P / 2 pi)^2 = 150 N m/rad.
    loose = SCREW.replace(command="servo", loop=Feedback(stiffness=1e-4))
    locked, free = (light(symmetric(drive=drive, damping=0.0), **STILL) for drive in (SCREW, loose))
    k, mass, rotors = heave(locked), 1000.0, 6 * SCREW.inertia / SCREW.per_turn**2 / locked.home_lengths[0] ** 2
    found = fx.modes(locked, fidelity="lumped").frequency.values
    assert np.abs(found - np.sqrt(k / mass) / (2 * np.pi)).min() < 1e-7 * np.sqrt(k / mass)
    expected = np.sqrt(k * (1 / mass + 1 / rotors)) / (2 * np.pi)
    found = fx.modes(free, fidelity="lumped").frequency.values
    assert np.abs(found - expected).min() < 1e-6 * expected  # k changes with l by the loop's rest


def test_the_sag_of_a_symmetric_machine_is_a_sum_of_compliances():
    robot = light(symmetric(drive=SCREW, **EVERYTHING))
    data = fx.modes(robot, fidelity="lumped")
    cos = 1.0 / robot.home_lengths[0]
    whole = sum(1 / x for x in (stiffness(robot), 2e8, 2e8, 3.3e8 / 0.75))
    # What turns with the sag is in proportion to it over the height, 5e-5.
    assert data.com_sag.values[2] == pytest.approx(-1000 * 9.81 * whole / (6 * cos**2), rel=2e-4)


@pytest.mark.parametrize("fidelity", ["rigid", "lumped"])
def test_sag_from_a_run_and_from_statics(fidelity):
    robot = machine(drive=SCREW, **EVERYTHING)
    start = run_robot(study(robot, fidelity=fidelity, step=1e-3, duration=0.01))
    sag = start["pose"][0, :3] - robot.home_position - robot.com
    np.testing.assert_allclose(sag, fx.modes(robot, fidelity=fidelity).com_sag.values, atol=1e-12)


def test_stiffness_is_load_over_sag():
    robot = machine(drive=SCREW, **EVERYTHING)
    push = np.array([30.0, -20.0, 50.0, 4.0, 2.0, -3.0])
    states = [fx.modes(robot, fidelity="lumped", load=x.tolist()).com_sag.values for x in (push, -push)]
    compliance = np.linalg.inv(fx.stiffness(robot, fidelity="lumped").stiffness.values)
    # The tool is the centre of mass; differences of sags of 50 um by 1e-13 m, of some um.
    np.testing.assert_allclose(0.5 * (states[0] - states[1]), (compliance @ push)[:3], rtol=1e-4, atol=1e-11)


COMMANDS = {
    "position": {},
    "stroke": {"encoder": fx.model.Encoder(at="stroke")},
    "servo": {"command": "servo", "loop": Feedback(stiffness=3e3, damping=8.0)},
    "torque": {"command": "torque", "loop": Feedback(stiffness=3e3, damping=8.0)},
}


@pytest.mark.parametrize("command", COMMANDS)
def test_energy_balances(command):
    # The error of the balance falls by four where the step is halved.
    drive = SCREW.replace(**COMMANDS[command], nut=NUT.replace(loss=0.05))
    errors = []
    for step in (5e-4, 2.5e-4):
        found = balance(run_robot(study(machine(drive=drive, **EVERYTHING), fidelity="lumped", step=step)))
        errors.append(np.abs(found - found[0]).max())
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.25)
    assert errors[1] < 1.0  # of 400 J


def test_a_torque_alone_holds_no_position():
    pushed = study(machine(drive=SCREW.replace(command="torque")), fidelity="lumped", step=5e-4, duration=0.1)
    with pytest.raises(InputError, match="a screw with a loop"):
        fx.simulate(pushed)
    # From the rigid path on it follows the torque of the rigid robot: it leaves the path by what gives way, no more.
    data = fx.simulate(pushed.replace(initial=pushed.initial.replace(start="moving")))
    assert 1e-6 < np.abs(data.com_deviation.values).max() < 5e-4


def test_pistons_without_mass_are_refused_where_nothing_else_moves():
    def light(**parts):
        robot = machine(**parts)
        legs = [leg.replace(piston=leg.piston.replace(rhoA=0.0, axial_inertia=0.0)) for leg in robot.legs]
        return study(robot.replace(legs=tuple(legs)), fidelity="lumped", step=1e-3, duration=0.01)

    assert np.isfinite(fx.simulate(light(base_joint=SOFT)).com_deviation.values).all()  # the cylinder stands on it
    for parts in ({"platform_joint": SOFT}, {"drive": SCREW}):
        with pytest.raises(InputError, match="without mass"):
            fx.simulate(light(**parts))


def test_torque_and_thrust_of_a_held_rotor():
    drive = SCREW
    given = study(machine(drive=drive, **EVERYTHING), fidelity="lumped", step=5e-4)
    data = fx.simulate(given)
    assert data.drive_force.attrs["units"] == "N m" and data.drive_position.attrs["units"] == "rad"
    travel = data.leg_length_command
    np.testing.assert_allclose(data.drive_position * drive.per_turn, travel, rtol=1e-12)
    # At rest the torque is thrust times lead over a turn, in motion the rotor's inertia comes to it. The thrust as the
    # force on the piston has the change of the screw's stiffness in it, 1e-5 of it.
    np.testing.assert_allclose(data.drive_force[0], data.actuator_force[0] * drive.per_turn, rtol=1e-4)
    rigid = fx.inverse_kinematics(given, output_step=1e-3)
    spin = rigid.leg_length_acceleration.sel(time=data.time, method="nearest").values / drive.per_turn
    expected = data.actuator_force * drive.per_turn + drive.inertia * spin
    np.testing.assert_allclose(data.drive_force, expected, rtol=1e-4, atol=0.02)


def test_a_measured_stroke_keeps_the_parts_before_it_out():
    robot = machine(drive=SCREW.replace(encoder=fx.model.Encoder(at="stroke")), **EVERYTHING)
    ideal = machine(**{**EVERYTHING, "springs": ()})
    ours, theirs = (fx.stiffness(x, fidelity="lumped").stiffness.values for x in (robot, ideal))
    np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-9 * np.abs(theirs).max())
    data = fx.simulate(study(robot, fidelity="lumped", step=1e-3))
    assert not np.abs(data.deviation_by_cause.sel(cause=["screw", "nut", "bracket", "bearing", "twist"])).values.any()


def test_causes_add_up_and_are_forces_over_stiffnesses():
    robot = symmetric(drive=SCREW, **EVERYTHING)
    data = fx.simulate(study(robot, fidelity="lumped", step=1e-3))
    assert list(data.cause.values) == ["axial-strain", "bending", "drive", "base_joint", "platform_joint", "screw",
                                       "twist", "nut", "bearing", "bracket"]  # fmt: skip
    whole = data.deviation_by_cause.sum(("cause", "leg")) + data.deviation_residual
    np.testing.assert_allclose(whole, data.com_deviation, rtol=0, atol=1e-15)
    assert np.abs(data.deviation_residual).max() < 1e-4 * np.abs(data.com_deviation).max()
    # At rest every part at the nut has the same force: causes are as their compliances.
    start = data.deviation_by_cause.isel(time=0).sel(axis="z").sum("leg")
    part = fx.parts(robot).part_stiffness.isel(leg=0)
    for name in ("screw", "twist", "bearing", "bracket"):
        ratio = float(start.sel(cause=name) / start.sel(cause="nut"))
        assert ratio == pytest.approx(float(part.sel(part="nut") / part.sel(part=name)), rel=1e-4)
    assert float(start.sel(cause="drive")) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("part", ["base_joint", "platform_joint", "bracket", "nut"])
def test_a_part_made_ideal_takes_its_cause_out_of_the_sag(part):
    parts = {"drive": SCREW, **EVERYTHING}
    ideal = {"base_joint": {"base_joint": Joint()}, "platform_joint": {"platform_joint": Joint()},
             "bracket": {"springs": ()}, "nut": {"drive": SCREW.replace(nut=NUT.replace(stiffness=NEVER))}}  # fmt: skip
    whole, without = (
        fx.simulate(study(machine(**x), fidelity="lumped", step=1e-3, duration=0.01)).isel(time=0)
        for x in (parts, parts | ideal[part])
    )
    change = (whole.com_deviation - without.com_deviation).values
    blamed = whole.deviation_by_cause.sel(cause=part).sum("leg").values
    np.testing.assert_allclose(change, blamed, atol=2e-2 * np.abs(blamed).max())


def test_maps_and_sweeps_take_them():
    robot = machine(drive=SCREW, **EVERYTHING)
    poses = {"heave": [-0.02, 0.0, 0.02]}
    data = fx.workspace_map(study(robot, fidelity="lumped"), poses)
    here = fx.modes(robot, fidelity="lumped")
    middle = data.isel(heave=1) if "heave" in data.dims else data.isel(pose=1)
    np.testing.assert_allclose(middle.frequency.values[:6], here.frequency.values[:6], rtol=1e-9)


@pytest.mark.parametrize("part", ["base_joint", "platform_joint"])
def test_a_hinge_made_rigid_takes_its_cause_out_of_the_sag(part):
    # A tripod under a force across: its hinges hold it, and so give way across their legs. Stiff pistons: bending is
    # not to hide it.
    soft = {"base_joint": SOFT, "platform_joint": SOFT}

    def sag(**joints):
        robot = three_rps()
        stiff = robot.legs[0].piston.replace(EI=1e7)
        legs = [
            leg.replace(piston=stiff, **{name: getattr(leg, name).replace(stiffness=joint.stiffness, leg_axes=True)
                                         for name, joint in joints.items()})
            for leg in robot.legs
        ]  # fmt: skip
        robot = robot.replace(legs=tuple(legs), gravity=[6.0, 3.0, -7.0])
        return fx.simulate(study(robot, fidelity="assumed-modes", modes=1, step=1e-3, duration=0.005)).isel(time=0)

    whole, without = sag(**soft), sag(**{name: joint for name, joint in soft.items() if name != part})
    blamed = whole.deviation_by_cause.sel(cause=part).sum("leg").values
    change = (whole.com_deviation - without.com_deviation).values
    np.testing.assert_allclose(change, blamed, atol=2e-2 * np.abs(blamed).max())
    assert np.abs(blamed[:2]).max() > 1e-7  # m, across


@pytest.mark.parametrize("name", ["8-UPS", "6-PUS", "3-RPS", "planar 3-RPR"])
def test_robots_of_other_kinds_take_the_parts(name):
    # Redundant, with carriages and struts, hinged, in a plane: energy balances to the square of the step, causes add.
    robot = ROBOTS[name]()
    at = {"stiffness": SOFT.stiffness, "leg_axes": True}

    def with_parts(leg):
        springs = [AxialSpring(name="plate", stiffness=1e8, at="base")]
        springs += [AxialSpring(name="bracket", stiffness=1e8)] * (leg.driven == "stroke")
        ends = {name: getattr(leg, name).replace(**at) for name in ("base_joint", "platform_joint")}
        return leg.replace(springs=tuple(springs), **ends)

    robot = robot.replace(legs=tuple(with_parts(leg) for leg in robot.legs))
    motion = AxisMotion(type="surge" if robot.plane else "heave", amplitude=0.01, duration=0.1)
    given = Study(robot=robot, motion=motion, simulation=Simulation(fidelity="lumped", step=5e-4, duration=0.1))
    errors = []
    for step in (5e-4, 2.5e-4):
        found = balance(run_robot(given.replace(simulation=given.simulation.replace(step=step))))
        errors.append(np.abs(found - found[0]).max())
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.25)
    data = fx.simulate(given)
    assert {"base_joint", "platform_joint", "plate"} < set(data.cause.values)
    assert np.abs(data.deviation_residual).max() < 1e-2 * np.abs(data.com_deviation).max()


def test_legs_that_are_driven_in_different_ways():
    """A servo beside screws, an offset tool, tilted gravity: the sum of the legs' stiffness along themselves."""
    drives = (SCREW, ServoDrive(stiffness=3e7, damping=1e4), PrescribedDrive(), SCREW.replace(mounting="fixed-fixed"))
    robot = machine(**EVERYTHING).replace(gravity=[3.0, -2.0, -8.0])
    springs = [(), (), (), EVERYTHING["springs"], (), ()]
    legs = [robot.legs[i].replace(drive=drives[i % 4], springs=springs[i]) for i in range(6)]
    robot = robot.replace(legs=tuple(legs), payload=robot.payload.replace(tool=[0.2, -0.1, 0.3]))
    place, along = robot.home_position, np.zeros((6, 6))
    for i, k in enumerate(fx.parts(robot).leg_stiffness.values):
        n = place + robot.platform_joints[i] - robot.base_joints[i]
        n /= np.linalg.norm(n)
        row = np.r_[n, np.cross(robot.platform_joints[i] - robot.payload.tool, n)]
        along += k * np.outer(row, row)
    found, size = fx.stiffness(robot).stiffness.values, np.sqrt(np.diag(along))
    # A ton on springs of 2e7 N/m in series turns legs by 1e-3, and their thrust adds 2e3 N over 1 m: 1e-4.
    np.testing.assert_allclose(found / np.outer(size, size), along / np.outer(size, size), rtol=0, atol=2e-3)
    run = fx.simulate(study(robot, fidelity="lumped", step=1e-3, duration=0.002, output_step=1e-3))
    # Newton's last step is below 1e-13 m in both.
    sag = fx.modes(robot, fidelity="lumped").com_sag.values
    np.testing.assert_allclose(run.com_deviation.values[0], sag, rtol=0, atol=1e-12)
