"""`fx.workspace_map`: grids, why poses are out of reach, quantities against other ways to the same number, figures."""

import numpy as np
import pytest
from tests.helpers.runs import paper_robot, with_legs

import flexapod as fx
from flexapod import kinematics
from flexapod.analysis.checks.reachability import REASONS, rigid_codes
from flexapod.analysis.results.poses import pose_coordinates, poses_about_home
from flexapod.design.maps.findings import GRID_VARIABLES, SCALARS, axis_words, map_findings
from flexapod.design.maps.grid import Range, build_grid
from flexapod.kinematics.inverse import BETA_LIMIT
from flexapod.kinematics.workspace import LONGEST, NO_FREE_LENGTH, PULLED_OUT, SHORTEST
from flexapod.model.motion import Waypoint, WaypointMotion

pytestmark = pytest.mark.unit

FLAG = [reason.flag for reason in REASONS]
AT = {"sway": 0.02, "pitch": 0.05}


@pytest.fixture(scope="module")
def study():
    return paper_robot()


@pytest.fixture(scope="module")
def slice_(study):
    axes = {"heave": [-0.3, 0.0, 0.05], "roll": np.deg2rad([0.0, 20.0])}
    return fx.workspace_map(study, axes, at=AT, direction=[1, 1, 0], acceleration=[0, 2, 0], frequencies=4)


def test_values_are_those_of_single_poses(study, slice_):
    assert slice_.frequency.dims == ("heave", "roll", "mode")
    pose = {"heave": 0.05, "roll": np.deg2rad(20.0), **AT}
    here = slice_.isel(heave=2, roll=1)
    modes, stiffness = fx.modes(study, pose), fx.stiffness(study, pose).stiffness.values
    np.testing.assert_allclose(here.frequency, modes.frequency[:4], rtol=1e-10)
    C, u = np.linalg.inv(stiffness)[:3, :3], np.array([1, 1, 0]) / np.sqrt(2)
    assert here.stiffness.item() == pytest.approx(1 / (u @ C @ u), rel=1e-10)
    soft = here.softest_direction.values
    assert here.stiffness_least.item() == pytest.approx(1 / (soft @ C @ soft), rel=1e-9)
    assert here.stiffness_least <= here.stiffness
    at = poses_about_home(study.robot, np.array([[0, 0.02, 0.05, pose["roll"], 0.05, 0]]))
    assert here.condition.item() == pytest.approx(kinematics.singularity(study.robot, at).condition[0], rel=1e-12)
    length = kinematics.inverse_kinematics(study.robot, at).length[0]
    stroke = study.robot.legs[0].stroke
    assert here.stroke_margin.item() == pytest.approx(min(length.min() - stroke.min, stroke.max - length.max()))
    start = fx.simulate(study.replace(motion=_still(pose)), duration=1e-3, step=1e-3).isel(time=0)
    # Rounding of positions of a metre.
    np.testing.assert_allclose(here.static_deviation, start.tool_deviation, atol=1e-14)
    np.testing.assert_allclose(here.actuator_force, start.actuator_force, rtol=1e-9)
    assert here.largest_force.item() == pytest.approx(np.abs(start.actuator_force).max().item(), rel=1e-9)


def _still(pose):
    points = [Waypoint(time=float(t), **{name: float(value) for name, value in pose.items()}) for t in (0, 1)]
    return WaypointMotion(points=points)


def test_what_is_out_of_reach_has_no_values(slice_):
    assert [FLAG[code] for code in slice_.reason.values[:, 0]] == ["leg_too_short", "reached", "reached"]
    for name in GRID_VARIABLES:
        if name != "reason":
            assert np.isnan(slice_[name][0]).all(), name
            assert np.isfinite(slice_[name][1:]).all(), name


def test_table_of_names(slice_):
    for name, (dims, units, _) in GRID_VARIABLES.items():
        assert slice_[name].dims == ("heave", "roll", *dims)
        assert slice_[name].attrs["units"] == units
    assert slice_.heave.attrs["units"] == "m"
    assert slice_["roll"].attrs["units"] == "rad"
    assert slice_.attrs["at_sway"] == 0.02
    assert "at_roll" not in slice_.attrs
    assert fx.model.loads(slice_.attrs["study"]).robot == paper_robot().robot


