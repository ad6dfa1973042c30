"""Frequencies of platforms on beam legs by dynamic stiffness: closed forms, massless legs, and finite elements."""

import numpy as np
import pytest
from scipy.linalg import block_diag, eigh
from scipy.optimize import brentq
from tests.oracles import beams, frames
from tests.oracles.mechanism_cases import SIX_BASE, SIX_TOP, THREE, ring, tangent

pytestmark = pytest.mark.literature

STEEL = {"EI": 200e9 * np.pi * 0.027**4 / 64, "EA": 200e9 * np.pi * 0.027**2 / 4, "rhoA": 7800 * np.pi * 0.027**2 / 4}
GJ = STEEL["EI"] * 2 / 2.6
HELD = frames.Body(mass=1.0, inertia=np.eye(3), com=np.zeros(3), free=np.zeros((0, 6)))


def upright(**changed):
    return frames.Leg(**({"base": np.zeros(3), "tip": np.array([0, 0, 0.6]), "first": np.eye(3)[0]} | STEEL | changed))


@pytest.mark.parametrize("ends", [("clamped", "clamped"), ("clamped", "pinned"), ("pinned", "pinned")])
def test_one_beam_between_walls(ends):
    axes = [{"clamped": frames.NONE, "pinned": np.eye(3)[1:2]}[end] for end in ends]
    leg = upright(base_axes=axes[0], tip_axes=axes[1], planes=(0,))
    wave = 0.5 / 0.6 * np.sqrt(STEEL["EA"] / STEEL["rhoA"])  # Hz: the bar held at both ends
    known = beams.frequency(beams.beam_roots(*ends, 8), 0.6, STEEL["EI"], STEEL["rhoA"])
    known = np.sort(np.r_[known, wave * np.arange(1, 4)])[:8]
    np.testing.assert_allclose(frames.frequencies([leg], HELD, 8), known, rtol=1e-11)  # roots of cos cosh = 1 to 1e-12


def test_both_planes_have_their_own_stiffness():
    leg = upright(EI_2=4 * STEEL["EI"], tip_axes=frames.NONE, base_axes=frames.NONE)
    one = beams.frequency(beams.beam_roots("clamped", "clamped", 4), 0.6, STEEL["EI"], STEEL["rhoA"])
    np.testing.assert_allclose(frames.frequencies([leg], HELD, 6), np.sort(np.r_[one, 2 * one])[:6], rtol=1e-11)


@pytest.mark.parametrize("hinge", ["pinned", "welded"])
def test_a_mass_on_a_cantilever(hinge):
    """A heavy body on a leg welded below: stiffness 3EI/s^3 with a ball, 12EI/s^3 (no turning) when welded."""
    leg = upright(base_axes=frames.NONE, tip_axes=frames.ALL[:2] if hinge == "pinned" else frames.NONE, rhoA=1e-9)
    body = frames.Body(mass=50.0, inertia=1e9 * np.eye(3), com=leg.tip, free=np.eye(6)[:3])
    factor = 3 if hinge == "pinned" else 12
    side, up = np.sqrt(factor * STEEL["EI"] / 0.6**3 / 50) / (2 * np.pi), np.sqrt(STEEL["EA"] / 0.6 / 50) / (2 * np.pi)
    np.testing.assert_allclose(
        frames.frequencies([leg], body, 3), [side, side, up], rtol=1e-9
    )  # mass of the leg: 1e-11


def test_shafts():
    leg = upright(base_axes=frames.NONE, tip_axes=frames.NONE, GJ=GJ, spin_inertia=3e-4)
    disc = frames.Body(mass=1.0, inertia=np.diag([1, 1, 2e-4]), com=leg.tip, free=np.eye(6)[5:])
    # x tan x = ratio of inertias for a shaft with a disc
    x = [brentq(lambda x: x * np.sin(x) - 1.5 * np.cos(x), i * np.pi, i * np.pi + 1.57) for i in range(2)]
    known = np.array(x) / (2 * np.pi) * np.sqrt(GJ / (3e-4 * 0.6))
    bent = beams.frequency(beams.beam_roots("clamped", "clamped", 30), 0.6, STEEL["EI"], STEEL["rhoA"])
    held = np.sqrt(STEEL["EA"] / STEEL["rhoA"]) / 1.2 * np.arange(1, 4)
    others = np.sort(np.r_[bent, bent, held])
    for f in known:
        low, high = (frames.below(2 * np.pi * f * (1 + d), [leg], disc) for d in (-1e-9, 1e-9))
        assert (low, high) == (np.sum(others < f) + np.sum(known < f), np.sum(others < f) + np.sum(known < f) + 1)


