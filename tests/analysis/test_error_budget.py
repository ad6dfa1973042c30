"""Error budgets: rows add up, parts made ideal take their rows with them, one number from one source, symmetry."""

import numpy as np
import pytest
from tests.helpers import mechanisms
from tests.helpers.machines import SCREW, SOFT, machine, study, symmetric
from tests.helpers.runs import paper_robot

import flexapod as fx
from flexapod.analysis.error_budget.rules import Budget
from flexapod.analysis.pose_errors.error_sources import ErrorRow
from flexapod.common.errors import InputError
from flexapod.model import AxisMotion, Geometry, Heat, Joint, Nut, PrescribedDrive, ServoDrive, Tolerances

pytestmark = pytest.mark.consistency

SERVO = ServoDrive(stiffness=2e7, damping=2e4)
OFFSETS = Geometry(leg_offset=[2e-5, 0, 0, -1e-5, 0, 0], lead=3e-5)
WARM = Heat(piston=[22.0, 22, 22, 23, 22, 22], base=20.5)
POSE = {"surge": 0.02, "heave": 0.03, "roll": 0.05, "yaw": -0.05}
LOOSE = SOFT.replace(play=5e-6)
BACKLASH = SCREW.replace(nut=Nut(stiffness=850e6, backlash=2e-6))


def real(**more):
    parts = {"drive": SCREW, "base_joint": SOFT, "platform_joint": SOFT} | more
    return machine(**parts).replace(geometry=OFFSETS, heat=WARM)


def with_parts(robot, **parts):
    return robot.replace(legs=tuple(leg.replace(**parts) for leg in robot.legs))


ROBOTS = {
    "6-UPS": (real, POSE),
    "paper": (lambda: paper_robot().robot, {"roll": 0.1}),
    "3-RPS": (lambda: with_parts(mechanisms.three_rps(), drive=SERVO), {"heave": 0.03, "roll": 0.05}),
    "6-PUS": (lambda: mechanisms.sliders("PUS"), {"surge": 0.02, "roll": 0.05}),
    "3-UPS+UP": (mechanisms.tricept, {"roll": 0.05, "pitch": -0.05}),
    "8-UPS": (mechanisms.eight, {"surge": 0.02, "yaw": 0.05}),
}


@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize("kind", ROBOTS)
def test_systematic_rows_add_up_to_the_static_deviation_of_any_mechanism(kind):
    robot, pose = (x() if callable(x) else x for x in ROBOTS[kind])
    found = fx.budget(robot, pose)
    assert list(found.kind.values) == ["systematic", "hysteretic", "random"]
    rows, total = found.budget.sel(kind="systematic"), found.budget_total.sel(kind="systematic")
    left = found.budget_residual.sel(kind="systematic")
    np.testing.assert_allclose(rows.sum("part") + left, total, atol=1e-18)
    np.testing.assert_allclose(found.budget_by_leg.sum("leg").sel(kind="systematic"), rows, atol=1e-18)
    # Second order: the deviation over the size of the robot, 1e-4, times what lever arms make of it.
    for part in (slice(3), slice(3, 6)):
        assert np.abs(left[part]).max() < 2e-3 * np.abs(rows[:, part]).sum("part").max()
    assert found.share.sum() == pytest.approx(1.0)


def test_the_systematic_total_is_where_a_simulation_at_rest_starts():
    robot = real()
    still = AxisMotion(type="heave", amplitude=0.0, duration=1.0)
    data = fx.simulate(robot, still, duration=2e-3, step=1e-3)
    total = fx.budget(robot).budget_total.sel(kind="systematic")
    np.testing.assert_allclose(total[:3], data.tool_deviation[0], rtol=0, atol=1e-13)
    np.testing.assert_allclose(total[3:], data.rotation_deviation[0], rtol=0, atol=1e-13)


