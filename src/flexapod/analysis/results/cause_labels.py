"""Labels of the causes of deviation."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from xarray import Dataset

#: Causes of a leg's length error that every robot has, the first ones of the `cause` dimension.
CAUSES = ("axial-strain", "bending", "drive")
CAUSE_WORDS = {
    "axial-strain": "stretch of the pistons",
    "bending": "bending of the pistons",
    "drive": "give of the drives",
    "base_joint": "give of the joints at the base",
    "platform_joint": "give of the joints at the platform",
    "screw": "stretch of the screws",
    "twist": "twist of the screws",
    "nut": "give of the nuts",
    "bearing": "give of the screws' bearings",
    "oil": "give of the oil columns",
    "unkeyed": "turning of pistons that are not keyed",
    "friction": "friction of the drives",
    "platform_mount": "give of the platform's mount",
    "base_mount": "give of the base's mount",
    "cylinder": "stretch and bending of the cylinders",
    "guide": "give of the bushings",
    "geometry": "errors of geometry",
    "heat_base": "heat of the base",
    "heat_platform": "heat of the platform",
    "heat_piston": "heat of the pistons",
    "heat_cylinder": "heat of the cylinders",
    "heat_screw": "heat of the screws",
}


def cause_label(cause: str, bodies: str = "pistons") -> str:
    """Label of a cause; a cause without a label of its own is a spring of that name."""
    return CAUSE_WORDS.get(cause, f"give of {cause}").replace("pistons", bodies)


def cause_labels(data: Dataset) -> dict[str, str]:
    """Labels of the causes of deviation; parts that bend in legs without stroke are struts."""
    causes = map(str, data.cause.values) if "cause" in data.coords else CAUSES
    return {cause: cause_label(cause, "pistons" if "leg_length" in data else "struts") for cause in causes}
