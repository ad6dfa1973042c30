"""A mesh fixed to the sliding beam converges with order one, whatever its guide; the mesh of the free length with four.

The mouth of the guide is inside an element, where the curvature jumps: every guide puts the clamp off by a share of the
element (T11.8), and the frequency is off by twice that over the free length (T11.7).
"""

from functools import cache

import numpy as np
import pytest
from tests.oracles import beams, sliding

import flexapod as fx
from flexapod.analysis.sliding_mesh import sliding_mesh
from flexapod.common.errors import InputError
from flexapod.model import ActuatorLoad, ActuatorMotion, preset
from flexapod.output.figures.elements import sliding_mesh as plot_sliding_mesh
from flexapod.solve.fem.beam_contact import frozen_frequencies, static_shape
from flexapod.solve.fem.beam_guide import ElementContact, InterpolatedClamp, NodeContact, Rollers
from flexapod.solve.fem.beam_march import march_sliding_beam
from flexapod.solve.fem.beam_mesh import band_product, beam_mesh

pytestmark = pytest.mark.convergence

STUDY = preset("paper-actuator")
BEAM = STUDY.actuator
LENGTH, FEED, TURN = 1.83, 0.1, 0.785
LOAD = ActuatorLoad(torque={"law": "constant", "value": 1.0})
#: A whole number of elements (5, 10, 20 of 100, 200, 400 on the beam) passes the mouth, from node to node.
DURATION, OUTPUT = 1.83, 5e-3
RIGID = {"elements": ElementContact(stiffness=1e24), "nodes": NodeContact(), "clamp": InterpolatedClamp()}
MEAN = {"elements": 0.5, "nodes": -0.5 - 1 / 12**0.5, "clamp": 0.0824}  # of the shifts (T11.8), by the element length


@cache
def reference():
    """Tip by the closed equation of the sliding beam, from the static shape at rest in x / L."""
    z = sliding.constants(6)
    shape = z.b / np.diag(z.E4)
    q0 = 5e-3 * shape / (z.b @ shape) * np.sqrt(BEAM.rhoA * LENGTH)
    motion = sliding.uniform_motion(LENGTH, FEED, TURN)
    t = np.arange(0, DURATION + 1e-9, OUTPUT)
    q = sliding.march(
        lambda time: sliding.q_equation(*motion(time), g=0.0, m_e=0.0, rho=BEAM.rhoA, EI=BEAM.EI, k=6),
        q0, FEED / (2 * LENGTH) * q0, t, step=OUTPUT,
    )  # fmt: skip
    return q @ z.b / np.sqrt(BEAM.rhoA * (LENGTH + FEED * t))


def error(guide, elements, step=1e-3):
    """Root mean square error of the tip by that of the motion."""
    run = march_sliding_beam(STUDY, elements, guide, step=step, duration=DURATION, output_step=OUTPUT)
    return np.sqrt(((run.tip - reference()) ** 2).mean() / (reference() ** 2).mean())


@pytest.mark.parametrize("name", RIGID)
def test_first_order(name):
    errors = np.array([error(RIGID[name], n) for n in (100, 200, 400)])
    # Size: the phase lags by the integral of 2 omega shift / L, omega = c / L^2, so c shift (L0^-2 - L1^-2) / L'; of
    # the root mean square of a lag that grows like t the motion sees 1 / sqrt(3). In contact the free length grows by
    # jumps of an element h: each changes the amplitude by 3/2 h / L at whatever phase, a tenth of the lag of 14 h / L
    # that every mesh has anew; a twentieth for the sag, which does not lag, and one for the last of five elements.
    c = beams.beam_roots("clamped", "free", 1)[0] ** 2 * np.sqrt(BEAM.EI / BEAM.rhoA)
    h = BEAM.length / np.array([100, 200, 400])
    lag = c * abs(MEAN[name]) * h * (LENGTH**-2 - (LENGTH + FEED * DURATION) ** -2) / FEED
    np.testing.assert_allclose(errors, lag / 3**0.5, rtol=0.2)
    assert np.log2(errors[0] / errors[-1]) / 2 == pytest.approx(1.0, abs=0.15)  # log2(1.1 / 0.9) / 2, as above


