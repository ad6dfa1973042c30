"""Study files: presets, every section, every refusal."""

import math
import re

import numpy as np
import pytest
from tests.helpers.texts import replaced

from flexapod import model
from flexapod.common.errors import InputError

pytestmark = pytest.mark.unit

ROBOT = model.preset_text("paper-robot")
ACTUATOR = model.preset_text("paper-actuator")


def robot_with(old: str, new: str, text: str = ROBOT) -> str:
    """The preset with one piece of text replaced; `old` must be there, so that a test cannot pass by accident."""
    return replaced(text, (old, new))


def with_motion(motion: str) -> str:
    return re.sub(r"\[motion\].*?(?=\[simulation\])", f"[motion]\n{motion}\n", ROBOT, flags=re.S)


def refusal(text: str, **kwargs) -> InputError:
    with pytest.raises(InputError) as caught:
        model.loads(text, **kwargs)
    return caught.value


class TestPresets:
    def test_paper_robot_is_the_contract(self):
        study = model.preset("paper-robot")
        robot, leg = study.robot, study.robot.legs[0]
        np.testing.assert_allclose(np.linalg.norm(robot.base_joints, axis=1), 0.25, rtol=1e-15)
        np.testing.assert_allclose(np.linalg.norm(robot.platform_joints, axis=1), 0.15, rtol=1e-15)
        assert robot.home_height == 0.9
        assert robot.gravity.tolist() == [0, 0, -9.81]
        assert robot.payload.mass == 100
        assert robot.payload.com.tolist() == robot.payload.tool.tolist() == [0, 0.373, 0]
        np.testing.assert_array_equal(robot.payload.inertia, 17.88 * np.eye(3))
        assert leg.cylinder == model.Cylinder(mass=3.0, com=0.1575, inertia=0.0248, mouth=0.31518)
        assert leg.stroke == model.Stroke(min=0.7, max=1.05)
        assert (leg.damping, leg.axial_modes, leg.drive) == (0.005, 2, model.PrescribedDrive())
        motion = model.AxisMotion(type="roll", amplitude=math.radians(26.6), duration=1.0, hold=1.0)
        assert study.motion == motion
        assert study.simulation == model.Simulation(fidelity="assumed-modes", modes=3, duration=2.0, tolerance=1e-4)
        assert (study.simulation.basis, study.initial.start, study.warnings) == ("tip-load", "equilibrium", ())

    def test_piston_of_the_paper(self):
        # REFERENCES section 1: A = 5.7256e-4, I = 2.6087e-8, EI = 5217.4, EA = 1.1451e8, m = 4.466 (as printed).
        piston = model.preset("paper-robot").robot.legs[0].piston
        assert piston.EI == pytest.approx(5217.4, rel=1e-5)
        assert piston.EA == pytest.approx(1.1451e8, rel=1e-4)
        assert piston.rhoA == pytest.approx(4.466, rel=1e-4)

    @pytest.mark.parametrize("name", ["paper-robot", "paper-robot-radii"])
    def test_600_mm_of_piston_are_free_at_home(self, name):
        # The mouth is given to 0.01 mm, so the free length is right to half of that.
        robot = model.preset(name).robot
        free = robot.home_lengths - robot.legs[0].cylinder.mouth
        np.testing.assert_allclose(free, 0.6, atol=0.5e-5)

    def test_radii_reading(self):
        study = model.preset("paper-robot-radii")
        np.testing.assert_allclose(np.linalg.norm(study.robot.base_joints, axis=1), 0.5, rtol=1e-15)
        np.testing.assert_allclose(np.linalg.norm(study.robot.platform_joints, axis=1), 0.3, rtol=1e-15)
        leg = study.robot.legs[0]
        assert leg.cylinder == model.Cylinder(mass=3.0, com=0.1796, inertia=0.0323, mouth=0.35926)
        assert leg.stroke == model.Stroke(min=0.8, max=1.12)
        assert study.motion.target[3] == math.radians(30)
        ordinary = model.preset("paper-robot").robot
        assert (study.robot.payload, leg.piston) == (ordinary.payload, ordinary.legs[0].piston)

    def test_paper_actuator_is_the_contract(self):
        study = model.preset("paper-actuator")
        assert study.actuator == model.Actuator(length=3.66, rhoA=4.02, EI=756.65, free_length=1.83)
        assert study.motion.rotation == model.RateLaw(rate=0.785)
        assert study.motion.extension == model.RateLaw(rate=0.1)
        assert study.initial.tip_displacement == 0.005
        assert (study.simulation.modes, study.duration, study.simulation.basis) == (3, 10.0, "clamped-free")

    def test_joint_angles_of_the_contract(self):
        # Leg: base angle, platform angle [deg] for half-angles b and p.
        b, p = 10.0, 7.0
        base = [-b, b, 120 - b, 120 + b, 240 - b, 240 + b]
        platform = [-60 + p, 60 - p, 60 + p, 180 - p, 180 + p, 300 - p]
        for joints, angles in (
            (model.base_circle(2.0, math.radians(b)), base),
            (model.platform_circle(2.0, math.radians(p)), platform),
        ):
            expected = [[2 * math.cos(math.radians(a)), 2 * math.sin(math.radians(a)), 0] for a in angles]
            np.testing.assert_allclose(joints, expected, atol=1e-15 * 10)

    @pytest.mark.parametrize("name", model.PRESETS)
    def test_open_values_have_a_reason_and_a_value(self, name):
        values = model.open_values(name)
        assert len({value.key for value in values}) == len(values) > 5
        assert all(len(value.reason) > 10 and value.value for value in values)
        assert model.preset_text(name).count("# ours") == len(values)

    def test_what_the_contract_calls_ours_is_marked(self):
        keys = {value.key for value in model.open_values("paper-robot")}
        ours = {
            "payload.com", "motion.amplitude", "motion.duration", "robot.base.half_angle", "robot.platform.half_angle",
            "robot.home_height", "leg.piston.length", "leg.cylinder.mass", "leg.cylinder.mouth",
        }  # fmt: skip
        assert ours <= keys
        printed = {"payload.mass", "payload.inertia", "robot.gravity", "leg.piston.diameter", "robot.base.radius"}
        assert not printed & keys

    def test_unknown_preset(self):
        with pytest.raises(InputError, match=r"paper-robo.*Did you mean 'paper-robot'"):
            model.preset("paper-robo")


