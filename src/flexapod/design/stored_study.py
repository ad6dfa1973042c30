"""A study from a file: a study file, or what was computed of it and carries it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from flexapod import model
from flexapod.common.files import RESULTS, path_of
from flexapod.common.lazy_imports import LazyModule

if TYPE_CHECKING:
    from flexapod.analysis import store
    from flexapod.analysis.results import attributes
    from flexapod.design.sweeps import result
else:
    attributes = LazyModule("flexapod.analysis.results.attributes")
    store = LazyModule("flexapod.analysis.store")
    result = LazyModule("flexapod.design.sweeps.result")

_SWEEPS = (".sqlite", ".zarr")


def load(path: str | Path) -> model.Study | model.ActuatorStudy:
    """Read a study from its file (TOML), from results (``.nc``), or from the store of a sweep (``.sqlite``, ``.zarr``).

    Parameters
    ----------
    path : str or Path
        The file. Tables that a study file names are found relative to its folder; results hold their tables, and no
        other file is read for them.

    Returns
    -------
    Study or ActuatorStudy
        SI values, frozen. Nothing is computed yet. Of a sweep the study that is varied.

    Raises
    ------
    InputError
        With file, key path, value, what is allowed, and the next step. Results of releases that held no tables name
        the table that is not there.

    Examples
    --------
    >>> from pathlib import Path
    >>> _ = Path("robot.toml").write_text(fx.preset("paper-robot").source_text)  # as `flexapod new robot.toml`
    >>> study = fx.load("robot.toml")
    >>> study.robot.payload.mass
    100.0
    >>> _ = fx.study.save(fx.mobility(study), "results.nc")
    >>> fx.load("results.nc").robot == study.robot
    True
    """
    ending = path_of(path, "path").suffix.lower()
    if ending not in (*RESULTS, *_SWEEPS):
        return model.load(path)

    if ending in RESULTS:
        attrs = store.stored_attributes(path)
    else:
        attrs = dict(result.open_sweep(path).attrs)
    return attributes.study_from_attributes(attrs, str(path))
