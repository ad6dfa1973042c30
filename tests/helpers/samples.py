"""Presets, and samples of mechanisms: the studies of `examples/mechanisms`."""

from pathlib import Path

import flexapod as fx

MECHANISMS = Path(__file__).parents[2] / "examples" / "mechanisms"
SAMPLES = sorted(path.stem for path in MECHANISMS.glob("*.toml"))
PRESETS = ("paper-robot", "paper-robot-radii", "machine-hexapod", "nano-hexapod", "small-hexapod", "motion-base",
           "flight-simulator", "tripod")  # fmt: skip


def sample_study(name):
    """The study of a sample."""
    return fx.load(MECHANISMS / f"{name}.toml")


def sample_text(name):
    """Its file."""
    return (MECHANISMS / f"{name}.toml").read_text(encoding="utf-8")


def known(name):
    """The study of a preset or of a sample."""
    return fx.preset(name) if name in PRESETS else sample_study(name)
