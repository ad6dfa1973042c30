"""Results of a run on disk: NetCDF, CSV, figures, report."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from flexapod.errors import InputError
from flexapod.files import check_name

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.study.record import Report

__all__ = ["FORMATS", "check_writable", "parse_formats", "results_folder", "write_all", "write_data"]

FORMATS = ("png", "svg", "pdf")  # of figures


def parse_formats(text: str) -> tuple[str, ...]:
    """Formats of figures from the text of ``--format``, each once: ``"png, PDF"`` gives ``("png", "pdf")``.

    Raises
    ------
    InputError
        One of them is unknown, or there is none.
    """
    names = tuple(dict.fromkeys(name.strip().lower() for name in text.split(",") if name.strip()))
    unknown = [name for name in names if name not in FORMATS]
    if unknown or not names:
        raise InputError(
            "is not a format of figures",
            key="--format",
            value=unknown[0] if unknown else text,
            allowed=f"{', '.join(FORMATS)}, or several with commas",
            next_step="For example --format png,pdf",
        )
    return names


def results_folder(file: Path, command: str, out: Path | None) -> Path:
    """Where a command's results go: `out`, else a folder of its own beside the study file, ``robot-run``.

    Raises
    ------
    InputError
        It cannot be written to.
    """
    folder = file.with_name(f"{file.stem}-{command}") if out is None else out
    check_writable(folder)
    return folder


def check_writable(folder: Path | None, key: str = "--out") -> None:
    """Refuse a folder that could not be made or written to, before anything is computed; it is not made yet."""
    if folder is None:
        return
    check_name(folder.absolute(), key)
    existing = next(place for place in (folder.absolute(), *folder.absolute().parents) if os.path.lexists(place))
    try:
        os.rmdir(tempfile.mkdtemp(prefix=".flexapod-", dir=existing))
    except OSError as error:
        what = (
            f"cannot be made: {existing} is a file" if existing.is_file() else f"cannot be written to: {error.strerror}"
        )
        raise InputError(what, key=key, value=str(folder), next_step=f"Choose another place with {key}") from None


def write_data(data: Dataset, folder: Path) -> list[Path]:
    """``results.nc`` and ``results.csv``, each whole or not at all."""
    from flexapod.study.store import save, save_csv

    return [save(data, folder / "results.nc"), save_csv(data, folder / "results.csv")]


def write_all(data: Dataset, folder: Path, report: Report, formats: Sequence[str]) -> list[Path]:
    """Data, figures in the formats asked for (none: no figures), ``report.html``; `report` is told what is written."""
    report("writing results", 0.90)
    files = write_data(data, folder)
    report("drawing figures", 0.92)
    from flexapod.report.figures import draw
    from flexapod.report.page import write_report

    figures = draw(data, folder, formats) if formats else []
    report("writing the report", 0.98)
    page = write_report(data, folder, figures)
    return [*files, *(path for figure in figures for path in figure.files), page]
