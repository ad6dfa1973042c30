"""Figures from Datasets: each call takes a result and returns a matplotlib figure; `save` writes PNG, SVG, PDF."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexapod.plot.actuator import actuator_modes, actuator_path, actuator_response
from flexapod.plot.budget import budget
from flexapod.plot.convergence import convergence, ladder
from flexapod.plot.elements import sliding_mesh, solid_comparison, solid_meshes
from flexapod.plot.legs import actuator_forces, by_leg, leg_lengths, tip_deflections
from flexapod.plot.maps import workspace_map
from flexapod.plot.payload import com_path, deviation_by_cause, energies, motion_law
from flexapod.plot.style import save
from flexapod.plot.sweep import sweep
from flexapod.plot.vibration import vibration
from flexapod.runtime.loading import later

if TYPE_CHECKING:
    from collections.abc import Callable

    from flexapod.plot.linear import bode, cumulative, transmissibility
    from flexapod.plot.poles import pole_map, root_locus
    from flexapod.plot.robot3d import modes_3d, robot_3d

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
    "flexapod.plot.linear": ("bode", "cumulative", "transmissibility"),
    "flexapod.plot.poles": ("pole_map", "root_locus"),
    "flexapod.plot.robot3d": ("modes_3d", "robot_3d"),
    "flexapod.paper.engine_figures": ("engine_forces", "engine_path"),
    "flexapod.paper.printed": ("actuator_free", "actuator_symbols", "forces_overlaid", "path_bands", "piston_mode"),
    "flexapod.paper.variant_figures": ("half_angles", "start_jump"),
}

__getattr__: Callable[[str], object] = later("flexapod.plot", _LATER)