def test_rollers_converge_to_a_longer_beam():
    # No jump of curvature, only a kink: error of order three in the elements; what stays is the rollers' own shift.
    guide = Rollers(spacing=0.05)
    errors = np.array([error(guide, n) for n in (100, 200)])
    assert abs(errors[1] / errors[0] - 1) < 0.03
    longer = BEAM.replace(free_length=LENGTH + 0.05 / 12**0.5)
    run = fx.simulate_actuator(
        STUDY.replace(actuator=longer), basis="clamped-free", modes=4, step=5e-4, duration=DURATION, output_step=OUTPUT
    )
    gap = (
        march_sliding_beam(STUDY, 200, guide, step=1e-3, duration=DURATION, output_step=OUTPUT).tip - run.tip_deflection
    )
    assert np.sqrt((gap**2).mean() / (reference() ** 2).mean()) < errors[1] / 5


@pytest.mark.parametrize("part", [0.1, 0.3, 0.5, 0.7, 0.9])
@pytest.mark.parametrize("name", RIGID)
def test_where_the_clamp_seems_to_be(name, part):
    mesh = beam_mesh(BEAM, 200)
    length = mesh.size * (100 + part)
    exact = beams.beam_roots("clamped", "free", 1)[0] ** 2 * np.sqrt(BEAM.EI / BEAM.rhoA) / (2 * np.pi * length**2)
    shift = (frozen_frequencies(mesh, RIGID[name], length, 1)[0] / exact - 1) * length / 2
    # Terms of second order: the shift over the length, 1.3 / 100 at most, with factors up to three halves.
    assert shift == pytest.approx(RIGID[name].clamp_shift(mesh, part), rel=0.03, abs=2e-3 * mesh.size)


def test_mean_shift_of_the_interpolated_clamp():
    mesh = beam_mesh(BEAM, 100)
    parts = (np.arange(400) + 0.5) / 400
    assert RIGID["clamp"].clamp_shift(mesh, parts).mean() / mesh.size == pytest.approx(MEAN["clamp"], abs=1e-4)


@pytest.mark.parametrize("stiffness", [1e8, 1e9])
def test_a_soft_guide_is_a_longer_beam(stiffness):
    # Fine mesh: the springs' own length 1 / b = (4 EI / k)^(1/4) is 7 and 12 elements; the mouth is amid an element.
    mesh, guide = beam_mesh(BEAM, 611), ElementContact(stiffness=stiffness)
    shape = static_shape(mesh, guide, LENGTH, 5e-3)
    force = band_product(mesh.bending, shape)[-2]
    give = guide.give(mesh)
    # tip force on a clamped beam with a half-infinite beam on springs behind: (T11.9) with its two further terms
    exact = 5e-3 * BEAM.EI / (LENGTH**3 / 3 + give * LENGTH**2 + give**2 * LENGTH + give**3 / 2)
    assert force == pytest.approx(exact, rel=1e-4)


@pytest.mark.parametrize("gap", [1e-6, 1e-5, 1e-4])
def test_a_gap_lets_the_beam_tilt(gap):
    mesh = beam_mesh(BEAM, 400)
    shape = static_shape(mesh, ElementContact(stiffness=1e16, gap=gap), LENGTH, 5e-3)
    force = band_product(mesh.bending, shape)[-2]
    inside = np.sqrt(12 * BEAM.EI * gap / (force * LENGTH))  # (T11.10) from the mouth to where the beam lies on again
    # Springs give by 0.7 mm, of which the mouth of a sharp edge a few times that: 1 % of the force at most
    exact = (5e-3 - gap) * BEAM.EI / (LENGTH**3 / 3 + LENGTH**2 * inside / 2)
    assert force == pytest.approx(exact, rel=5e-3)


def test_without_sliding_it_is_the_mesh_of_the_free_length():
    # Mouth at a node, same elements, same integrator: nothing differs but the springs of the clamp, 1e-9 of EI / h^3.
    beam = BEAM.replace(tip_mass=2.0, tip_inertia=0.5, hub_radius=0.3, gravity=2.0, angle=0.5)
    motion = ActuatorMotion(rotation={"law": "smooth", "amplitude": 4.0, "duration": 1.0})
    study = STUDY.replace(actuator=beam, motion=motion)
    settings = {"step": 1e-3, "duration": 1.0, "output_step": OUTPUT}
    ours = march_sliding_beam(study, 16, RIGID["clamp"], **settings).tip
    free = fx.simulate_actuator(study, fidelity="beam-fem", modes=16, rho_inf=0.8, **settings).tip_deflection.values
    assert np.abs(ours - free).max() < 1e-6 * np.abs(free).max()


