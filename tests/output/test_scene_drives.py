"""Forces and places of drives of any kind, as figures, charts and colours read them."""

import numpy as np
import pytest
from tests.helpers.mechanisms import ROBOTS

import flexapod as fx
from flexapod import model, plot
from flexapod.app.browser import charts, legend
from flexapod.output.scene.style import drives

pytestmark = pytest.mark.unit

KINDS = {
    "6-RUS": ("torque", "N m", "angle of the cranks", 6),
    "3-PRS": ("force", "N", "place of the carriages", 3),
    "3-UPS+UP": ("force", "N", "length", 3),
}


@pytest.mark.parametrize("name", KINDS)
def test_drives_of_cranks_carriages_and_strokes(name):
    robot = ROBOTS[name]()
    motion = model.CombinedMotion(amplitudes={"heave": 0.01}, duration=0.02)
    data = fx.simulate(robot, motion, fidelity="rigid", step=1e-3, output_step=1e-3, duration=0.02)
    word, unit, place, count = KINDS[name]
    found = drives(data)
    assert (found.word, found.unit, found.place, found.force.sizes["leg"]) == (word, unit, place, count)
    chart = charts.charts(data)["leg forces"]
    assert len(chart.names) == count and word in chart.title.lower()
    colors = legend.leg_colors("force", model.loads(data.attrs["study"]), data)
    assert np.isnan(colors.values).all(axis=0).sum() == robot.count - count
    titles = [axes.get_title(loc="left") for axes in plot.actuator_forces(data).axes]
    assert sum(title.startswith("Leg") for title in titles) == count
    assert place in plot.leg_lengths(data).axes[0].get_title(loc="left")