IDEAL = {
    "base_joint": (lambda robot: with_parts(robot, base_joint=Joint()), ["base_joint"]),
    "platform_joint": (lambda robot: with_parts(robot, platform_joint=Joint()), ["platform_joint"]),
    "drive": (lambda robot: with_parts(robot, drive=PrescribedDrive()), ["screw", "twist", "nut", "bearing"]),
    "geometry": (lambda robot: robot.replace(geometry=None), ["leg_offset", "lead"]),
    "heat": (lambda robot: robot.replace(heat=None), ["heat_base", "heat_piston"]),
}


@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize("name", IDEAL)
def test_a_part_made_ideal_takes_its_row_out_of_the_total(name):
    robot = real()
    change, parts = IDEAL[name]
    before, after = fx.budget(robot, POSE), fx.budget(change(robot), POSE)
    assert set(before.part.values) - set(after.part.values) == set(parts)
    row = before.budget.sel(kind="systematic", part=parts).sum("part")
    change = (before.budget_total - after.budget_total).sel(kind="systematic")
    for axes in (slice(3), slice(3, 6)):
        np.testing.assert_allclose(change[axes], row[axes], rtol=0, atol=0.02 * float(np.abs(row[axes]).max()))


def test_random_rows_add_as_squares_and_equal_machines_drawn():
    robot = paper_robot().robot.replace(tolerances=Tolerances(base_joints=2e-5, platform_joints=1e-5, leg_offset=1e-5))
    found, drawn = fx.budget(robot, {"roll": 0.1}), fx.accuracy(robot, {"roll": 0.1}, draws=10_000, seed=2)
    random = found.budget.sel(kind="random")
    np.testing.assert_allclose(np.sqrt((random**2).sum("part")), found.budget_total.sel(kind="random"), rtol=1e-12)
    sigma = np.sqrt(np.diag(drawn.sample_covariance))
    # Of 10,000 draws a standard deviation is known to 0.7 %: 3 % is four of them.
    np.testing.assert_allclose(found.budget_total.sel(kind="random"), sigma, rtol=0.03)


def test_play_adds_as_a_bound():
    robot = real(base_joint=LOOSE, drive=BACKLASH)
    found, pose = fx.budget(robot, POSE), fx.accuracy(robot, POSE)
    bound = found.budget_total.sel(kind="hysteretic")
    np.testing.assert_allclose(bound, pose.play_worst, rtol=1e-12)
    np.testing.assert_allclose(found.repeatability_bidirectional, 2 * bound, rtol=1e-12)
    assert not found.repeatability_unidirectional.any()
    most = np.abs(found.budget_total.sel(kind="systematic")) + bound
    np.testing.assert_allclose(found.worst, most, rtol=1e-12)


def test_a_symmetric_robot_has_a_symmetric_budget():
    robot = symmetric(drive=BACKLASH, base_joint=LOOSE, platform_joint=SOFT)
    robot = robot.replace(heat=Heat(piston=22.0), tolerances=Tolerances(base_joints=1e-5))
    found = fx.budget(robot)
    sizes = np.abs(found.budget_by_leg.sel(component="z"))
    np.testing.assert_allclose(sizes, sizes.mean("leg").broadcast_like(sizes), rtol=1e-6, atol=1e-15)
    whole = found.budget_total.sel(kind="systematic")
    assert np.abs(whole.sel(component=["x", "y"])).max() < 1e-6 * abs(whole.sel(component="z"))
    for kind in ("hysteretic", "random"):
        x, y = found.budget_total.sel(kind=kind, component=["x", "y"]).values
        assert x == pytest.approx(y, rel=0.2)  # a sum of sizes is not the same along both axes, squares are
    x, y = found.budget_total.sel(kind="random", component=["x", "y"]).values
    assert x == pytest.approx(y, rel=1e-9)


