"""The paper's whole study on disk: data, figures, claims, report."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

from xarray import Dataset

from flexapod.analysis.results.time_history import Report
from flexapod.analysis.store import save, save_csv
from flexapod.common.errors import InputError
from flexapod.common.files import replace_file, write_text
from flexapod.verification.paper.claims import claims, claims_markdown
from flexapod.verification.paper.engines import check_engine
from flexapod.verification.paper.figures import paper_figures
from flexapod.verification.paper.report import paper_page
from flexapod.verification.paper.study import PaperStudy
from flexapod.verification.paper.study import replicate as compute


def replicate(
    folder: str | Path,
    *,
    engines: bool = False,
    formats: Sequence[str] = ("png",),
    progress: Report | None = None,
) -> PaperStudy:
    """Compute the paper's whole study and write it into a folder.

    Data of each part are written as soon as it is computed: an interrupt leaves what is done. An older report is
    removed first, so that none speaks of other data.

    Parameters
    ----------
    folder : path
        Made if needed.
    engines : bool
        Also with an independent engine, Exudyn; if it fails, the result says so and the rest is written.
    formats : sequence of str
        Of the figures: of png, svg, pdf, none for no figures; the report is written in either case.
    progress : callable, optional
        Called with what is being done, in words, and the share of the whole that is done (0 to 1).

    Returns
    -------
    PaperStudy

    Raises
    ------
    InputError
        The folder cannot be written to, or the engine is not installed.
    ComputationError
        Of our simulations.
    """
    if engines:
        check_engine()
    folder = Path(folder)
    _remove(folder / "report.html")
    result = compute(
        engines=engines,
        progress=_upto(0.75, progress),
        keep=lambda name, data: _store(data, folder / "data" / name),
    )
    groups = paper_figures(result, folder / "figures", formats, _from(0.75, progress)) if formats else {}
    table = claims(result)
    write_text(folder / "claims.md", claims_markdown(table))
    write_text(folder / "report.html", paper_page(result, table, groups))
    return result


def _remove(path: Path) -> None:
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        words = f"cannot be replaced: {error.strerror or error}"
        raise InputError(words, file=path, next_step="Choose another folder with --out DIR") from None


def _upto(share: float, progress: Report | None) -> Report | None:
    return None if progress is None else lambda words, done: progress(words, share * done)


def _from(share: float, progress: Report | None) -> Report | None:
    return None if progress is None else lambda words, done: progress(words, share + (1 - share) * done)


def _store(data: Dataset, stem: Path) -> None:
    """NetCDF and CSV of a part."""
    save(data, stem.with_name(stem.name + ".nc"))
    table = stem.with_name(stem.name + ".csv")
    if "time" in data.dims:
        save_csv(data, table)
    else:
        _save_rows(data, table)


def _save_rows(data: Dataset, path: Path) -> None:
    """A CSV file of a part without time: variable, labels, value and unit, a value a row."""
    with replace_file(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(["variable", "labels", "value", "unit"])
        for name, values in data.data_vars.items():
            unit = values.attrs.get("units", "1")
            labels, numbers = [()], [values.values[()]]
            if values.dims:
                flat = values.stack(all_labels=values.dims)
                labels, numbers = flat.all_labels.values, flat.values
            for label, value in zip(labels, numbers, strict=True):
                shown = f"{value:.10g}" if values.dtype.kind == "f" else str(value)
                rows.writerow([name, _label(label, values.dims), shown, unit])


def _label(label: object, dims: tuple[object, ...]) -> str:
    parts = label if isinstance(label, tuple) else (label,)
    return " ".join(f"{dim}={part}" for dim, part in zip(dims, parts, strict=True))
