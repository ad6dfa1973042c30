"""Units for co-simulation and the C of a robot against the product's own march."""

import getpass
import os
import re
import socket
import subprocess
import zipfile
from pathlib import Path
from threading import Thread

import numpy as np
import pytest
from tests.helpers.fmi_importer import Instance, Unit
from tests.helpers.samples import sample_study

import flexapod as fx
from flexapod.common.errors import InputError
from flexapod.mechanics.symbolic.compiler import compiler
from flexapod.model import override
from flexapod.output.exchange.c_source import FLAGS
from flexapod.output.exchange.fmu import UNITS
from flexapod.solve.time import native
from flexapod.solve.time.recording import Counters, unpack
from flexapod.solve.time.robot_march import prepare

pytestmark = [pytest.mark.consistency, pytest.mark.skipif(compiler() is None, reason="there is no C compiler")]
STEP = 5e-4


@pytest.fixture(scope="module")
def units(tmp_path_factory):
    """Units by study and commands; the file of each."""
    known = {}

    def unit(name, commands="inputs", step=STEP):
        if (name, commands) not in known:
            folder = tmp_path_factory.mktemp("unit")
            found = fx.export(fx.preset(name), "fmu", folder / "robot.fmu", commands=commands, step=step)
            known[name, commands] = (Unit(found.path, folder / "unpacked"), found)
        return known[name, commands]

    return unit


@pytest.mark.parametrize("name", ["paper-robot", "machine-hexapod", "tripod"])
def test_the_built_in_motion_is_the_march(units, name):
    """The same steps, with commands as series to 1e-13 and vectors that sum in another order: 1e-12 of a metre."""
    unit, _ = units(name, "motion")
    data = fx.simulate(fx.preset(name), step=STEP, output_step=STEP, duration=400 * STEP)
    one, found = Instance(unit), {x: [] for x in ("tool_position", "drive_force", "energy_strain")}
    for k in range(401):
        for variable, rows in found.items():
            rows.append(one.get(variable))
        if k < 400:
            assert one.steps(STEP) == 0, one.said
    assert np.abs(np.array(found["tool_position"]) - data.tool_position.values).max() < 1e-12
    # forces by the masses over the step's square: 1e-13 m, 10 kg and 4 / h^2 make 2e-5 N of some 200 N
    error = np.abs(np.array(found["drive_force"]) - data.drive_force.values).max()
    assert error < 1e-7 * np.abs(data.drive_force.values).max()
    np.testing.assert_allclose(np.array(found["energy_strain"]).ravel(), data.energy_strain.values, rtol=1e-7)


def test_inputs_are_the_march_with_extrapolated_commands(units):
    """Commands held for 4 steps with rate and acceleration: the table of the march made by the same rule."""
    many, count = 4, 60
    unit, _ = units("paper-robot")
    march = prepare(override(fx.preset("paper-robot"), step=STEP, output_step=STEP))
    system, law = march.system, march.problem.tables
    port = int(np.flatnonzero(system.ports == system.kernel.shapes.l_index)[0])
    table, load = law(np.arange(many * count + 1) * STEP)
    force = np.array([20.0, -10.0, 5.0, 1.0, 2.0, -3.0])
    load = load + force * (np.arange(len(load)) > 0)[:, None]
    for k in range(1, many * count + 1):
        at, since = (k - 1) // many * many, ((k - 1) % many + 1) * STEP
        value, rate, change = law(np.array([at * STEP]))[0][0, :, port, :3].T
        table[k, :, port, :3] = np.stack(
            [value + since * rate + since**2 * change / 2, rate + since * change, change], 1
        )
    flow, _ = native.first_record(system, march.start, table[0], load[0] - force * 0)
    made = native.advance(system, march.problem.method, flow, STEP, (table, load), many, Counters())
    wanted = unpack(system, np.zeros(len(made.rows)), made.rows)
    one = Instance(unit)
    one.set("wrench", force)
    for k in range(count):
        value, rate, change = law(np.array([k * many * STEP]))[0][0, :, port, :3].T
        one.set("drive_command", value)
        one.set("drive_command_rate", rate)
        one.set("drive_command_acceleration", change)
        assert one.steps(many * STEP) == 0, one.said
        assert np.abs(one.get("com_position") - wanted.pose[k, :3]).max() < 1e-12