def test_along_a_motion_dynamic_rows_add_exactly_and_with_the_static_ones_make_the_simulation():
    s = study(real(), duration=0.15, step=5e-4)
    found, data = fx.budget(s, motion=True), fx.simulate(s)
    assert float(found.worst_time) in data.time
    for kind in ("dynamic_peak", "dynamic_rms"):
        rows, left = found.budget.sel(kind=kind).sum("part"), found.budget_residual.sel(kind=kind)
        np.testing.assert_allclose(rows + left, found.budget_total.sel(kind=kind), atol=1e-18)
        assert np.abs(left).max() < 2e-3 * np.abs(found.budget_total.sel(kind=kind)).max()
    time = float(found.peak_time.sel(component="z"))
    pose = fx.kinematics.poses(s.robot, s.motion, np.array([time]))
    static = fx.budget(s, fx.kinematics.Poses.at_rest(pose.position, pose.rotation))
    whole = static.budget_total.sel(kind="systematic") + found.budget_total.sel(kind="dynamic_peak")
    # The spline through poses at rest is exact at its knots: here at all instants.
    assert float(whole.sel(component="z")) == pytest.approx(
        float(data.tool_deviation.sel(axis="z").sel(time=time, method="nearest")), abs=1e-12
    )
    assert found.attrs["summary"].startswith("The largest culprit at the pose of t = ")


def test_rules_of_addition_by_hand():
    def row(part, kind, nature, *values, stands=False):
        by_leg = np.zeros((2, 6))
        by_leg[:, 0] = values
        return ErrorRow(part, kind, nature, by_leg, "by hand", stands)

    found = Budget(
        rows=[
            row("a", "systematic", "calibratable", 3.0, -1.0),
            row("b", "systematic", "repeatable", 1.0, 1.0),
            row("c", "systematic", "drifting", -1.0, 0.0),
            row("d", "hysteretic", "", 1.0, -1.0),
            row("e", "random", "", 3.0, 4.0, stands=True),
            row("f", "random", "", 0.6, 0.8),
        ],
        whole={"systematic": np.array([3.5, 0, 0, 0, 0, 0])},
    )
    assert found.total("systematic")[0] == 3.5
    assert found.residual("systematic")[0] == 0.5
    assert found.total("hysteretic")[0] == 2.0
    assert found.total("random")[0] == pytest.approx(np.sqrt(26))
    assert found.worst[0] == pytest.approx(3.5 + 2 + 3 * np.sqrt(26))
    assert found.rss[0] == pytest.approx(np.sqrt(3.5**2 + 2**2 + 26))
    assert found.accuracy(calibrated=False)[0] == pytest.approx(3.5 + 15)
    assert found.accuracy(calibrated=True)[0] == pytest.approx(1.5)
    assert found.unidirectional[0] == pytest.approx(4.0)
    assert found.bidirectional[0] == pytest.approx(8.0)
    assert found.with_half("a").total("systematic")[0] == 2.5
    assert found.with_half("d").worst[0] == pytest.approx(found.worst[0] - 1)
    sizes = {"a": 2, "b": 2, "c": 1, "d": 2, "e": 15, "f": 3}
    assert found.shares == pytest.approx({part: size / 25 for part, size in sizes.items()})


def test_the_repeatability_of_a_distance_is_that_of_many_approaches_at_most():
    rng, sigma = np.random.default_rng(4), 1e-6
    for scale in ([1.0, 0, 0], [1.0, 1, 1], [1.0, 0.5, 0.1]):
        by_leg = np.zeros((1, 6))
        by_leg[0, :3] = sigma * np.array(scale)
        found = Budget(rows=[ErrorRow("noise", "random", "", by_leg, "")], whole={}).repeatability
        size = np.linalg.norm(rng.normal(size=(200_000, 3)) * by_leg[0, :3], axis=1)
        drawn = size.mean() + 3 * size.std()
        assert drawn < 1.01 * found
        if scale == [1.0, 0, 0]:  # 200,000 draws: 0.2 %
            assert drawn == pytest.approx(found, rel=0.01)


