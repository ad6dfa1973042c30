"""Error of a mesh fixed to the sliding beam, against the mesh of the free length: a study in, a Dataset out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from flexapod import model
from flexapod.analysis.actuator import simulate_actuator
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.variables import Variable, dataset
from flexapod.common.arrays import Array
from flexapod.solve.fem.beam_contact import frozen_frequencies
from flexapod.solve.fem.beam_guide import ElementContact, GuideContact, InterpolatedClamp, NodeContact
from flexapod.solve.fem.beam_march import march_sliding_beam
from flexapod.solve.fem.beam_mesh import beam_mesh

if TYPE_CHECKING:
    from xarray import Dataset

#: Guides that are compared, stiff enough to count as rigid at the meshes of the study, without gap.
GUIDES: Mapping[str, GuideContact] = {
    "nodes": NodeContact(stiffness=1e14),
    "elements": ElementContact(stiffness=1e24),
    "clamp": InterpolatedClamp(stiffness=1e14, turning=1e11),
}
ELEMENTS = (50, 100, 200, 400)
FREE_ELEMENTS = (2, 3, 4, 6)
STIFFNESSES = (1e8, 1e10, 1e12, 1e14, 1e16, 1e18, 1e20, 1e22, 1e24)
PARTS = np.linspace(0.02, 0.98, 25)
#: [s]; halving the step changes the errors of 0.02 to 0.75 by less than 1e-3.
STEP, OUTPUT_STEP = 5e-4, 5e-3

_FORMS = {
    "tip_reference": Variable(("time",), "m", "deflection of the tip by assumed modes on the free length"),
    "tip_deflection": Variable(("guide", "time"), "m", "deflection of the tip with the mesh of the figure"),
    "error": Variable(
        ("guide", "element_length"), "1", "root mean square difference of the tip, by that of the reference"
    ),
    "error_free_length": Variable(("free_element_length",), "1", "the same with elements on the free length"),
    "order": Variable(("guide", "mesh_pair"), "1", "observed order between neighbouring meshes"),
    "clamp_shift": Variable(("guide", "outside_part"), "1", "shift of the clamp by an element's length, outwards"),
    "clamp_shift_law": Variable(("guide", "outside_part"), "1", "the same by its law"),
    "error_of_stiffness": Variable(("stiffness",), "1", "error with contact of elements, by the guide's stiffness"),
}
_WORDS = {
    "element_length": ("m", "length of an element"),
    "free_element_length": ("m", "length of an element at the start"),
    "stiffness": ("N m-2", "stiffness of the guide per length"),
    "outside_part": ("1", "part of the element at the mouth that is outside"),
}


def sliding_mesh(
    study: model.ActuatorStudy,
    *,
    elements: Sequence[int] = ELEMENTS,
    stiffnesses: Sequence[float] = STIFFNESSES,
    duration: float | None = None,
    shown: int = 1,
    progress: Callable[[float, float], None] | None = None,
) -> Dataset:
    """Errors of a mesh that is fixed to the beam and slides through a guide, by element length and guide.

    Parameters
    ----------
    study : ActuatorStudy
        Prescribed rotation and extension, no damping.
    elements : sequence of int
        Elements on the whole beam, ascending.
    stiffnesses : sequence of float
        Of the guide [N/m^2], for contact of elements on the mesh number ``shown``.
    duration : float, optional
        [s], in place of the study's.
    shown : int
        Number (from 0) of the mesh of the curves over time and of the stiffnesses.
    progress : callable, optional
        Called with runs done and number of runs.

    Returns
    -------
    xarray.Dataset
        `error`, `order` by guide and element length, and what `_FORMS` names.

    Raises
    ------
    InputError
        Free or damped motion, too few elements, or a beam that leaves its guide.
    ComputationError
        A run does not succeed.
    """
    end = study.duration if duration is None else duration
    reference = simulate_actuator(
        study, fidelity="assumed-modes", basis="clamped-free", modes=6, step=1e-4, duration=end, output_step=OUTPUT_STEP
    )
    runs = _Runs(study, end, reference.tip_deflection.values, len(GUIDES) * len(elements) + len(stiffnesses), progress)
    tips = {(name, n): runs.tip(n, guide) for name, guide in GUIDES.items() for n in elements}
    errors = np.array([[runs.error(tips[name, n]) for n in elements] for name in GUIDES])
    sweep = [runs.error(runs.tip(elements[shown], ElementContact(stiffness=k))) for k in stiffnesses]
    shifts = [_clamp_shifts(study, elements[shown], guide) for guide in GUIDES.values()]
    values = {
        "tip_reference": reference.tip_deflection.values,
        "tip_deflection": np.array([tips[name, elements[shown]] for name in GUIDES]),
        "error": errors,
        "order": -np.diff(np.log(errors), axis=1) / np.diff(np.log(np.asarray(elements, dtype=float))),
        "error_free_length": np.array([runs.error(_free_length_tip(study, n, end)) for n in FREE_ELEMENTS]),
        "clamp_shift": np.array([found for found, _ in shifts]),
        "clamp_shift_law": np.array([law for _, law in shifts]),
        "error_of_stiffness": np.array(sweep),
    }
    labels = {**_labels(study, elements, stiffnesses), "time": reference.time.values}
    attrs = {**attributes(study, []), "shown_element_length": study.actuator.length / elements[shown], "step": STEP}
    return _described(dataset(values, labels, attrs, _FORMS))


def _labels(study: model.ActuatorStudy, elements: Sequence[int], stiffnesses: Sequence[float]) -> dict[str, ArrayLike]:
    return {
        "guide": list(GUIDES),
        "element_length": study.actuator.length / np.array(elements),
        "free_element_length": study.actuator.free_length / np.array(FREE_ELEMENTS),
        "outside_part": PARTS,
        "stiffness": np.array(stiffnesses),
    }


def _described(data: Dataset) -> Dataset:
    for name, (units, words) in _WORDS.items():
        data[name].attrs.update(units=units, long_name=words)
    return data


class _Runs:
    """Runs of one study whose progress is counted together."""

    def __init__(
        self,
        study: model.ActuatorStudy,
        end: float,
        reference: Array,
        count: int,
        progress: Callable[[float, float], None] | None,
    ) -> None:
        self.study, self.end, self.reference, self.count, self.progress = study, end, reference, count, progress
        self.done = 0

    def tip(self, elements: int, guide: GuideContact) -> Array:
        """Deflection of the tip (T,) [m] with a mesh fixed to the beam."""
        run = march_sliding_beam(self.study, elements, guide, step=STEP, duration=self.end, output_step=OUTPUT_STEP)
        self.done += 1
        if self.progress is not None:
            self.progress(self.done, self.count)
        return run.tip

    def error(self, tip: Array) -> float:
        """Root mean square difference from the reference, by its root mean square."""
        return float(np.sqrt(((tip - self.reference) ** 2).mean() / (self.reference**2).mean()))


def _free_length_tip(study: model.ActuatorStudy, elements: int, end: float) -> Array:
    run = simulate_actuator(
        study, fidelity="beam-fem", modes=2 * elements, step=1e-4, duration=end, output_step=OUTPUT_STEP
    )
    return np.asarray(run.tip_deflection.values)


def _clamp_shifts(study: model.ActuatorStudy, elements: int, guide: GuideContact) -> tuple[Array, Array]:
    """Shift of the clamp by an element's length: from the first frequency, Eq. (T11.7), and by its law."""
    bare = study.actuator.replace(tip_mass=0.0, tip_inertia=0.0)
    mesh = beam_mesh(bare, elements)
    first = np.floor((bare.length - bare.free_length) / mesh.size) * mesh.size
    lengths = bare.length - first - mesh.size * (1 - PARTS)
    found = np.array([frozen_frequencies(mesh, guide, length, 1)[0] for length in lengths])
    exact = 1.875104068712**2 * np.sqrt(bare.EI / bare.rhoA) / (2 * np.pi * lengths**2)
    return (1 - np.sqrt(exact / found)) * lengths / mesh.size, guide.clamp_shift(mesh, PARTS) / mesh.size
