"""Every lateral basis keeps one contract, for every number of shapes from 1 to 12."""

import numpy as np
import pytest
from tests.oracles import beams
from tests.oracles.ritz import clamped_free

from flexapod.mechanics.shapes import lateral_basis

pytestmark = pytest.mark.contract

BASES = [
    ("clamped-free", 0.0, 0.0),
    ("tip-load", 0.0, 0.0),
    ("tip-mass", 1.0, 0.0),
    ("tip-mass", 1.0, 10.0),
]
NAMES = ["clamped-free", "tip-load", "tip-mass", "tip-body"]
COUNTS = range(1, 13)
#: Largest n-th derivative of twelve shapes, order of magnitude: rounding is relative to this.
STEEP = 38.0 ** np.arange(4)

LOADED = [("tip-load", 0.0, 1.0), ("tip-load", 1.0, 0.0, 50.0, 5.0)]  # a moment at the tip, a turning beam
PIECEWISE = [("segments", 0.0, 0.0), ("hermite", 0.0, 0.0)]
ALL_BASES = BASES + LOADED + PIECEWISE
ALL_NAMES = [*NAMES, "tip-moment", "turning", "segments", "hermite"]
ALL = [(which, count) for which in ALL_BASES for count in COUNTS if which[0] != "hermite" or count % 2 == 0]
every_count = pytest.mark.parametrize(
    ("which", "count"), ALL, ids=[f"{ALL_NAMES[ALL_BASES.index(which)]}-{count}" for which, count in ALL]
)
every_basis = pytest.mark.parametrize("which", BASES, ids=NAMES)


