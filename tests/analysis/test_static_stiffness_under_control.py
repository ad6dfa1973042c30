"""What controllers leave of static stiffness, against springs by hand, and what is said of it."""

import numpy as np
import pytest
from tests.helpers.sampled_springs import PID, STUDY, K, T, height

import flexapod as fx
from flexapod.analysis.predicted_damping import control_effect, static_stiffness
from flexapod.control import IFF, Decentralised, integrator
from flexapod.output.text.description import control_words

pytestmark = pytest.mark.consistency

FORCES = '[control]\nlaw = "iff"\ngain = 200\nsample = "0.5 ms"\n'


def of(table):
    return static_stiffness(fx.loads(STUDY + table))


def across():
    """Least stiffness of six springs alike, (rows of K / 2 (1 - s^2) across, s^2 K up): that across, by symmetry."""
    return 6 * K * min(height() ** 2, (1 - height() ** 2) / 2)


@pytest.mark.parametrize(
    ("table", "left"),
    [
        (FORCES + "high_pass = 5\n", 2 * np.pi * 5 / (2 * np.pi * 5 + 200)),
        (FORCES, 0.0),
        (PID.format(law="pid", T=T, proportional=8e5, integral=0, derivative=60), 1.4),
        (PID.format(law="pid", T=T, proportional=8e5, integral=4e6, derivative=60), np.inf),
    ],
)
def test_springs_by_hand(table, left):
    """A spring k whose force is integrated above w has k w / (w + g), with a proportional gain k + P; turns of the
    payload take part, so that the ratio is that of the legs and the size below that of springs that do not turn."""
    off, on = of(table)
    assert on / off == pytest.approx(left, rel=1e-9)
    assert off <= across() * (1 + 1e-9)


def test_without_a_controller_there_is_nothing_to_say():
    assert static_stiffness(fx.loads(STUDY)) is None and control_words(control_effect(fx.loads(STUDY))) == ()


def test_flexures_beside_the_drives_keep_some():
    """Springs of flexures beside sensors hold what summed forces let go of."""
    text = fx.model.preset_text("nano-hexapod") + FORCES.replace("0.5 ms", "0.1 ms")
    off, on = static_stiffness(fx.loads(text))
    assert 1e-4 * off < on < 0.1 * off


def test_a_parallel_stiffness_is_that_of_springs_in_place_of_the_drives():
    """What sums force + k stroke holds the force of a spring k: at rest the robot has drives of that stiffness."""
    text = fx.model.preset_text("nano-hexapod")
    _, on = static_stiffness(
        fx.loads(text + FORCES.replace("0.5 ms", "0.1 ms") + 'parallel_stiffness = "0.7 N/um"\nnoise = 1e-4\n')
    )
    sprung = fx.loads(text.replace('stiffness = "1.846 N/um", damping', 'stiffness = "0.7 N/um", damping'))
    compliance = np.linalg.inv(fx.stiffness(sprung).stiffness.values)[:3, :3]
    # The weight rests on stiffer springs in the first: their sag by a few um changes arms of 60 mm by less than 1e-4
    assert on == pytest.approx(1 / np.linalg.norm(compliance, 2), rel=1e-4)


def test_words():
    words = control_words(control_effect(fx.loads(STUDY + FORCES)))
    assert "none with it" in words[0] and "static stiffness is lost" in words[1]
    assert len(control_words(control_effect(fx.loads(STUDY + FORCES + "high_pass = 5\n")))) == 1


@pytest.mark.parametrize(
    ("law", "said"),
    [
        (IFF(200.0), True),
        (IFF(200.0, high_pass=1.0), False),
        (IFF(200.0, parallel_stiffness=1e5), False),
        (Decentralised(integrator(1e5), sensor="stroke"), False),
    ],
)
def test_a_simulation_remarks_on_what_lets_go(law, said):
    data = fx.simulate(fx.loads(STUDY), controller=law, sample=T, duration=2 * T)
    assert ("static stiffness is lost" in data.attrs["warnings"]) == said
