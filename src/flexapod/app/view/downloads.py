"""What can be taken away: study, results, figures, report, as bytes."""

from __future__ import annotations

import io
import tempfile
import threading
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.model import ActuatorStudy, Study

__all__ = ["csv", "figures", "netcdf", "report"]

_ONE_AT_A_TIME = threading.Lock()  # neither NetCDF nor the drawing of figures promises to work in parallel


def netcdf(data: Dataset) -> bytes:
    """``results.nc``; of the study file it keeps the name, not the folders of whoever runs the server."""
    from flexapod.study.store import save

    named = data.assign_attrs(study_file=Path(str(data.attrs.get("study_file", ""))).name)
    with _ONE_AT_A_TIME, tempfile.TemporaryDirectory(prefix="flexapod-") as folder:
        return save(named, Path(folder) / "results.nc").read_bytes()


def csv(data: Dataset) -> bytes:
    """``results.csv``."""
    from flexapod.study.store import save_csv

    with tempfile.TemporaryDirectory(prefix="flexapod-") as folder:
        return save_csv(data, Path(folder) / "results.csv").read_bytes()


def figures(data: Dataset) -> bytes:
    """A ZIP archive of the standard figures, PNG."""
    from flexapod.report.figures import draw

    with _ONE_AT_A_TIME, tempfile.TemporaryDirectory(prefix="flexapod-") as folder:
        archive = io.BytesIO()
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_STORED) as files:
            for figure in draw(data, folder, ("png",)):
                files.write(figure.png, figure.png.name)
        return archive.getvalue()


def report(study: Study | ActuatorStudy, data: Dataset) -> bytes:
    """``report.html``, one file."""
    from flexapod.report.page import robot_report

    with _ONE_AT_A_TIME:
        return robot_report(study, data).encode()