class TestReading:
    def test_text_and_path_are_kept(self, tmp_path):
        file = tmp_path / "mine.toml"
        file.write_text(ROBOT, encoding="utf-8")
        study = model.load(file)
        assert study.source_text == ROBOT
        assert study.path == str(file)

    def test_six_unequal_legs(self):
        leg = """[[leg]]
cylinder = {{ mass = 0, mouth = 0 }}
piston = {{ diameter = "{d} mm", inner_diameter = "10 mm", length = 1, E = "70 GPa", density = 2700 }}
u_axis = [1, 0, 0]
axial_modes = 1
"""
        legs = "\n".join(leg.format(d=20 + i) for i in range(6))
        text = re.sub(r"\[leg\].*?(?=\[motion\])", lambda _: legs, ROBOT, flags=re.S)
        study = model.loads(text)
        assert [leg.piston.diameter for leg in study.robot.legs] == [0.02, 0.021, 0.022, 0.023, 0.024, 0.025]
        first = study.robot.legs[0]
        assert first.piston.EA == pytest.approx(70e9 * math.pi / 4 * (0.02**2 - 0.01**2), rel=1e-15)
        assert first.piston.EI == pytest.approx(70e9 * math.pi / 64 * (0.02**4 - 0.01**4), rel=1e-15)
        assert (first.axial_modes, first.u_axis.tolist(), first.stroke, first.damping) == (1, [1, 0, 0], None, 0.0)
        assert "appears 5 times" in str(refusal(text.replace(leg.format(d=25), "")))

    def test_stiffness_given_directly(self):
        text = robot_with(
            '{ diameter = "27 mm", length = "750 mm", material = "steel" }',
            '{ length = "750 mm", EI = "5 kN m^2", EA = "0.1 GN", rhoA = 4.5 }',
        )
        piston = model.loads(text).robot.legs[3].piston
        assert (piston.EI, piston.EA, piston.rhoA, piston.E, piston.diameter) == (5e3, 1e8, 4.5, None, None)

    def test_joints_and_tensor(self):
        rows = [[round(0.3 * math.cos(a), 3), round(0.3 * math.sin(a), 3), 0.01] for a in range(6)]
        text = robot_with('{ radius = "250 mm", half_angle = "10 deg" }', f"{{ joints = {rows} }}")
        tensor = [[2.0, 0.1, 0], [0.1, 2.5, 0], [0, 0, 3.0]]
        text = robot_with("inertia = [17.88, 17.88, 17.88]", f"inertia = {tensor}", text)
        robot = model.loads(text).robot
        assert robot.base_joints.tolist() == rows
        assert robot.payload.inertia.tolist() == tensor

    @pytest.mark.parametrize(
        ("drive", "expected"),
        [
            (
                '{ type = "servo", stiffness = "50 N/um", damping = 200 }',
                model.ServoDrive(stiffness=5e7, damping=200.0),
            ),
            ('{ type = "force" }', model.ForceDrive(law="rigid")),
            (
                '{ type = "force", law = "rigid", feedback = { stiffness = 1e6, damping = 1e3 } }',
                model.ForceDrive(feedback=model.Feedback(stiffness=1e6, damping=1e3)),
            ),
        ],
    )
    def test_drives(self, drive, expected):
        assert model.loads(robot_with('{ type = "prescribed" }', drive)).robot.legs[5].drive == expected

    def test_force_table(self, tmp_path):
        header = ", ".join(["time [s]", *(f"leg {i} [kN]" for i in range(1, 7))])
        (tmp_path / "f.csv").write_text(f"{header}\n0,1,2,3,4,5,6\n1,1,2,3,4,5,7\n")
        text = robot_with('{ type = "prescribed" }', '{ type = "force", law = "csv", file = "f.csv" }')
        legs = model.loads(text, path=tmp_path / "s.toml").robot.legs
        assert [leg.drive.force.tolist() for leg in legs][-2:] == [[5000, 5000], [6000, 7000]]
        assert legs[0].drive.time.tolist() == [0, 1]

    def test_motions(self):
        study = model.loads(
            with_motion(
                'type = "combined"\namplitudes = { roll = "5 deg", heave = "10 mm" }\nduration = 1\nprofile = "smooth"'
            )
        )
        np.testing.assert_allclose(study.motion.target, [0, 0, 0.01, math.radians(5), 0, 0], rtol=1e-15)
        study = model.loads(
            with_motion('type = "waypoints"\nhold = 0.5\npoints = [{ time = 1, yaw = 0.1 }, { time = "2 s" }]').replace(
                'duration = "2 s"             # ours: motion and hold', ""
            )
        )
        assert study.motion.times.tolist() == [0, 1, 2]
        assert study.motion.poses[:, 5].tolist() == [0, 0.1, 0]
        assert study.duration == 2.5

    @pytest.mark.parametrize("profile", model.PROFILES)
    def test_profiles(self, profile):
        assert model.loads(robot_with('"quintic"', f'"{profile}"')).motion.profile == profile

    def test_loads(self, tmp_path):
        (tmp_path / "w.csv").write_text("time [s], Fz [N]\n0, 1\n2, 3\n")
        path = tmp_path / "s.toml"
        cases = {
            '["1 kN", 0, 0, 0, 0, "5 N m"]': model.ConstantWrench(value=[1000, 0, 0, 0, 0, 5]),
            '{ law = "sine", amplitude = [1, 0, 0, 0, 0, 0], frequency = "5 Hz" }': model.SineWrench(
                amplitude=[1, 0, 0, 0, 0, 0], frequency=5.0
            ),
            '{ law = "step", amplitude = [1, 0, 0, 0, 0, 0], time = 0.5 }': model.StepWrench(
                amplitude=[1, 0, 0, 0, 0, 0], time=0.5
            ),
            '{ law = "csv", file = "w.csv" }': model.CsvWrench(
                file="w.csv", time=[0.0, 2.0], wrench=[[0, 0, 1, 0, 0, 0], [0, 0, 3, 0, 0, 0]]
            ),
        }
        for text, expected in cases.items():
            assert model.loads(f"{ROBOT}\n[load]\nwrench = {text}", path=path).load.wrench == expected

    def test_actuator_of_section_and_material(self):
        text = robot_with('rhoA = "4.02 kg/m"', 'section = { width = "6 in", height = "0.375 in" }', ACTUATOR)
        text = robot_with('EI = "756.65 N m^2"', 'material = "aluminium"', text)
        actuator = model.loads(text).actuator
        assert actuator.EI == pytest.approx(68.9e9 * 0.1524 * 0.009525**3 / 12, rel=1e-14)
        assert (actuator.section.depth, actuator.material.E) == (pytest.approx(0.009525), 68.9e9)

    def test_driven_actuator(self):
        text = re.sub(r"rotation =.*\nextension =.*\n", "", ACTUATOR)
        study = model.loads(
            f'{text}\n[load]\ntorque = "2 N m"\nforce = {{ law = "sine", amplitude = 3, frequency = 1 }}'
        )
        assert study.motion == model.ActuatorMotion(rotation=None, extension=None)
        assert study.load.torque == model.ConstantLaw(value=2.0)
        assert study.load.force == model.SineLaw(amplitude=3.0, frequency=1.0)

    def test_spin_up(self):
        text = robot_with(
            "{ rate = 0.785 }", '{ law = "spin-up", rate = "57.29577951308232 deg/s", duration = 15 }', ACTUATOR
        )
        law = model.loads(text).motion.rotation
        assert (law.law, law.rate, law.duration) == ("spin-up", pytest.approx(1.0, rel=1e-15), 15.0)


