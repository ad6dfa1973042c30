"""Screws in a loop: where the position is measured, what an encoder resolves, what the motor is told."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.helpers.machines import EVERYTHING, NUT, SCREW, light, machine, study, symmetric
from tests.helpers.runs import balance, run_robot
from tests.helpers.texts import replaced

import flexapod as fx
from flexapod import model
from flexapod.common.errors import InputError
from flexapod.model import Encoder, Feedback, Geometry, Heat, LengthSpread, Loop, RatioSpread, Rotor, Tolerances

pytestmark = pytest.mark.consistency

TEXT = model.preset_text("machine-hexapod")
PARTS = {"rotor": [], "stroke": ["screw", "twist", "nut", "bearing", "bracket"],
         "joint-to-joint": ["screw", "twist", "nut", "bearing", "bracket", "base_joint", "platform_joint",
                            "axial-strain"]}  # fmt: skip


def at(place, **more):
    """A machine whose screws are measured at a place."""
    return machine(drive=SCREW.replace(encoder=Encoder(at=place)), **{**EVERYTHING, **more})


def changed(*pairs):
    return model.loads(replaced(TEXT, *pairs))


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


class TestTorque:
    def moving(self, drive, **more):
        given = study(machine(drive=drive), fidelity="lumped", step=5e-4, duration=0.05, **more)
        return given.replace(initial=model.Initial(start="moving"))

    def test_a_table_of_the_rigid_torque_is_that_torque(self):
        drive = SCREW.replace(command="torque", rotor=Rotor(inertia=1e-3, ratio=2))
        given = self.moving(drive)
        rigid, t = fx.inverse_dynamics(given, output_step=5e-4), np.arange(0, 0.05001, 5e-4)
        # What the motor gives: of the thrust and of all that turns, by hand (T15.12)-(T15.13), over its ratio.
        inertia = 2.0**2 * 1e-3 + SCREW.material.density * 0.9 * np.pi / 32 * 0.02874**4
        thrust = rigid.actuator_force_rigid.interp(time=t).values * 0.01 / (2 * np.pi)
        turns = inertia * rigid.leg_length_acceleration.interp(time=t).values * 2 * np.pi / 0.01
        torque = (thrust + turns) / 2
        replay = fx.simulate(given)
        legs = [
            leg.replace(drive=drive.replace(law="csv", file="t.csv", time=t, torque=torque[:, i]))
            for i, leg in enumerate(given.robot.legs)
        ]
        table = fx.simulate(given.replace(robot=given.robot.replace(legs=tuple(legs))))
        # Between its rows a table is linear.
        difference = np.abs(table.com_position - replay.com_position).max()
        assert float(difference) < 2e-3 * float(np.ptp(replay.com_position.values[:, 2]))

    def test_a_constant_torque_with_a_loop_lifts_by_its_share(self):
        # The loop's spring carries what the constant torque leaves: its angle is the torque's over its stiffness.
        loop = Feedback(stiffness=2e4, damping=20.0)
        found = []
        for value in (0.0, 1.0):
            drive = SCREW.replace(command="torque", law="constant", value=value, loop=loop)
            rest = fx.simulate(study(machine(drive=drive), fidelity="lumped", step=1e-3, duration=0.002)).isel(time=0)
            found.append(rest.drive_position.values)
        np.testing.assert_allclose(found[1] - found[0], 1.0 / 2e4, rtol=2e-3)

    def test_without_a_loop_there_is_no_rest(self):
        drive = SCREW.replace(command="torque", law="constant", value=1.0)
        with pytest.raises(InputError, match="holds no position"):
            fx.modes(machine(drive=drive))

    def test_files(self, tmp_path):
        head = "time [s], " + ", ".join(f"leg {i} [N m]" for i in range(1, 7))
        (tmp_path / "torques.csv").write_text(f"{head}\n0, 1, 2, 3, 4, 5, 6\n1, 2, 2, 3, 4, 5, 6\n")
        old = 'command = "position"         # ours'
        text = TEXT.replace(old, 'command = "torque"\nlaw = "csv"\nfile = "torques.csv" # ours')
        file = tmp_path / "machine.toml"
        file.write_text(text)
        given = fx.load(file)
        np.testing.assert_array_equal(given.robot.legs[0].screw.torque, [1.0, 2.0])
        np.testing.assert_array_equal(given.robot.legs[5].screw.torque, [6.0, 6.0])


class TestLimitsInARun:
    def test_what_is_exceeded_is_said(self):
        given = changed(('limits = { speed = "3000 rpm", torque = "10 N m", rms_torque = "3.5 N m" }',
                         'limits = { speed = "500 rpm", torque = "1 N m", rms_torque = "0.5 N m", force = "500 N" }'),
                        ('brake = { torque = "4 N m" }', 'brake = { torque = "0.5 N m" }'))  # fmt: skip
        data = fx.simulate(model.override(given, fidelity="rigid", step=1e-3))
        words = data.attrs["warnings"]
        for part in ("the thrust reaches", "above the limit of 500 N", "the motor's speed reaches", "500 rpm",
                     "the motor's torque reaches", "(root mean square), above the limit of 0.5 N m",
                     "the brake holds 500 mN m"):  # fmt: skip
            assert part in words.replace("\N{NO-BREAK SPACE}", " "), part
        within = fx.simulate(model.override(model.loads(TEXT), fidelity="rigid", step=1e-3))
        assert "limit" not in within.attrs["warnings"] and "brake" not in within.attrs["warnings"]

    def test_hydraulic(self):
        text = model.preset_text("motion-base").replace('"140 bar", flow = "470 l/min"', '"30 bar", flow = "200 l/min"')
        words = fx.simulate(model.override(model.loads(text), fidelity="rigid", step=2e-3)).attrs["warnings"]
        assert "needs a pressure of" in words and "needs a flow of" in words


LOOP = Loop(stiffness=5e3, damping=60.0, integral=2e4)
SUMS = SCREW.replace(command="servo", loop=LOOP)


class TestIntegral:
    def test_at_rest_it_is_a_held_rotor(self):
        ours, theirs = (machine(drive=x, **EVERYTHING) for x in (SUMS, SCREW))
        sag = [fx.modes(x, fidelity="lumped").com_sag.values for x in (ours, theirs)]
        np.testing.assert_allclose(sag[0], sag[1], rtol=0, atol=1e-13)
        stiff = [fx.stiffness(x, fidelity="lumped").stiffness.values for x in (ours, theirs)]
        np.testing.assert_allclose(stiff[0], stiff[1], rtol=1e-12, atol=1e-12 * np.abs(stiff[1]).max())
        rows = [fx.budget(study(x, fidelity="lumped")) for x in (ours, theirs)]
        assert "drive" not in rows[0].part.values
        np.testing.assert_allclose(rows[0].budget_total, rows[1].budget_total, rtol=0, atol=1e-12)
        assert "drive" not in fx.parts(ours).part.values
        still = study(ours, fidelity="lumped", step=1e-3, duration=0.02)
        run = fx.simulate(still.replace(motion=still.motion.replace(amplitude=0.0)))
        np.testing.assert_allclose(run.com_deviation.values[0], sag[0], rtol=0, atol=1e-12)
        # It has summed what holds the rotor, and stays where it is.
        np.testing.assert_allclose(run.drive_force[-1], run.drive_force[0], rtol=1e-8)

    def test_modes_are_those_of_spring_and_damper(self):
        # About another rest, higher by what the loop gives: 1e-6 m of a metre.
        ours, theirs = (fx.modes(machine(drive=SUMS.replace(loop=LOOP.replace(integral=x))), fidelity="lumped")
                        for x in (2e4, 0.0))  # fmt: skip
        np.testing.assert_allclose(ours.frequency[:6], theirs.frequency[:6], rtol=1e-5)
        np.testing.assert_allclose(ours.damping_ratio[:6], theirs.damping_ratio[:6], rtol=1e-4)

    def test_path_of_one_equation(self):
        """Legs without mass, rigid but for their loops, lift a payload straight up: one coordinate, by itself."""
        loop = Loop(stiffness=50.0, damping=2.0, integral=200.0)
        ends = {"bearing": SCREW.bearing.replace(stiffness=1e12), "nut": NUT.replace(stiffness=1e12)}
        steel = SCREW.material.replace(E=1e15, density=1e-3)
        drive = SUMS.replace(**ends, loop=loop, rotor=Rotor(inertia=4e-3), material=steel)
        robot = light(symmetric(drive=drive))
        given = study(robot, fidelity="rigid", step=2.5e-4, duration=0.2, output_step=1e-3)
        data = fx.simulate(given)
        z0, reach = robot.home_position[2], np.linalg.norm((robot.platform_joints - robot.base_joints)[0, :2])
        mass, turns = robot.payload.mass, drive.inertia / drive.per_turn**2
        k, c, gain = (x / drive.per_turn**2 for x in (loop.stiffness, loop.damping, loop.integral))

        def length(z):
            return np.hypot(z, reach)

        def commanded(t):
            s = np.clip(t / 0.1, 0, 1)  # quintic, by hand
            z = z0 + 0.02 * (10 * s**3 - 15 * s**4 + 6 * s**5)
            rate = 0.02 * (30 * s**2 - 60 * s**3 + 30 * s**4) / 0.1
            return length(z), rate * z / length(z)

        def rates(t, x):
            z, v, total = x
            slope, bend = z / length(z), reach**2 / length(z) ** 3
            command, rate = commanded(t)
            force = k * (command - length(z)) + c * (rate - slope * v) + gain * total
            push = 6 * slope * (force - turns * bend * v**2) - 9.81 * mass
            return [v, push / (mass + 6 * turns * slope**2), command - length(z)]

        start = [z0, 0.0, 9.81 * mass / (6 * z0 / length(z0)) / gain]
        found = solve_ivp(rates, (0, 0.2), start, rtol=1e-11, atol=1e-13, dense_output=True, max_step=1e-3)
        rigid = data.com_position_rigid.values[:, 2]
        beside = found.sol(data.time.values)[0] - z0 - (rigid - rigid[0])
        lag = data.com_deviation.values[:, 2]
        assert np.abs(lag).max() > 1e-6
        # Second order in the step, 1e-4 of the largest here; gravity is 9.81.
        np.testing.assert_allclose(lag, beside, rtol=0, atol=1e-3 * np.abs(beside).max())

    def test_a_load_that_comes_is_made_up_for(self):
        def after(integral):
            drive = SUMS.replace(loop=LOOP.replace(integral=integral, damping=120.0))
            wrench = model.StepWrench(amplitude=[0, 0, -2000, 0, 0, 0], time=0.01)
            still = study(machine(drive=drive), fidelity="rigid", step=2e-3, duration=2.0)
            still = still.replace(motion=still.motion.replace(amplitude=0.0), load=model.Load(wrench=wrench))
            return fx.simulate(still).deviation_by_cause.sel(cause="drive", axis="z").sum("leg").values

        with_it, without = after(2e4), after(0.0)
        assert np.abs(with_it[-1]) < 0.01 * np.abs(without[-1] - without[0])
        assert np.abs(with_it).max() > 0.3 * np.abs(without[-1] - without[0])

    def test_energy_closes_to_second_order(self):
        errors = []
        for step in (1e-3, 5e-4):
            found = balance(run_robot(study(machine(drive=SUMS), fidelity="lumped", step=step, duration=0.1)))
            errors.append(np.abs(found - found[0]).max())
        assert errors[0] / errors[1] == pytest.approx(4, rel=0.25)

    def test_beside_legs_that_sum_nothing(self):
        robot = machine(drive=SCREW)
        drives = (SUMS, SCREW, SUMS.replace(loop=LOOP.replace(integral=0.0)))
        legs = tuple(leg.replace(drive=drives[i % 3]) for i, leg in enumerate(robot.legs))
        given = study(robot.replace(legs=legs), fidelity="lumped", step=1e-3, duration=0.01)
        sag = fx.modes(given.robot, fidelity="lumped").com_sag.values
        np.testing.assert_allclose(fx.simulate(given).com_deviation.values[0], sag, rtol=0, atol=1e-12)

    def test_files(self):
        old = 'command = "position"         # ours'
        loop = 'loop = { stiffness = "5 kN m/rad", damping = "20 N m s/rad", integral = "20 kN m/(rad s)" }'
        given = changed((old, f'command = "servo"\n{loop} # ours'))
        assert given.robot.legs[0].screw.loop.integral == 2e4
        assert model.loads(model.to_toml(given)).robot == given.robot
        for bad in ("-1 N m/(rad s)", "1e9 N m/(rad s)", "5 N m/rad"):
            with pytest.raises(InputError) as caught:
                changed((old, f'command = "servo"\n{loop.replace("20 kN m/(rad s)", bad)} # ours'))
            assert caught.value.key == "leg.drive.loop.integral"
        assert "stiffness * damping / inertia" in str(self.refused(old, loop))

    def refused(self, old, loop):
        with pytest.raises(InputError) as caught:
            changed((old, f'command = "servo"\n{loop.replace("20 kN m/(rad s)", "1e9 N m/(rad s)")} # ours'))
        return caught.value
