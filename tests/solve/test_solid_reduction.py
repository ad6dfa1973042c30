"""The reduced solid against the unreduced one, held by the same guide, at rest and turning."""

import numpy as np
import pytest
from scipy.linalg import null_space
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import eigsh

from flexapod.model import Rectangle
from flexapod.solve.fem.hexahedra import extrude_section, integrals, mass, slope_stiffness, stiffness
from flexapod.solve.fem.reduction import reduced_beam
from flexapod.solve.fem.section_mesh import free_unknowns, section_averages, section_mesh
from flexapod.solve.fem.sliding import HubMotion, SlidingBeam, mouth_of

pytestmark = pytest.mark.consistency

FLAT, LENGTH = Rectangle(width=0.1524, height=0.0095), 3.66
EI, RHOA = 756.65, 4.02
MATERIAL = {"E": EI / FLAT.second_moment, "density": RHOA / FLAT.area}


def at(length, spin=0.0):
    return HubMotion(
        length=length, length_rate=0.0, length_acceleration=0.0, angle=0.0, angle_rate=spin, angle_acceleration=0.0
    )


def unreduced(kind, size, poisson, intervals, held_from, spin):
    """Frequencies of the whole solid, every unknown kept, its averages held at the stations from `held_from` on."""
    section, H = section_mesh(FLAT, size, kind, whole=False), LENGTH / intervals
    mesh = extrude_section(section, LENGTH, intervals * max(1, round(H / size)))
    parts, averages = integrals(mesh), section_averages(section)
    density, length = MATERIAL["density"], held_from * H

    def stress(x):
        return density * spin**2 * (length * (LENGTH - x) - (LENGTH - x) ** 2 / 2)

    M = mass(parts, density)
    K = stiffness(parts, MATERIAL["E"], poisson) + slope_stiffness(parts, stress) - spin**2 * M
    C = np.zeros((3, 3 * len(section.points)))
    C[0, 1::3], C[1, 0::3], C[2, 0::3] = averages.deflection, averages.rotation, averages.stretch
    movable = null_space(C[:, free_unknowns(section.points, section)])  # motions of a plane that the guide lets pass
    free = np.flatnonzero(free_unknowns(mesh.nodes[:, 1:], section))
    number = np.full(mesh.unknowns, -1)
    number[free] = np.arange(len(free))
    held = []
    for station in range(held_from, intervals + 1):
        nodes = np.flatnonzero(np.abs(mesh.nodes[:, 0] - LENGTH + station * H) < 1e-9)
        unknowns = number[(3 * nodes[:, None] + np.arange(3)).ravel()]
        held.append(unknowns[unknowns >= 0])
    rest = np.setdiff1d(np.arange(len(free)), np.concatenate(held))
    rows, columns, values, count = [rest], [np.arange(len(rest))], [np.ones(len(rest))], len(rest)
    for plane in held:
        i, j = np.indices(movable.shape)
        rows.append(plane[i.ravel()])
        columns.append(count + j.ravel())
        values.append(movable.ravel())
        count += movable.shape[1]
    shape = (len(free), count)
    Z = csr_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=shape)
    K, M = (csc_array(Z.T @ matrix[free][:, free] @ Z) for matrix in (K, M))
    start = np.ones(count)
    return np.sqrt(np.sort(eigsh(K, 3, M, sigma=0.0, v0=start, return_eigenvectors=False))) / (2 * np.pi)


@pytest.mark.parametrize(
    ("kind", "poisson", "spin"), [("hex20", 0.0, 0.0), ("hex20", 0.3, 0.785), ("hex8", 0.3, 0.0), ("hex8", 0.0, 2.0)]
)
def test_frequencies_of_the_unreduced_solid(kind, poisson, spin):
    # Statics are kept, inertia between the stations follows them: (lam H / L)^4 / 720 = 2e-8, 9e-7, 7e-6 with 18
    # intervals outside; on top of it the rounding of the unreduced one, 1e-7 of the first.
    model = reduced_beam(FLAT, LENGTH, 0.05, **MATERIAL, poisson=poisson, kind=kind, spacing=LENGTH / 36)
    ours = SlidingBeam(model=model).frequencies(at(LENGTH / 2, spin))
    whole = unreduced(kind, 0.05, poisson, 36, 18, spin)
    assert (np.abs(ours / whole - 1) < [5e-7, 4e-6, 3e-5]).all()
    assert (ours > whole * (1 - 5e-7)).all()  # a reduction only stiffens


@pytest.mark.parametrize(("poisson", "statics"), [(0.0, 1e-8), (0.3, 2e-4)])
def test_mouth_between_stations_is_the_mouth_at_a_finer_station(poisson, statics):
    # The same elements, stations a quarter as far apart: the mouth that cuts an interval of one is a station of the
    # other. Static compliance is that of the solid; at nu = 0.3 the finer one is held at more places inside the hub, a
    # share of the 0.5 % by which the mouth stiffens. Inertia of the cut interval is not adapted: the error of the
    # order 4 reaches 1.5 intervals.
    coarse, fine = (
        SlidingBeam(model=reduced_beam(FLAT, LENGTH, LENGTH / 144, **MATERIAL, poisson=poisson, spacing=LENGTH / n))
        for n in (36, 144)
    )
    for quarter in range(70, 75):
        length = quarter * LENGTH / 144
        tips = [1 / np.linalg.inv(b.mouth.stiffness(length, b.mouth.last(length)))[0, 0] for b in (coarse, fine)]
        assert tips[0] == pytest.approx(tips[1], rel=statics)
        gap = coarse.frequencies(at(length)) / fine.frequencies(at(length)) - 1
        assert (np.abs(gap) < np.array([2e-6, 3e-5, 3e-4]) + statics / 2).all()


@pytest.mark.parametrize("poisson", [0.0, 0.3])
def test_stiffness_does_not_jump_when_a_station_comes_out(poisson):
    beam = SlidingBeam(model=reduced_beam(FLAT, LENGTH, 0.05, **MATERIAL, poisson=poisson))
    for last in (12, 20):
        length = (last + 0.5) * beam.model.spacing
        before, after = (np.linalg.inv(beam.mouth.stiffness(length, k))[:8, :8] for k in (last - 1, last))
        np.testing.assert_allclose(before, after, rtol=5e-7)


@pytest.mark.parametrize("size", [0.02, 0.04])
def test_a_mouth_between_stations_meets_the_solid_at_the_next(size):
    """An interval farther out the station between is free and carries nothing: the solid's own stiffness without it."""
    section, beam, intervals, last = Rectangle(width=size, height=size), 1.0, 20, 7
    material = {"E": 2e11, "density": 7800.0}
    model = reduced_beam(section, beam, beam / 40, **material, kind="hex20", spacing=beam / intervals)
    mouth, n = mouth_of(model), 2 * (last + 1)
    assert mouth.bending == pytest.approx(1 / (material["E"] * section.second_moment), rel=1e-9)
    K = model.stiffness[: n + 2, : n + 2]
    exact = K[:n, :n] - K[:n, n:] @ np.linalg.solve(K[n:, n:], K[n:, :n])
    found = mouth.stiffness((last + 2) * model.spacing, last)
    # What the section's own shapes carry from one station to the next falls with the distance over the depth, as in
    # Saint-Venant: e^(-5.5 H / depth) for a square, 1e-6 and 1e-3; stiffnesses of neighbours differ by a part of that.
    np.testing.assert_allclose(found, exact, atol={0.02: 1e-6, 0.04: 1e-3}[size] * np.abs(exact).max())