class TestTables:
    POSES = "# a comment\ntime [s], roll [deg], heave [mm]\n0, 0, 0\n\n1, 90, 5\n"

    def load(self, tmp_path, text: str):
        (tmp_path / "path.csv").write_text(text)
        return model.loads(with_motion('type = "csv"\nfile = "path.csv"'), path=tmp_path / "s.toml")

    def test_poses(self, tmp_path):
        motion = self.load(tmp_path, self.POSES).motion
        assert motion.time.tolist() == [0, 1]
        np.testing.assert_allclose(motion.pose[1], [0, 0, 0.005, math.pi / 2, 0, 0], rtol=1e-15)

    @pytest.mark.parametrize(
        ("old", "new", "words"),
        [
            ("1, 90, 5", "1, , 5", ("line 5", "'roll'", "is empty or no finite number")),
            ("1, 90, 5", "1, nan, 5", ("line 5", "is empty or no finite number")),
            ("1, 90, 5", "1, 90", ("line 5", "has 2 cells for 3 columns")),
            ("1, 90, 5", "2, 90, 5\n1, 90, 5", ("line 6", "goes back in time")),
            ("1, 90, 5", "1, 90, 5\n1, 90, 5", ("line 6", "repeats the instant before")),
            (
                "1, 90, 5",
                "1, 90, 5\n1.0000000001, 90, 5",
                ("line 6", "repeats the instant before", "at least 1e-09 s above 1 s"),
            ),
            ("0, 0, 0", "0.5, 0, 0", ("line 3", "does not start at 0")),
            ("1, 90, 5", "", ("fewer than two rows",)),
            ("roll [deg]", "roll", ("line 2", "has no unit in the header")),
            ("roll [deg]", "roll [mm]", ("line 2", "is not an angle")),
            ("roll [deg]", "rol [deg]", ("unknown column 'rol'", "Did you mean 'roll'")),
            ("roll [deg]", "heave [deg]", ("is not a length",)),
            ("roll [deg]", "heave [m]", ("'heave' twice",)),
            ("time [s]", "yaw [deg]", ("no column 'time'",)),
        ],
    )
    def test_bad_tables_are_refused_with_the_line(self, tmp_path, old, new, words):
        assert old in self.POSES
        with pytest.raises(InputError) as caught:
            self.load(tmp_path, self.POSES.replace(old, new))
        message = str(caught.value)
        assert "path.csv" in message
        assert all(word in message for word in words), message

    def test_missing_file(self, tmp_path):
        error = refusal(with_motion('type = "csv"\nfile = "none.csv"'), path=tmp_path / "s.toml")
        assert error.file == str(tmp_path / "s.toml") and error.key == "motion.file" and error.value == "none.csv"
        assert "cannot be read" in str(error)