def tripod(**changed):
    """3-RPS at home with the centre of its load in the plane of the joints."""
    base, top = ring(0.35, THREE), ring(0.2, THREE, 0.7)
    return [
        frames.Leg(base=b, tip=t, base_axes=tangent(b)[None], tip_axes=frames.ALL[:0], **(STEEL | changed))
        for b, t in zip(base, top, strict=True)
    ]


def balls(legs):
    """The same with balls at the tips: two turns across each leg; the third is idle."""
    return [frames.Leg(**{**vars(leg), "tip_axes": leg.axes().T[:2]}) for leg in legs]


def test_closed_forms_of_a_tripod():
    """kx = 3/2 (k cg^2 + kb), kz = 3 k sg^2, tilt 3/2 k r^2 sg^2, yaw 3 kb r^2, x with pitch -3/2 k r sg cg."""
    legs = balls(tripod())
    body = frames.Body(mass=1.0, inertia=np.eye(3), com=np.array([0, 0, 0.7]))
    K, r, s = frames.stiffness(legs, body), 0.2, legs[0].span
    k, kb = STEEL["EA"] / s, 3 * STEEL["EI"] / s**3
    sg, cg = 0.7 / s, 0.15 / s
    assert K[0, 0] == pytest.approx(1.5 * (k * cg**2 + kb), rel=1e-12)
    assert K[2, 2] == pytest.approx(3 * k * sg**2, rel=1e-12)
    assert K[4, 4] == pytest.approx(1.5 * k * r**2 * sg**2, rel=1e-12)
    assert K[5, 5] == pytest.approx(3 * kb * r**2, rel=1e-12)
    assert abs(K[0, 4]) == pytest.approx(1.5 * k * r * sg * cg, rel=1e-12)
    stiff = 5e3  # hinge that gives across its plane: 1/kb = s^3/3EI + l^2/k_h
    soft = [
        frames.Leg(
            **{**vars(leg), "base_axes": leg.axes().T[:2] if False else _both(leg), "base_springs": (0.0, stiff)}
        )
        for leg in legs
    ]
    kb = 1 / (1 / kb + s**2 / stiff)
    assert frames.stiffness(soft, body)[5, 5] == pytest.approx(3 * kb * r**2, rel=1e-12)


def _both(leg):
    """The hinge's axis, and the one across its plane."""
    axis = leg.base_axes[0]
    return np.array([axis, np.cross(leg.axes()[:, 2], axis)])


@pytest.mark.parametrize("count", [3, 4, 6])
def test_a_table_on_fixed_legs_sways_with_twelve_EI(count):
    corners = ring(0.3, np.arange(count) * 360 / count)
    legs = [
        frames.Leg(base=c, tip=c + np.array([0, 0, 0.8]), base_axes=frames.NONE, tip_axes=frames.NONE, GJ=GJ, **STEEL)
        for c in corners
    ]
    body = frames.Body(mass=1.0, inertia=np.eye(3), com=np.array([0, 0, 0.8]))
    K, s = frames.stiffness(legs, body), 0.8
    assert K[0, 0] == pytest.approx(12 * count * STEEL["EI"] / s**3, rel=1e-12)
    assert K[2, 2] == pytest.approx(count * STEEL["EA"] / s, rel=1e-12)
    assert K[5, 5] == pytest.approx(count * (GJ / s + 12 * STEEL["EI"] / s**3 * 0.3**2), rel=1e-12)


def shaped(name):
    """Legs and body of robots of several kinds, not at rest positions of symmetry."""
    turn = np.array([[0.98, -0.19, 0.05], [0.19, 0.98, 0.03], [-0.05, -0.02, 1.0]])
    turn = np.linalg.qr(turn)[0] * np.sign(np.diag(np.linalg.qr(turn)[1]))
    angles = {"6-UPS": (SIX_BASE, SIX_TOP), "welded": (SIX_BASE, SIX_TOP), "3-RPS": (THREE, THREE)}
    eight = (np.array([-10, 10, 80, 100, 170, 190, 260, 280]), np.array([-40, 40, 50, 130, 140, 220, 230, 310]))
    base, top = (ring(r, a) for r, a in zip((0.35, 0.2), angles.get(name, eight), strict=True))
    top = top @ turn.T + [0.01, -0.02, 0.8]
    body = frames.Body(mass=40.0, inertia=np.diag([1.5, 1.2, 2.0]), com=np.array([0.02, 0.03, 0.85]))
    legs = []
    for b, t in zip(base, top, strict=True):
        z = (t - b) / np.linalg.norm(t - b)
        x = np.cross([0, 0, 1.0], z)
        x /= np.linalg.norm(x)
        cross = np.array([x, np.cross(z, x)])
        parts = {"mouth": 0.25, "length": 0.7, "inertia": 0.06, "axial_inertia": 4e-3} | STEEL
        if name == "3-RPS":
            parts |= {"base_axes": tangent(b)[None], "tip_axes": cross}
        elif name == "welded":
            parts |= {"base_axes": cross, "tip_axes": frames.NONE, "GJ": GJ, "spin_inertia": 5e-4}
        else:
            parts |= {"base_axes": cross, "tip_axes": cross}
        legs.append(frames.Leg(base=b, tip=t, **parts))
    return legs, body


