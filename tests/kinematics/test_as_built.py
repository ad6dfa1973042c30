"""The machine as built and warm: similarities, shifts, where simulations end, causes that add up."""

import numpy as np
import pytest
from tests.helpers import machines, mechanisms
from tests.helpers.runs import paper_robot

import flexapod as fx
from flexapod import kinematics
from flexapod.common.errors import ComputationError, InputError
from flexapod.kinematics.as_built import built_parts
from flexapod.model import MATERIALS, Expansion, Geometry, Heat
from flexapod.solve.time.robot_march import prepare

pytestmark = pytest.mark.consistency

RNG = np.random.default_rng(7)
POSE = np.array([[0.02, -0.03, 0.04, 0.1, -0.05, 0.15]])
ERRORS = {
    "base_joints": 1e-4 * RNG.normal(size=(6, 3)),
    "platform_joints": 1e-4 * RNG.normal(size=(6, 3)),
    "leg_offset": 5e-5 * RNG.normal(size=6),
    "lead": 1e-4 * RNG.normal(size=6),
}


def displaced(robot, pose=POSE):
    path = kinematics.poses_from_home(robot, pose)
    found = kinematics.built_poses(robot, path)
    return found.position - path.position, found.rotation @ path.rotation.swapaxes(1, 2), path


def hexapod():
    return paper_robot().robot


@pytest.mark.parametrize("robot", [hexapod, mechanisms.three_rps], ids=["6-UPS", "3-RPS"])
def test_the_same_shift_of_all_joints_moves_the_platform_and_does_not_turn_it(robot):
    robot, shift = robot(), np.array([1e-3, -2e-3, 5e-4])
    pose = POSE if robot.count == 6 else POSE * [0, 0, 1, 1, 1, 0]
    every = np.tile(shift, (robot.count, 1))
    moved, turned, _ = displaced(robot.replace(geometry=Geometry(base_joints=every)), pose)
    np.testing.assert_allclose(moved[0], shift, atol=1e-14)  # rounding of lengths through J^-1, about 10
    np.testing.assert_allclose(turned[0], np.eye(3), atol=1e-14)
    if robot.count == 6:  # hinges are turned with the platform's frame, not with its joints
        moved, turned, path = displaced(robot.replace(geometry=Geometry(platform_joints=every)), pose)
        np.testing.assert_allclose(moved[0], -path.rotation[0] @ shift, atol=1e-14)
        np.testing.assert_allclose(turned[0], np.eye(3), atol=1e-14)


def test_uniform_heat_is_a_similarity():
    steel = MATERIALS["steel"].expansion
    heat = Heat(reference=20.0, base=45.0, platform=45.0, piston=45.0, cylinder=45.0)
    moved, turned, path = displaced(hexapod().replace(heat=heat))
    np.testing.assert_allclose(moved, 25 * steel * path.position, atol=1e-14)
    np.testing.assert_allclose(turned[0], np.eye(3), atol=1e-14)
    other = heat.replace(reference=45.0)
    assert np.abs(displaced(hexapod().replace(heat=other))[0]).max() < 1e-15


def test_a_strut_grows_like_a_piston_and_a_slider_carries_it():
    robot = mechanisms.sliders("PUS")
    warm = robot.replace(heat=Heat(piston=30.0, expansion=Expansion(piston=2e-5)))
    longer = robot.replace(geometry=Geometry(leg_offset=2e-4 * robot.legs[0].strut.length))
    still = np.zeros((1, 6))
    np.testing.assert_allclose(displaced(warm, still)[0], displaced(longer, still)[0], atol=1e-15)


def test_a_hot_screw_moves_what_it_drives():
    robot = machines.machine(drive=machines.SCREW)
    steel, home = MATERIALS["steel"].expansion, robot.home_lengths
    heat = Heat(screw=[30.0, *[20.0] * 5], cylinder=22.0)
    screw, cylinder = 10 * steel * (home[0] - 0.75 - 0.06), 2 * steel * 0.06
    offset = cylinder * np.ones(6) + screw * np.eye(6)[0]
    still = np.zeros((1, 6))
    moved, turned, _ = displaced(robot.replace(heat=heat), still)
    same, turned_alike, _ = displaced(robot.replace(geometry=Geometry(leg_offset=offset)), still)
    np.testing.assert_allclose(moved, same, atol=1e-15)
    np.testing.assert_allclose(turned, turned_alike, atol=1e-15)
    assert np.abs(moved).max() > 1e-6