def test_dynamic_deviation_is_that_of_rigid_leg_forces_on_springs(study):
    """Heavy cylinders, pistons of a milligram: the change of the joint forces stretches the pistons (lumped)."""
    heavy = study.robot.legs[0].cylinder.replace(mass=30.0)
    light = with_legs(
        study,
        lambda leg: leg.replace(cylinder=heavy, piston=leg.piston.replace(rhoA=1e-6, E=None, density=None)),
    )
    light = light.replace(robot=light.robot.replace(gravity=[0, 0, 0]))
    robot, a = light.robot, np.array([1.0, -2.0, 3.0])
    still = poses_about_home(robot, np.array([[0.0, 0.0, 0.03, 0.2, 0.0, 0.1]]))
    zero = np.zeros((1, 3))
    moving = kinematics.Poses(
        position=still.position, rotation=still.rotation, velocity=zero, omega=zero, acceleration=a[None], alpha=zero
    )
    at = {"roll": 0.2, "yaw": 0.1}
    J = kinematics.length_jacobian(
        robot.base_joints, robot.platform_joints, still.position[0], still.rotation[0], robot.payload.tool
    )
    thrust = (kinematics.inverse_dynamics(robot, moving).joint_force[0] * J[:, :3]).sum(axis=1)
    piston = robot.legs[0].piston
    expected = np.linalg.solve(J, -thrust * piston.length / piston.EA)[:3]
    found = fx.workspace_map(light, {"heave": [0.03]}, at=at, acceleration=a, fidelity="lumped").dynamic_deviation
    # Pistons of a milligram leave out 1e-5 of a cylinder's inertia.
    assert found.item() == pytest.approx(np.linalg.norm(expected), rel=1e-5)
    worst = fx.workspace_map(light, {"heave": [0.03]}, at=at, fidelity="lumped").dynamic_deviation.item()
    assert worst >= found.item() / np.linalg.norm(a) * (1 - 1e-12)


def test_reasons_are_those_of_the_rigid_robot(study):
    robot = with_legs(study, lambda leg: leg.replace(
        stroke={"min": 0.62, "max": 1.06}, piston=leg.piston.replace(length=0.7))).robot  # fmt: skip
    rng = np.random.default_rng(3)
    values = rng.uniform(-1, 1, (300, 6)) * [0.3, 0.3, 0.6, 0.6, 0.6, 2.5]
    path = poses_about_home(robot, values)
    code = rigid_codes(kinematics.RigidPoses(robot, path), from_home=False)
    folded = np.array([FLAG[c] == "joint_folds" for c in code])
    np.testing.assert_array_equal((code == 0) | folded, kinematics.reachable(robot, path))
    kinds = {"leg_too_short": SHORTEST, "leg_too_long": LONGEST, "no_free_length": NO_FREE_LENGTH,
             "pulled_out": PULLED_OUT}  # fmt: skip
    for k, c in enumerate(code):
        length = kinematics.leg_lengths(robot.base_joints, robot.platform_joints, path.position[k], path.rotation[k])[
            None
        ]
        strokes, pistons = kinematics.strokes(robot, [0.0], length), kinematics.pull_out(robot, [0.0], length)
        first = strokes or [e for e in pistons if e.fatal]  # the stroke counts before the piston
        worst = max(first, key=lambda e: abs(e.value - e.limit), default=None)
        assert kinds.get(FLAG[c]) == (worst.kind if worst else None)
    assert {"reached", "leg_too_short", "leg_too_long", "pulled_out"} <= {FLAG[c] for c in code}


