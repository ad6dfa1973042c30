"""Matrices of the linear model against central differences of the equations of motion, friction and loops included."""

from dataclasses import replace

import numpy as np
import pytest
from tests.helpers import motor_loops as motors
from tests.helpers.machines import BASE, EVERYTHING, OIL, SCREW, TOP, machine, study
from tests.helpers.samples import PRESETS, SAMPLES, known

import flexapod as fx
from flexapod import model

pytestmark = pytest.mark.consistency

STEP = 1e-6
OTHERS = {
    "loops": study(motors.mixed()),
    "sum": study(machine(drive=SCREW.replace(command="servo", loop=motors.GAINS), **EVERYTHING)),
    "mounts": study(machine().replace(base_mount=BASE, platform_mount=TOP)),
    "oil": study(machine(drive=OIL)),
}
INPUTS = ["wrench", "command", "force:joint-1", "floor:x", "floor:y", "floor:z"]


def plants():
    return [*PRESETS, *(x for x in SAMPLES if x != "strut"), *OTHERS]


def slopes(plant):
    """By steps of all coordinates, rates and accelerations: balances, closures (rows, size), by central differences."""
    system, x, wrench = plant.system, plant.x.state(0), plant.locked.acts.wrench
    table = np.zeros((system.legs, system.ports.size, 4))
    table[..., 0] = plant.command[0]
    b = system.kernel.shapes.bristles
    x = replace(x, bristles=np.zeros((system.legs, 2 * b)), drive=np.zeros((system.legs, system.ports.size)))

    def by(change):
        rows = [[system.residual(change(sign * STEP * e), table, wrench)[k] for sign in (1, -1) for k in (0, 1)]
                for e in np.eye(system.size)]  # fmt: skip
        return [np.array([(r[k] - r[2 + k]) / (2 * STEP) for r in rows]).T for k in (0, 1)]

    def slid(step):
        """Displaced, and the bristles of what sticks bent by as much as it would have slid."""
        moved = system.displace(x, step)
        if not b or plant.locked.simulation.friction == "sliding":
            return moved
        way = system.friction(replace(x, v=step)).state[:, b:]
        return replace(moved, bristles=np.concatenate([way, np.zeros_like(way)], axis=1))

    K, G = by(slid)
    D, _ = by(lambda step: replace(x, v=step))
    M, _ = by(lambda step: replace(x, v_dot=step))
    return M, D, K, G


def kinds(plant):
    """Unit of each balance: coordinates of lengths, of angles and of amplitudes."""
    system = plant.system
    turns = ("alpha", "beta", "spin", "gamma1", "gamma2", "gamma3", "u4", "u5", "u6", "t")
    of_leg = [f"{name in turns}" if name not in ("w", "j") else name
              for name, size in system.kernel.shapes.layout for _ in range(size)]  # fmt: skip
    return np.array(of_leg * system.legs + ["False"] * 3 + ["True"] * 3)


def same(ours, theirs, rows, columns, least):
    """Within 1e-6 of the largest entry of the same unit."""
    for r in np.unique(rows):
        for c in np.unique(columns):
            a, b = (x[np.ix_(rows == r, columns == c)] for x in (ours, theirs))
            assert np.abs(a - b).max() <= 1e-6 * np.abs(b).max() + least


@pytest.mark.parametrize("name", plants())
def test_matrices_are_the_slopes_of_the_equations(name):
    given = OTHERS.get(name) or known(name)
    given = given.replace(simulation=given.simulation.replace(friction="stuck"))
    lin = fx.linearize(given, inputs=INPUTS, outputs=["tool", "com", "stroke"])
    found, plant = lin.descriptor(), lin.plant
    M, D, K, G = slopes(plant)
    unit = kinds(plant)
    least = 1e-10 * np.abs(K).max()  # rounding of forces of 1e5 N over a step of 1e-6: 1e-5 N/m of 1e9
    same(found.M, M, unit, unit, 1e-12 * np.abs(M).max())
    same(found.D, D, unit, unit, 1e-12 * np.abs(D).max() + 1e-9)
    same(found.K, K, unit, unit, least)
    assert found.G == pytest.approx(G, abs=1e-6)
    assert found.coordinates[0].startswith("leg 1 ") and found.coordinates[-1] == "payload rz"


def test_inputs_are_the_slopes_of_the_equations():
    given = OTHERS["loops"]
    lin = fx.linearize(given, inputs=INPUTS, outputs="tool")
    found, plant = lin.descriptor(), lin.plant
    system, x, wrench = plant.system, plant.x.state(0), plant.locked.acts.wrench
    table = np.zeros((system.legs, system.ports.size, 4))
    table[..., 0] = plant.command[0]

    def pushed(table, wrench):
        return system.residual(x, table, wrench)[0]

    rest = pushed(table, wrench)
    for k, name in enumerate(lin.inputs):
        group, _, which = name.rpartition(":")
        if group == "wrench":
            expected = rest - pushed(table, wrench + np.eye(6)[k])  # forces stand on the other side
            assert found.B[:, k] == pytest.approx(expected, abs=1e-9)
        if group == "command":
            leg, port = int(which) - 1, np.flatnonzero(system.ports == plant.port[int(which) - 1])[0]
            for order, ours in ((0, found.B), (1, found.B_rate)):
                more = table.copy()
                more[leg, port, order] += 1e-3
                expected = (rest - pushed(more, wrench)) / 1e-3
                assert ours[:, k] == pytest.approx(expected, abs=1e-6 * np.abs(expected).max())


def test_a_load_that_turns_the_platform_keeps_its_own_axes():
    # a moment about an axis of the world is not conservative: K has a part that is not symmetric
    given = fx.preset("tripod").replace(load=model.Load(wrench=model.ConstantWrench(value=[20, 30, -50, 5, -8, 3])))
    lin = fx.linearize(given, {"heave": 0.01}, inputs="wrench", outputs="tool")
    found = lin.descriptor()
    _, _, K, _ = slopes(lin.plant)
    assert np.abs(found.K - K)[-6:, -6:].max() < 1e-6 * np.abs(K[-6:, -6:]).max()
