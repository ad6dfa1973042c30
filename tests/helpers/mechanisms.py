"""Robots of many kinds for tests, built from the model's classes."""

from __future__ import annotations

import numpy as np

from flexapod.model import Robot
from flexapod.model.leg.cylinder import Cylinder
from flexapod.model.leg.joint import Carriage
from flexapod.model.study.payload import Payload
from flexapod.verification.robots import CYLINDER, LOWER, PISTON, THREE, UPPER, leg, rod, tangents

__all__ = ["CYLINDER", "LOWER", "PISTON", "ROBOTS", "THREE", "UPPER", "built", "leg", "ring", "rod", "tangents"]

LOAD = Payload(mass=100.0, inertia=[18.0, 18.0, 18.0], com=[0.0, 0.05, 0.1])


def ring(radius, degrees, height=0.0):
    a = np.deg2rad(degrees)
    return np.stack([radius * np.cos(a), radius * np.sin(a), np.full(len(a), height)], axis=-1)


def built(kind, base, top, height, legs, **more):
    found = tuple(legs)
    return Robot(
        type=kind, base_joints=base, platform_joints=top, home_height=height, gravity=[0, 0, -9.81],
        payload=more.pop("payload", LOAD), legs=found, **more,
    )  # fmt: skip


def hexapod(chain="UPS", lower=LOWER, upper=UPPER, height=0.8):
    base, top = ring(0.35, lower), ring(0.2, upper)
    return built(f"{len(base)}-{chain}", base, top, height, [leg(chain)] * len(base))


def eight():
    corners = np.repeat(np.arange(4) * 90.0, 2)
    return hexapod("UPS", corners + np.tile([-12, 12], 4), corners + np.tile([-35, 35], 4) + 8.0)


def three_rps():
    return built("3-RPS", ring(0.35, THREE), ring(0.2, THREE), 0.6, [leg("RPS", axis) for axis in tangents(THREE)])


def three_spr():
    legs = [leg("SPR", None, axis) for axis in tangents(THREE)]
    return built("3-SPR", ring(0.2, THREE), ring(0.35, THREE), 0.6, legs)


def three_upu(height=0.6):
    return built(
        "3-UPU", ring(0.35, THREE), ring(0.2, THREE), height, [leg("UPU", axis, axis) for axis in tangents(THREE)]
    )


def tricept():
    base = np.vstack([ring(0.35, THREE), [[0.0, 0.0, 0.0]]])
    top = np.vstack([ring(0.2, THREE), [[0.0, 0.0, 0.0]]])
    legs = [*[leg("UPS")] * 3, leg("UP", [1.0, 0.0, 0.0], passive=True)]
    return built("3-UPS+UP", base, top, 0.7, legs)


def sliders(chain, axes=(None,) * 6, lower=LOWER, upper=UPPER, length=0.65, rail=(0.0, 0.0, 1.0), side=-1):
    """Upright rails, the platform above (`side` -1) or below its carriages."""
    count = len(lower)
    carriage = Carriage(kind="slider", axis=rail, mass=3.0, side=side)
    ends = [axis if chain.endswith("U") else None for axis in axes]
    legs = [
        leg(chain, a, e, carriage=carriage, strut=rod(length)) for a, e in zip(axes[:count], ends[:count], strict=True)
    ]
    return built(f"{count}-{chain}", ring(0.3, lower), ring(0.15, upper), 0.6, legs)


def delta():
    return sliders("PUU", tangents(THREE), THREE, THREE, length=0.4, side=1)


def three_prs():
    return sliders("PRS", tangents(THREE), THREE, THREE, length=0.5)


def six_rus():
    base = ring(0.3, LOWER)
    legs = [
        leg("RUS", carriage=Carriage(kind="crank", axis=out, arm=0.12 * (along + 0.3 * np.array([0, 0, 1.0])),
                                     inertia=0.02), strut=rod(0.62))
        for out, along in zip(ring(1.0, LOWER), tangents(LOWER), strict=True)
    ]  # fmt: skip
    return built("6-RUS", base, ring(0.18, UPPER), 0.6, legs)


def planar(chain="RPR"):
    base, top = ring(0.35, THREE), ring(0.08, THREE + 10.0)
    if chain == "PRR":
        ways = [Carriage(kind="slider", axis=axis, mass=0.2, side=-1) for axis in tangents(THREE)]
        legs = [leg(chain, carriage=way, strut=rod(0.4)) for way in ways]
    else:
        short = {"cylinder": Cylinder(mass=1.0, com=0.05, mouth=0.1), "piston": PISTON}
        legs = [leg(chain, **short)] * 3
    return built(f"3-{chain}", base, top, 0.0, legs, plane="xy")


def between_points():
    """One actuator between two fixed points."""
    return built("1-UPS", np.zeros((1, 3)), np.zeros((1, 3)), 0.8, [leg("UPS")], payload=None, platform_fixed=True)


def flexures():
    return hexapod("FPF")


ROBOTS = {
    "6-UPS": hexapod,
    "6-SPS": lambda: hexapod("SPS"),
    "6-UCU": lambda: hexapod("UCU"),
    "6-FPF": flexures,
    "8-UPS": eight,
    "3-RPS": three_rps,
    "3-SPR": three_spr,
    "3-UPU": three_upu,
    "3-PRS": three_prs,
    "3-PUU": delta,
    "3-UPS+UP": tricept,
    "6-PUS": lambda: sliders("PUS"),
    "6-RUS": six_rus,
    "planar 3-RPR": planar,
    "planar 3-PRR": lambda: planar("PRR"),
    "1-UPS": between_points,
}


AMPLITUDES = {"surge": 0.03, "sway": -0.02, "heave": 0.04, "roll": 0.15, "pitch": -0.12, "yaw": 0.2}
TILTS, SHIFTS = ("heave", "roll", "pitch"), ("surge", "sway", "heave")
OWN = {"3-RPS": TILTS, "3-SPR": TILTS, "3-PRS": TILTS, "3-UPS+UP": TILTS, "3-UPU": SHIFTS, "3-PUU": SHIFTS}
MOVING = [name for name in ROBOTS if name != "1-UPS"]
DURATION = 0.5


def quintic(amplitude, t):
    """Value, rate, acceleration of the law from rest to rest."""
    s = t / DURATION
    law = [s**3 * (10 - 15 * s + 6 * s**2), 30 * (s * (1 - s)) ** 2, 60 * s * (1 - s) * (1 - 2 * s)]
    return amplitude * np.array(law) / DURATION ** np.arange(3)
