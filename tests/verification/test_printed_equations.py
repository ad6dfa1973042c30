"""The paper's energies as printed: each line's equation by hand, the derived path by another engine, the page's table.

The oracle has constants of its own, its equation in q = sqrt(rho L) a, and another integrator.
"""

import re
from pathlib import Path

import numpy as np
import pytest
from tests.helpers.paper_parts import part
from tests.oracles import sliding

from flexapod.mechanics.shapes import lateral_basis
from flexapod.verification.paper import printed_equations
from flexapod.verification.paper.energies import SHAPES, TIP_MASS, matrices
from flexapod.verification.paper.printed_equations import GRAVITY, LINES, tip_paths

RHO, EI, L0, FEED, TURN = 4.02, 756.65, 1.83, 0.1, 0.785
AT = {"L": 2.1, "L_dot": 0.1, "angle": 0.9, "angle_dot": 0.785}
pytestmark = [pytest.mark.consistency, pytest.mark.xdist_group("claims")]  # one process computes the parts
PAGE = Path(__file__).parents[2] / "docs" / "theory" / "T9-actuator.md"


def oracle():
    """Constants of the oracle in the signs of the product's shapes."""
    z, tip = sliding.constants(SHAPES), lateral_basis("clamped-free", SHAPES).tip
    sign = np.sign(z.b * tip)
    both = np.outer(sign, sign)
    e, f, b = (sign * x for x in (z.e, z.f, z.b))
    return e, f, b, *(both * x for x in (z.E4, z.B, z.C, z.G0, z.G1, z.Gt))


def equation(change):
    return [np.array(x) for x in matrices(change, GRAVITY)(*AT.values())]


def derived():
    """M, C, K, rest in amplitudes a at constant rates: (T9.5) with q = sqrt(rho L) a, multiplied by sqrt(rho L)."""
    e, _f, b, E4, B, C2, G0, G1, Gt = oracle()
    L, feed, angle, turn = AT.values()
    r, m, bb = feed / L, RHO * L, np.outer(b, b)
    # q' = sqrt(m) (a' + r/2 a), q'' = sqrt(m) (a'' + r a' - r^2/4 a), as r' = -r^2
    M = m * np.eye(SHAPES) + TIP_MASS * bb
    C = r * (m * 2 * B - TIP_MASS * bb)
    K = EI / L**3 * E4 + turn**2 * (m * G1 + TIP_MASS * Gt - M) - m * r**2 * (C2 + B) + TIP_MASS * bb * (3 / 4) * r**2
    K = K - GRAVITY * np.sin(angle) * (RHO * G0 + TIP_MASS / L * Gt)
    C, K = C + r * M, K + r / 2 * C - r**2 / 4 * M
    rest = 2 * turn * feed * (m * e + TIP_MASS * b) + GRAVITY * np.cos(angle) * (m * e + TIP_MASS * b)
    return M, C, K, rest[:, None]


def test_derived_lines_give_the_published_equation():
    for ours, theirs in zip(equation(lambda _: {}), derived(), strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-12 * np.abs(theirs).max())


def by_hand():
    """What each line adds to M, C, K and rest, written down by hand; what is not named stays."""
    e, _f, b, E4, _B, _C2, G0, _G1, Gt = oracle()
    L, feed, angle, turn = AT.values()
    m, bb, m_e = RHO * L, np.outer(b, b), TIP_MASS
    eps = np.sqrt(np.sqrt(np.diag(E4)))
    a2 = np.diag(((np.sin(eps) + np.sinh(eps)) / (np.cos(eps) + np.cosh(eps))) ** 2)
    slope = lateral_basis("clamped-free", SHAPES).values(np.array([1.0]), 1)[:, 0]
    less = np.linalg.inv(a2) - np.eye(SHAPES)
    coupled = {"rest": -(2 - m_e / 2) * m_e * turn * feed * b}
    return {
        "2, norm": {"M": m * less, "C": m * feed / L * less, "K": EI / L**3 * E4 @ less - turn**2 * m * less},
        "2, power (copy)": {"K": np.diag(RHO * np.sqrt(EI / RHO) * eps**2 / L) - EI / L**3 * E4},
        "5, dots lost (copy)": {
            "M": -m_e * bb,
            "K": -m_e * bb,
            "rest": -(2 * m_e * turn * feed + 0.5 * m_e**2 * L * turn) * b,
        },
        "5, with dots": coupled,
        "5, with dots and factor 2": {"rest": -m_e * turn * feed * b},
        "7, nothing elastic": {"rest": -GRAVITY * np.cos(angle) * (m * e + m_e * b)},
        "8, linear": {"K": -(turn**2) * m_e * Gt, "rest": m_e * turn**2 * L * slope},
        "8, with half and square": {"K": turn**2 * m_e * (np.outer(slope, slope) - Gt)},
        "9-10, centrifugal only": {"K": GRAVITY * np.sin(angle) * (RHO * G0 + m_e / L * Gt)},
    }


