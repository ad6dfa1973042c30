"""Studies whose commands make up for what elastic robots do: the call for all of them."""

from __future__ import annotations

from typing import Literal, get_args, overload

from flexapod.analysis.results.arguments import FileLike, RobotLike, as_study, read
from flexapod.commissioning.feedforward.actuator_inversion import tip_inversion
from flexapod.commissioning.feedforward.command_table import check_out
from flexapod.commissioning.feedforward.compensation import compensation
from flexapod.commissioning.feedforward.elastic_path import elastic_compensation
from flexapod.common.arguments import flag
from flexapod.common.errors import InputError
from flexapod.common.resources import one_thread
from flexapod.model import ActuatorStudy, Study

__all__ = ["compensate"]

Order = Literal[0, 2, "stable-inversion"]


@overload
def compensate(
    study: ActuatorStudy,
    order: Order = ...,
    *,
    corrections: int = ...,
    as_built: bool = ...,
    drives: Literal["given", "force"] = ...,
    out: FileLike | None = ...,
) -> ActuatorStudy: ...
@overload
def compensate(
    study: RobotLike,
    order: Order = ...,
    *,
    corrections: int = ...,
    as_built: bool = ...,
    drives: Literal["given", "force"] = ...,
    out: FileLike | None = ...,
) -> Study: ...
@one_thread()
def compensate(
    study: RobotLike | ActuatorStudy,
    order: Order = 0,
    *,
    corrections: int = 2,
    as_built: bool = True,
    drives: Literal["given", "force"] = "given",
    out: FileLike | None = None,
) -> Study | ActuatorStudy:
    """A study whose motion brings the loaded tool onto the path of this study's motion.

    Corrections are of the pose: of all six coordinates, of a robot with fewer motions of those that are commanded.

    Parameters
    ----------
    study : Study, ActuatorStudy or path
    order : 0, 2 or "stable-inversion"
        0: what gravity, load and forces of drives do at rest at each pose. 2: and the inertia of the path's
        accelerations, as it bends a robot that follows them without vibrating. "stable-inversion": and the motion of
        its modes, by commands that begin before the path and end after it; of a single actuator so that its tip does
        what that of a rigid beam would.
    corrections : int
        How often the robot is looked at again where it then stands: one leaves 1e-4 of the miss, two 1e-8.
    as_built : bool
        Whether `geometry` and `heat` of the study are made up for, too.
    drives : {"given", "force"}
        Of a single actuator: the motion of its hub, or the torque on it.
    out : path, optional
        ``NAME.toml``, written with ``NAME.csv`` beside it.

    Returns
    -------
    Study or ActuatorStudy
        Its motion is a table of poses; its `notes` say what it brings. Results of it give deviations from the commanded
        path: ``tool_position`` less the ``tool_position_rigid`` of the study before is the miss.

    Raises
    ------
    InputError
        The path or the commanded one leaves the workspace; a load or a profile that jumps; drives that are a force.
    ComputationError
        There is no equilibrium at an instant.

    Examples
    --------
    >>> ahead = fx.compensate(fx.preset("machine-hexapod"))
    >>> ahead.motion.type
    'csv'
    >>> print(ahead.notes[0])
    commands make up for what weight and load do ...: the tool misses the wanted path by ... in place of 20.4 µm, ...
    """
    subject = read(study)
    if not isinstance(order, str | int) or isinstance(order, bool) or order not in get_args(Order):
        raise InputError("is not known", key="order", value=order, allowed='0, 2, "stable-inversion"')
    if not isinstance(subject, Study | ActuatorStudy):
        subject = as_study(subject)
    if out is not None:
        check_out(subject, out)
    flag(as_built, "as_built")
    if isinstance(subject, ActuatorStudy):
        _refuse_of_robots(order, corrections, as_built)
        return tip_inversion(subject, drives, out).study
    if not isinstance(drives, str) or drives != "given":
        raise InputError("is for single actuators", key="drives", value=drives, allowed='"given" of robots')
    settings = {"corrections": corrections, "as_built": as_built, "out": out}
    if order == "stable-inversion":
        return elastic_compensation(subject, **settings).study
    return compensation(subject, order, **settings).study


def _refuse_of_robots(order: Order, corrections: int, as_built: bool) -> None:
    """Refuse what a single actuator has none of."""
    for key, value, usual in (("corrections", corrections, 2), ("as_built", as_built, True)):
        if value != usual:
            raise InputError("is for robots", key=key, value=value, allowed=f"{usual}, of a single actuator")
    if order != "stable-inversion":
        raise InputError("is not known of a single actuator", key="order", value=order, allowed='"stable-inversion"')