def fine_rule(panels=40, points=12):
    """A composite rule unlike the one in the package: 40 panels of 12 Gauss points on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(points)
    left = np.arange(panels) / panels
    return (left[:, None] + (x + 1) / (2 * panels)).ravel(), np.tile(w / (2 * panels), panels)


def rule_for(which, count):
    """The fine rule, with panels inside which the shapes are smooth."""
    return fine_rule(4 * count) if which in PIECEWISE else fine_rule()


def close(ours, reference, digits=1e-12):
    np.testing.assert_allclose(ours, reference, rtol=0, atol=digits * max(1.0, np.abs(reference).max()))


@every_count
def test_closed_integrals(which, count):
    b = lateral_basis(which[0], count, *which[1:])
    z, w = rule_for(which, count)
    phi, slope, curvature = (b.values(z, order) for order in range(3))
    sliding = (1 - z) * slope
    both = np.concatenate([phi, sliding])
    assert b.count == count
    close(b.mass, (both * w) @ both.T)
    close(b.first, both @ w)
    close(b.moment, both @ (w * z))
    close(b.powers, np.array([both @ (w * (1 - z) ** j) for j in range(len(b.powers))]))
    close(b.stiffness, (curvature * w) @ curvature.T)
    close(b.slope_tip, (slope * w) @ slope.T)
    close(b.slope_first, (slope * w * (1 - z)) @ slope.T)
    close(b.slope_moment, (slope * w * (1 - z**2) / 2) @ slope.T)
    close(b.turn, (slope * w) @ curvature.T - (curvature * w) @ slope.T)


@every_count
def test_ends(which, count):
    b, mu, inertia = lateral_basis(which[0], count, *which[1:]), *which[1:3]
    clamp, tip = ([b.values(np.array([x]), n)[:, 0] / STEEP[n] for n in range(4)] for x in (0.0, 1.0))
    np.testing.assert_allclose([clamp[0], clamp[1]] / np.abs(b.tip).max(initial=1.0), 0, atol=1e-13)
    np.testing.assert_allclose([tip[0], tip[1] * STEEP[1]], [b.tip, b.tip_slope], rtol=1e-13, atol=1e-13)
    if which in LOADED:
        return
    if which[0] == "tip-load":  # a held tip carries a force, no moment
        np.testing.assert_allclose(tip[2], 0, atol=1e-12)
        np.testing.assert_allclose(b.tip, np.eye(count)[0], atol=1e-12)
    elif which not in PIECEWISE:
        eps = np.array([phi.eps for phi in b.shapes])
        np.testing.assert_allclose(tip[2] * STEEP[2] / eps**2, inertia * eps**2 * b.tip_slope, atol=1e-11)
        np.testing.assert_allclose(tip[3] * STEEP[3] / eps**3, -mu * eps * b.tip, atol=1e-11)


@pytest.mark.parametrize("which", LOADED, ids=["tip-moment", "turning"])
@pytest.mark.parametrize("count", [2, 3, 6, 12])
def test_load_shapes_contain_the_static_ones(which, count):
    """(T1.16): the static shape under a tip force, with a moment also that one, lies in what the shapes span."""
    b = lateral_basis(which[0], count, *which[1:])
    np.testing.assert_allclose(b.mass[:count, :count], np.eye(count), atol=1e-9)
    _, _, inertia, speed, hub = (*which, 0.0, 0.0)[:5]
    tension = speed**2 * (hub * b.slope_first + b.slope_moment + which[1] * (1 + hub) * b.slope_tip)
    stiffness = b.stiffness + tension
    np.testing.assert_allclose(stiffness / np.sqrt(np.outer(*2 * [np.diag(stiffness)])), np.eye(count), atol=1e-9)
    if inertia:
        z = np.linspace(0, 1, 21)
        for load, shape in ((b.tip, z**2 / 2 - z**3 / 6), (b.tip_slope, z**2 / 2)):
            np.testing.assert_allclose(np.linalg.solve(b.stiffness, load) @ b.values(z), shape, atol=1e-9)


@pytest.mark.parametrize("count", [2, 3, 6, 12])
def test_shapes_for_a_tip_moment_span_every_clamped_polynomial(count):
    """(T1.18): both static shapes are among them, and so is zeta^(k + 1); only the first moves the tip."""
    b = lateral_basis("tip-load", count, moment=True)
    z, w = fine_rule()
    close(b.tip, np.eye(count)[0])
    close(b.stiffness / np.sqrt(np.outer(*2 * [np.diag(b.stiffness)])), np.eye(count), 1e-9)
    for shape in (3 * z**2 - z**3, z**2, z ** (count + 1)):
        left = shape - np.linalg.lstsq(b.values(z).T, shape)[0] @ b.values(z)
        assert left @ (w * left) < 1e-20
    free = lateral_basis("tip-load", count)
    assert np.linalg.cond(b.mass[:count, :count]) < 2 * np.linalg.cond(free.mass[:count, :count])


@every_basis
def test_derivatives_belong_together(which):
    b = lateral_basis(which[0], 12, *which[1:])
    z, w = fine_rule()
    for order in range(3):  # from the clamp to three stations, by integration: differences would lose digits
        for station in (0.2, 0.55, 1.0):
            start, end = b.values(np.array([0.0, station]), order).T
            rise = station * b.values(station * z, order + 1) @ w
            np.testing.assert_allclose(end - start, rise, atol=1e-11 * STEEP[order])


@pytest.mark.parametrize("name", ["segments", "hermite"])
def test_derivatives_of_pieces_belong_together(name):
    # As above. The spread turn of a hinge makes up its jump of slope at the ends of its segment, where stations lie.
    b = lateral_basis(name, 12)
    z, w = fine_rule(48)
    for order in range(2):
        for station in (0.25, 0.5, 1.0):
            start, end = b.values(np.array([0.0, station]), order).T
            rise = station * b.values(station * z, order + 1) @ w
            np.testing.assert_allclose(end - start, rise, atol=1e-11 * STEEP[order])


@pytest.mark.parametrize("elements", [1, 2, 3, 6])
def test_hermite_shapes_are_nodal_and_hold_every_clamped_cubic(elements):
    b, nodes = lateral_basis("hermite", 2 * elements), np.arange(1, elements + 1) / elements
    np.testing.assert_allclose(b.values(nodes)[0::2], np.eye(elements), atol=1e-14)
    np.testing.assert_allclose(b.values(nodes, 1)[1::2], elements * np.eye(elements), atol=1e-12)
    z = np.linspace(0, 1, 61)
    for power in (2, 3):
        part = np.ravel([nodes**power, power * nodes ** (power - 1) / elements], order="F")
        np.testing.assert_allclose(part @ b.values(z), z**power, atol=1e-14)
        # inside the elements: third derivatives jump at nodes
        np.testing.assert_allclose(part @ b.values(z + 1e-3 * (z < 1), 3), 6 * (power == 3), atol=1e-9)
    static = np.linalg.solve(b.stiffness, b.tip)  # exact under a tip force
    np.testing.assert_allclose([b.tip @ static, b.tip_slope @ static], [1 / 3, 1 / 2], rtol=1e-11)


@pytest.mark.parametrize("count", COUNTS)
def test_segments_are_rigid_between_hinges(count):
    b, hinges = lateral_basis("segments", count), (np.arange(count) + 0.5) / count
    np.testing.assert_allclose(b.values(np.append(hinges[1:], 1.0)), np.eye(count), atol=1e-14)
    ends = np.concatenate([[0.0], hinges, [1.0]])
    inside = ends[:-1] + np.array([[0.1], [0.5], [0.9]]) * np.diff(ends)
    slopes = b.values(inside, 1)
    np.testing.assert_allclose(slopes, slopes[:, :1, :] + np.zeros((3, 1)), atol=1e-12)
    turns = np.diff(slopes[:, 0], axis=1)  # (T1.14): springs EI n / s on them
    np.testing.assert_allclose(b.stiffness, count * turns @ turns.T, rtol=1e-12, atol=1e-9)
    # A tip force turns hinge j by (1 - zeta_j) / n: the midpoint rule of int (1 - zeta)^2, low by 1 / (4 n^2).
    static = np.linalg.solve(b.stiffness, b.tip)
    np.testing.assert_allclose(b.tip @ static, (1 - 0.25 / count**2) / 3, rtol=1e-11)
    np.testing.assert_allclose(static @ b.values(hinges, 2), 1 - hinges, atol=1e-10)  # the moment of the springs


@every_basis
def test_a_count_is_a_prefix_of_orthogonal_shapes(which):
    # Shapes are unit vectors in the mass they belong to; the first twelve curvatures are orthogonal.
    b, mu, inertia = lateral_basis(which[0], 12, *which[1:]), *which[1:]
    bend = np.diag(b.stiffness)
    np.testing.assert_allclose(b.stiffness / np.sqrt(np.outer(bend, bend)), np.eye(12), atol=1e-11)
    mass = b.mass[:12, :12] + mu * np.outer(b.tip, b.tip) + inertia * np.outer(b.tip_slope, b.tip_slope)
    rows = slice(1, None) if which[0] == "tip-load" else slice(None)  # its static shape has another scale
    size = np.sqrt(np.diag(mass))
    np.testing.assert_allclose((mass / np.outer(size, size))[rows, rows], np.eye(12)[rows, rows], atol=1e-11)
    assert (b.values(np.array([1e-3]))[:, 0] > 0).all()  # all start out to the same side


@pytest.mark.parametrize(("which", "roots"), [
    (BASES[0], beams.beam_roots("clamped", "free", 12)),
    (BASES[2], beams.tip_body_roots(1.0, 12)),
    (BASES[3], beams.tip_body_roots(1.0, 12, 10.0)),
], ids=["clamped-free", "tip-mass", "tip-body"])  # fmt: skip
def test_eigenfunctions_keep_their_digits(which, roots):
    b, mu, inertia = lateral_basis(which[0], 12, *which[1:]), *which[1:]
    np.testing.assert_allclose([phi.eps for phi in b.shapes], roots, rtol=1e-13)
    mass = np.diag(b.mass)[:12] + mu * b.tip**2 + inertia * b.tip_slope**2
    np.testing.assert_allclose(np.diag(b.stiffness) / mass, roots**4, rtol=1e-12)  # Rayleigh quotient
    z = np.linspace(0, 1, 41)
    quartic = np.array([phi(z, 4) / phi.eps**4 for phi in b.shapes])
    np.testing.assert_allclose(quartic, b.values(z), atol=1e-13)


def test_clamped_free_equals_the_other_formulation():
    b, z = lateral_basis("clamped-free", 12), np.linspace(0, 1, 101)
    for i in range(12):
        for order in range(4):
            reference = clamped_free(i + 1)(z, order)
            np.testing.assert_allclose(b.values(z, order)[i], reference, atol=1e-12 * np.abs(reference).max())
    np.testing.assert_allclose(b.tip, 2 * (-1.0) ** np.arange(12), rtol=1e-12)


@pytest.mark.parametrize("count", COUNTS)
def test_tip_load_spans_all_polynomials_that_fit(count):
    # Clamped and free of moment at the tip: phi'' = (1 - z) times any polynomial of degree count - 1.
    b, z = lateral_basis("tip-load", count), np.linspace(0, 1, 101)
    shapes = b.values(z, 2)
    for degree in range(count):
        target = (1 - z) * np.polynomial.Legendre.basis(degree, domain=[0, 1])(z)
        part = np.linalg.lstsq(shapes.T, target, rcond=None)[0]
        np.testing.assert_allclose(part @ shapes, target, atol=1e-10)
    np.testing.assert_allclose(b.values(z)[0], (3 * z**2 - z**3) / 2, atol=1e-15)


@pytest.mark.parametrize("which", ALL_BASES, ids=ALL_NAMES)
def test_damping_is_the_same_ratio_for_every_mode(which):
    b = lateral_basis(which[0], 12, *which[1:])
    mass = b.mass[:12, :12]
    product = b.damping @ np.linalg.solve(mass, b.damping)  # D M^-1 D = K
    scale = np.sqrt(np.outer(np.diag(b.stiffness), np.diag(b.stiffness)))
    np.testing.assert_allclose(product / scale, b.stiffness / scale, atol=1e-10)


@pytest.mark.parametrize("name", ["clamped-free", "tip-load", "tip-mass", "segments", "hermite"])
def test_no_shapes(name):
    b = lateral_basis(name, 0)
    assert (b.count, b.mass.shape, b.powers.shape[1]) == (0, (0, 0), 0)


def test_unknown_name():
    with pytest.raises(ValueError, match="clamped-free, tip-load, tip-mass, segments or hermite"):
        lateral_basis("hinged", 3)
    with pytest.raises(ValueError, match="two"):
        lateral_basis("hermite", 3)
