"""Figures from Datasets: each call takes a result and returns a matplotlib figure; `save` writes PNG, SVG, PDF."""

from flexapod.common.lazy_imports import lazy_names

#: Figures of the paper's study: they live with it, answer here, and are not listed.
_PAPER = {
    "flexapod.verification.paper.engine_figures": ("engine_forces", "engine_path", "half_angles", "start_jump"),
    "flexapod.verification.paper.printed_figures": (
        "actuator_free",
        "actuator_symbols",
        "forces_overlaid",
        "path_bands",
        "piston_mode",
    ),
}

__getattr__, __dir__, __all__ = lazy_names(__name__, hidden=_PAPER)
