"""The beam that slides out of a turning hub: forces, assumed modes, finite elements, solids."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from flexapod import model
from flexapod.analysis.actuator import simulate_actuator
from flexapod.analysis.results.mode_shapes import local_vibration
from flexapod.analysis.results.time_history import collect
from flexapod.analysis.solid import simulate_solid
from flexapod.common.arrays import Array
from flexapod.solve.fem.beam_guide import ElementContact, GuideContact, InterpolatedClamp, NodeContact
from flexapod.solve.fem.beam_march import march_sliding_beam
from flexapod.solve.time.actuator_march import prepare_actuator
from flexapod.verification.case import Case, Check, case, checks
from flexapod.verification.cases.bending import ROOTS

RIGID_LENGTH, RIGID_FREE, RHOA, RIGID_TIP, RIGID_HUB, GRAVITY, ANGLE = 3.66, 1.5, 4.02, 1.3, 0.7, 9.81, 0.3
RIGID_TURN, RIGID_FEED = 1.2, 0.8
INSTANTS = (0.1, 0.3, 0.5, 0.7, 0.9)


def _law(stroke: float) -> model.ProfileLaw:
    return model.ProfileLaw(law="quintic", amplitude=stroke, duration=1.0)


def _quintic(t: Array, stroke: float) -> tuple[Array, Array, Array]:
    """10 t^3 - 15 t^4 + 6 t^5 times the stroke, with its rates."""
    s = np.polynomial.Polynomial([0, 0, 0, 10, -15, 6]) * stroke
    return s(t), s.deriv(1)(t), s.deriv(2)(t)


def rigid_beam_loads(t: Array) -> tuple[Array, Array]:
    """Torque [N m] and force [N] of the rigid beam."""
    turned, rate, push = _quintic(t, RIGID_TURN)
    fed, speed, pull = _quintic(t, RIGID_FEED)
    angle, length = ANGLE + turned, RIGID_FREE + fed
    inertia = RIGID_HUB + RHOA * (length**3 - (length - RIGID_LENGTH) ** 3) / 3 + RIGID_TIP * length**2
    first = RHOA * (2 * length * RIGID_LENGTH - RIGID_LENGTH**2) / 2 + RIGID_TIP * length
    mass = RHOA * RIGID_LENGTH + RIGID_TIP
    torque = inertia * push + 2 * first * speed * rate + GRAVITY * np.cos(angle) * first
    return torque, mass * pull - first * rate**2 + mass * GRAVITY * np.sin(angle)


@case(
    "Torque and force of a rigid beam with a tip mass, turning by 1.2 rad and sliding by 0.8 m",
    source="equations of motion of the sliding link without bending, written by hand",
    argument="both are closed forms of the same instant: rounding",
)
def _sliding_forces() -> list[Check]:
    beam = model.Actuator(
        length=RIGID_LENGTH,
        free_length=RIGID_FREE,
        rhoA=RHOA,
        EI=756.65,
        tip_mass=RIGID_TIP,
        hub_inertia=RIGID_HUB,
        gravity=GRAVITY,
        angle=ANGLE,
    )
    motion = model.ActuatorMotion(rotation=_law(RIGID_TURN), extension=_law(RIGID_FEED))
    data = simulate_actuator(beam, motion, fidelity="rigid", step=0.01, output_step=0.1, duration=1.0)
    at = data.sel(time=list(INSTANTS), method="nearest")
    torque, force = rigid_beam_loads(np.array(INSTANTS))
    return [
        *checks([f"torque at {t:g} s" for t in INSTANTS], torque, at.torque, 1e-10, "N m"),
        *checks([f"force at {t:g} s" for t in INSTANTS], force, at.force, 1e-10, "N"),
    ]


TIP_MM = (5, 1.46875, 2.52914, 3.4969, -9.29794, 3.92053, -8.32143, -9.74686, -4.10753, -1.73481, -2.7728)
LARGEST_MM = 13.9986


@case(
    "Tip of the beam of the paper's Table 2, out of the hub at 0.1 m/s, turning at 0.785 rad/s",
    source="independent closed equation of motion with six shapes, converged to the printed digits",
    argument="three shapes are within 4e-3 mm of six",
)
def _sliding_beam() -> list[Check]:
    study = model.override(model.preset("paper-actuator"), modes=3, step=1e-4, output_step=0.01)
    first = 2.5e-3 * np.eye(3)[0]  # phi_1(1) = 2; the table starts from the first mode with sqrt(rhoA L) a at rest
    march = prepare_actuator(study, first, -FEED / (2 * study.actuator.free_length) * first)
    record = collect(march.chunks, (), study.duration, None)
    tip = 1e3 * record.q[:, 0, 2:] @ march.system.kernel.shapes.beam.a.tip
    names = [*(f"tip at {t} s" for t in range(11)), "largest deflection"]
    return checks(names, [*TIP_MM, LARGEST_MM], [*tip[::100], np.abs(tip).max()], 4e-3, "mm", absolute=True)


ELEMENTS, SHAPES, STEP, OUTPUT_STEP, DURATION = 12, 8, 5e-5, 5e-3, 10.0
FEED, TURN, TIP = 0.1, 0.785, 5e-3  # m/s, rad/s, m: of the preset
#: cos x cosh x = -1; higher roots are odd multiples of a quarter turn to 1e-7.
LAMBDA = np.array([*ROOTS, *(np.pi * (np.arange(6, SHAPES + 1) - 0.5))])


def predicted_gap(elements: int, t: Array) -> tuple[Array, Array]:
    """Tip by elements less that by modes (T,) [m], and a bound on it: modes in step, but each ahead by its own phase.

    Mode i of n cubics is fast by (lambda / n)^4 / 1440 and after the angle int omega dt = c lambda^2 int L^-2 dt ahead
    by that share of it. Its part of the static shape under a tip force is 12 lambda^-4 of the tip, of that under a
    uniform load (the Coriolis force, which begins at t = 0) 32 sigma lambda^-5 with alternating signs. The amplitude
    grows like L^(1/2): the energy a^2 / L^3 of a slowly sliding beam goes with the frequency, L^-2.
    """
    beam, x = model.preset("paper-actuator").actuator, LAMBDA
    start, length = beam.free_length, beam.free_length + FEED * t
    angle = np.sqrt(beam.EI / beam.rhoA) * x[:, None] ** 2 * (1 / start - 1 / length) / FEED
    ahead = angle * (x[:, None] / elements) ** 4 / 1440
    sag = 2 * TURN * FEED * beam.rhoA * start**4 / (8 * beam.EI)
    sigma = (np.cosh(x) + np.cos(x)) / (np.sinh(x) + np.sin(x))
    part = TIP * 12 / x**4 + sag * 32 * sigma * (-1.0) ** np.arange(len(x)) / x**5
    growth = np.sqrt(length / start)
    most = 2 * np.sin(np.minimum(ahead, np.pi) / 2)
    return growth * (part @ (np.cos(angle + ahead) - np.cos(angle))), growth * (np.abs(part) @ most)


def _tip(study: model.ActuatorStudy, **settings: object) -> Array:
    return np.asarray(simulate_actuator(study, step=STEP, output_step=OUTPUT_STEP, **settings).tip_deflection.values)  # pyright: ignore


@case(
    "Tip of the beam of the paper's Table 2 over 10 s, every 5 ms: twelve cubic elements on the free length "
    "against eight clamped-free shapes",
    source="assumed modes of this software, themselves checked in sliding-beam; the size of the difference by the "
    "order of the elements: mode i of n runs ahead by (lambda / n)^4 / 1440 of its angle",
    argument="root mean squares: the next term of that law takes 3 % off the lead of mode 3 and 4 % off that of mode "
    "4; largest values: no more than all modes ahead would give if they met at one instant, 0.14 % of the peak; the "
    "same steps in both",
)
def _beam_fem() -> list[Check]:
    study = model.preset("paper-actuator")
    elements = _tip(study, fidelity="beam-fem", modes=2 * ELEMENTS)
    modes = _tip(study, fidelity="assumed-modes", basis="clamped-free", modes=SHAPES)
    t = np.asarray(np.arange(len(modes)) * OUTPUT_STEP, dtype=float)
    peak, gap = float(np.abs(modes).max()), elements - modes
    law, bound = predicted_gap(ELEMENTS, t)
    most = float(bound.max()) / peak
    ends, largest = (0.5 * DURATION, DURATION), float(np.abs(gap).max()) / peak
    names = [f"root mean square difference in {end:g} s" for end in ends]
    predicted, found = ([np.sqrt((of[t <= end] ** 2).mean()) for end in ends] for of in (law, gap))
    return [
        *checks(names, predicted, found, 0.05, "m"),
        Check("largest difference in 10 s", 0.0, largest, most, "of the peak", absolute=True),
        Check("largest deflection", peak, float(np.abs(elements).max()), most, "m"),
    ]


MESHES, MESH_STEP = (100, 200, 400), 1e-3
#: [s] 5, 10, 20 elements pass the mouth, from node to node.
MESH_DURATION = 1.83
OF_ORDER, OF_SIZE = 0.15, 0.2  # tolerances
#: Mean of the shift of the clamp over the places of the mouth in an element, by its length, Eq. (T11.8).
GUIDES: dict[str, tuple[GuideContact, float]] = {
    "whole elements": (ElementContact(stiffness=1e24), 0.5),
    "nodes": (NodeContact(), 0.5 + 1 / 12**0.5),
    "clamp": (InterpolatedClamp(), 0.0824),
}


def _lag(study: model.ActuatorStudy, shift: float) -> float:
    """Root mean square error by that of the motion: the phase 2 int omega shift / L dt, Eq. (T11.7), over sqrt 3."""
    beam = study.actuator
    speed = ROOTS[0] ** 2 * np.sqrt(beam.EI / beam.rhoA)
    ends = np.array([beam.free_length, beam.free_length + FEED * MESH_DURATION])
    return float(speed * shift * (ends[0] ** -2 - ends[1] ** -2) / FEED / 3**0.5)


@case(
    "Error of a beam mesh that is fixed to the material and slides through a guide, Table 2 beam, 1.83 s",
    source="theory: the clamp is off by a share of an element's length, so order one and 2 int omega shift / L dt",
    argument="in contact the free length grows by jumps of an element at any phase of the vibration: each changes the "
    "amplitude by 3/2 h / L, which does not average out over four periods, a tenth of the lag of 14 h / L, in every "
    "mesh anew: log2(1.1 / 0.9) / 2 = 0.15 of the order. Sizes: that tenth, a twentieth for the sag that does not "
    "lag, a twentieth for the last of five elements: 0.2",
)
def _sliding_mesh() -> Iterator[Check]:
    study = model.preset("paper-actuator")
    exact = simulate_actuator(
        study, basis="clamped-free", modes=6, step=1e-4, duration=MESH_DURATION, output_step=OUTPUT_STEP
    ).tip_deflection.values
    for name, (guide, shift) in GUIDES.items():
        errors = []
        for n in MESHES:
            run = march_sliding_beam(study, n, guide, step=MESH_STEP, duration=MESH_DURATION, output_step=OUTPUT_STEP)
            errors.append(float(np.sqrt(((run.tip - exact) ** 2).mean() / (exact**2).mean())))
        first, last = MESHES[0], MESHES[-1]
        order = float(np.log(errors[0] / errors[-1]) / np.log(last / first))
        yield Check(f"{name}, order from {first} to {last} elements", 1.0, order, OF_ORDER)
        lags = [_lag(study, shift * study.actuator.length / n) for n in MESHES]
        yield from checks([f"{name}, error with {n} elements" for n in MESHES], lags, errors, OF_SIZE)


SIZE, SOLID_OUTPUT_STEP, WINDOWS = 0.025, 0.01, 3
PERIODS = 1.45  # s: three of them
EARLY, GROWTH = 7e-6, 2.5e-6  # m in three periods, m/s after them


def _solid_beam(duration: float) -> Iterator[Check]:
    study = model.preset("paper-actuator")
    beam = simulate_actuator(study, modes=8, step=1e-4, output_step=SOLID_OUTPUT_STEP, duration=duration)
    solid, plate = (
        simulate_solid(study, size=SIZE, poisson=nu, output_step=SOLID_OUTPUT_STEP, duration=duration)
        for nu in (0.0, 0.3)
    )
    t, modes = solid.time.values, beam.tip_deflection.values
    gap = np.abs(solid.tip_deflection.values - modes)
    spans, bounds = ("three periods", f"{duration:g} s"), (EARLY, EARLY + GROWTH * (duration - PERIODS))
    names, gaps = [f"nu = 0, largest difference in {span}" for span in spans], (gap[t < PERIODS].max(), gap.max())
    yield from checks(names, [0, 0], gaps, bounds, "m", absolute=True)
    slow = local_vibration(t, modes, solid.frequency.values, WINDOWS)
    fast = local_vibration(t, plate.tip_deflection.values, plate.frequency.values, WINDOWS)
    locked = plate.frequency.values / solid.frequency.values
    hanging = plate.static_deflection.values / solid.static_deflection.values
    at = [f"nu = 0.3, {{}} near {time:.1f} s" for time in fast.time]
    for name, ours, reference, tolerance, unit in (
        ("frequency", fast.frequency, slow.frequency * np.interp(fast.time, t, locked), 5e-4, "Hz"),
        ("envelope", fast.envelope, slow.envelope, 2.5e-3, "m"),
        ("Coriolis sag", fast.sag, slow.sag * np.interp(fast.time, t, hanging), 3e-3, "m"),
    ):
        yield from checks([words.format(name) for words in at], reference, ours, tolerance, unit)
    # Between a section that may curl, 0, and a plate whose mouth is held at every point, 0.6 %
    rise = [float(of(locked)) - 1 for of in (np.min, np.max)]
    yield from checks(["nu = 0.3, least rise", "nu = 0.3, largest rise"], [3e-3] * 2, rise, 3e-3, absolute=True)


SOLID = [
    Case(
        name=name,
        statement=f"Tip of the beam of the paper's Table 2, {time}: quadratic solid elements of 25 mm, reduced, "
        "against eight assumed modes; point by point at Poisson's ratio 0, by frequency, envelope and Coriolis sag at "
        "0.3",
        source="assumed modes of this software; at 0.3 times what the solid says at rest at the same length",
        argument="shear and rotary inertia: 1.8e-5 of the first frequency, 2 pi 3 periods of 6 mm: 2 um, 16 periods of "
        "7 mm: 13 um; 1.2e-4 of the second, 0.15 mm in 19 and 100 periods: 2 and 12 um; steps of the assumed modes: "
        "3 um. At 0.3 the fits of three periods that drift by a third have residues of the second mode, 5e-4; sag and "
        "envelope share the 5 mm of the start, and the stiffer mouth takes 6 um from the sag; a plate held at every "
        "point of its mouth is stiffer by 0.6 %, the guide's averages leave it between that and nothing",
        compute=partial(_solid_beam, duration),
        slow=name.endswith("long"),
    )
    for name, time, duration in (("solid-beam", "the first 4 s", 4.0), ("solid-beam-long", "10 s", 10.0))
]
