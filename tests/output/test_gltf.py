"""Motions as GLB files, read by another reader: where their vertices are is where the result says that the robot is."""

import json
import subprocess

import numpy as np
import pytest
from tests.helpers.machines import BASE, TOP
from tests.helpers.machines import study as machine_study
from tests.helpers.mechanisms import ROBOTS as KINDS
from tests.helpers.readers import GlbReader, z_up
from tests.helpers.samples import MECHANISMS, sample_study
from tests.helpers.stepped import section

import flexapod as fx
from flexapod.analysis.results.variables import VARIABLES
from flexapod.kinematics.rotations import exponential, matrix
from flexapod.model import CsvMotion, Guide, Piston, override
from flexapod.output.scene.geometry import RobotMotion
from flexapod.output.scene.style import LEG_COLORS

pytestmark = pytest.mark.consistency

SIDES, STATIONS = 16, 25
FLOAT32 = 2.0**-23  # of a number: what its storage may lose; half of it by rounding
ROBOTS = ("paper-robot", "tripod", "hexaglide", "delta", "planar", "in bushings", "on mounts")


def study_of(name):
    study = fx.preset("paper-robot")
    robot = study.robot
    if name == "in bushings":
        legs = tuple(leg.replace(guide=Guide(gland=2e8, head=2e8)) for leg in robot.legs)
        return override(study.replace(robot=robot.replace(legs=legs)), output_step=0.05)
    if name == "on mounts":
        return override(study.replace(robot=robot.replace(base_mount=BASE, platform_mount=TOP)), output_step=0.05)
    study = sample_study(name) if (MECHANISMS / f"{name}.toml").exists() else fx.preset(name)
    return override(study, output_step=0.02)


@pytest.fixture(scope="module", params=ROBOTS)
def motion(request, tmp_path_factory):
    """A study, its result, and the file of both."""
    study = study_of(request.param)
    data = fx.simulate(study)
    path = tmp_path_factory.mktemp("gltf") / "robot.glb"
    fx.export(study, "gltf", path, data=data)
    return study, data, GlbReader(path)


def instants(data):
    return np.linspace(0, data.sizes["time"] - 1, 7).astype(int)


def rings(points):
    """Centres of the rings of a rod's vertices, (stations, 3)."""
    return points.reshape(-1, SIDES, 3).mean(axis=1)


def test_bending_is_that_of_the_result_to_float32(motion):
    """A tip is bent off its cylinder's axis by `tip_deflection`: a sum of a few products of numbers in float32.

    Rings are means of 16 vertices a radius from the axis; by targets alone nothing of that size is added.
    """
    _, data, file = motion
    for k in instants(data):
        for i in range(data.sizes["leg"]):
            bent = rings(file.local(f"piston_{i + 1}", k))[-1, :2]
            deflection = data.tip_deflection.values[k, i]
            amplitudes = np.abs(data.lateral_amplitude.values[k, i]).sum()
            assert np.abs(bent - deflection).max() < 4 * FLOAT32 * max(amplitudes, 1e-9)


def test_tips_meet_the_platform_and_pistons_lie_where_the_page_draws_them(motion):
    """To some float32 of the robot's size; the page's lines lean by small angles: second order of deflections."""
    study, data, file = motion
    drawn, size = RobotMotion(study, data), float(study.robot.home_lengths.max())
    R = matrix(data.platform_quaternion.values)
    centre = data.com_position.values - R @ study.robot.com
    lost = 8 * FLOAT32 * size
    second = np.abs(data.tip_deflection.values).max() ** 2 / size
    for k in instants(data):
        joints = study.robot.platform_joints
        if study.robot.platform_mount is not None:  # they give way in platform axes
            arms, turn = joints - study.robot.platform_mount.at, data.platform_mount_rotation.values[k]
            joints = joints + data.platform_mount_displacement.values[k] + np.cross(turn, arms)
        tips = centre[k] + joints @ R[k].T
        flexible = drawn.instant_at(float(data.time[k]), 1.0).flexible
        for i in range(study.robot.count):
            line = rings(z_up(file.vertices(f"piston_{i + 1}", k)))
            assert line[-1] == pytest.approx(tips[i], abs=lost)
            assert line == pytest.approx(flexible.piston[i], abs=lost + second)


def test_the_payload_moves_as_the_result_says(motion):
    study, data, file = motion
    for time, _ in file.tracks.values():
        assert time == pytest.approx(data.time.values, rel=FLOAT32)
    R = matrix(data.platform_quaternion.values)
    for k in instants(data):
        T = file.transform(file.nodes["payload"], k)
        up = file.transform(file.nodes["robot"], k)[:3, :3]
        assert np.linalg.det(up) == pytest.approx(1) and up @ [0, 0, 1] == pytest.approx([0, 1, 0])
        assert up.T @ T[:3, :3] == pytest.approx(R[k], abs=8 * FLOAT32)
        com = up.T @ (T[:3, :3] @ study.robot.com + T[:3, 3])
        assert com == pytest.approx(
            data.com_position.values[k], abs=8 * FLOAT32 * float(study.robot.home_lengths.max())
        )