@pytest.mark.parametrize("line", LINES, ids=lambda line: line.name)
def test_each_line_changes_what_it_says(line):
    own, found = equation(lambda _: {}), equation(line.change)
    if line.name == "4, without sliding":
        # u_t alone at fixed x / L: no convective matrices, so C and K keep only what L' in rho L does to M a'.
        e, f, _b, _, B, C2, *_ = oracle()
        L, feed, _, turn = AT.values()
        m, r = RHO * L, feed / L
        A = B + 0.5 * np.eye(SHAPES)  # int phi (1 - xi) phi'^T = B + 1/2
        inside = C2 + 0.5 * (B + B.T) + 0.25 * np.eye(SHAPES)  # int (1 - xi)^2 phi' phi'^T
        np.testing.assert_allclose(found[0], own[0], rtol=1e-13)
        np.testing.assert_allclose(found[1] - own[1], -m * r * (A - A.T), atol=1e-10)
        # d/dt (m r A) = 0 at constant rates, - r^2 inside from dL/da, and in rest what theta' int x Du/Dt loses
        np.testing.assert_allclose(found[2] - own[2], m * r**2 * inside, atol=1e-9)
        moment = 2 * f - e  # int xi (1 - xi) phi' = - int (1 - 2 xi) phi
        np.testing.assert_allclose(found[3][:, 0] - own[3][:, 0], m * L * turn * r * moment, atol=1e-9)
        return
    changed = by_hand()[line.name]
    for name, before, after in zip(("M", "C", "K", "rest"), own, found, strict=True):
        gap = (after - before).reshape(SHAPES, -1)
        expected = np.asarray(changed.get(name, np.zeros_like(gap))).reshape(SHAPES, -1)
        np.testing.assert_allclose(gap, expected, atol=1e-11 * max(np.abs(before).max(), np.abs(expected).max(), 1))


def test_derived_paths_are_those_of_another_engine(monkeypatch):
    """First two seconds, level and upright, by the oracle's collocation of order 6 at 1 ms.

    Runge-Kutta's phase is off by (omega h)^4 / 120 a radian: of the third shape, 253 rad/s and 9 um, two at the tip,
    by 2e-6 x 506 = 1e-3, that is 2e-8 m; of the others less. Upright its amplitude is rho g L^4 f / EI eps^4 = 39 um.
    """
    monkeypatch.setattr(printed_equations, "DURATION", 2.0)
    ours = tip_paths([(None, False), (None, True)])
    basis = lateral_basis("clamped-free", SHAPES)
    static = np.linalg.solve(basis.stiffness, basis.tip)
    a0 = 5e-3 * static / (basis.tip @ static) * np.sign(sliding.constants(SHAPES).b * basis.tip)
    motion, t = sliding.uniform_motion(L0, FEED, TURN), np.arange(0, 2.005, 0.01)
    for path, g, off in zip(ours, (0.0, GRAVITY), (2e-8, 8e-8), strict=True):

        def right(time, g=g):
            return sliding.q_equation(*motion(time), g=g, m_e=TIP_MASS, rho=RHO, EI=EI, k=SHAPES)

        root = np.sqrt(RHO * L0)
        q = sliding.march(right, root * a0, root * FEED / L0 / 2 * a0, t)  # a' = 0: q' = r/2 q
        theirs = q @ sliding.constants(SHAPES).b / np.sqrt(RHO * (L0 + FEED * t))
        np.testing.assert_allclose(path, theirs, rtol=0, atol=off)


def test_page_says_what_the_lines_cost():
    """Largest error of the tip and its share, in the rows of the table in T9, by the program, rounded as printed."""
    costs = {str(line): (float(e), float(e / s)) for line, e, s in zip(*_costs(), strict=True)}
    text = PAGE.read_text(encoding="utf-8").split("## Line by line against the print")[1]
    printed = re.findall(r"\| ([\d.]+) mm, ([\d.]+) % \|", text)
    found = [(f"{1e3 * error:.3g}", f"{100 * share:.2g}") for error, share in costs.values()]
    found = [tuple(f"{float(x):g}" for x in pair) for pair in found]
    assert printed == found


def _costs():
    data = part("printed-lines")
    return data.line.values, data.tip_error.values, data.largest.values
