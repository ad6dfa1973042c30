"""What is kept of a computation, and how near it has to come again."""

import json
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).with_name("numbers")
SAMPLES = 24  # of each quantity
# Rounding seen when masses, lengths and diameters change in their last digit, and what it comes from. A number is
# compared with `bound` times its scale; the scale is the quantity's peak unless it is a difference of larger numbers.
SAME = 1e-12  # some hundred operations in a row on numbers of the size of the peak
LENGTH = 3e-13  # of a metre (and a radian): deviations and amplitudes are what legs of 1 m miss, seen: 1.6e-14
RATE = 1e-9  # rad/s: an error of LENGTH over a step; seen: 1e-10
ENERGY = 1e-11  # of the largest energy: all are parts of one balance; seen: 1e-12, from forces of legs that are rigid
# Index 3: forces hold closures that are known to 2e-16 m, so they err by m 2e-16 m / (beta h^2) = 4e-7 N, and without
# numerical damping (rho_inf = 0.9) it piles up. Seen: 1e-9 of 1.1 kN, in legs without any compliance 3e-6.
FORCE = {"march-rigid": 3e-5, "march": 1e-8, "sweep": 1e-8}
DAMPING = 1e-11  # quotients of small numbers from eigenvectors, frequencies from 20 Hz to 3.5 kHz; seen: 3e-13
DIFFERENCES = ("deviation", "sag", "amplitude", "tip_deflection", "leg_angle", "vibration.amplitude")

# Runs within a tolerance choose their steps by estimates of the error, and the last bits, which differ between
# processors, may turn such a decision: a step more moves the result by part of the tolerance. So a hundredth of it is
# compared. What the tolerance is a share of is the largest deviation (actuator: the peak of each quantity): places,
# lengths and angles err as the deviation does, whatever their own size. Forces follow it by the stiffness of a leg,
# 5.2e8 N/m of paper-robot, each part of the energy by its own size, and what little is lost by the strain that is lost.
TOLERANCE = {"march-tolerance": 1e-4, "actuator-tolerance": 1e-5}
STIFFNESS = 5.2e8  # N/m


def within_tolerance(case, name, kept):
    """Largest distance allowed in a run within a tolerance."""
    share, own = 1e-2 * TOLERANCE[case], kept[name]["peak"]
    if "energy" in name or name.startswith("work"):
        return share * max(own, kept["energy_strain"]["peak"])
    if case.startswith("actuator"):
        return share * own
    if name == "nearest_legs":
        return 0.0
    largest = kept["com_deviation"]["peak"]
    if "force" in name:
        return share * STIFFNESS * largest
    return share * (max(own, largest) if "angular_velocity" in name or "deviation" in name else largest)


def sampled(values):
    """Some of the values, at places that do not keep step with any dimension."""
    flat = np.ravel(values)
    return flat[np.unique(np.arange(SAMPLES) * 7919 % flat.size)]


def peak(values):
    """Largest size, of what is a number."""
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max()) if finite.size else 0.0


def bound(case, name, kept):
    """Largest distance allowed between the kept numbers of a quantity and new ones."""
    if case in TOLERANCE:
        return within_tolerance(case, name, kept)
    quantity = kept[name]["peak"]
    if "energy" in name or name.startswith("work"):
        return ENERGY * max(kept[other]["peak"] for other in kept if "energy" in other or other.startswith("work"))
    if any(part in name for part in DIFFERENCES) and not case.startswith("actuator"):
        return LENGTH
    if name == "platform_angular_velocity":
        return RATE
    if "damping" in name or name == "vibration.share":
        return DAMPING * quantity
    if "force" in name and "rigid" not in name:
        return next((of for prefix, of in FORCE.items() if case.startswith(prefix)), SAME) * quantity
    return SAME * quantity


def write(case, found):
    """Keep the numbers of a case."""
    kept = {
        name: {"size": values.size, "peak": peak(values), "values": [float(x) for x in sampled(values)]}
        for name, values in sorted(found.items())
    }
    lines = ",\n".join(f"{json.dumps(name)}: {json.dumps(entry)}" for name, entry in kept.items())
    FOLDER.mkdir(exist_ok=True)
    (FOLDER / f"{case}.json").write_text("{\n" + lines + "\n}\n", encoding="utf-8")


def read(case):
    """The kept numbers of a case."""
    return json.loads((FOLDER / f"{case}.json").read_text(encoding="utf-8"))