def test_quaternions_go_the_short_way(motion):
    _, _, file = motion
    for (_, path), (_, values) in file.tracks.items():
        if path == "rotation":
            assert (values[1:] * values[:-1]).sum(axis=1).min() > 0


def test_between_samples_a_platform_turns_on_where_its_quaternion_changes_sign(tmp_path):
    """Rocking twice past half a turn, a viewer's mean of two samples is half the way between their yaws, by hand."""
    study, home, time = fx.preset("paper-robot"), np.radians(178.0), np.linspace(0.0, 1.0, 41)
    robot = study.robot.replace(home=study.robot.home.replace(rotation=[0.0, 0.0, home]))
    yaw = 0.1 * (1 - np.cos(4 * np.pi * time))
    motion = CsvMotion(time=time, pose=np.stack([*np.zeros((5, 41)), yaw], axis=1))
    study = study.replace(robot=robot, motion=motion)
    study = override(study, fidelity="rigid", output_step=0.025, duration=1.0)
    file = GlbReader(fx.export(study, "gltf", tmp_path / "robot.glb", data=fx.simulate(study)).path)
    _, turns = file.tracks[file.nodes["payload"], "rotation"]
    for k in range(40):
        x, y, z, w = turns[k : k + 2].sum(axis=0) / np.linalg.norm(turns[k : k + 2].sum(axis=0))
        half = home + 0.5 * (yaw[k] + yaw[k + 1])
        assert [x, y] == pytest.approx([0, 0], abs=8 * FLOAT32)
        assert abs(w * np.cos(half / 2) + z * np.sin(half / 2)) == pytest.approx(1.0, abs=8 * FLOAT32)
    assert (np.diff(np.sign(np.cos((home + yaw) / 2))) != 0).sum() == 4  # it passes half a turn four times


def test_each_leg_has_its_colour(motion):
    """Of what is painted: pistons in the colour of their leg, light as sRGB's power says; cylinders alike in grey."""
    study, _, file = motion
    painted = {}
    for mesh in file.json["meshes"]:
        material = file.json["materials"][mesh["primitives"][0]["material"]]
        painted[mesh["name"]] = material["name"], material["pbrMetallicRoughness"]["baseColorFactor"]
    for i in range(study.robot.count):
        name, colour = painted[f"piston_{i + 1}"]
        wanted = [int(LEG_COLORS[i % len(LEG_COLORS)][k : k + 2], 16) / 255 for k in (1, 3, 5)]
        assert name == f"leg_{i + 1}" and np.array(colour[:3]) ** (1 / 2.2) == pytest.approx(wanted, abs=1e-12)
        if f"cylinder_{i + 1}" in painted:
            assert painted[f"cylinder_{i + 1}"][0] == "cylinder"
    names = [material["name"] for material in file.json["materials"]]
    assert len(set(names)) == len(names)  # each stands there once
    assert painted["base"][0] == "base" and painted["payload"][0] == "payload"


def test_a_node_for_each_body_and_names_of_results_alone(motion):
    study, _, file = motion
    count = study.robot.count
    bodies = {f"{name}_{i + 1}" for name in ("cylinder", "piston") for i in range(count)}
    bodies |= {f"carriage_{i + 1}" for i, leg in enumerate(study.robot.legs) if leg.carriage is not None}
    assert set(file.nodes) == bodies | {"robot", "base", "payload"}
    named = {x["name"].rstrip("0123456789").rstrip("_") for x in file.json["accessors"] if "name" in x}
    assert named - {"time"} <= set(VARIABLES)
    targets = [name for mesh in file.json["meshes"] for name in mesh.get("extras", {}).get("targetNames", ())]
    assert {name.split()[0] for name in targets} <= {"lateral_amplitude", "tip_deflection"}
    assert "/" not in json.dumps(file.json)


def test_deflections_can_be_magnified_and_rigid_robots_do_not_bend(tmp_path):
    study = study_of("tripod")
    data = fx.simulate(study, fidelity="rigid")
    plain = GlbReader(fx.export(study, "gltf", tmp_path / "rigid.glb", data=data).path)
    assert not any("targets" in x for mesh in plain.json["meshes"] for x in mesh["primitives"])
    data = fx.simulate(study)
    bent = [GlbReader(fx.export(study, "gltf", tmp_path / "b.glb", data=data, magnify=m).path) for m in (1.0, 100.0)]
    one, many = (rings(file.local("piston_1", 20))[:, :2] for file in bent)
    assert many[-1] == pytest.approx(100 * one[-1], rel=1e-6)
    between = 100 * one  # all along the piston, not at its tip alone; means of vertices a radius away, in float32
    assert many == pytest.approx(between, abs=1e-2 * np.abs(between).max())


