"""Screws in a loop: where the position is measured, what an encoder resolves, what the motor is told."""

import numpy as np
import pytest
from tests.consistency.test_screw_drive import EVERYTHING
from tests.machines import NUT, SCREW, machine, study

import flexapod as fx
from flexapod import model
from flexapod.errors import InputError
from flexapod.model import Encoder, Geometry, Heat, LengthSpread, RatioSpread, Rotor, Tolerances

TEXT = model.preset_text("machine-hexapod")
PARTS = {"rotor": [], "stroke": ["screw", "twist", "nut", "bearing", "bracket"],
         "joint-to-joint": ["screw", "twist", "nut", "bearing", "bracket", "base_joint", "platform_joint",
                            "axial-strain"]}  # fmt: skip


def at(place, **more):
    """A machine whose screws are measured at a place."""
    return machine(drive=SCREW.replace(encoder=Encoder(at=place)), **{**EVERYTHING, **more})


def changed(*pairs):
    text = TEXT
    for old, new in pairs:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return model.loads(text)


class TestMeasured:
    @pytest.mark.parametrize("place", list(PARTS))
    def test_parts_inside_the_loop_leave_the_systematic_column(self, place):
        found = fx.budget(study(at(place), fidelity="lumped"))
        left = {str(part) for part in found.part.values}
        everything = {"axial-strain", "base_joint", "platform_joint", "screw", "twist", "nut", "bearing", "bracket"}
        assert left - {"bending"} == everything - set(PARTS[place])

    def test_from_joint_to_joint_is_a_rotor_that_makes_up_for_everything(self):
        # The rotor's own commands corrected until the joints are as far from each other as they should be (T23.11).
        robot, offset = at("rotor"), np.zeros(6)
        for _ in range(3):
            given = robot.replace(geometry=Geometry(leg_offset=offset)) if offset.any() else robot
            rest = fx.simulate(study(given, fidelity="lumped", step=1e-3, duration=0.002)).isel(time=0)
            offset = offset + (rest.leg_length_command - rest.leg_length).values
        found = fx.simulate(study(at("joint-to-joint"), fidelity="lumped", step=1e-3, duration=0.002)).isel(time=0)
        assert 1e-5 < np.abs(offset).min()
        # Joints across the leg move by (1e3 N / 1.5e8 N/m)^2 / 2 m, 2e-11 m: what a real loop makes up for as well.
        np.testing.assert_allclose(found.com_position, rest.com_position, rtol=0, atol=1e-10)
        # Forces are of the same bodies at the same place; the piston is 3e-5 m farther out, its weight the same.
        np.testing.assert_allclose(found.joint_force, rest.joint_force, rtol=0, atol=0.1)
        np.testing.assert_allclose(found.drive_force, rest.drive_force, rtol=1e-4)

    def test_a_motion_keeps_energy_and_path(self):
        data = fx.simulate(study(at("joint-to-joint"), fidelity="lumped", step=1e-3))
        assert np.abs(data.com_deviation).max() < 1e-9
        total = (data.energy_kinetic + data.energy_potential + data.energy_strain + data.energy_dissipated
                 - data.work_drive - data.work_external)  # fmt: skip
        assert np.ptp(total.values) < 1e-3 * np.ptp(data.energy_potential.values)

    def test_errors_inside_the_loop_do_not_count(self):
        heat = Heat(piston=[25.0], cylinder=[25.0], screw=[25.0], base=25.0)
        tolerances = Tolerances(lead=RatioSpread(sigma=1e-5), EA=RatioSpread(sigma=0.01),
                                leg_offset=LengthSpread(sigma=1e-5))  # fmt: skip
        parts = {}
        for place in PARTS:
            nut = NUT.replace(backlash=1e-5)
            joint = EVERYTHING["base_joint"].replace(play=1e-5)
            drive = SCREW.replace(encoder=Encoder(at=place), nut=nut)
            robot = machine(**{**EVERYTHING, "base_joint": joint, "drive": drive})
            robot = robot.replace(heat=heat, tolerances=tolerances, geometry=Geometry(lead=[1e-4]))
            found = fx.budget(study(robot, fidelity="lumped"), {"heave": 0.05})
            parts[place] = {str(x) for x in found.part.values}
        lost = parts["rotor"] - parts["stroke"]
        assert lost == {*PARTS["stroke"], "lead", "lead tolerance", "heat_screw", "drive play"}
        more = parts["stroke"] - parts["joint-to-joint"]
        assert more == {*PARTS["joint-to-joint"]} - {*PARTS["stroke"]} | {
            "heat_piston", "heat_cylinder", "base_joint play", "EA tolerance"}  # fmt: skip
        assert {"heat_base", "leg_offset tolerance"} <= parts["joint-to-joint"]

    def test_beside_flexures_it_is_refused(self):
        flexure = model.Joint(stiffness=np.diag([1e8, 2e8, 1e8, 0, 0, 0]))
        with pytest.raises(InputError, match="joint-to-joint") as caught:
            at("joint-to-joint", base_joint=flexure, springs=())
        assert "encoder" in str(caught.value.key)


