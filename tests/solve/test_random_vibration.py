"""Random vibration of one mode against closed forms, and floors by their class, Eqs. (T18.6)-(T18.12)."""

import numpy as np
import pytest

from flexapod.model import CURVES, Floor, Spectrum
from flexapod.solve.linear.random_vibration import LinearRobot, Source, density_at, random_vibration

pytestmark = pytest.mark.analytic

F0, RATIO, K = 20.0, 0.01, 3e6


def one_mode(f0: float = F0, ratio: float = RATIO, k: float = K) -> LinearRobot:
    """A mass on a spring that moves the tool along x; a force on it, and an acceleration of its base."""
    omega = 2 * np.pi * f0
    tool = np.zeros((6, 1))
    tool[0] = 1 / np.sqrt(k)  # unit stiffness: q = sqrt(k) x
    return LinearRobot(
        omega=np.array([omega]),
        damping=np.array([[2 * ratio / omega]]),
        tool=tool,
        inputs={"force": np.array([[1 / np.sqrt(k)]]), "floor": np.array([[-np.sqrt(k) / omega**2]])},
    )


def white(forces, level: float, *, low: float = 1e-4, high: float = 1e6, rates: int = 0) -> Source:
    frequency = np.array([low, high])
    return Source(name="one", forces=forces, frequency=frequency, density=np.full((2, 1), level), rates=rates)


def test_a_white_force_on_one_mode():
    # Crandall & Mark, Random Vibration in Mechanical Systems, sec. 2.2, one-sided in Hz; what lies outside
    # 1e-4 .. 1e6 Hz is below 1e-5 of the variance
    model, level = one_mode(), 0.04
    found = random_vibration(model, [white(model.inputs["force"], level)])
    assert found.rms[0] == pytest.approx(np.sqrt(np.pi * F0 * level / (4 * RATIO)) / K, rel=1e-5)
    assert found.cumulative[0] == pytest.approx(found.rms)
    assert found.by_mode.sum(axis=0) == pytest.approx(found.rms)
    assert not found.rms[1:].any()


def test_a_white_floor_acceleration_on_one_mode():
    # Miles: mean square of the relative displacement = S_a / (64 pi^3 f0^3 zeta), with S_x = S_a / (2 pi f)^4 the
    # resonance part sqrt(pi f0 S_x(f0) / (4 zeta))
    model, level = one_mode(), 1e-6
    found = random_vibration(model, [white(model.inputs["floor"], level)])
    at_resonance = level / (2 * np.pi * F0) ** 4
    assert found.rms[0] == pytest.approx(np.sqrt(np.pi * F0 * at_resonance / (4 * RATIO)), rel=1e-5)
    assert found.rms[0] == pytest.approx(np.sqrt(level / (64 * np.pi**3 * F0**3 * RATIO)), rel=1e-5)


@pytest.mark.parametrize("ratio", [1e-4, 1e-2, 0.3, 0.95, 3.0])
def test_the_integral_converges_whatever_the_damping(ratio):
    model = one_mode(ratio=ratio)
    source = white(model.inputs["force"], 1.0, low=0.5, high=500.0)
    coarse, fine = (random_vibration(model, [source], refine=n).rms[0] for n in (1, 4))
    assert coarse == pytest.approx(fine, rel=1e-5)  # four Gauss points where the next pole is a panel away: 1e-6
    if ratio <= 0.01:
        band = np.sqrt(np.pi * F0 / (4 * ratio)) / K
        assert fine == pytest.approx(band, rel=2 * ratio + 1e-3)


def of_floor(curve: str, rates: int) -> float:
    """Rms of the floor itself: of its velocity, or with -1 its displacement."""
    floor, model = Floor.by_curve(curve), one_mode(f0=1e7, ratio=0.5, k=1.0)
    keep = floor.frequency >= 8.0
    f = np.unique(np.append(floor.frequency[keep], 8.0))
    source = Source(
        name="floor", forces=model.inputs["force"], frequency=f,
        density=density_at(floor.frequency, floor.density, f)[:, :1], rates=rates,
    )  # fmt: skip
    return float(random_vibration(model, [source]).rms[0])


def test_a_floor_of_class_a_at_its_worst():
    # every band from 8 to 80 Hz at 50 um/s: 157.7 um/s and 1454 nm together
    assert of_floor("VC-A", 0) == pytest.approx(157.7e-6, abs=0.05e-6)
    assert of_floor("VC-A", -1) == pytest.approx(1454e-9, abs=0.5e-9)
    assert of_floor("VC-C", 0) == pytest.approx(157.7e-6 / 4, abs=0.05e-6)


@pytest.mark.parametrize("curve", list(CURVES))
def test_each_third_of_an_octave_reaches_the_curve(curve):
    floor = Floor.by_curve(curve)
    for centre in (10.0, 25.0, 63.0):
        f = np.geomspace(centre * 2 ** (-1 / 6), centre * 2 ** (1 / 6), 20001)
        rms = np.sqrt(np.trapezoid(density_at(floor.frequency, floor.density, f)[:, 2], f))
        # a density that falls with 1 / f: the band holds ln 2 / 3 over its width for its middle, 0.9 % more
        assert rms == pytest.approx(CURVES[curve] * np.sqrt(np.log(2) / 3 / (2 ** (1 / 6) - 2 ** (-1 / 6))), rel=1e-6)
    assert CURVES[curve] == pytest.approx(
        {"A": 50e-6, "B": 25e-6, "C": 12.5e-6, "D": 6.25e-6, "E": 3.12e-6, "F": 1.56e-6, "G": 0.78e-6}[curve[-1]],
        rel=5e-3,
    )


def test_a_spectrum_between_its_rows():
    table = Spectrum(frequency=np.array([1.0, 10.0, 20.0, 40.0]), density=np.array([[1.0], [100.0], [0.0], [4.0]]))
    f = np.array([0.5, 1.0, 2.0, 10.0, 15.0, 30.0, 40.0, 41.0])
    expected = [0.0, 1.0, 4.0, 100.0, 50.0, 2.0, 4.0, 0.0]
    assert density_at(table.frequency, table.density, f)[:, 0] == pytest.approx(expected)
