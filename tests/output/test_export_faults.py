"""Calls of exported C and of units that fail: nothing of them is left, and what follows is as if they had never been.

The other side is the memory before the call, byte by byte, and a twin that never got the bad call: to the bit.
"""

import ctypes as ct

import numpy as np
import pytest
from tests.helpers.fmi_importer import Instance, Unit
from tests.helpers.robot_c import compiled

import flexapod as fx
from flexapod.mechanics.symbolic.compiler import compiler

pytestmark = [pytest.mark.consistency, pytest.mark.skipif(compiler() is None, reason="there is no C compiler")]
STEP = 5e-4
CASES = {
    "prescribed strokes": ("paper-robot", "inputs"),
    "force drives": ("nano-hexapod", "inputs"),
    "friction, loops, motion built in": ("machine-hexapod", "motion"),
}
BAD = (np.nan, np.inf, -np.inf, 1e300)
OK, NOT_CONVERGED, NOT_FINITE, SINGULAR, JUMPS, BACKWARDS = 0, 1, 2, 3, 6, 7
GOOD = 200


@pytest.fixture(scope="module", params=CASES.values(), ids=CASES)
def robot(request, tmp_path_factory):
    """A library, and inputs under which a robot moves."""
    name, commands = request.param
    folder = tmp_path_factory.mktemp("c")
    fx.export(fx.preset(name), "c", folder, commands=commands, step=STEP)
    found = compiled(folder)
    moving = found.start.copy()
    moving[found.names.index("wrench[1]")] = 20.0
    return found, moving, name


def begun(robot, moving, steps=7):
    memory = robot.memory()
    assert robot.step(memory, moving, steps) == OK
    return memory


def test_after_each_bad_input_all_goes_on_as_before(robot):
    robot, moving, name = robot
    memory = begun(robot, moving)
    before = memory.copy()
    twin = begun(robot, moving)
    for _ in range(GOOD):
        assert robot.step(twin, moving) == OK
    ends, codes = robot.outputs(twin), set()
    for k, said in enumerate(robot.names):
        for value in BAD:
            bad = moving.copy()
            bad[k] = value
            code = robot.step(memory, bad)
            if code == OK:  # a force beside a drive that keeps its command has no effect: that of nothing at all
                assert name != "nano-hexapod" and said.startswith("control_input") and np.isfinite(value)
                memory[:] = before
            assert np.array_equal(memory, before), (said, value, code)
            assert code == NOT_FINITE or np.isfinite(value), (said, value, code)
            codes.add(code)
        if said.endswith("[1]"):
            for _ in range(GOOD):
                assert robot.step(memory, moving) == OK
            np.testing.assert_array_equal(robot.outputs(memory), ends)
            memory[:] = before
    assert codes <= {OK, NOT_FINITE, SINGULAR, JUMPS, NOT_CONVERGED}


def test_what_fails_within_an_iteration_after_good_steps_leaves_nothing(robot):
    """A force that throws the platform away: of 200 steps in one call some are made before one has no solution."""
    robot, moving, _ = robot
    memory = begun(robot, moving)
    before, found = memory.copy(), {}
    for size in 10.0 ** np.arange(4, 13):
        bad = moving.copy()
        bad[robot.names.index("wrench[1]")] = size
        if code := robot.step(memory, bad, 200):
            assert np.array_equal(memory, before), size
            found[size] = (code, robot.step(memory, bad))
        memory[:] = before
    # the least of these forces can be borne for one step: its call failed on the way; the largest for none
    (code, one), (_, none) = found[min(found)], found[max(found)]
    assert code in (NOT_CONVERGED, SINGULAR) and one == OK and none != OK


def test_a_first_call_that_fails_leaves_the_start(robot):
    robot, moving, _ = robot
    memory, twin = robot.memory(), robot.memory()
    before = memory.copy()
    bad = moving.copy()
    bad[robot.names.index("wrench[1]")] = 1e300
    assert robot.step(memory, bad) != OK and np.array_equal(memory, before)
    for one in (memory, twin):
        for _ in range(20):
            assert robot.step(one, moving) == OK
    np.testing.assert_array_equal(robot.outputs(memory), robot.outputs(twin))


def test_no_steps_are_nothing_and_steps_back_are_refused(robot):
    robot, moving, _ = robot
    memory = begun(robot, moving)
    before, other = memory.copy(), robot.start.copy()
    for steps, code in ((0, OK), (-1, BACKWARDS), (-(2**62), BACKWARDS)):
        assert robot.step(memory, other, steps) == code
        assert np.array_equal(memory, before) and robot.time(memory) == pytest.approx(7 * STEP, rel=1e-12)


