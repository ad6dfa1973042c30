"""Presets and samples of mechanisms."""

from pathlib import Path

import flexapod as fx

PRESETS = ("paper-robot", "paper-robot-radii", "machine-hexapod", "nano-hexapod", "small-hexapod", "motion-base",
           "flight-simulator", "tripod")  # fmt: skip
SAMPLES = sorted(path.stem for path in Path("examples/mechanisms").glob("*.toml"))


def known(name):
    return fx.preset(name) if name in PRESETS else fx.load(f"examples/mechanisms/{name}.toml")