class TestResolution:
    @pytest.mark.parametrize(("place", "resolution", "step"), [
        ("rotor", 1e-3, 1e-3 * 0.01 / (2 * np.pi) / 3),
        ("stroke", 1e-7, 1e-7),
        ("joint-to-joint", 5e-7, 5e-7),
    ])  # fmt: skip
    def test_is_a_random_row(self, place, resolution, step):
        drive = SCREW.replace(encoder=Encoder(at=place, resolution=resolution), rotor=Rotor(inertia=2e-3, ratio=3))
        robot = machine(drive=drive)
        assert drive.increment == pytest.approx(step)
        found = fx.budget(study(robot, fidelity="lumped"))
        row = found.budget.sel(part="encoder", kind="random").values
        # An independent sensitivity: how far the tool moves by forward kinematics for a length that is longer.
        home, moved = robot.home_lengths, []
        for i in range(6):
            longer = home.copy()
            longer[i] += 1e-6
            pose = fx.forward_kinematics(robot, longer)
            tool = next(name for name in pose.data_vars if name.startswith("tool_position"))
            there = fx.forward_kinematics(robot, home)[tool].values.ravel()[:3]
            moved.append((pose[tool].values.ravel()[:3] - there) / 1e-6)
        expected = step / np.sqrt(12) * np.linalg.norm(moved, axis=0)
        np.testing.assert_allclose(row[:3], expected, rtol=1e-4)
        assert "Smallest increment" in found.attrs["summary"] and "encoders resolve" not in found.attrs["summary"]

    def test_uniform_steps_have_this_deviation(self):
        drawn = np.random.default_rng(1).uniform(0.0, 1e-3, 200_000)
        # 200,000 draws: some 1 / sqrt(2 n) of it.
        left = drawn - np.round(drawn / 1e-7) * 1e-7
        assert np.std(left) == pytest.approx(1e-7 / np.sqrt(12), rel=0.01)

    def test_files(self):
        old = 'command = "position"         # ours'
        for text, increment in (('{ at = "rotor", resolution = "0.36 deg" }', 1e-5),
                                ('{ at = "stroke", resolution = "0.1 um" }', 1e-7),
                                ('{ at = "joint-to-joint", resolution = "50 nm" }', 5e-8)):  # fmt: skip
            given = changed((old, f"encoder = {text}\n{old}"))
            assert given.robot.legs[0].screw.increment == pytest.approx(increment)
            assert model.loads(model.to_toml(given)).robot == given.robot
        for text in ('{ at = "rotor", resolution = "1 um" }', '{ at = "stroke", resolution = "1 deg" }',
                     '{ at = "stroke", resolution = 0 }', '{ at = "tool" }'):  # fmt: skip
            with pytest.raises(InputError) as caught:
                changed((old, f"encoder = {text}\n{old}"))
            assert caught.value.key.startswith("leg.drive.encoder")