def test_folded_joints_and_singularities(study):
    # The legs swing towards the first axes of their joints: beta grows with surge.
    robot = with_legs(
        study, lambda leg: leg.replace(stroke=None, u_axis=[1, 0, 0], piston=leg.piston.replace(length=90.0))
    ).robot
    values = np.zeros((2, 6))
    values[:, 0] = 3.0, 30.0
    path = poses_about_home(robot, values)
    tips = path.point(robot.platform_joints)[0] - robot.base_joints
    _, beta = kinematics.joint_angles(
        kinematics.home_frames(robot), tips / np.linalg.norm(tips, axis=-1, keepdims=True)
    )
    assert (np.abs(beta).max(axis=1) > BETA_LIMIT).tolist() == [False, True]
    codes = rigid_codes(kinematics.RigidPoses(robot, path), from_home=False)
    assert [FLAG[c] for c in codes] == ["reached", "joint_folds"]
    turned = np.zeros((3, 6))
    turned[:, 5] = np.deg2rad([0, 80, 100])
    codes = rigid_codes(kinematics.RigidPoses(robot, poses_about_home(robot, turned)), from_home=True)
    assert [FLAG[c] for c in codes] == ["reached", "reached", "singular"]
    assert not rigid_codes(kinematics.RigidPoses(robot, poses_about_home(robot, turned)), from_home=False).any()


def test_a_robot_that_sags_through_its_singularity_has_no_equilibrium(study):
    axes = {"roll": np.deg2rad(np.linspace(-60, 0, 7)), "yaw": np.deg2rad([-87.0, -84.0, -80.0])}
    data = fx.workspace_map(study, axes)
    assert {FLAG[c] for c in data.reason.values.ravel()} & {"falls_through", "gives_way", "not_settled", "unstable"}
    # Where there is one, the payload stays on the side of the singularity where home is.
    assert np.nanmax(data.static_deviation_size) < 0.02


def test_coordinates_come_back(study):
    values = np.random.default_rng(1).uniform(-1, 1, (20, 6))
    np.testing.assert_allclose(pose_coordinates(study.robot, poses_about_home(study.robot, values)), values, atol=1e-14)


def test_ranges_that_are_chosen(study):
    found = build_grid(study.robot, {"surge": None, "heave": Range(count=11), "yaw": None}, None)
    assert found.shape == (21, 11, 5)
    for name, values in found.values.items():
        assert 0.0 in values, name
        np.testing.assert_allclose(np.diff(values), values[1] - values[0])
    ends = np.zeros((2, 6))
    ends[:, 2] = found.values["heave"][[0, -1]]
    beyond = kinematics.RigidPoses(study.robot, poses_about_home(study.robot, ends))
    assert rigid_codes(beyond, from_home=True).all()  # a little beyond the reach
    slices = np.zeros((5, 6))
    slices[:, 5] = found.values["yaw"]
    assert not rigid_codes(
        kinematics.RigidPoses(study.robot, poses_about_home(study.robot, slices)), from_home=True
    ).any()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"axes": {"surg": None}}, "Did you mean 'surge'"),
        ({"axes": ["surge", "heave"]}, "not a set of coordinates by name"),
        ({"axes": "surge"}, "not a set of coordinates by name"),
        ({"axes": {3: [0.0]}}, "is not a coordinate"),
        ({"at": 3}, "not a set of coordinates by name"),
        ({"at": {2: 0.1}}, "is not a coordinate"),
        ({"axes": {}}, "number of axes"),
        ({"axes": dict.fromkeys(("surge", "sway", "heave", "yaw"))}, "number of axes"),
        ({"axes": {"surge": []}}, "not points"),
        ({"axes": {"surge": [0.1, 0.0]}}, "ascending"),
        ({"axes": {"surge": [np.nan]}}, "finite"),
        ({"axes": {"surge": Range(low=0.1, high=-0.1)}}, "begins where it should end"),
        ({"axes": {"surge": Range(count=0)}}, "not a number of points"),
        ({"axes": {"surge": Range(low=0, high=1, count=3_000_000)}}, "too many poses"),
        ({"at": {"heave": 0.1}}, "varies in this map"),
        ({"at": {"lift": 0.1}}, "is not a coordinate"),
        ({"at": {"roll": "10 mm"}}, "is not an angle"),
        ({"at": {"roll": [1.0, 2.0]}}, "is not a number"),
        ({"axes": {"roll": None}, "at": {"heave": 1.0}}, "out of reach"),
        ({"direction": "up"}, "is not a direction"),
        ({"direction": [0, 0, 0]}, "has no direction"),
        ({"acceleration": [1, 2]}, "is not a vector"),
        ({"frequencies": 0}, "number of modes"),
        ({"frequencies": 2.5}, "number of modes"),
        ({"fidelity": "rigid"}, "nothing that could vibrate"),
    ],
)
def test_input_that_is_refused(study, change, words):
    with pytest.raises(fx.InputError, match=words):
        fx.workspace_map(study, **{"axes": {"heave": [0.0], "surge": [0.0]}} | change)