def test_words_name_the_culprit_and_say_what_is_not_known():
    rigid = paper_robot(fidelity="rigid", modes=None)
    nothing = fx.budget(rigid)
    assert nothing.attrs["summary"] == "Nothing that the study names moves the tool off its place at home."
    assert not fx.plot.budget(nothing).axes
    found = fx.budget(paper_robot())
    first, accuracy, repeatability = found.attrs["summary"].splitlines()
    whole = float(np.linalg.norm(found.worst[:3]))
    assert first.startswith("The largest culprit at home is the stretch of the pistons, 100 % of the sizes")
    assert f"from {1e6 * whole:.3g} µm to {0.5e6 * whole:.3g} µm" in first
    assert "ISO 9283" in accuracy
    assert repeatability.startswith("Repeatability: the study names neither play nor friction nor")
    assert set(np.unique(found.nature)) == {"repeatable"}
    far = fx.budget(mechanisms.delta()).attrs["summary"].splitlines()  # it gives way by centimetres
    assert far[1].startswith("The rows, of first order, leave 14.2 mm of the static deviation of 63 mm")


def test_what_has_no_budget_is_refused():
    with pytest.raises(InputError, match="is given together with a motion"):
        fx.budget(paper_robot(), POSE, motion=True)
    with pytest.raises(InputError, match="is not an axis"):
        fx.budget(paper_robot(), {"heavy": 0.1})
    with pytest.raises(InputError, match="platform that is fixed"):
        fx.budget(mechanisms.between_points())


def test_legs_that_are_not_straight_come_on_top_of_what_is_simulated():
    straight = real()
    bent = straight.replace(legs=tuple(leg.replace(piston=leg.piston.replace(bow=5e-4)) for leg in straight.legs))
    before, after = fx.budget(straight, POSE), fx.budget(bent, POSE)
    row = after.budget.sel(kind="systematic", part="bent_legs")
    assert str(after.nature.sel(part="bent_legs").values) == "repeatable"
    assert np.abs(row).max() > 0
    np.testing.assert_allclose((after.budget_total - before.budget_total).sel(kind="systematic"), row, atol=1e-15)
    np.testing.assert_allclose(after.budget_residual, before.budget_residual, atol=1e-15)


def test_a_map_has_the_budget_of_each_of_its_poses():
    robot = real(base_joint=LOOSE, drive=BACKLASH).replace(tolerances=Tolerances(leg_offset=1e-5))
    found = fx.workspace_map(robot, {"heave": np.array([0.0, 0.02, 5.0])}, at={"roll": 0.05}, budget=True)
    assert found.error_worst.dims == ("heave",)
    assert np.isnan(found.error_worst[2]) and np.isnan(found.error_by_part[2]).all()
    one = fx.budget(robot, {"heave": 0.02, "roll": 0.05})
    assert float(found.error_worst[1]) == pytest.approx(float(np.linalg.norm(one.worst[:3])), rel=1e-9)
    sizes = found.error_by_part.sel(part=one.part.values)[1]
    np.testing.assert_allclose(sizes / found.error_by_part[1].sum(), one.share, atol=1e-9)
    assert fx.plot.workspace_map(found, "error_worst").axes
    assert "error_worst" not in fx.workspace_map(robot, {"heave": np.array([0.0, 0.02])})


@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize("kind", ["3-RPS", "6-PUS", "3-UPS+UP", "8-UPS"])
def test_joints_made_ideal_take_their_row_out_of_other_mechanisms(kind):
    robot, pose = (x() if callable(x) else x for x in ROBOTS[kind])
    springs = {"stiffness": np.diag([15e6, 15e6, 20e6, 0, 0, 0]), "leg_axes": True}
    soft = robot.replace(legs=tuple(leg.replace(base_joint=leg.base_joint.replace(**springs)) for leg in robot.legs))
    before, after = (fx.budget(x, pose) for x in (soft, robot))
    row = before.budget.sel(kind="systematic", part="base_joint")
    change = (before.budget_total - after.budget_total).sel(kind="systematic")
    for axes in (slice(3), slice(3, 6)):
        np.testing.assert_allclose(change[axes], row[axes], rtol=0, atol=0.02 * float(np.abs(row[axes]).max()))


