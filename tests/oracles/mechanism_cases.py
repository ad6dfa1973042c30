"""Mechanisms that people build, as plain numbers, each with a motion in its own degrees of freedom."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from tests.oracles.mechanisms import HEAVE, PITCH, ROLL, SURGE, SWAY, YAW, Mechanism, chain, platform, unit

CYLINDER = (3.0, 0.16, 0.025, 2e-3)  # kg, m, kg m^2 across and along
PISTON = (3.3, 0.75, 5e-4)  # kg, m, kg m^2
UP = np.array([0.0, 0.0, 1.0])


def ring(radius, degrees, height=0.0):
    a = np.deg2rad(degrees)
    return np.column_stack([radius * np.cos(a), radius * np.sin(a), np.full(len(a), height)])


def tangent(point):
    return unit(np.cross(UP, point))


def radial(point):
    return unit([point[0], point[1], 0])


def pairs(half, centres):
    return np.concatenate([[c - half, c + half] for c in centres])


def load(height, mass=30.0, com=(0.02, 0.05, 0.08), pivot=(0.0, 0.0, 0.0)):
    inertia = np.array([[0.9, 0.05, -0.03], [0.05, 1.1, 0.02], [-0.03, 0.02, 1.4]])
    home = np.array([0, 0, height])
    return platform(mass, home + com, inertia, home + pivot)


def built(legs, height, independent=range(6), **kept):
    hub = load(height, **kept)
    return Mechanism(tuple(legs), hub, np.array([0.03, -0.02, height + 0.1]), independent=tuple(independent))


SIX_BASE = pairs(10, [0, 120, 240])[[0, 1, 2, 3, 4, 5]]
SIX_TOP = np.array([-50, 50, 70, 170, 190, 290])
THREE = np.array([0, 120, 240])


def ups(count_angles=(SIX_BASE, SIX_TOP), letters="UPS", **more):
    base, top = ring(0.35, count_angles[0]), ring(0.2, count_angles[1], 0.8)
    return built(
        [chain(letters, b, t, cylinder=CYLINDER, piston=PISTON, **more) for b, t in zip(base, top, strict=True)], 0.8
    )


def eight_ups():
    return ups((np.array([-10, 10, 80, 100, 170, 190, 260, 280]), np.array([-40, 40, 50, 130, 140, 220, 230, 310])))


def six_ucu():
    return ups(letters="UCU")


def three_rps(letters="RPS", independent=(HEAVE, PITCH, ROLL)):
    base, top = ring(0.35, THREE), ring(0.2, THREE, 0.7)
    if letters == "SPR":
        base, top = ring(0.2, THREE), ring(0.35, THREE, 0.7)
    legs = [
        chain(letters, b, t, axis=tangent(b) if letters == "RPS" else None, platform_axis=tangent(t),
              cylinder=CYLINDER, piston=PISTON)
        for b, t in zip(base, top, strict=True)
    ]  # fmt: skip
    return built(legs, 0.7, independent)


def three_spr():
    return three_rps("SPR")


def three_prs():
    base, top = ring(0.4, THREE), ring(0.2, THREE, 0.55)
    legs = [
        chain("PRS", b, t, slider=UP, axis=tangent(b), carriage=4.0, strut=rod(b, t, 2.0, 3e-4))
        for b, t in zip(base, top, strict=True)
    ]
    return built(legs, 0.55, (HEAVE, PITCH, ROLL))


def tricept():
    base, top = ring(0.4, THREE), ring(0.18, THREE, 0.9)
    legs = [chain("UPS", b, t, cylinder=CYLINDER, piston=PISTON) for b, t in zip(base, top, strict=True)]
    middle = chain("UP", [0, 0, 0.1], [0, 0, 0.9], axis=[1, 0, 0], cylinder=(6.0, 0.2, 0.08, 0.01),
                   piston=(5.0, 0.7, 8e-3), passive=True)  # fmt: skip
    # its own motions: turns of the cross and the length; surge, sway and heave of the platform's centre name them
    return built([*legs, middle], 0.9, (SURGE, SWAY, HEAVE))


def rod(base, tip, mass, axial):
    return mass, float(np.linalg.norm(tip - base)), axial


def six_pus(slope=None):
    """Rails upright, or at a slope along the circle of their joints."""
    base, top = ring(0.4, SIX_BASE), ring(0.18, SIX_TOP, 0.7)
    rails = [UP if slope is None else slope * UP + tangent(b) for b in base]
    legs = [
        chain("PUS", b, t, slider=rail, carriage=3.0, strut=rod(b, t, 1.5, 2e-4))
        for b, t, rail in zip(base, top, rails, strict=True)
    ]
    return built(legs, 0.7)


def six_rus():
    base, top = ring(0.3, SIX_BASE), ring(0.18, SIX_TOP, 0.6)
    legs = []
    for b, t in zip(base, top, strict=True):
        arm = 0.12 * unit(tangent(b) + 0.3 * UP)
        legs.append(chain("RUS", b, t, crank=(radial(b), arm), carriage=0.02, strut=rod(b, t, 1.5, 2e-4)))
    return built(legs, 0.6)


def delta():
    base, top = ring(0.25, THREE, 0.6), ring(0.06, THREE, 0.2)
    legs = [
        chain("PUU", b, t, slider=UP, axis=tangent(b), platform_axis=tangent(b), carriage=0.8,
              strut=rod(b, t, 0.4, 1e-4))
        for b, t in zip(base, top, strict=True)
    ]  # fmt: skip
    return built(legs, 0.2, (SURGE, SWAY, HEAVE))


def planar_prr(length=0.2):
    """Sliders along the sides of a triangle, each behind its rod; in the plane z = 0, gravity along -y."""
    middle, top = ring(0.24, THREE), ring(0.06, np.array([8, 128, 248]))
    legs = []
    for m, t in zip(middle, top, strict=True):
        rail = tangent(m)
        across = t - m - rail * np.dot(t - m, rail)
        base = t - across - rail * np.sqrt(length**2 - across @ across)
        legs.append(chain("PRR", base, t, slider=rail, axis=UP, carriage=0.2, strut=(0.1, length, 0.0)))
    found = built(legs, 0.0, (SURGE, SWAY, YAW), com=(0.01, 0.02, 0.0))
    return replace(found, gravity=np.array([0, -9.81, 0]), tool=np.array([0.03, -0.02, 0.0]))


def three_upu(around=tangent):
    base, top = ring(0.35, THREE), ring(0.2, THREE, 0.7)
    legs = [
        chain("UPU", b, t, axis=around(b), platform_axis=around(t), cylinder=CYLINDER, piston=PISTON, exact=True)
        for b, t in zip(base, top, strict=True)
    ]
    return built(legs, 0.7, (SURGE, SWAY, HEAVE))


def exechon():
    """Two UPR legs that turn about one axis x, one SPR leg in the plane of y and z."""
    x, y = np.eye(3)[:2]
    parts = {"cylinder": CYLINDER, "piston": PISTON, "exact": True}
    legs = [
        chain("UPR", [0.4 * side, 0, 0], [0.2 * side, 0, 0.8], axis=x, platform_axis=y, **parts) for side in (1, -1)
    ]
    legs.append(chain("SPR", [0, 0.4, 0], [0, 0.2, 0.8], platform_axis=x, **parts))
    return built(legs, 0.8, (HEAVE, PITCH, ROLL))


def planar_rpr():
    base, top = ring(0.3, THREE), ring(0.1, THREE + 40)
    legs = [
        chain("RPR", b, t, axis=UP, cylinder=CYLINDER, piston=(1.0, 0.2, 0.0)) for b, t in zip(base, top, strict=True)
    ]
    return built(legs, 0.0, (SURGE, SWAY, YAW))


def similar_hexagons():
    return ups((SIX_BASE, SIX_BASE))


@dataclass(frozen=True)
class Case:
    """A mechanism and amplitudes of its independent coordinates."""

    mechanism: Mechanism
    amplitudes: tuple[float, ...]

    def motion(self, t):
        """Values, rates, accelerations (3, d) at a time."""
        a = np.array(self.amplitudes)
        w, p = 3.0 + np.arange(len(a)), 0.4 + 0.7 * np.arange(len(a))
        return np.array([a * np.sin(w * t + p), a * w * np.cos(w * t + p), -a * w**2 * np.sin(w * t + p)])


SIX = (0.04, 0.03, 0.05, 0.2, 0.15, 0.18)
CASES = {
    "6-UPS": lambda: Case(ups(), SIX),
    "6-UCU": lambda: Case(six_ucu(), SIX),
    "8-UPS": lambda: Case(eight_ups(), SIX),
    "3-RPS": lambda: Case(three_rps(), (0.06, 0.2, 0.18)),
    "3-PRS": lambda: Case(three_prs(), (0.05, 0.2, 0.18)),
    "3-SPR": lambda: Case(three_spr(), (0.05, 0.2, 0.18)),
    "3-UPS+UP": lambda: Case(tricept(), (0.1, 0.08, 0.06)),
    "6-PUS": lambda: Case(six_pus(), SIX),
    "6-PUS inclined": lambda: Case(six_pus(1.0), SIX),
    "6-RUS": lambda: Case(six_rus(), tuple(0.5 * np.array(SIX))),
    "3-PUU": lambda: Case(delta(), (0.05, 0.04, 0.05)),
    "3-PRR": lambda: Case(planar_prr(), (0.01, 0.008, 0.1)),
}


def orsino_motion(t):
    w, turn = 4 * np.pi, np.pi / 9
    c, s, c2, s2 = np.cos(w * t), np.sin(w * t), np.cos(2 * w * t), np.sin(2 * w * t)
    value = np.array([0.1 * c, 0.1 * s, turn * s2])  # from x = 2, y = 0.3
    rate = w * np.array([-0.1 * s, 0.1 * c, 2 * turn * c2])
    return value, rate, -(w**2) * np.array([0.1 * c, 0.1 * s, 4 * turn * s2])