def test_numbers_of_numpy_and_directions_of_any_length(study):
    data = fx.workspace_map(study, {"heave": [0.0]}, frequencies=np.int64(3), direction="x")
    assert data.sizes["mode"] == 3
    for length in (1e-200, 1e300):  # squares are not numbers
        along = fx.workspace_map(study, {"heave": [0.0]}, direction=[length, 0, 0])
        assert along.stiffness.item() == data.stiffness.item()


def test_margins_are_those_of_the_legs_that_have_limits(study):
    """Legs without a stroke once had their whole length left; one leg without a cylinder took the others' margin."""
    legs, at = study.robot.legs, {"heave": [0.0], "roll": [0.1]}

    def changed(change, numbers):
        some = [change(leg) if i in numbers else leg for i, leg in enumerate(legs, start=1)]
        return fx.workspace_map(study.replace(robot=study.robot.replace(legs=tuple(some))), at, fidelity="lumped")

    def no_stroke(leg):
        return leg.replace(stroke=None)

    def no_cylinder(leg):
        return leg.replace(cylinder=leg.cylinder.replace(mouth=0.0))

    length = kinematics.inverse_kinematics(
        study.robot, poses_about_home(study.robot, np.array([[0, 0, 0, 0.1, 0, 0]]))
    ).length[0]
    stroke, mouth, piston = legs[0].stroke, legs[0].cylinder.mouth, legs[0].piston.length
    margin = np.minimum(length - stroke.min, stroke.max - length)
    guided = np.minimum(piston, mouth + piston - length)
    worst = int(margin.argmin()) + 1
    assert changed(no_stroke, []).stroke_margin.item() == pytest.approx(margin.min(), rel=1e-12)
    assert changed(no_stroke, [worst]).stroke_margin.item() == pytest.approx(
        np.delete(margin, worst - 1).min(), rel=1e-12
    )
    assert np.isnan(changed(no_stroke, range(1, 7)).stroke_margin.item())
    worst = int(guided.argmin()) + 1
    assert changed(no_cylinder, [worst]).guided_length.item() == pytest.approx(
        np.delete(guided, worst - 1).min(), rel=1e-12
    )
    none = changed(no_cylinder, range(1, 7))
    assert np.isnan(none.guided_length.item())
    assert none.reason.item() == 0


def test_findings(study):
    data = fx.workspace_map(study, {"heave": [-0.3, -0.1, 0.0, 0.1]})
    found = map_findings(data)
    assert (found.poses, found.reached) == (4, 3)
    assert found.reasons == {"a leg is shorter than its stroke allows": 1}
    frequency = next(q for q in found.quantities if q.name == "frequency")
    first = data.frequency.values[:, 0]
    assert frequency.least == np.nanmin(first)
    assert frequency.least_at == {"heave": data.heave.values[np.nanargmin(first)]}
    assert frequency.home == first[2]
    assert axis_words(data) == "heave -300 mm to 100 mm (4)"
    second = next(q for q in map_findings(data, mode=2).quantities if q.name == "frequency")
    assert second.least == np.nanmin(data.frequency.values[:, 1])
    nothing = map_findings(fx.workspace_map(study, {"heave": [2.0, 3.0]}))
    assert (nothing.reached, nothing.quantities) == (0, ())


