"""What everybody begins with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flexapod import model
from flexapod.app.view.document import Document

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["Source"]


@dataclass(frozen=True, kw_only=True)
class Source:
    """What everybody begins with: a study file, its study, and results if there are any."""

    document: Document
    study: model.Study | model.ActuatorStudy
    data: Dataset | None = None