def test_a_refusal_knows_file_and_key():
    """What it says, of every wrong text: `tests/golden/refusals.jsonl`."""
    error = refusal(robot_with('mass = "100 kg"', 'mass = "-100 kg"', ROBOT), path="mine.toml")
    assert (error.file, error.key, error.exit_code) == ("mine.toml", "payload.mass", 2)


def test_broken_files(tmp_path):
    assert "is not valid TOML" in str(refusal("[robot"))
    assert "neither [robot] nor [actuator]" in str(refusal("[payload]\nmass = 1"))
    assert "both [robot] and [actuator]" in str(refusal("[robot]\n[actuator]"))
    with pytest.raises(InputError, match="cannot be read: No such file"):
        model.load(tmp_path / "none.toml")
    (tmp_path / "latin.toml").write_bytes(b"# \xe9")
    with pytest.raises(InputError, match="not UTF-8 text"):
        model.load(tmp_path / "latin.toml")


def test_doubtful_values_are_remarked_on_not_refused():
    study = model.loads(robot_with('diameter = "27 mm"', 'diameter = "80 mm"'))
    assert len(study.warnings) == 1
    assert "all legs" in study.warnings[0]
    assert "Euler-Bernoulli" in study.warnings[0]
    study = model.loads(robot_with('"assumed-modes"   #', '"rigid"   #'))
    assert study.warnings == ("simulation.modes = 3 has no effect with fidelity 'rigid'",)
    study = model.loads(robot_with('com = "157.5 mm"', 'com = "400 mm"'))
    assert "outside the cylinder" in study.warnings[0]


def test_massless_cylinder_is_legal():
    text = robot_with(
        '{ mass = "3 kg", com = "157.5 mm", inertia = 0.0248, mouth = "315.18 mm" }',
        "{ mass = 0, com = 0, inertia = 0, mouth = 0 }",
    )
    assert model.loads(text).warnings == ()


def test_legs_alike_are_read_once_and_a_table_of_forces_has_a_column_for_each(tmp_path):
    legs = model.loads(ROBOT).robot.legs
    assert all(leg is legs[0] for leg in legs)
    head = "time [s]," + ",".join(f"leg {i} [N]" for i in range(1, 7))
    (tmp_path / "forces.csv").write_text(f"{head}\n0,1,2,3,4,5,6\n1,1,2,3,4,5,6\n")
    drive = 'drive = { type = "force", law = "csv", file = "forces.csv" }'
    study = tmp_path / "study.toml"
    study.write_text(robot_with('drive = { type = "prescribed" }', drive), encoding="utf-8")
    assert [leg.drive.force[0] for leg in model.load(study).robot.legs] == [1, 2, 3, 4, 5, 6]