def test_a_command_with_an_acceleration_is_the_one_that_is_told_anew_in_each_step(units):
    """Servos with dampers: once for 20 steps, or at each step's end value and rate by hand, without an acceleration."""
    unit, _ = units("nano-hexapod")
    start, change = unit.start("drive_command"), np.array([0.5, -1.0, 0.75, 0.25, -0.5, 1.0])
    once, anew = Instance(unit), Instance(unit)
    for k in range(3):
        t = 20 * k * STEP
        once.set("drive_command", start + change * t**2 / 2)
        once.set("drive_command_rate", change * t)
        once.set("drive_command_acceleration", change)
        assert once.steps(20 * STEP) == 0, once.said
        for t in STEP * np.arange(20 * k + 1, 20 * k + 21):
            anew.set("drive_command", start + change * t**2 / 2 - STEP * change * t)
            anew.set("drive_command_rate", change * t)
            assert anew.steps(STEP) == 0, anew.said
        # rounding; the rate is some 1e-2 m/s at the dampers' 20 N s/m, 0.2 N
        np.testing.assert_allclose(once.get("drive_force"), anew.get("drive_force"), rtol=0, atol=1e-6)
        np.testing.assert_allclose(once.get("drive_position"), anew.get("drive_position"), rtol=0, atol=1e-12)


def run(unit, count, force=0.0):
    one = Instance(unit)
    if force:
        one.set("control_input", np.full(6, force))
    return one, [advance(one) for _ in range(count)]


def advance(one):
    assert one.steps(STEP) == 0, one.said
    return np.concatenate([one.get(x) for x in ("tool_position", "drive_force", "energy_strain")])


