"""Figures from Datasets: each call takes a result and returns a matplotlib figure; `save` writes PNG, SVG, PDF."""

from flexapod.plot.actuator import actuator_modes, actuator_path, actuator_response
from flexapod.plot.convergence import convergence, ladder
from flexapod.plot.deviation import deviation_by_cause
from flexapod.plot.energy import energies
from flexapod.plot.engines import engine_forces, engine_path
from flexapod.plot.legs import actuator_forces, leg_lengths, tip_deflections
from flexapod.plot.maps import workspace_map
from flexapod.plot.motion import motion_law
from flexapod.plot.paths import com_path
from flexapod.plot.printed import actuator_free, actuator_symbols, forces_overlaid, path_bands, piston_mode
from flexapod.plot.robot3d import modes_3d, robot_3d
from flexapod.plot.sliding_mesh import sliding_mesh
from flexapod.plot.solid import solid_comparison, solid_meshes
from flexapod.plot.style import save
from flexapod.plot.sweep import sweep
from flexapod.plot.sweeps import half_angles, start_jump

__all__ = [
    "actuator_forces",
    "actuator_free",
    "actuator_modes",
    "actuator_path",
    "actuator_response",
    "actuator_symbols",
    "com_path",
    "convergence",
    "deviation_by_cause",
    "energies",
    "engine_forces",
    "engine_path",
    "forces_overlaid",
    "half_angles",
    "ladder",
    "leg_lengths",
    "modes_3d",
    "motion_law",
    "path_bands",
    "piston_mode",
    "robot_3d",
    "save",
    "sliding_mesh",
    "solid_comparison",
    "solid_meshes",
    "start_jump",
    "sweep",
    "tip_deflections",
    "workspace_map",
]
