"""A robot about rest as matrices with named channels."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from flexapod import model
from flexapod.analysis.linear import linearize
from flexapod.analysis.results.arguments import LoadLike, PoseLike
from flexapod.common.files import scratch
from flexapod.output.exchange.content import Content


def state_space(
    study: model.Study,
    *,
    name: str,
    pose: PoseLike = None,
    load: LoadLike = None,
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
) -> Content:
    """A, B, C, D with names and units of `flexapod.linearize`, in the format that `name` ends in.

    Without names all of a robot's own: wrench, commands and floor in, tool, strokes and drive forces out. Drives that
    are forces are released, and their forces are inputs in place of commands.
    """
    robot = study.robot
    pushed = any(leg.driven and leg.drive.pushes for leg in robot.legs)
    of_platform, in_space = not robot.platform_fixed, robot.plane is None
    into = ["wrench"] * of_platform + ["drive" if pushed else "command"] + ["floor"] * in_space
    screws = any(leg.screw is not None for leg in robot.legs)  # drive_force of results is a torque there
    out = ["tool"] * of_platform + ["stroke", "force-sensor:drive" if screws else "drive-force"]
    found = linearize(
        study,
        pose,
        inputs=into if inputs is None else inputs,
        outputs=out if outputs is None else outputs,
        drives="force" if pushed else "given",
        load=load,
    )
    with scratch() as folder:
        content = found.save(folder / Path(name).name).read_bytes()
    left = ["all that is not linear about the equilibrium", "frequencies above those of the shapes"]
    left += ["[control]: the loop of a controller"] * (study.control is not None)
    return Content(files={"": content}, left_out=tuple(left))
