"""Points, meshes, colours and charts of the view, without a browser."""

from functools import cache

import numpy as np
import pytest
from tests.helpers.mechanisms import ROBOTS

import flexapod as fx
from flexapod import kinematics, model
from flexapod.app.browser import charts as view_charts
from flexapod.app.browser import legend
from flexapod.mechanics import shapes
from flexapod.model import CombinedMotion, Guide, Piston, PistonSection, preset
from flexapod.output.scene import geometry, skeleton
from flexapod.output.scene.skeleton import STATIONS, Skeleton
from flexapod.output.scene.style import LEG_COLORS, colors_of_legs

pytestmark = pytest.mark.unit


@cache
def robot_run(**settings):
    study = fx.preset("paper-robot")
    data = fx.simulate(study.replace(motion=study.motion.replace(duration=0.3, hold=0.0)), duration=0.3, **settings)
    return fx.loads(data.attrs["study"]), data


@cache
def actuator_run():
    study = fx.preset("paper-actuator")
    data = fx.simulate_actuator(study, duration=1.0)
    return fx.loads(data.attrs["study"]), data


def test_in_true_size_the_robot_stands_where_the_result_says():
    study, data = robot_run()
    now = geometry.RobotMotion(study, data).instant_at(0.2, 1.0)
    at = data.isel(time=now.index)
    R = at.platform_quaternion.values
    arms = study.robot.platform_joints - study.robot.payload.com
    turned = arms @ rotation(R).T
    # The same numbers by another path: rounding only.
    assert now.flexible.com == pytest.approx(at.com_position.values, abs=1e-15)
    assert now.flexible.platform == pytest.approx(at.com_position.values + turned, abs=1e-14)
    assert now.rigid.com == pytest.approx(at.com_position_rigid.values, abs=1e-15)
    lengths = np.linalg.norm(now.rigid.platform - now.rigid.base, axis=1)
    assert lengths == pytest.approx(at.leg_length_command.values, abs=1e-14)


def rotation(q):
    """Rotation matrix of a quaternion w x y z, by hand."""
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


@pytest.mark.parametrize("settings", [{}, {"basis": "clamped-free", "modes": 5}, {"fidelity": "beam-fem", "modes": 4}])
def test_the_drawn_centre_line_is_the_bent_piston(settings):
    """Against the leg's own coordinates: cylinder axis from the joint's angles, shapes on it."""
    study, data = robot_run(**settings)
    i = int(np.abs(data.tip_deflection.values).max(axis=(1, 2)).argmax())
    drawn = geometry.RobotMotion(study, data).instant_at(float(data.time[i]), 1.0).flexible.piston
    at, robot, zeta = data.isel(time=i), study.robot, np.linspace(0, 1, STATIONS)
    simulation = study.simulation
    phi = shapes.lateral_basis(simulation.lateral_basis, simulation.lateral_shapes).values(zeta)
    frames = kinematics.home_frames(robot)
    largest = float(np.abs(at.tip_deflection).max())
    for leg in range(6):
        alpha, beta = at.leg_angle.values[leg]
        cx, sx, cy, sy = np.cos(alpha), np.sin(alpha), np.cos(beta), np.sin(beta)
        turned = frames[leg] @ np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]]) @ [[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]]
        across = at.lateral_amplitude.values[leg] @ phi
        mouth = robot.legs[leg].cylinder.mouth
        along = mouth + (float(at.leg_length[leg]) - mouth) * zeta
        exact = robot.base_joints[leg] + np.stack([*across, along], axis=1) @ turned.T
        # The chord and the axis of the cylinder differ by the angle tip/length: second order in the deflection.
        assert np.abs(drawn[leg] - exact).max() < 2 * largest**2 / 0.3
        assert np.abs(across).max() > 100 * largest**2 / 0.3  # so the line would be seen to be wrong


def test_magnified_pistons_still_join_cylinder_and_platform():
    study, data = robot_run()
    motion = geometry.RobotMotion(study, data)
    factor = motion.automatic_scale()
    assert factor > 1
    now = motion.instant_at(0.3, factor)
    assert now.flexible.piston[:, -1] == pytest.approx(now.flexible.platform, abs=1e-12)
    mouths = np.linalg.norm(now.flexible.mouth - now.flexible.base, axis=1)
    # The cylinder is as long as it is, up to the square of its lean of at most 0.12 (the automatic factor's share).
    assert mouths == pytest.approx([leg.cylinder.mouth for leg in study.robot.legs], rel=0.12**2)
    assert now.flexible.com - now.rigid.com == pytest.approx(factor * now.deviation, abs=1e-12)