def test_two_instances_take_turns_and_threads(units):
    unit, _ = units("nano-hexapod")
    _, alone = run(unit, 30, 5.0)
    one, other = Instance(unit), Instance(unit)
    for x, force in ((one, 5.0), (other, -2.0)):
        x.set("control_input", np.full(6, force))
    rows = []
    for _ in range(30):
        rows.append(advance(one))
        advance(other)
    np.testing.assert_array_equal(rows, alone)
    found = {}
    threads = [Thread(target=lambda k=k: found.update({k: run(unit, 30, 5.0)[1]})) for k in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for k in range(3):
        np.testing.assert_array_equal(found[k], alone)


def test_saved_restored_and_reset(units):
    """To the bit: into the same instance, into another one, and after a reset from the start."""
    unit, _ = units("nano-hexapod")
    one, first = run(unit, 13, 5.0)
    saved, now = one.saved(), one.time
    ahead = [advance(one) for _ in range(20)]
    one.restore(saved, now)
    np.testing.assert_array_equal([advance(one) for _ in range(20)], ahead)
    other = Instance(unit)
    other.restore(saved, now)
    np.testing.assert_array_equal([advance(other) for _ in range(20)], ahead)
    one.call("Reset")
    one.time = 0.0
    one.set("control_input", np.full(6, 5.0))
    np.testing.assert_array_equal([advance(one) for _ in range(13)], first)
    assert other.status("DeserializeFMUState", b"x", 1, None) == 3


def test_steps_of_any_multiple(units):
    unit, _ = units("nano-hexapod")
    _, rows = run(unit, 10, 5.0)
    one = Instance(unit)
    one.set("control_input", np.full(6, 5.0))
    for many, at in ((1, 1), (4, 5), (2, 7), (3, 10)):
        assert one.steps(many * STEP) == 0
        np.testing.assert_array_equal(one.get("tool_position"), rows[at - 1][:3])
    assert one.get("time")[0] == pytest.approx(10 * STEP)
    assert one.steps(1.5 * STEP) == 3
    assert "no multiple of the step inside" in one.said[-1]
    one.time += STEP
    assert one.steps(STEP) == 3
    assert "not the time reached" in one.said[-1]


def test_a_held_prescribed_stroke_is_refused_in_words(units):
    unit, _ = units("paper-robot")
    one = Instance(unit)
    assert one.steps(STEP) == 0
    one.set("drive_command", unit.start("drive_command") + 1e-5)
    assert one.steps(STEP) == 3
    assert "give drive_command_rate and drive_command_acceleration" in one.said[-1]
    servo = Instance(units("nano-hexapod")[0])
    assert servo.steps(STEP) == 0
    servo.set("drive_command", servo.unit.start("drive_command") + 1e-6)
    assert servo.steps(STEP) == 0


def test_another_token_is_refused(units):
    unit, _ = units("nano-hexapod")
    token = unit.root.get("instantiationToken")
    try:
        unit.root.set("instantiationToken", "another")
        with pytest.raises(AssertionError, match="of another unit"):
            Instance(unit)
    finally:
        unit.root.set("instantiationToken", token)


def test_names_are_those_of_results(units):
    unit, _ = units("machine-hexapod", "motion")
    data = fx.simulate(fx.preset("machine-hexapod"), step=STEP, output_step=STEP, duration=2 * STEP)
    outputs = [name for name, (_, _, said) in unit.variables.items() if said["causality"] == "output"]
    assert set(outputs) <= set(data.data_vars)
    assert {"tool_position", "platform_quaternion", "drive_force", "drive_position", "work_drive"} <= set(outputs)
    for name in outputs:
        _, shape, said = unit.variables[name]
        assert data[name].shape[1:] == shape
        assert said.get("unit", "mixed") == data[name].units
        np.testing.assert_allclose(
            Instance(unit).get(name).reshape(shape), data[name].values[0], rtol=1e-9, atol=1e-9, err_msg=name
        )


def test_nothing_of_this_machine_is_inside(units):
    _, found = units("nano-hexapod")
    with zipfile.ZipFile(found.path) as archive:
        parts = b"".join(archive.read(name) for name in archive.namelist())
        assert {info.date_time for info in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
    words = {str(Path.home()), os.getcwd(), "/tmp", socket.gethostname(), getpass.getuser()} - {"root", "user"}
    assert not [
        word for word in words if len(word) > 2 and re.search(rb"\b" + re.escape(word.encode()) + rb"\b", parts)
    ]
    assert b"march=native" not in parts


def test_c_under_sanitizers_is_the_unit_to_the_bit(units, tmp_path):
    unit, _ = units("nano-hexapod")
    fx.export(fx.preset("nano-hexapod"), "c", tmp_path / "c", step=STEP)
    one = Instance(unit)
    assert one.steps(50 * STEP) == 0
    wanted = [(name, one.get(name)) for name, (_, _, said) in unit.variables.items() if said["causality"] == "output"]
    command = [*compiler(), *FLAGS, "robot.c", "main.c", "-lm", "-o"]
    checked = ["-O0", "-Wconversion", "-Werror", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    for more, name in (([], "plain"), (checked, "checked")):
        subprocess.run([*command, name, *more], cwd=tmp_path / "c", check=True)
        said = subprocess.run(
            [f"./{name}", "50"], cwd=tmp_path / "c", check=True, capture_output=True, text=True
        ).stdout
        numbers = [float(line.split()[1]) for line in said.splitlines()[:-2]]
        np.testing.assert_array_equal(numbers, np.concatenate([values for _, values in wanted]))
        assert re.search(r"longest step [\d.e+]+ us, at most [234] iterations", said)
    text = (tmp_path / "c" / "robot.c").read_text()
    assert not re.search(r"\b(malloc|calloc|free|printf)\s*\(", text)
    assert not re.search(r"^static (?!const|inline|void|int|long|double|lanes|Settings|State|Instance|Work|Remembered|"
                         r"__attribute__|size_t)", text, re.M)  # fmt: skip


@pytest.mark.parametrize("name", ["delta", "flexures", "planar", "strut", "tricept"])
def test_c_of_other_mechanisms_is_their_march(tmp_path, name):
    """Hinges, flexures with six closures a leg, a plane, struts, unlike legs: the tool to 1e-12 m.

    Compiled without optimising: the same numbers, as products and sums are not contracted.
    """
    study = sample_study(name)
    fx.export(study, "c", tmp_path / "c", commands="motion", step=2e-4)
    subprocess.run(
        [*compiler(), *FLAGS, "-O0", "robot.c", "main.c", "-lm", "-o", "run"], cwd=tmp_path / "c", check=True
    )
    said = subprocess.run(["./run", "40"], cwd=tmp_path / "c", check=True, capture_output=True, text=True).stdout
    found = dict(line.rsplit(" ", 1) for line in said.splitlines()[:-2])
    data = fx.simulate(study, step=2e-4, output_step=2e-4, duration=40 * 2e-4)
    tool = np.array([float(found[f"tool_position[{k}]"]) for k in (1, 2, 3)])
    assert np.abs(tool - data.tool_position.values[-1]).max() < 1e-12


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"commands": "stroke"}, "is not known"),
        ({}, "goes by fixed steps"),
        ({"pose": None, "modes": 3}, "not an option"),
    ],
)
def test_refusals(tmp_path, given, words):
    with pytest.raises(InputError, match=words):
        fx.export(fx.preset("tripod"), "fmu", tmp_path / "robot.fmu", **given)


