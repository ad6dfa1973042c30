"""Figures from Datasets: each call takes a result and returns a matplotlib figure; `save` writes PNG, SVG, PDF."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexapod.common.lazy_imports import lazy_attributes
from flexapod.output.figures.actuator import actuator_modes, actuator_path, actuator_response
from flexapod.output.figures.budget import budget
from flexapod.output.figures.convergence import convergence, ladder
from flexapod.output.figures.elements import sliding_mesh, solid_comparison, solid_meshes
from flexapod.output.figures.legs import actuator_forces, by_leg, leg_lengths, tip_deflections
from flexapod.output.figures.maps import workspace_map
from flexapod.output.figures.payload import com_path, deviation_by_cause, energies, motion_law
from flexapod.output.figures.style import save
from flexapod.output.figures.sweep import sweep

if TYPE_CHECKING:
    from collections.abc import Callable

    from flexapod.output.figures.linear import bode, cumulative, transmissibility, vibration
    from flexapod.output.figures.poles import pole_map, root_locus
    from flexapod.output.figures.robot3d import modes_3d, robot_3d

__all__ = [
    "actuator_forces",
    "actuator_modes",
    "actuator_path",
    "actuator_response",
    "bode",
    "budget",
    "by_leg",
    "com_path",
    "convergence",
    "cumulative",
    "deviation_by_cause",
    "energies",
    "ladder",
    "leg_lengths",
    "modes_3d",
    "motion_law",
    "pole_map",
    "robot_3d",
    "root_locus",
    "save",
    "sliding_mesh",
    "solid_comparison",
    "solid_meshes",
    "sweep",
    "tip_deflections",
    "transmissibility",
    "vibration",
    "workspace_map",
]

#: Figures of the paper's study: they live with it and keep their names here. And those in space, which take axes of
#: their own from matplotlib, and those of linear systems, which few ask for.
_LATER = {
    "flexapod.output.figures.linear": ("bode", "cumulative", "transmissibility", "vibration"),
    "flexapod.output.figures.poles": ("pole_map", "root_locus"),
    "flexapod.output.figures.robot3d": ("modes_3d", "robot_3d"),
    "flexapod.verification.paper.engine_figures": ("engine_forces", "engine_path", "half_angles", "start_jump"),
    "flexapod.verification.paper.printed_figures": (
        "actuator_free",
        "actuator_symbols",
        "forces_overlaid",
        "path_bands",
        "piston_mode",
    ),
}

__getattr__: Callable[[str], object] = lazy_attributes("flexapod.output.figures", _LATER)