@pytest.mark.parametrize("name", RIGID)
def test_start_is_at_rest_in_x_over_the_length(name):
    # Material points have the velocity L' (1 - z) phi'(z) d / L, phi = (3 z^2 - z^3) / 2; accelerations of 1 m/s^2 add
    # 1e-6 m/s in the one step, the clamp's shift of 0.8 elements twice 0.8 / 100.
    run = march_sliding_beam(STUDY, 200, RIGID[name], step=1e-6, duration=1e-6, output_step=1e-6)
    z = np.array([0.25, 0.5, 0.75])
    node = 100 + np.round(100 * z).astype(int)
    velocity = (run.unknowns[1] - run.unknowns[0])[2 * node] / 1e-6
    exact = FEED * (1 - z) * (3 * z - 1.5 * z**2) * 5e-3 / LENGTH
    np.testing.assert_allclose(velocity, exact, rtol=0.03)


def test_rotation_gravity_tip_body_and_hub_agree_with_the_free_length():
    # All loads and both parts of the axial force act; the clamp's error at 200 elements is 2 % (test_first_order),
    # with a tip mass and gravity on top; a load or an axial force left out is more than a tenth.
    beam = BEAM.replace(tip_mass=0.4, tip_inertia=0.05, hub_radius=0.3, gravity=2.0, angle=0.5)
    smooth = {"law": "smooth", "duration": 2.0}
    motion = ActuatorMotion(rotation={**smooth, "amplitude": 2.5}, extension={**smooth, "amplitude": 0.3})
    study = STUDY.replace(actuator=beam, motion=motion)
    ours = march_sliding_beam(study, 400, RIGID["clamp"], step=1e-3, duration=1.0, output_step=OUTPUT).tip
    free = fx.simulate_actuator(study, fidelity="beam-fem", modes=8, step=5e-4, duration=1.0, output_step=OUTPUT)
    assert np.abs(ours - free.tip_deflection.values).max() < 0.02 * np.abs(free.tip_deflection.values).max()


def test_dataset_and_figure():
    data = sliding_mesh(STUDY, elements=(20, 40), stiffnesses=(1e10, 1e14), duration=0.2, shown=1)
    assert data.sizes["element_length"] == 2
    assert data.tip_deflection.units == "m"
    assert data.error.dims == ("guide", "element_length")
    assert (data.order > 0).all()
    fig = plot_sliding_mesh(data)
    assert [axes.get_xlabel() != "" for axes in fig.axes] == [True] * 4


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"actuator": BEAM.replace(damping=0.01)}, "actuator.damping"),
        ({"motion": ActuatorMotion(rotation=None), "load": LOAD}, "motion.rotation"),
        ({"motion": ActuatorMotion(extension={"law": "rate", "rate": 2.0})}, "motion.extension"),
    ],
)
def test_what_it_does_not_model_is_refused(change, key):
    with pytest.raises(InputError) as refused:
        march_sliding_beam(STUDY.replace(**change), 50, RIGID["clamp"], step=1e-3, duration=1.0)
    assert refused.value.key == key


@pytest.mark.parametrize(("elements", "step", "key"), [(2, 1e-3, "elements"), (50, 0.0, "step")])
def test_meshes_and_steps_that_make_no_sense_are_refused(elements, step, key):
    with pytest.raises(InputError) as refused:
        march_sliding_beam(STUDY, elements, RIGID["clamp"], step=step, duration=1.0)
    assert refused.value.key == key


@pytest.mark.parametrize("value", [0.0, -1.0, float("nan")])
def test_guides_that_make_no_sense_are_refused(value):
    for make in (ElementContact, NodeContact, InterpolatedClamp):
        with pytest.raises(InputError, match=r"guide\.stiffness"):
            make(stiffness=value)
    with pytest.raises(InputError, match=r"guide\.gap"):
        ElementContact(gap=-1e-6)