def test_what_acts_on_all_legs_at_once_has_no_shares_of_legs():
    shaken = fx.loads(fx.model.preset_text("machine-hexapod") + '\n[disturbance]\nfloor = "VC-C"\n')
    found = fx.budget(shaken)
    row = found.budget.sel(kind="random", part="floor vibration")
    assert np.isnan(found.budget_by_leg.sel(kind="random", part="floor vibration")).all()
    # Of what differs from approach to approach it is all: 4 standard deviations.
    np.testing.assert_allclose(found.repeatability_unidirectional, 4 * row, rtol=1e-12)
    labels = [label.get_text() for label in fx.plot.budget(found).axes[0].get_yticklabels()]
    assert "floor vibration" in labels


def shaken(text="", **legs):
    study = fx.loads(fx.model.preset_text("machine-hexapod") + f'\n[disturbance]\nfloor = "VC-C"\n{text}')
    if not legs:
        return study
    robot = study.robot.replace(legs=tuple(leg.replace(**legs) for leg in study.robot.legs))
    return study.replace(robot=robot)


def test_a_vibration_without_size_is_missing_and_said_to_be():
    # Nothing is damped: the floor's vibration at a resonance grows without end. All other rows are there.
    springs = {"stiffness": np.diag([150e6, 150e6, 200e6, 0, 0, 0]), "leg_axes": True}
    undamped = shaken(damping=0.0, base_joint=Joint(**springs), platform_joint=Joint(**springs), springs=())
    robot = undamped.robot
    still = {"loss": None, "damping": None}
    drives = [
        leg.drive.replace(nut=leg.drive.nut.replace(**still), bearing=leg.drive.bearing.replace(**still), friction=None)
        for leg in robot.legs
    ]
    legs = tuple(leg.replace(drive=drive) for leg, drive in zip(robot.legs, drives, strict=True))
    undamped = undamped.replace(robot=robot.replace(legs=legs))
    found, still = fx.budget(undamped), fx.budget(undamped.replace(disturbance=None))
    assert "vibration by disturbances has no row" in found.attrs["warnings"]
    assert "without damping" in found.attrs["warnings"]
    assert list(found.part.values) == list(still.part.values)
    np.testing.assert_array_equal(found.worst, still.worst)
    data = fx.workspace_map(undamped, {"heave": np.array([0.0, 0.01])}, budget=True)
    assert np.isnan(data.error_by_part.sel(part="floor vibration")).all() and np.isfinite(data.error_worst).all()


def test_a_map_has_vibration_among_its_parts():
    study = shaken()
    data = fx.workspace_map(study, {"heave": np.array([0.0, 0.01])}, budget=True)
    one = fx.budget(study, {"heave": 0.01})
    assert float(data.error_worst[1]) == pytest.approx(float(np.linalg.norm(one.worst[:3])), rel=1e-6)
    size = 3 * np.linalg.norm(one.budget.sel(part="floor vibration", kind="random")[:3])
    assert float(data.error_by_part.sel(part="floor vibration")[1]) == pytest.approx(float(size), rel=1e-6)


def test_natures_are_those_of_systematic_errors():
    found = fx.budget(real(base_joint=LOOSE).replace(tolerances=Tolerances(leg_offset=1e-5)))
    natures = dict(zip(found.part.values, found.nature.values, strict=True))
    assert natures["leg_offset tolerance"] == "" and natures["base_joint play"] == ""
    assert set(natures.values()) <= {"", "calibratable", "repeatable", "drifting"}
    # A tolerance is the same at each approach: in the accuracy, and nothing of the repeatability.
    assert found.pose_accuracy[0, 0] > found.pose_accuracy[1, 0] and not found.repeatability_unidirectional.any()