def test_a_memory_elsewhere_goes_on_after_a_fault(robot):
    """Copied to another address, failed there, gone on: as the one that stayed."""
    robot, moving, _ = robot
    memory, elsewhere = begun(robot, moving), robot.memory()
    elsewhere[:] = memory
    bad = moving.copy()
    bad[robot.names.index("wrench[3]")] = 1e12
    assert robot.step(elsewhere, bad) != OK and np.array_equal(elsewhere, memory)
    for one in (memory, elsewhere):
        assert robot.step(one, moving, 5) == OK
    np.testing.assert_array_equal(robot.outputs(memory), robot.outputs(elsewhere))


def test_the_memory_that_the_header_names_is_enough(robot):
    """Of twice as wide vectors than here at most twice as much."""
    found = robot[0]
    assert 2 * found.size <= found.bytes <= 8 * found.size


# Units


@pytest.fixture(scope="module", params=["paper-robot", "nano-hexapod"])
def unit(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("unit")
    found = fx.export(fx.preset(request.param), "fmu", folder / "robot.fmu", step=STEP)
    return Unit(found.path, folder / "unpacked"), request.param


def started(unit):
    one = Instance(unit)
    one.set("wrench", [20.0, 0, 0, 0, 0, 0])
    for _ in range(5):
        assert one.steps(STEP) == 0, one.said
    return one


def status(one, name, values, *more):
    """Status of setting variables of these names at once."""
    names = [name, *more]
    references = (ct.c_uint32 * len(names))(*(one.unit.variables[x][0] for x in names))
    values = np.ascontiguousarray(values, dtype=float)
    pointer = values.ctypes.data_as(ct.POINTER(ct.c_double))
    return one.status("SetFloat64", references, ct.c_size_t(len(names)), pointer, ct.c_size_t(values.size))


def test_a_unit_goes_on_as_before_after_each_bad_input(unit):
    unit, name = unit
    one, twin = started(unit), started(unit)
    before = one.saved()
    for _ in range(GOOD):
        assert twin.steps(STEP) == 0
    inputs = [name for name, (_, _, said) in unit.variables.items() if said["causality"] == "input"]
    for said in inputs:
        size = int(np.prod(unit.variables[said][1]))
        kept = one.get(said)
        for k in range(size):
            for value in BAD:
                values = kept.copy()
                values[k] = value
                if not np.isfinite(value):
                    assert status(one, said, values) != 0
                    assert one.saved() == before, (said, value)
                    continue
                one.set(said, values)
                given = one.saved()
                if one.steps(STEP) == 0:
                    assert name == "paper-robot" and said == "control_input"
                    one.restore(given, 5 * STEP)
                assert one.saved() == given, (said, value)
                assert one.time == pytest.approx(5 * STEP, rel=1e-12)
                one.set(said, kept)
                assert one.saved() == before
    for _ in range(GOOD):
        assert one.steps(STEP) == 0, one.said
    for result in ("tool_position", "drive_force"):
        np.testing.assert_array_equal(one.get(result), twin.get(result))


def test_of_several_variables_all_are_set_or_none(unit):
    one = started(unit[0])
    before = one.saved()
    bad = np.concatenate([np.full(6, 3.0), [0, 0, np.nan, 0, 0, 0]])
    assert status(one, "wrench", bad, "control_input") != 0 and one.saved() == before
    assert status(one, "wrench", np.zeros(12), "tool_position") != 0 and one.saved() == before


def test_times_that_are_none_leave_a_unit_as_it_was(unit):
    unit, _ = unit
    one = started(unit)
    before, now = one.saved(), one.time
    for length in (np.nan, np.inf, -np.inf, 1e300, -1e300, -STEP, 0.0, 0.5 * STEP, 1.1e6):
        one.time = now
        assert one.steps(length) != 0, length
        assert one.saved() == before and one.time == now
    for instant in (np.nan, np.inf, -np.inf, 1e300, now + STEP, now - STEP):
        one.time = instant
        assert one.steps(STEP) != 0, instant
        assert one.saved() == before and one.time == now


def test_start_times_beside_which_steps_are_lost_are_refused(unit):
    """A step of 5e-4 s has thousand parts of 1.1e-10 s beside 1e6 s, and none beside 1e300."""
    unit, _ = unit
    assert Instance(unit, start=1e6).steps(STEP) == 0
    one = Instance(unit)
    for start in (np.nan, np.inf, -np.inf, 1e300, 1e13):
        assert one.status("EnterInitializationMode", False, ct.c_double(0), ct.c_double(start), False, ct.c_double(0))
        assert one.get("time")[0] == 0.0


def test_a_state_of_another_unit_is_refused(unit):
    """As many bytes, with another token at the begin."""
    one, state = started(unit[0]), ct.c_void_p()
    before = one.saved()
    token = unit[0].root.get("instantiationToken").encode()
    assert before.startswith(token)
    saved = token[::-1] + before[len(token) :]
    given = (ct.c_ubyte * len(saved)).from_buffer_copy(saved)
    assert one.status("DeserializeFMUState", given, ct.c_size_t(len(saved)), ct.byref(state)) != 0
    assert one.status("SetFMUState", state) != 0 and one.saved() == before