#: Kilogram, metre, second, radian of each unit that results have.
SI = {
    "m": (0, 1, 0, 0), "rad": (0, 0, 0, 1), "N": (1, 1, -2, 0), "N m": (1, 2, -2, 0), "J": (1, 2, -2, 0), "1": (0,) * 4,
    "m s-1": (0, 1, -1, 0), "m s-2": (0, 1, -2, 0), "rad s-1": (0, 0, -1, 1), "rad s-2": (0, 0, -2, 1),
}  # fmt: skip


def test_units_are_what_their_names_say(units):
    written = {
        unit.get("name"): unit.find("BaseUnit").attrib
        for name in (("machine-hexapod", "motion"), ("nano-hexapod",))
        for unit in units(*name)[0].root.find("UnitDefinitions")
    }
    assert {"m", "N", "J", "m s-1", "m s-2"} <= set(written)
    for name, base in (written | UNITS).items():
        assert tuple(int(base.get(of, 0)) for of in ("kg", "m", "s", "rad")) == SI[name]
        assert set(base) <= {"kg", "m", "s", "rad"}


def test_all_results_are_those_of_the_march_on_the_way(units):
    """After 60 steps with the motion built in, works and energies by their names; as forces of `built_in` 1e-6."""
    unit, _ = units("machine-hexapod", "motion")
    data = fx.simulate(fx.preset("machine-hexapod"), step=STEP, output_step=STEP, duration=60 * STEP).isel(time=-1)
    one = Instance(unit)
    for _ in range(60):
        assert one.steps(STEP) == 0, one.said
    for name, (_, shape, said) in unit.variables.items():
        if said["causality"] == "output" and name != "closure_residual":
            ours = data[name].values
            np.testing.assert_allclose(
                one.get(name).reshape(shape), ours, rtol=1e-6, atol=1e-6 * np.abs(ours).max() + 1e-12, err_msg=name
            )
    assert abs(float(data.work_drive)) > 1e-6 and abs(float(data.energy_kinetic)) > 1e-9


def test_a_unit_begins_when_it_is_told_and_again_at_nothing_after_a_reset(units):
    unit, _ = units("nano-hexapod")
    late, early = Instance(unit, start=2.5), Instance(unit)
    assert late.get("time")[0] == 2.5
    for one in (late, early):
        one.set("wrench", [1.0, -2.0, 3.0, 0.1, 0.2, -0.3])
        for _ in range(4):
            assert one.steps(STEP) == 0, one.said
    assert late.get("time")[0] == pytest.approx(2.5 + 4 * STEP, rel=1e-12)
    np.testing.assert_array_equal(late.get("tool_position"), early.get("tool_position"))
    late.call("Reset")
    assert late.get("time")[0] == 0.0
    # a moment alone turns the platform: of the wrench all six numbers act
    still, turned = Instance(unit), Instance(unit)
    turned.set("wrench", [0.0, 0.0, 0.0, 0.0, 0.0, 5.0])
    for one in (still, turned):
        for _ in range(20):
            assert one.steps(STEP) == 0, one.said
    assert np.abs(turned.get("platform_quaternion")[3] - still.get("platform_quaternion")[3]) > 1e-9


def test_carriages_that_keep_their_first_command_stay_where_they_are(tmp_path):
    """Commands of a hexaglide count from the feet of its rails: told what it starts with it does not move."""
    study = sample_study("hexaglide")
    found = fx.export(study, "fmu", tmp_path / "robot.fmu", commands="inputs", step=STEP)
    one = Instance(Unit(found.path, tmp_path / "unpacked"))
    assert np.abs(one.unit.start("drive_command")).min() > 0.1
    np.testing.assert_allclose(one.unit.start("drive_command"), one.get("drive_position"), atol=1e-12)
    start = one.get("tool_position")
    for _ in range(10):
        assert one.steps(STEP) == 0, one.said
    # at rest in its equilibrium, found to 1e-10 of a metre
    np.testing.assert_allclose(one.get("tool_position"), start, atol=1e-8)
    np.testing.assert_allclose(one.get("drive_position"), one.unit.start("drive_command"), atol=1e-9)
