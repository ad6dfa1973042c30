"""Random vibration of any outputs of a linear system: the integral of `flexapod.vibration`, (T18.6)-(T18.11)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from flexapod.common.arrays import floats
from flexapod.common.errors import InputError
from flexapod.control.frequency_response import reachable_observable
from flexapod.control.state_space import channel_indices
from flexapod.model.study.disturbance import Disturbance, Floor, Spectrum, check_density
from flexapod.solve.linear.random_vibration import (
    FLOOR_RATES,
    GROUPS,
    SOURCES,
    RandomVibration,
    Source,
    VibrationModel,
    vibration_with_error,
)

if TYPE_CHECKING:
    from flexapod.control.state_space import StateSpace

#: A disturbance of a study, or one-sided spectra by channel or group: tables of a study, or (frequency [Hz], density).
Sources = Disturbance | Mapping[str, Floor | Spectrum | tuple[ArrayLike, ArrayLike]]
EXAMPLE = "spectra by channel: {'wrench:fz': (frequencies [Hz], densities)}"


def output_vibration(system: StateSpace, sources: Sources) -> tuple[RandomVibration, float]:
    """Vibration of all outputs, and the error of the integral over frequency that is estimated, relative."""
    if system.sample is not None:
        raise InputError("is of samples: spectra need a continuous system", key="sample", value=system.sample)
    every = _sources(system, sources)
    used = system.select([system.inputs[i] for i in np.flatnonzero(sum(abs(s.forces).sum(axis=1) for s in every))])
    every = [
        Source(
            name=one.name,
            forces=one.forces[[system.inputs.index(name) for name in used.inputs]],
            frequency=one.frequency,
            density=one.density,
            rates=one.rates,
        )
        for one in every
    ]
    poles = np.linalg.eigvals(reachable_observable(used.A, used.B, used.C)[0]).astype(complex)
    model = VibrationModel(  # its outputs take the place of modes
        tool=np.eye(len(used.outputs)),
        poles=lambda rate: poles,
        amplitudes=lambda frequency, forces: np.moveaxis(used.at(frequency), 2, 0) @ forces,
    )
    return vibration_with_error(model, every)


def _sources(system: StateSpace, given: Sources) -> list[Source]:
    """Sources with what each of their columns moves, (inputs, columns)."""
    if isinstance(given, Disturbance):
        tables = {field: getattr(given, field) for field in GROUPS}
        return [_source(system, SOURCES[f], GROUPS[f], table) for f, table in tables.items() if table is not None]
    if not isinstance(given, Mapping) or not given:
        words = "is empty: nothing shakes" if given is None or isinstance(given, Mapping) else "are none"
        raise InputError(words, key="sources", value=given, allowed=EXAMPLE)
    return [_source(system, name, name, table) for name, table in given.items()]


def _source(system: StateSpace, name: str, group: str, table: Floor | Spectrum | tuple[ArrayLike, ArrayLike]) -> Source:
    places = channel_indices(group, system.inputs, "sources")
    rates = FLOOR_RATES[table.of] if isinstance(table, Floor) else 0
    if isinstance(table, tuple):
        try:
            frequency, density = map(floats, table)
        except ValueError:
            raise InputError("is no spectrum", key=f"sources[{name}]", value=table, allowed=EXAMPLE) from None
        density = density[:, None] if density.ndim == 1 else density
        check_density(frequency, density)
    else:
        if not isinstance(table, Floor | Spectrum):
            raise InputError("is no spectrum", key=f"sources[{name}]", value=table, allowed=EXAMPLE)
        frequency, density = table.frequency, table.density
    columns = density.shape[1]
    if isinstance(table, Floor):
        places = places[:columns]  # along x, y, z; not about them
    if columns not in (1, len(places)):
        raise InputError(
            f"has {columns} columns", key=f"sources[{name}]", allowed=f"1, or {len(places)}: one for each of {group}"
        )
    forces = np.zeros((len(system.inputs), len(places)))
    forces[places, np.arange(len(places))] = 1.0
    density = np.broadcast_to(density, (len(frequency), len(places)))
    return Source(name=name, forces=forces, frequency=frequency, density=density, rates=rates)