def test_rigid_and_lumped_legs_are_drawn_straight():
    for fidelity in ("rigid", "lumped"):
        study, data = robot_run(fidelity=fidelity)
        motion = geometry.RobotMotion(study, data)
        assert (motion.automatic_scale() == 1) == (fidelity == "rigid")  # rounding is not magnified
        drawn = motion.instant_at(0.1, 1000.0).flexible
        chord = drawn.platform - drawn.base
        away = np.cross(drawn.piston - drawn.base[:, None], chord[:, None])
        assert np.abs(away).max() < 1e-12


def test_results_are_drawn_with_the_shapes_they_were_computed_with():
    """Results whose study could not be read whole come with default settings: once a mismatch of three and five."""
    study, data = robot_run(basis="clamped-free", modes=5)
    lost = study.replace(simulation=model.Simulation())
    one, other = (
        geometry.RobotMotion(study, data).instant_at(0.3, 50.0),
        geometry.RobotMotion(lost, data).instant_at(0.3, 50.0),
    )
    assert np.array_equal(one.flexible.piston, other.flexible.piston)
    assert geometry.computed_study(study, data) is study


def test_the_beam_of_the_actuator_ends_where_the_result_says():
    study, data = actuator_run()
    motion = geometry.BeamMotion(study, data)
    i, bent, straight = motion.frame_at(0.7, 1.0)
    X, Y = data.tip_position.values[i]
    # The drawn beam is not foreshortened: (3/5) v^2 / L of a static shape, about 1e-5 m here.
    assert bent[-1] == pytest.approx([X, 0.0, Y], abs=2 * float(np.abs(data.tip_deflection).max()) ** 2 / 1.83)
    assert np.linalg.norm(straight[-1] - straight[0]) == pytest.approx(float(data.length[i]), rel=1e-14)
    i, bent, straight = motion.frame_at(0.7, 20.0)
    assert motion.tips(20.0)[i] == pytest.approx(bent[-1], abs=1e-12)
    assert np.linalg.norm(bent[-1] - straight[-1]) == pytest.approx(20 * abs(float(data.tip_deflection[i])), rel=1e-12)


@pytest.mark.parametrize(("factor", "shown"), [(0.2, 1), (1, 1), (1.9, 1), (2, 2), (49, 20), (50, 50), (1e6, 1e6)])
def test_round_down(factor, shown):
    assert geometry.round_down(factor) == shown


def test_nearest_instant():
    instants = np.array([0.0, 0.1, 0.2])
    assert [geometry.nearest_index(instants, t) for t in (-1.0, 0.04, 0.06, 0.19, 9.0)] == [0, 0, 1, 2, 2]


def test_tubes_have_their_radius_and_close_around():
    line = np.stack([np.linspace(0, 1, 9), 0.1 * np.linspace(0, 1, 9) ** 2, np.zeros(9)], axis=1)
    rings = geometry.tube(np.stack([line, line[:, ::-1]]), 0.02).reshape(2, 9, 8, 3)
    assert np.linalg.norm(rings[0] - line[:, None], axis=-1) == pytest.approx(np.full((9, 8), 0.02), rel=1e-12)
    faces = geometry.tube_faces(9)
    assert faces.max() == 71 and len(faces) == 128
    assert volume(rings[0].reshape(-1, 3), faces) > 0  # outward: else it is drawn from inside