def elements(legs, body, n=8):
    """Frequencies [Hz] with cubic and linear elements, consistent masses: everything assembled as plain matrices."""
    size = 6 + sum(len(leg.base_axes) + len(leg.tip_axes) for leg in legs)
    inner = 0
    for leg in legs:
        inner += 2 * (2 * (n - 1)) + (n - 1) + (n - 1 if np.isfinite(leg.GJ) else 0)
    total, at, loose = size + inner, 6, size
    K, M = np.zeros((total, total)), np.zeros((total, total))
    line = np.array([[1, -1], [-1, 1]])

    def add(part, stiff, heavy):
        used = np.flatnonzero(part.any(axis=0))
        part = part[:, used]
        K[np.ix_(used, used)] += part.T @ stiff @ part
        M[np.ix_(used, used)] += part.T @ heavy @ part

    M[:6, :6] = block_diag(body.mass * np.eye(3), body.inertia)
    for leg in legs:
        A = leg.axes()
        nb, nt = len(leg.base_axes), len(leg.tip_axes)
        low, high, move = np.zeros((3, total)), np.zeros((3, total)), np.zeros((3, total))
        low[:, at : at + nb] = leg.base_axes.T
        high[:, 3:6], high[:, at + nb : at + nb + nt] = np.eye(3), leg.tip_axes.T
        arm = leg.tip - body.com
        move[:, :3] = np.eye(3)
        move[:, 3:6] = np.array([np.cross(e, arm) for e in np.eye(3)]).T
        low, high, move, at = A.T @ low, A.T @ high, A.T @ move, at + nb + nt
        h, g = (leg.span - leg.mouth) / n, leg.length / n
        unit = np.outer([1, h, 1, h], [1, h, 1, h])
        bend = leg.EI / h**3 * unit * [[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]]
        heavy = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]])
        heavy = leg.rhoA * h / 420 * unit * heavy
        for plane, slopes in ((0, (low[1], high[1])), (1, (-low[0], -high[0]))):
            rows = np.zeros((2 * n + 2, total))
            rows[:2], rows[-2:] = [leg.mouth * slopes[0], slopes[0]], [move[plane], slopes[1]]
            rows[2:-2, loose : loose + 2 * n - 2] = np.eye(2 * n - 2)
            loose += 2 * n - 2
            for e in range(n):
                add(rows[2 * e : 2 * e + 4], bend, heavy)
            solid = leg.inertia + leg.rhoA * (leg.mouth**3 - (leg.span - leg.length) ** 3) / 3
            M += solid * np.outer(slopes[0], slopes[0])
        M += leg.axial_inertia * np.outer(low[2], low[2])
        lines = [(np.zeros(total), move[2], leg.EA, leg.rhoA * leg.length)]
        lines += [(low[2], high[2], leg.GJ, leg.spin_inertia)] if np.isfinite(leg.GJ) else []
        for first, last, stiff, mass in lines:
            rows = np.zeros((n + 1, total))
            rows[0], rows[-1], rows[1:-1, loose : loose + n - 1] = first, last, np.eye(n - 1)
            loose += n - 1
            for e in range(n):
                add(rows[e : e + 2], stiff / g * line, mass / n / 6 * np.array([[2, 1], [1, 2]]))
    return np.sqrt(np.abs(eigh(K, M, eigvals_only=True))) / (2 * np.pi)


@pytest.mark.parametrize("name", ["6-UPS", "3-RPS", "8-UPS", "welded"])
def test_against_finite_elements(name):
    legs, body = shaped(name)
    exact, found = frames.frequencies(legs, body, 14), elements(legs, body)
    # Cubic elements: (lam / n)^4 / 1440 with lam up to 5 below the second bending: 1e-4; bars (x / n)^2 / 24, x < 0.6.
    np.testing.assert_allclose(found[:14], exact, rtol=2e-4)
    assert np.all(found[:14] > exact * (1 - 1e-9))  # from above
    for i in range(15, 30):  # counts between frequencies that are apart
        if found[i] > found[i - 1] * 1.02:
            assert frames.below(np.pi * (found[i] + found[i - 1]), legs, body) == i