def test_a_result_of_something_else_is_refused_and_a_wrong_factor(tmp_path):
    with pytest.raises(fx.InputError, match=r"magnify = 0.*above 0"):
        fx.export(study_of("tripod"), "gltf", tmp_path / "a.glb", magnify=0)
    with pytest.raises(fx.InputError, match=r"data.*a result of flexapod\.simulate"):
        fx.export(study_of("tripod"), "gltf", tmp_path / "a.glb", data=fx.modes(study_of("tripod")))


def test_khronos_validator_finds_nothing(motion, tmp_path):
    """Their own program, where `npm install gltf-validator` has put it within the reach of node."""
    script = (
        "const v = require('gltf-validator'), fs = require('fs');"
        "v.validateBytes(new Uint8Array(fs.readFileSync(process.argv[1])))"
        ".then(r => console.log(JSON.stringify(r.issues)));"
    )
    path = tmp_path / "robot.glb"
    study, data, _ = motion
    fx.export(study, "gltf", path, data=data)
    try:
        run = subprocess.run(["node", "-e", script, path], capture_output=True, text=True, check=True, timeout=300)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("gltf-validator is not installed: npm install gltf-validator, and NODE_PATH")
    issues = json.loads(run.stdout)
    assert (issues["numErrors"], issues["numWarnings"]) == (0, 0), issues["messages"]


@pytest.mark.parametrize("name", ["hexaglide", "6-RUS"])
def test_carriages_slide_and_cranks_turn_by_what_drives_do(tmp_path, name):
    """Base joints by hand: along the rail by the drive's way, about the shaft by its angle, where the rod ends."""
    study = machine_study(KINDS[name](), fidelity="rigid", output_step=0.02) if name in KINDS else study_of(name)
    data = fx.simulate(study, fidelity="rigid")
    file = GlbReader(fx.export(study, "gltf", tmp_path / "robot.glb", data=data).path)
    robot, lost = study.robot, 1e-6
    moved = data.drive_position.values  # from the foot of the rail, from the arm as it is given
    for i, leg in enumerate(robot.legs):
        way, home = leg.carriage, robot.base_joints[i]
        for k in instants(data):
            cylinder = z_up(file.transform(file.nodes[f"cylinder_{i + 1}"], k)[None, :3, 3])[0]
            rod = rings(z_up(file.vertices(f"carriage_{i + 1}", k)))
            axis = way.axis / np.linalg.norm(way.axis)
            if way.kind == "slider":
                assert cylinder == pytest.approx(home + moved[k, i] * axis, abs=lost)
                assert rod.mean(axis=0) == pytest.approx(cylinder, abs=lost)
                assert np.abs(np.cross(rod[-1] - rod[0], axis)).max() < lost
            else:
                turned = exponential(axis * moved[k, i]) @ way.arm
                assert cylinder == pytest.approx(home + turned, abs=lost)
                assert rod[0] == pytest.approx(home, abs=lost)
                assert rod[-1] == pytest.approx(cylinder, abs=lost)
    assert np.ptp(moved, axis=0).max() > 1e-3


def test_rods_are_as_thick_as_their_pistons(tmp_path):
    """A stepped piston has at each station the radius of its section, its tube half as much again as at the mouth."""
    study = override(fx.preset("paper-robot"), fidelity="rigid", output_step=0.5)
    stepped = Piston.stepped([section(0.5, 0.04), section(0.25, 0.02)])  # from the drive to the tip
    robot = study.robot.replace(legs=tuple(leg.replace(piston=stepped) for leg in study.robot.legs))
    study = study.replace(robot=robot)
    file = GlbReader(fx.export(study, "gltf", tmp_path / "robot.glb", data=fx.simulate(study)).path)
    free = robot.home_lengths[0] - robot.legs[0].cylinder.mouth
    ring = file.local("piston_1", 0).reshape(-1, SIDES, 3)
    from_tip = free * (1 - ring[:, 0, 2] / ring[:, 0, 2].max())
    assert free > 0.3
    sure = np.abs(from_tip - 0.25) > free / STATIONS
    expected = np.where(from_tip < 0.25, 0.01, 0.02)[sure, None] * np.ones(SIDES)
    assert np.linalg.norm(ring[..., :2], axis=-1)[sure] == pytest.approx(expected, rel=1e-6)
    tube = file.local("cylinder_1", 0).reshape(-1, SIDES, 3)
    assert np.linalg.norm(tube[..., :2], axis=-1) == pytest.approx(np.full(tube.shape[:2], 0.03), rel=1e-6)


def test_shapes_that_change_with_the_stroke_are_told(tmp_path):
    """Of a uniform rod they depend on the place over its free length alone, of a stepped one on where its step is."""
    study = override(fx.preset("paper-robot"), output_step=0.1, duration=0.2)
    stepped = Piston.stepped([section(0.5, 0.04), section(0.25, 0.02)])
    legs = tuple(leg.replace(piston=stepped) for leg in study.robot.legs)
    other = study.replace(robot=study.robot.replace(legs=legs))
    for each, told in ((study, False), (other, True)):
        found = fx.export(each, "gltf", tmp_path / f"{told}.glb", data=fx.simulate(each))
        assert any("change with the stroke" in words for words in found.left_out) == told