def test_a_machine_with_screws_runs_and_blames_the_heat():
    robot = machines.machine(drive=machines.SCREW)
    warm = robot.replace(heat=Heat(screw=25.0), geometry=Geometry(lead=1e-4, leg_offset=ERRORS["leg_offset"]))
    drawn, hot = (fx.simulate(machines.study(x), fidelity="lumped", duration=0.03, step=1e-3) for x in (robot, warm))
    path = kinematics.poses(warm, machines.study(warm).motion, hot.time.values)
    com = kinematics.built_poses(warm, path).place(warm.com) - path.place(warm.com)
    # Beside the vibration, which the same command excites alike: errors of 1e-4 of a leg change it by as much.
    sag = np.abs(drawn.com_deviation).max().item()
    np.testing.assert_allclose(hot.com_deviation - drawn.com_deviation, com, atol=5e-3 * sag)
    assert {"geometry", "heat_screw"} <= set(hot.cause.values)
    share = hot.deviation_by_cause.sel(cause=["geometry", "heat_screw"]).sum(("cause", "leg"))
    np.testing.assert_allclose(share, com, atol=1e-3 * np.abs(com).max())


def test_lead_and_offset_lengthen_a_leg_as_they_say():
    robot, path = hexapod(), kinematics.poses_from_home(hexapod(), POSE)
    lengths = kinematics.inverse_kinematics(robot, path).length
    expected = lengths + ERRORS["leg_offset"] + ERRORS["lead"] * (lengths - robot.home_lengths)
    own = robot.replace(geometry=Geometry(leg_offset=ERRORS["leg_offset"], lead=ERRORS["lead"]))
    found = kinematics.inverse_kinematics(robot, kinematics.built_poses(own, path)).length
    np.testing.assert_allclose(found, expected, atol=1e-15)


def test_temperatures_over_time_are_those_of_the_table():
    table = Heat(time=[0.0, 600.0, 1800.0], columns=("piston", "cylinder 3"), table=[[20, 20], [24, 21], [26, 23]])
    robot = hexapod().replace(heat=table)
    t = np.array([0.0, 600.0, 1800.0, 4000.0])
    piston, cylinder = built_parts(robot)
    rise = np.array([0, 4, 6, 6])[:, None] * np.ones(6)
    np.testing.assert_allclose(piston.size(t).position, MATERIALS["steel"].expansion * rise, atol=1e-18)
    assert not np.delete(cylinder.size(t).position, 2, axis=1).any()
    found = kinematics.built_poses(robot, kinematics.poses_from_home(robot, np.repeat(POSE, 4, axis=0)), t)
    still = hexapod().replace(heat=Heat(piston=26.0, cylinder=[20, 20, 23, 20, 20, 20]))
    np.testing.assert_allclose(
        found.position[3], kinematics.built_poses(still, kinematics.poses_from_home(still, POSE)).position[0]
    )


def warming(heat):
    """A rigid robot that warms up as it rolls: it, its simulation, its drawn path, the way of its centre of mass."""
    study = paper_robot(fidelity="rigid")
    robot = study.robot.replace(heat=heat)
    study = study.replace(robot=robot, motion=study.motion.replace(duration=0.1, hold=0.0))
    data = fx.simulate(study, duration=0.12, step=1e-3)
    path = kinematics.poses(robot, study.motion, data.time.values)
    return robot, data, path, kinematics.built_poses(robot, path, data.time.values).place(robot.com)


def test_legs_that_warm_up_while_they_move_take_the_rates_along():
    # Tenths of a degree in tenths of a second: growth by a hundred micrometres, at rates of the motion's own size.
    heat = Heat(time=[0.0, 0.04, 0.1], columns=("piston", "cylinder 3"), table=[[20, 20], [40, 20], [30, 60]])
    _, data, _, com = warming(heat)
    np.testing.assert_allclose(data.com_position, com, atol=1e-12)
    balances = [x.energy_kinetic + x.energy_potential - x.work_drive for x in (data, warming(None)[1])]
    # Work is integrated to second order in the step; growing legs do not make it worse.
    assert np.ptp(balances[0].values) < 1.5 * np.ptp(balances[1].values)
    heated = np.abs(data.deviation_by_cause.sel(cause="heat_piston").values)
    assert heated[0].max() < 1e-15 and heated[-1].max() > 1e-5


