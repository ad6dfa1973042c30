"""The report's section of the linear model: disturbances, and damping by a controller before anything is simulated."""

import numpy as np
import pytest

import flexapod as fx
from flexapod.analysis.predicted_damping import predicted_damping
from flexapod.model import preset_text
from flexapod.output.report.report import robot_report

pytestmark = pytest.mark.consistency

MORE = '\n[disturbance]\nfloor = "VC-C"\n\n[control]\nlaw = "iff"\ngain = 200\nsample = "0.1 ms"\n'


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    path = tmp_path_factory.mktemp("study") / "nano.toml"
    path.write_text(preset_text("nano-hexapod") + MORE)
    return fx.load(path)


def test_predicted_damping_is_that_of_the_closed_form(study):
    """Light struts: g / 2 w more than without; struts of flexures have 1/50 of their stiffness beside the sensors."""
    found = predicted_damping(study)
    suspension = found.frequency < 600
    added = (found.ratio_with - found.ratio)[suspension]
    np.testing.assert_allclose(added, 200 / (4 * np.pi * found.frequency[suspension]), rtol=0.1)
    assert found.growing == 0
    assert predicted_damping(fx.preset("nano-hexapod")) is None


def test_reports_have_a_section_of_the_linear_model_where_there_is_something_to_say(study):
    short = {"step": 1e-4, "duration": 0.005}
    page = robot_report(study, fx.simulate(study, **short))
    assert "Linear model about home" in page and "disturbances shake the tool" in page.lower()
    assert "with the controller [Hz]" in page and "Predicted by the linear model" in page
    plain = fx.preset("nano-hexapod")
    assert "Linear model about home" not in robot_report(plain, fx.simulate(plain, **short))
