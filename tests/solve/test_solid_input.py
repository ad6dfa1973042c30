"""Meshes and studies of solid elements: what is refused, the order of nodes, sections by symmetry."""

import numpy as np
import pytest

import flexapod as fx
from flexapod.analysis.results.mode_shapes import local_vibration
from flexapod.analysis.results.time_history import Interrupted
from flexapod.analysis.solid import simulate_solid
from flexapod.common.errors import ComputationError, InputError
from flexapod.model import Rectangle, Tube
from flexapod.output.figures.elements import solid_comparison, solid_meshes
from flexapod.solve.fem.frequencies import banded_solver, frequencies
from flexapod.solve.fem.hexahedra import SolidMesh, beam_mesh, integrals, mass, stiffness
from flexapod.solve.fem.reduction import reduced_beam
from flexapod.solve.fem.section_mesh import section_averages, section_mesh
from flexapod.solve.fem.sliding import HubMotion, SlidingBeam, march_solid_beam

pytestmark = pytest.mark.unit

FLAT = Rectangle(width=0.1524, height=0.0095)
SECTIONS = [FLAT, Tube(diameter=0.027), Tube(diameter=0.03, inner_diameter=0.02)]
STUDY = fx.preset("paper-actuator")


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"size": 0.0}, "size"),
        ({"size": -0.01}, "size"),
        ({"size": np.nan}, "size"),
        ({"size": 2.0}, "size"),
        ({"length": 0.0}, "length"),
        ({"length": np.inf}, "length"),
        ({"kind": "hex27"}, "kind"),
    ],
)
def test_degenerate_meshes_are_refused(changes, key):
    with pytest.raises(InputError) as caught:
        beam_mesh(**({"section": FLAT, "length": 1.0, "size": 0.05} | changes))
    assert caught.value.key == key
    assert caught.value.allowed


def test_elements_turned_inside_out_are_refused():
    good = beam_mesh(FLAT, 0.2, 0.05)
    nodes = good.nodes.copy()
    nodes[good.elements[2, 6], 0] -= 0.06
    bad = SolidMesh(nodes=nodes, elements=good.elements, section=good.section, length=good.length)
    with pytest.raises(InputError, match="inside out") as caught:
        integrals(bad)
    assert "element 3 of" in str(caught.value)


@pytest.mark.parametrize(
    "changes", [{"E": 0.0}, {"density": -1.0}, {"poisson": 0.5}, {"poisson": -1.0}, {"count": 0}, {"E": np.nan}]
)
def test_materials_that_are_not_physical_are_refused(changes):
    with pytest.raises(InputError):
        frequencies(beam_mesh(FLAT, 0.2, 0.05, kind="hex8"), **({"E": 1.0, "density": 1.0} | changes))


@pytest.mark.parametrize("changes", [{"size": 0.0}, {"size": 0.3, "spacing": 0.1}, {"spacing": 2.0}, {"poisson": 0.6}])
def test_reductions_that_do_not_fit_are_refused(changes):
    with pytest.raises(InputError):
        reduced_beam(**({"section": FLAT, "length": 3.66, "size": 0.05, "E": 1.0, "density": 1.0} | changes))


def test_free_bodies_have_no_static_solution():
    K = stiffness(integrals(beam_mesh(FLAT, 0.2, 0.05, kind="hex8")), 1.0, 0.0)
    with pytest.raises(ComputationError, match="singular"):
        banded_solver(K)(np.zeros(K.shape[0]))


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"actuator": STUDY.actuator.replace(damping=0.01)}, "actuator.damping"),
        ({"motion": {"rotation": None}, "load": {"torque": {"law": "constant", "value": 1.0}}}, "motion"),
        ({"motion": {"extension": {"law": "rate", "rate": 0.175}}}, "motion.extension"),
        ({"motion": {"extension": {"law": "rate", "rate": -0.175}}}, "motion.extension"),
        ({"motion": {"rotation": {"law": "linear", "amplitude": 1.0, "duration": 2.0}}}, "motion"),
    ],
)
def test_studies_that_the_solid_does_not_take(change, key):
    study = STUDY.replace(**change)
    with pytest.raises(InputError) as caught:
        simulate_solid(study, size=0.05)
    assert caught.value.key == key


@pytest.mark.parametrize("settings", [{"step": 0.0}, {"size": -1.0}, {"size": 1.5}, {"kind": "tet"}, {"spacing": 0.0}])
def test_settings_that_do_not_fit(settings):
    with pytest.raises(InputError):
        simulate_solid(STUDY, **({"size": 0.05} | settings))


def test_a_robot_is_no_actuator():
    with pytest.raises(InputError, match="single actuator"):
        simulate_solid(fx.preset("paper-robot"))


def test_a_beam_that_leaves_the_hub_on_the_way():
    beam = SlidingBeam(model=reduced_beam(FLAT, 3.66, 0.05, E=7e10, density=2700.0))

    def inwards(t):
        return HubMotion(
            length=0.5 - t, length_rate=-1.0, length_acceleration=0.0, angle=0.0, angle_rate=0.0, angle_acceleration=0.0
        )

    with pytest.raises(ComputationError, match="wholly into the hub"):
        march_solid_beam(beam, inwards, 1e-3, np.linspace(0, 0.5, 6), 0.01)