def test_screws_that_warm_up_as_they_turn_grow_at_the_rates_of_a_product():
    # From the bearing to the nut a screw is l - L_p - b long; it is warmed along a table and driven along a parabola.
    # Rates are differences of the product; splines of fifth order leave h^2 of what they bend, 1e-5 of it.
    heat = Heat(time=[0.0, 1.0, 2.0], columns=("screw",), table=[[20], [30], [45]])
    robot = machines.machine(drive=machines.SCREW).replace(heat=heat)
    (part,), t, h = built_parts(robot), np.array([0.3, 0.7, 1.6]), 1e-3
    length = np.polynomial.Polynomial([1.1, 0.2, -0.15])
    L, q = kinematics.COORDINATES.index("l"), np.zeros((3, 3, 6, 8))
    q[..., L] = np.array([length.deriv(k)(t) for k in range(3)])[..., None]

    def grown(t):
        screw = length(t) - machines.TUBE.length - machines.BEARING.position
        return part.size(t).position * screw[:, None]

    found, (before, now, after) = kinematics.added(part, t, kinematics.Law(*q)), map(grown, (t - h, t, t + h))
    np.testing.assert_allclose(found.position[..., L], now, rtol=1e-12)
    np.testing.assert_allclose(found.rate[..., L], (after - before) / (2 * h), rtol=1e-4)
    np.testing.assert_allclose(found.acceleration[..., L], (after - 2 * now + before) / h**2, rtol=1e-4)
    assert np.abs(found.acceleration[..., L]).min() > 1e-6


def test_plates_that_warm_up_move_the_platform_as_kinematics_says():
    # Legs take the growth of the plates as a length: what that leaves is its square over the length of a leg, through
    # J^-1. Both plates have started elsewhere than at the reference, so that joints of the kernel are shifted, too.
    heat = Heat(time=[0.0, 0.04, 0.1], columns=("base", "platform"), table=[[23, 20], [26, 22], [25, 30]])
    robot, data, path, com = warming(heat)
    grown = 12e-6 * 10 * 0.5
    assert np.abs(com - path.place(robot.com)).max() > 0.3 * grown
    np.testing.assert_allclose(data.com_position, com, atol=20 * grown**2 / robot.home_lengths.min())
    balances = [x.energy_kinetic + x.energy_potential - x.work_drive for x in (data, warming(None)[1])]
    assert np.ptp(balances[0].values) < 1.5 * np.ptp(balances[1].values)  # rates fit values
    causes = data.deviation_by_cause.sum("leg")
    assert np.abs(causes.sel(cause=["heat_base", "heat_platform"])[-1]).max() > 1e-5
    left = 20 * grown**2 / robot.home_lengths.min()
    np.testing.assert_allclose(causes.sel(cause=["axial-strain", "bending", "drive"]), 0.0, atol=left)
    assert np.abs(data.deviation_residual).max() < left


def test_growth_of_plates_has_the_rates_of_its_values():
    study = paper_robot()
    heat = Heat(time=[0.0, 0.04, 0.1], columns=("base", "platform"), table=[[23, 20], [26, 22], [25, 30]])
    robot, t, h = study.robot.replace(heat=heat), np.array([0.02, 0.05, 0.09]), 1e-5
    for part in built_parts(robot):
        at = [
            kinematics.plate_grows(part, x, kinematics.poses(robot, study.motion, x), robot) for x in (t - h, t, t + h)
        ]
        # Central differences leave h^2 of the third derivative, 1e-7 of values, and rounding of 1e-20 m over h^2.
        np.testing.assert_allclose((at[2].position - at[0].position) / (2 * h), at[1].rate, rtol=1e-5, atol=1e-12)
        np.testing.assert_allclose((at[2].rate - at[0].rate) / (2 * h), at[1].acceleration, rtol=1e-4, atol=1e-9)


def test_plates_that_warm_up_under_other_legs_are_refused_in_motions(tmp_path):
    heat = Heat(time=[0.0, 600.0], columns=("base",), table=[[20], [24]])
    for robot in (mechanisms.three_rps(), mechanisms.sliders("PUS")):
        study = fx.model.Study(robot=robot.replace(heat=heat), motion=paper_robot().motion)
        with pytest.raises(InputError, match="legs UPS alone") as caught:
            prepare(study)
        assert caught.value.key == "heat.file"
    assert np.abs(fx.accuracy(mechanisms.sliders("PUS").replace(heat=heat)).pose_drift[1]).max() > 1e-6


def with_errors():
    return hexapod().replace(geometry=Geometry(**ERRORS))


def run(**built):
    study = paper_robot(fidelity="lumped")
    study = study.replace(motion=study.motion.replace(duration=0.1, hold=0.0), robot=study.robot.replace(**built))
    data = fx.simulate(study, duration=0.1, step=1e-3)
    path = kinematics.poses(study.robot, study.motion, data.time.values)
    return data, path, study.robot


@pytest.mark.parametrize("start", ["equilibrium", "straight", "moving"])
def test_a_rigid_machine_runs_where_forward_kinematics_says(start):
    study = paper_robot(fidelity="rigid", start=start)
    robot = study.robot.replace(geometry=Geometry(**ERRORS), heat=Heat(piston=24.0, base=22.0))
    study = study.replace(robot=robot, motion=study.motion.replace(duration=0.05, hold=0.0))
    data = fx.simulate(study, duration=0.05, step=1e-3)
    path = kinematics.poses(robot, study.motion, data.time.values)
    com = kinematics.built_poses(robot, path).place(robot.com)
    # The legs follow the commands as built exactly; closures leave rounding, through J^-1.
    np.testing.assert_allclose(data.com_position, com, atol=1e-12)
    assert np.abs(data.com_deviation).max() > 1e-4