def test_progress_is_told(study):
    told = []
    fx.workspace_map(study, {"heave": np.linspace(0, 0.01, 201)}, fidelity="lumped", progress=lambda *x: told.append(x))
    assert [share for _, share in told] == [200 / 201, 1.0]


@pytest.mark.parametrize("axes", [("heave",), ("sway", "heave"), ("roll", "heave"), ("surge", "sway", "heave")])
def test_figures_of_lines_slices_and_volumes(study, axes, tmp_path):
    grids = {
        "heave": [-0.35, 0.0, 0.02],
        "roll": [0.0, 0.3],
        "sway": [-0.1, 0.0, 0.1, 0.5, 0.6],
        "surge": np.linspace(-1, 1, 5),
    }
    data = fx.workspace_map(study, {name: grids[name] for name in axes}, fidelity="lumped")
    for quantity in SCALARS if len(axes) == 2 else ["frequency"]:
        figure = fx.plot.workspace_map(data, quantity, mode=2)
        labels = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
        assert "home" in labels
        assert "a leg is shorter than its stroke allows" in labels
    assert "Natural frequency of mode 2" in fx.plot.workspace_map(data, mode=2).get_suptitle()
    assert fx.plot.save(figure, tmp_path / "map")[0].stat().st_size > 10_000


def test_rounding_has_no_colours_and_no_contours(study):
    # A map whose values differ in their last bits alone, as the gap of two joints that stand fixed: within 1e-12
    x = np.linspace(-0.1, 0.1, 7)
    data = fx.workspace_map(study, {"surge": x, "heave": 0.2 * x}, fidelity="lumped")
    wobble = 1 + 1e-13 * np.random.default_rng(1).standard_normal(data.leg_clearance.shape)
    for factor, lines in ((wobble, 0), (1 + 0.1 * data.surge, 1)):
        axes = fx.plot.workspace_map(
            data.assign(leg_clearance=0.0565 * (0 * data.leg_clearance + factor)), "leg_clearance"
        ).axes[0]
        mesh = next(c for c in axes.collections if hasattr(c, "get_coordinates"))
        colours = mesh.norm(mesh.get_array().compressed())
        assert (np.ptp(colours) > 0.9) == bool(lines)
        assert any("Contour" in type(c).__name__ for c in axes.collections) == bool(lines)


def test_cells_out_of_reach_are_not_coloured(study):
    data = fx.workspace_map(
        study, {"sway": [-0.1, 0.0, 0.1, 0.9], "heave": [-0.35, 0.0, 0.02, 0.04]}, fidelity="lumped"
    )
    mesh = fx.plot.workspace_map(data).axes[0].collections
    colours = next(c for c in mesh if hasattr(c, "get_coordinates")).get_array()
    np.testing.assert_array_equal(np.ma.getmaskarray(colours).reshape(4, 4), (data.reason.values != 0).T)


def test_figures_that_are_refused(study):
    data = fx.workspace_map(study, {"heave": [0.0]}, fidelity="lumped")
    with pytest.raises(fx.InputError, match="not in this map"):
        fx.plot.workspace_map(data, "speed")
    free = with_legs(study, stroke=None)
    without = fx.workspace_map(free, {"heave": [0.0]}, fidelity="lumped")
    with pytest.raises(fx.InputError, match="no leg has such a limit"):  # an empty picture once
        fx.plot.workspace_map(without, "stroke_margin")
    with pytest.raises(fx.InputError, match="cannot be drawn"):
        fx.plot.workspace_map(fx.modes(study, fidelity="lumped"))


def test_a_map_is_stored_and_read(study, tmp_path):
    data = fx.workspace_map(study, {"heave": [0.0, 2.0]}, fidelity="lumped")
    path = fx.study.save(data, tmp_path / "map.nc")
    again = fx.study.open_results(path)
    assert again.equals(data)
    assert again.reason.attrs["flag_meanings"] == data.reason.attrs["flag_meanings"]
    fx.plot.workspace_map(again)
