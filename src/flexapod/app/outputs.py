"""Results of a run on disk: NetCDF, CSV, figures, report."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from flexapod.errors import InputError

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.study.record import Report

__all__ = ["check_writable", "results_folder", "write_all", "write_data"]


def results_folder(file: Path, out: Path | None) -> Path:
    """Where results go: `out`, else a folder in the current one named after the study file.

    Raises
    ------
    InputError
        It cannot be written to.
    """
    folder = Path(file.stem) if out is None else out
    check_writable(folder)
    return folder


def check_writable(folder: Path | None) -> None:
    """Refuse a folder that could not be made or written to, before anything is computed; it is not made yet."""
    if folder is None:
        return
    existing = next(place for place in (folder.absolute(), *folder.absolute().parents) if os.path.lexists(place))
    try:
        os.rmdir(tempfile.mkdtemp(prefix=".flexapod-", dir=existing))
    except OSError as error:
        what = (
            f"cannot be made: {existing} is a file" if existing.is_file() else f"cannot be written to: {error.strerror}"
        )
        raise InputError(
            what, key="--out", value=str(folder), next_step="Choose another folder with --out DIR"
        ) from None


def write_data(data: Dataset, folder: Path) -> list[Path]:
    """``results.nc`` and ``results.csv``, each whole or not at all."""
    from flexapod.study.store import save, save_csv

    return [save(data, folder / "results.nc"), save_csv(data, folder / "results.csv")]


def write_all(data: Dataset, folder: Path, report: Report) -> list[Path]:
    """Data, figures and ``report.html``; `report` is told what is being written."""
    report("writing results", 0.90)
    files = write_data(data, folder)
    report("drawing figures", 0.92)
    from flexapod.app.figures import draw
    from flexapod.app.report import write_report

    figures = draw(data, folder)
    report("writing the report", 0.98)
    page = write_report(data, folder, figures)
    return [*files, *(path for figure in figures for path in (figure.png, figure.svg)), page]