def test_an_elastic_machine_differs_from_it_by_the_sag():
    drawn, built = (fx.modes(robot, POSE[0], fidelity="lumped") for robot in (hexapod(), with_errors()))
    path = kinematics.poses_from_home(hexapod(), POSE)
    com = kinematics.built_poses(with_errors(), path).place(hexapod().com) - path.place(hexapod().com)
    sag = np.abs(drawn.com_sag).max().item()
    # The load stands beside the drawn pose by the error, in parts of the platform's radius: so much the sag changes.
    atol = 2 * sag * np.linalg.norm(com) / 0.15
    np.testing.assert_allclose(built.com_sag - drawn.com_sag, com[0], atol=atol)
    assert atol < 0.01 * np.abs(com).max()


def test_causes_of_the_machine_as_built_add_up():
    data, path, robot = run(geometry=Geometry(**ERRORS), heat=Heat(piston=24.0, base=22.0))
    assert list(data.cause.values) == ["axial-strain", "bending", "drive", "geometry", "heat_base", "heat_piston"]
    whole = data.deviation_by_cause.sum(("cause", "leg")) + data.deviation_residual
    np.testing.assert_allclose(whole, data.com_deviation, rtol=0, atol=4 * np.finfo(float).eps)
    deviation = np.abs(data.com_deviation).max().item()
    assert np.abs(data.deviation_residual).max() < 10 * deviation**2 / robot.home_lengths.min()  # second order
    share = data.deviation_by_cause.sel(cause="geometry").sum("leg").values
    only = robot.replace(heat=None)
    exact = kinematics.built_poses(only, path).place(robot.com) - path.place(robot.com)
    np.testing.assert_allclose(share, exact, atol=10 * deviation**2 / robot.home_lengths.min())
    for cause in ("bending", "drive"):
        assert np.abs(data.deviation_by_cause.sel(cause=cause)).max() < 1e-12


def test_modes_and_maps_see_the_machine_as_built():
    robot = hexapod()
    longer = robot.replace(geometry=Geometry(leg_offset=2e-3))
    found, drawn = fx.modes(longer, fidelity="lumped"), fx.modes(robot, fidelity="lumped")
    up = kinematics.built_poses(longer, kinematics.home_pose(longer)).position[0, 2] - robot.home_height
    assert found.platform_position[2] - drawn.platform_position[2] == pytest.approx(up, rel=1e-3)
    many = fx.modes(longer, np.zeros((2, 6)), fidelity="lumped")
    np.testing.assert_allclose(many.frequency[0], found.frequency, rtol=1e-9)


def test_three_hinged_legs_as_built_stand_where_kinematics_says():
    robot = mechanisms.three_rps()
    rng = np.random.default_rng(5)
    errors = Geometry(**{f"{end}_joints": 1e-4 * rng.normal(size=(3, 3)) for end in ("base", "platform")})
    drawn, built = (fx.modes(x, fidelity="lumped").com_sag for x in (robot, robot.replace(geometry=errors)))
    home = kinematics.home_pose(robot)
    com = kinematics.built_poses(robot.replace(geometry=errors), home).place(robot.com) - home.place(robot.com)
    atol = 2 * np.abs(drawn).max().item() * np.linalg.norm(com) / 0.2  # as above; the platform's radius
    np.testing.assert_allclose(built - drawn, com[0], atol=atol)


def test_legs_that_do_not_fit_strain_each_other():
    robot = mechanisms.eight()
    longer = robot.replace(geometry=Geometry(leg_offset=[1e-4, *[0.0] * 7]))
    drawn, built = (fx.modes(x, fidelity="lumped").com_sag for x in (robot, longer))
    share = fx.accuracy(longer).pose_error.values
    shift = share[:3] + np.cross(share[3:], robot.com - robot.tool)  # accuracy is of the tool
    # Legs are alike: the compliance of pistons that only stretch is that of the first order. Sag and error mix by 1e-3.
    np.testing.assert_allclose(built - drawn, shift, atol=0.02 * np.abs(shift).max())


def test_joints_that_hold_too_much_are_said_not_to_fit():
    robot = mechanisms.eight()
    spread = Geometry(leg_offset=[1e-4, *[0.0] * 7])
    with pytest.raises(ComputationError, match="do not fit together without strain"):
        kinematics.built_poses(robot.replace(geometry=spread), kinematics.home_pose(robot))
