"""A meshed beam that slides out of a turning hub through a guide, in time, Eqs. (T11.1)-(T11.6)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.generalized_alpha import GeneralizedAlpha
from flexapod.model import ActuatorStudy
from flexapod.solve.fem.beam_contact import Contact, band_solve, contact_at, solve_contact, static_shape
from flexapod.solve.fem.beam_guide import GuideContact
from flexapod.solve.fem.beam_mesh import BeamMesh, band_product, beam_mesh

#: With a spectral radius below one: the element that leaves the guide strikes vibrations of its own length.
METHOD = GeneralizedAlpha(rho=0.8)


@dataclass(frozen=True, kw_only=True)
class BeamRun:
    """Motion of a meshed beam: `time` (T,) [s], `unknowns` (T, 2 n + 2) [m, 1], and the number of steps."""

    mesh: BeamMesh
    time: Array = field(repr=False)
    unknowns: Array = field(repr=False)
    steps: int

    @property
    def tip(self) -> Array:
        """Deflection of the tip [m], (T,)."""
        return self.unknowns[:, -2]


@dataclass(frozen=True, kw_only=True)
class _Path:
    """Free length and what of the prescribed motion acts on the beam, (T,) each, Eqs. (T11.2)-(T11.4)."""

    length: Array
    push: Array
    turn: Array
    pull: Array
    spin: Array


def march_sliding_beam(
    study: ActuatorStudy,
    elements: int,
    guide: GuideContact,
    *,
    step: float,
    duration: float | None = None,
    output_step: float | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> BeamRun:
    """Motion of the study's beam, meshed along its whole length, through ``guide``.

    Rotation and extension are prescribed, without damping; fidelity and number of shapes of the study are not used.
    `step`, `duration`, `output_step` [s]: of the study where not given, ``output_step`` rounded to whole steps;
    `progress` is called with simulated and whole time [s].

    InputError: free rotation or extension, rates that jump, damping, or a beam that leaves the guide or is wholly in
    it; ComputationError: contact does not settle, or the matrix of a step is not positive definite.
    """
    mesh = beam_mesh(study.actuator, elements)
    end = study.duration if duration is None else duration
    _check_times(study, step, end)
    every = max(1, round((output_step or study.simulation.stored_step) / step))
    count = every * int(end / (step * every) + 1e-6)
    path = _path(study, np.linspace(0.0, count * step, count + 1))
    _check(mesh, path.length)
    return _Steps(mesh, guide, path, step).run(study, every, progress)


def _check_times(study: ActuatorStudy, step: float, end: float) -> None:
    if not 0 < step <= end:
        raise InputError("is not a step of the run", key="step", value=step, allowed=f"above 0, at most {end:g} s")
    jumps = [jump for jump in study.motion.rate_jumps if jump < end]
    if jumps:
        raise InputError(
            "jumps in its rate, which is an impact; a mesh that slides takes smooth motions only",
            key="motion",
            value=f"jump at {jumps[0]:g} s",
            allowed="laws whose rate does not jump before the end",
            next_step='Choose the law "smooth" or "quintic", or end before the jump',
        )


def _path(study: ActuatorStudy, time: Array) -> _Path:
    actuator, motion = study.actuator, study.motion
    actuator.refuse_space()
    if motion.extension is None or motion.rotation is None:
        raise InputError(
            "is free; a mesh that slides takes prescribed motions only",
            key="motion.extension" if motion.extension is None else "motion.rotation",
            allowed="a law of time",
        )
    turn, slide = kinematics.motion_law(motion.rotation, time), kinematics.motion_law(motion.extension, time)
    length, angle = actuator.free_length + slide.position, actuator.angle + turn.position
    reach = actuator.hub_radius + length
    return _Path(
        length=length,
        push=2 * turn.rate * slide.rate + reach * turn.acceleration + actuator.gravity * np.cos(angle),
        turn=turn.acceleration,
        pull=turn.rate**2 * reach - slide.acceleration - actuator.gravity * np.sin(angle),
        spin=turn.rate**2,
    )


def _check(mesh: BeamMesh, length: Array) -> None:
    low, high = mesh.size, mesh.beam.length - mesh.size
    for bad, words in ((length < low, "less than an element is outside"), (length > high, "less than one is inside")):
        if bad.any():
            raise InputError(
                f"takes the beam where {words} the guide",
                key="motion.extension",
                value=float(length[np.argmax(bad)]),
                allowed=f"free lengths of {low:g} to {high:g} m with {mesh.elements} elements",
                next_step="Take more elements, or change the extension",
            )


class _Steps:
    """Generalized-alpha on M u'' + K(t) u + contact = f(t); accelerations satisfy the equation at every step's end.

    J. Chung, G. M. Hulbert, J. Appl. Mech. 60 (1993) 371-375, in the form of M. Arnold, O. Bruls (2007), as in T6.
    """

    def __init__(self, mesh: BeamMesh, guide: GuideContact, path: _Path, step: float) -> None:
        self.mesh, self.guide, self.path, self.step = mesh, guide, path, step

    def run(self, study: ActuatorStudy, every: int, progress: Callable[[float, float], None] | None) -> BeamRun:
        """All steps; states stored each ``every`` of them."""
        alpha_m, alpha_f, beta, gamma = METHOD.alpha_m, METHOD.alpha_f, METHOD.beta, METHOD.gamma
        h, count = self.step, len(self.path.length) - 1
        u, v = self._start(study)
        w = self._acceleration(0, u)
        a = w.copy()
        kept = [u]
        for i in range(1, count + 1):
            carried = (alpha_f * w - alpha_m * a) / (1 - alpha_m)
            share = (1 - alpha_f) / (1 - alpha_m)
            u_free = u + h * v + h**2 * ((0.5 - beta) * a + beta * carried)
            v_free = v + h * ((1 - gamma) * a + gamma * carried)
            u, w = self._advanced(i, u_free, h**2 * beta * share, u)
            a = carried + share * w
            v = v_free + h * gamma * share * w
            if i % every == 0:
                kept.append(u)
                if progress is not None:
                    progress(i * h, count * h)
        return BeamRun(
            mesh=self.mesh, time=np.linspace(0.0, count * h, len(kept)), unknowns=np.array(kept), steps=count
        )

    def _advanced(self, i: int, u_free: Array, factor: float, guess: Array) -> tuple[Array, Array]:
        """State u = u_free + factor w at step i and its acceleration w, M w + K u = f + contact, Eq. (T11.4)."""
        elastic, load, contact = self._forces(i)
        K = elastic + self.mesh.mass / factor
        u = solve_contact(contact, K, load + band_product(self.mesh.mass, u_free) / factor, guess)
        return u, (u - u_free) / factor

    def _acceleration(self, i: int, u: Array) -> Array:
        """Acceleration at step i in the state ``u``."""
        elastic, load, contact = self._forces(i)
        return band_solve(self.mesh.mass, load - band_product(elastic, u) + contact.force(u))

    def _forces(self, i: int) -> tuple[Array, Array, Contact]:
        mesh, path = self.mesh, self.path
        elastic = mesh.bending + path.pull[i] * mesh.tension - path.spin[i] * (mesh.spin + mesh.transverse)
        load = path.turn[i] * mesh.turn - path.push[i] * mesh.push
        return elastic, load, contact_at(mesh, self.guide, path.length[i])

    def _start(self, study: ActuatorStudy) -> tuple[Array, Array]:
        """Static shape at the given tip displacement, and its rate when the beam slides slowly, Eq. (T11.6)."""
        tip, length = study.initial.tip_displacement, self.path.length[0]
        rate = kinematics.motion_law(study.motion.extension, np.zeros(1)).rate[0]  # type: ignore[arg-type]
        shape = static_shape(self.mesh, self.guide, length, tip)
        if not rate:
            return shape, np.zeros_like(shape)
        # A whole element apart the mouth has the same place in its element: jumps where a node leaves cancel.
        shapes = [static_shape(self.mesh, self.guide, length + d * self.mesh.size, tip) for d in (-0.5, 0.5)]
        return shape, rate * (shapes[1] - shapes[0]) / self.mesh.size