@pytest.mark.parametrize("section", SECTIONS)
@pytest.mark.parametrize("kind", ["hex8", "hex20"])
def test_symmetric_parts_are_the_whole(section, kind):
    whole, part = (section_averages(section_mesh(section, 0.005, kind, whole=w)) for w in (True, False))
    assert part.area == pytest.approx(whole.area, rel=1e-12)
    assert part.second_moment == pytest.approx(whole.second_moment, rel=1e-12)
    assert whole.deflection.sum() == pytest.approx(1.0, rel=1e-12)
    # Chords for arcs: 4 (pi / 2n)^2 / 6 at most with n to a quarter; parabolas: to the fourth power.
    assert whole.area == pytest.approx(section.area, rel=0.12 if kind == "hex8" else 1e-3)


@pytest.mark.parametrize("kind", ["hex8", "hex20"])
def test_nodes_stand_in_the_order_of_abaqus(kind):
    mesh = beam_mesh(FLAT, 0.4, 0.05, kind=kind)
    x = mesh.nodes[mesh.elements]
    assert (np.ptp(x[:, :4, 0], axis=1) == 0).all()
    assert (np.ptp(x[:, 4:8, 0], axis=1) == 0).all()
    assert (x[:, 4, 0] > x[:, 0, 0]).all()
    around = np.cross(x[:, 1] - x[:, 0], x[:, 3] - x[:, 0])
    assert (around[:, 0] > 0).all()  # seen from the other end, 1 2 3 4 run counter-clockwise
    if kind == "hex20":
        ends = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
        for middle, (i, j) in enumerate(ends, start=8):
            np.testing.assert_allclose(x[:, middle], (x[:, i] + x[:, j]) / 2, atol=1e-14)
    assert set(mesh.elements.ravel()) == set(range(len(mesh.nodes)))
    np.testing.assert_allclose(mesh.nodes[mesh.plane(0), 0], 0.0)
    np.testing.assert_allclose(mesh.nodes[mesh.plane(1), 0], 0.4)


@pytest.mark.parametrize("section", SECTIONS)
def test_matrices_of_a_rigid_body(section):
    mesh = beam_mesh(section, 0.1, 0.01)
    parts, x = integrals(mesh), mesh.nodes
    turn = np.stack([-x[:, 1], x[:, 0], np.zeros(len(x))], axis=1).ravel()
    K, M = stiffness(parts, 2e11, 0.3), mass(parts, 7800.0)
    np.testing.assert_allclose(K @ turn, 0, atol=1e-12 * np.abs(K.data).max())
    averages = section_averages(mesh.section)
    inertia = 7800 * (averages.area * 0.1**3 / 3 + averages.second_moment * 0.1)
    assert turn @ (M @ turn) == pytest.approx(inertia, rel=1e-10)


def test_fit_of_a_drifting_vibration():
    t = np.linspace(0, 10, 2001)
    phase = 2 * np.pi * (2.2 * t - 0.05 * t**2)
    signal = (6 + 0.1 * t) * np.cos(phase) - 1.2 - 0.1 * t + 0.05 * np.cos(55 * t)
    fit = local_vibration(t, signal, 2.0 - 0.09 * t, count=5)
    np.testing.assert_allclose(fit.frequency, 2.2 - 0.1 * fit.time, rtol=2e-3)
    np.testing.assert_allclose(fit.envelope, 6 + 0.1 * fit.time, rtol=5e-3)
    np.testing.assert_allclose(fit.sag, -1.2 - 0.1 * fit.time, atol=0.03)
    with pytest.raises(InputError, match="too short"):
        local_vibration(t[:100], signal[:100], 2.0 - 0.09 * t[:100])


def test_figures():
    coarse = simulate_solid(STUDY, size=0.05, kind="hex8", duration=0.2)
    fine = simulate_solid(STUDY, size=0.05, duration=0.2)
    reference = fx.simulate_actuator(STUDY, duration=0.2, output_step=1e-3)
    three = solid_meshes({"A, linear": coarse, "B, quadratic": fine, "again": fine}, reference).axes
    assert three[0].get_title(loc="left") == "A, linear\n50 mm, 1,314 unknowns\n8.97 Hz at the start"
    assert three[1].get_title(loc="left").startswith("B, quadratic") and not three[3].get_visible()
    np.testing.assert_allclose(three[0].lines[1].get_ydata(), 1e3 * coarse.tip_deflection.values)
    four = solid_comparison({"solid elements": fine}, reference).axes
    gap = 1e6 * (fine.tip_deflection.values - reference.tip_deflection.values)
    np.testing.assert_allclose(four[1].lines[0].get_ydata(), gap)
    with pytest.raises(InputError, match="tip_deflection"):
        solid_comparison({"solid elements": fine.drop_vars("tip_deflection")}, reference)


def test_meshes_that_no_machine_holds_are_refused_before_they_are_made():
    flat = Rectangle(width=0.1524, height=0.0095)
    with pytest.raises(InputError, match=r"2\.6e\+06 elements") as error:
        beam_mesh(flat, 3.66, 0.00127)
    assert error.value.key == "size"
    with pytest.raises(InputError, match="elements of"):
        reduced_beam(flat, 3.66, 0.001, E=1.0, density=1.0)


def test_a_stopped_run_keeps_what_was_computed():
    def stop(time, end):
        if time > 0.02:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted) as stopped:
        simulate_solid(fx.preset("paper-actuator"), size=0.05, duration=0.1, output_step=0.01, progress=stop)
    data = stopped.value.dataset
    assert data.attrs["partial"] == 1
    np.testing.assert_allclose(data.time, [0.0, 0.01, 0.02, 0.03])


@pytest.mark.parametrize(("name", "value"), [("size", "5 s"), ("poisson", None), ("step", "1 mm"), ("section", "flat")])
def test_what_is_no_number_or_section_is_refused_in_words(name, value):
    with pytest.raises(InputError) as error:
        simulate_solid(fx.preset("paper-actuator"), **{name: value})
    assert error.value.key == name