def volume(vertices, faces):
    """Enclosed volume of a surface with outward triangles."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6


def test_plates_are_closed_and_face_outward():
    square = np.array([[1.0, 1, 0], [-1, 1, 0], [1, -1, 0], [-1, -1, 0]])
    # A square of 2 by 2 and 0.1 thick, its corners in any order.
    assert volume(*geometry.plate(square, 0.1)) == pytest.approx(0.4, rel=1e-12)
    vertices, faces = geometry.disc(0.5, 0.2, sides=40)
    area = 0.5 * 40 * 0.25 * np.sin(2 * np.pi / 40)
    assert volume(vertices, faces) == pytest.approx(0.2 * area, rel=1e-12)
    assert np.abs(vertices[:, 1]).max() == pytest.approx(0.1)


def test_orientation_turns_z_into_a_direction():
    directions = np.array([[0, 0, 1.0], [1, 0, 0], [0.3, -2, 0.5], [0, 0, -1]])
    for q, d in zip(geometry.orientation(directions), directions, strict=True):
        assert rotation(q)[:, 2] == pytest.approx(d / np.linalg.norm(d), abs=1e-12)


def test_rotation_of_a_drawn_robot():
    study, data = robot_run()
    now = geometry.RobotMotion(study, data).instant_at(0.3, 1.0)
    assert now.flexible.rotation == pytest.approx(rotation(data.platform_quaternion.values[now.index]), abs=1e-12)


def test_paths_are_thinned_and_keep_their_ends():
    path = np.linspace([0, 0, 0], [1, 2, 3], 5001)
    segments = geometry.path_segments(path, 400)
    assert segments.shape == (400, 2, 3)
    assert np.array_equal(segments[0, 0], path[0]) and np.array_equal(segments[-1, 1], path[-1])
    assert np.array_equal(segments[1:, 0], segments[:-1, 1])


def test_leg_colors_of_figures_and_view_are_the_same():
    assert view_charts.charts(robot_run()[1])["leg forces"].colors == LEG_COLORS
    for color in LEG_COLORS:
        assert f"rgb({','.join(map(str, legend.rgb(color)))})" in legend.plain_legend(6)


@pytest.mark.parametrize("quantity", legend.QUANTITIES[1:])
def test_colours_span_the_scale_and_the_legend_tells_the_values(quantity):
    study, data = robot_run()
    found = legend.leg_colors(quantity, study, data)
    assert found.low < found.high
    assert (found.values >= found.low - 1e-12).all() and (found.values <= found.high + 1e-12).all()
    first = np.unravel_index(found.values.argmax(), found.values.shape)
    html = found.html(int(first[0]))
    assert found.title in html and html.count("leg ") >= 6
    colors = found.colors(int(first[0]))
    assert colors.shape == (6, 3) and colors.min() >= 0 and colors.max() <= 255
    end = found.anchors[-1] if found.values[first] == found.high else found.anchors[0]
    assert quantity == "force" or tuple(colors[first[1]]) == legend.rgb(end)


def test_stroke_margins_are_what_is_left():
    study, data = robot_run()
    found = legend.leg_colors("stroke margin", study, data)
    stroke = study.robot.legs[0].stroke
    length = data.leg_length.values[-1, 0]
    assert found.values[-1, 0] == pytest.approx(1e3 * min(length - stroke.min, stroke.max - length), rel=1e-12)
    first, *others = study.robot.legs
    length = data.leg_length.values[:, 1]
    narrow = others[0].replace(stroke=others[0].stroke.replace(min=float(np.median(length))))
    robot = study.robot.replace(legs=(first.replace(stroke=None), narrow, *others[1:]))
    found = legend.leg_colors("stroke margin", study.replace(robot=robot), data)
    beyond = int(length.argmin())
    colors = found.colors(beyond)
    assert np.isnan(found.values[:, 0]).all() and "leg 1: no limits" in found.html(0)
    assert found.values[beyond, 1] < 0
    grey, red = legend.rgb("#A8A8A8"), legend.rgb("#D6002F")  # neither is on the scale of what is left
    assert tuple(colors[0]) == grey and tuple(colors[1]) == red
    assert tuple(colors[2]) not in (grey, red)


def test_charts_keep_extremes_and_values():
    _, data = robot_run()
    drawn = view_charts.charts(data)
    assert list(drawn) == ["deviation", "leg forces", "tip deflections", "energies"]
    deviation = drawn["deviation"]
    assert deviation.unit == "µm"
    assert deviation.values == pytest.approx(1e6 * data.com_deviation.values.T)
    time, values = deviation.values_at(0.1004)  # of the nearest stored instant, as in the scene
    assert time == pytest.approx(0.1)
    assert values == pytest.approx(1e6 * data.com_deviation.sel(time=0.1, method="nearest").values)
    signal = np.vstack([np.sin(np.arange(5000.0)), np.zeros(5000)])
    signal[0, 1234] = 7.0  # one instant among thousands
    kept = geometry.decimation_indices(signal, view_charts.MOST)
    assert 1234 in kept and len(kept) <= view_charts.MOST + 2
    assert kept[0] == 0 and kept[-1] == 4999 and (np.diff(kept) > 0).all()
    assert list(view_charts.charts(actuator_run()[1])) == ["tip deflection", "length", "torque", "force", "energies"]


def test_the_hull_of_a_platform_leaves_out_a_joint_in_its_middle():
    corners = np.array([[0.2, 0, 1.0], [-0.1, 0.17, 1], [-0.1, -0.17, 1], [0, 0, 1], [0.01, 0.02, 1]])
    assert sorted(skeleton.convex_hull(corners)) == [0, 1, 2]
    hexagon = np.array([[np.cos(a), np.sin(a), 0.3 * np.sin(a)] for a in (0, 2, 1, 4, 3, 5)])
    order = list(skeleton.convex_hull(hexagon))
    start = order.index(0)
    ring = order[start:] + order[:start]
    assert ring in ([0, 2, 1, 4, 3, 5], [0, 5, 3, 4, 1, 2])


@pytest.mark.parametrize("name", list(ROBOTS))
def test_a_rigid_mechanism_at_home_is_drawn_where_its_joints_are(name):
    robot = ROBOTS[name]()
    drawn = skeleton.Skeleton(robot).home
    # Positions of carriages at home are computed twice, by the reader and for the picture: rounding.
    np.testing.assert_allclose(drawn.base, robot.home_bases, rtol=0, atol=1e-12)
    np.testing.assert_allclose(drawn.platform, robot.home_tips, rtol=0, atol=1e-15)
    np.testing.assert_allclose(drawn.piston[:, -1], drawn.platform, rtol=0, atol=1e-12)
    hinges = sum(
        "R" in joints for joints in [j for leg in robot.legs for j in (leg.letters.base, leg.letters.platform)]
    )
    cranks = sum(leg.letters.carriage == "crank" for leg in robot.legs)
    assert len(drawn.hinges) == hinges + cranks
    assert len(drawn.guides) == sum(leg.carriage is not None for leg in robot.legs)


@pytest.mark.parametrize("name", ["6-PUS", "6-RUS", "3-PUU", "planar 3-PRR", "3-UPS+UP"])
def test_struts_keep_their_length_where_the_platform_moves(name):
    robot = ROBOTS[name]()
    path = kinematics.poses(
        robot, CombinedMotion(amplitudes={"yaw" if robot.plane else "heave": 0.03}, duration=1.0), [0.7]
    )
    drawn = skeleton.Skeleton(robot).scene_at(path.position[0], path.rotation[0])
    legs = kinematics.inverse_kinematics(robot, path)
    lengths = np.linalg.norm(drawn.platform - drawn.base, axis=1)
    np.testing.assert_allclose(lengths, legs.length[0], rtol=0, atol=1e-9)  # gap of a guided pose


def test_colours_of_many_legs_differ():
    assert colors_of_legs(6) == LEG_COLORS and len(set(colors_of_legs(16))) == 16


def test_pistons_are_as_thick_as_their_sections_and_end_at_their_heads():
    steel = {"E": 2e11, "density": 7800.0}
    thick = PistonSection(length=0.35, diameter=0.04, **steel)
    cone = PistonSection(length=0.5, diameter=0.04, tip_diameter=0.02, **steel)
    robot = preset("paper-robot").robot
    leg = robot.legs[0].replace(piston=Piston.stepped([thick, cone]), guide=Guide(gland=1e8, head=1e8))
    home = Skeleton(robot.replace(legs=(leg, *robot.legs[1:]))).home
    assert home.radii[0, -1] == pytest.approx(0.01) and home.radii[0, 0] == pytest.approx(0.02)
    free = np.linalg.norm(home.piston[0, -1] - home.piston[0, 0])
    np.testing.assert_allclose(home.radii[0, 12], 0.01 + 0.01 * (free / 2) / 0.5)
    assert home.radii[1] == pytest.approx(0.5 * robot.legs[1].piston.diameter)
    assert home.heads.shape == (1, 2, 3)
    np.testing.assert_allclose(home.heads[0, 0], home.mouth[0])
    np.testing.assert_allclose(np.linalg.norm(home.heads[0, 1] - home.platform[0]), 0.85)
