"""Motions of a mechanism as text, and coordinates of the platform that can be commanded, Eqs. (T14.15)-(T14.16)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import InputError
from flexapod.kinematics.leg_geometry import DRIVEN, Limbs
from flexapod.kinematics.mobility import Mobility, Posture, displaced, mobility, nearly_redundant
from flexapod.model.leg.chain import chain_of
from flexapod.model.motion import AXES, CsvMotion, Motion, WaypointMotion

PURE = 1e-6  # share of other coordinates, in units of L_c and radians, below which a motion has one name

_BASE = ("move along x", "move along y", "move along z", "turn about base x", "turn about base y", "turn about base z")
_NUMBERS = ("no", "one", "two", "three", "four", "five", "six")


def motion_names(limbs: Limbs, twists: Array, at: Posture | None = None) -> tuple[str, ...]:
    """Names of motions whose twists (6, d) are those of `Mobility.platform`, Eq. (T14.15).

    Surge to yaw where each is about the platform frame's origin, else about that of the base, whichever takes fewer
    names for one motion.
    """
    place = limbs.position if at is None else at.place
    of_platform, of_base = _names(twists, AXES), _names(_about(twists, -place / limbs.L_c), _BASE)
    return of_platform if sum(map(_mixed, of_platform)) <= sum(map(_mixed, of_base)) else of_base


def _mixed(name: str) -> bool:
    return " with " in name


def _about(twists: Array, arm: Array) -> Array:
    """Twists at a point `arm` away from theirs, in units of L_c."""
    moved = twists.copy()
    moved[:3] += np.cross(twists[3:], arm, axis=0)
    return moved


def _names(twists: Array, names: Sequence[str]) -> tuple[str, ...]:
    basis = np.linalg.qr(twists)[0]
    shares = basis @ basis.T
    pure = [k for k in range(6) if np.linalg.norm(shares[:, k] - np.eye(6)[k]) < PURE]
    rest = np.delete(np.eye(6), pure, axis=1)
    left = rest.T @ shares @ rest
    rows = np.linalg.eigh(left)[1][:, ::-1][:, : twists.shape[1] - len(pure)].T @ rest.T
    mixed = ([int(k) for k in np.argsort(-np.abs(row), kind="stable") if abs(row[k]) > PURE] for row in _reduced(rows))
    return tuple(names[k] for k in pure) + tuple(
        f"{names[first]} with {' and '.join(names[k] for k in others)}" for first, *others in mixed
    )


def _reduced(rows: Array) -> Array:
    """Rows of the same span, each with a one where the others have zeros."""
    rows = rows.copy()
    for k in range(len(rows)):
        pivot = int(np.argmax(np.abs(rows[k:]).max(axis=0)))
        best = k + int(np.argmax(np.abs(rows[k:, pivot])))
        rows[[k, best]] = rows[[best, k]]
        rows[k] /= rows[k, pivot]
        others = np.arange(len(rows)) != k
        rows[others] -= rows[others, pivot, None] * rows[k]
    return rows


def independent_axes(
    limbs: Limbs, moved: Mask, pivot: Array, named: Sequence[str] | None = None, found: Mobility | None = None
) -> Mask:
    """Platform coordinates (6,) that a motion commands, the others following from the closures, Eq. (T14.16).

    Parameters
    ----------
    limbs : Limbs
    moved : ndarray of bool, shape (6,)
        Coordinates that the motion changes.
    pivot : ndarray, shape (3,)
        About which the platform turns, platform axes [m].
    named : sequence of str, optional
        What `motion.independent` names; without it those that are moved and as many others as there are motions.
    found : Mobility, optional
        At home, where it is known.

    Raises
    ------
    InputError
        The robot cannot follow independent commands of these coordinates.
    """
    twists = (mobility(limbs) if found is None else found).platform
    rows = _about(twists, limbs.rotation @ pivot / limbs.L_c)
    asked = [k for k in range(6) if (moved[k] if named is None else AXES[k] in named)]
    if _rank(rows[asked]) < len(asked) or (named is not None and len(asked) < twists.shape[1]):
        raise _beyond(limbs, twists, asked, named)
    while len(asked) < twists.shape[1]:  # the coordinate that the ones so far say least about
        left = rows - rows @ np.linalg.pinv(rows[asked]) @ rows[asked] if asked else rows
        asked.append(int(np.argmax(np.linalg.norm(left, axis=1).round(6))))
    return np.isin(np.arange(6), asked)


def commanded_coordinates(limbs: Limbs, motion: Motion, found: Mobility) -> Mask:
    """Platform coordinates (6,) that a motion commands of a mechanism with the motions `found` at home.

    Raises
    ------
    InputError
        It asks for one that the robot does not have, or for more than it names as independent.
    """
    named = motion.independent
    if isinstance(motion, WaypointMotion | CsvMotion):
        rows = motion.poses if isinstance(motion, WaypointMotion) else motion.pose
        moved = (rows != 0).any(axis=0)
    else:
        moved = motion.target != 0
    others = [axis for k, axis in enumerate(AXES) if named is not None and moved[k] and axis not in named]
    if others and not isinstance(motion, CsvMotion):  # a table may hold what follows, too
        raise InputError(
            f"leaves {' and '.join(others)} to follow, which the motion commands",
            key="motion.independent",
            value=list(named or ()),
            next_step=f"Name {others[0]} as well, or leave it out of the motion",
        )
    return independent_axes(limbs, moved, motion.pivot, named, found)


def _rank(rows: Array) -> int:
    return int(np.sum(np.linalg.svd(rows, compute_uv=False) > PURE)) if len(rows) else 0


def _beyond(limbs: Limbs, twists: Array, asked: list[int], named: Sequence[str] | None) -> InputError:
    count, names = twists.shape[1], ", ".join(motion_names(limbs, twists))
    which, nearly = " and ".join(AXES[k] for k in asked), nearly_redundant(limbs)
    over = (
        f". It is nearly over-constrained: but for small errors of axes {_count(nearly, 'condition')} of its joints "
        "would say what others say. Make these axes exactly parallel or normal to each other"
    )
    return InputError(
        f"asks for {which} of a robot with {_count(count, 'motion')}: {names}{over if nearly else ''}",
        key="motion" if named is None else "motion.independent",
        value=which if named is None else list(named),
        allowed=f"{_count(count, 'coordinate')} that can be chosen independently of each other",
        next_step="The other coordinates follow from these; leave them out, and name the chosen ones in "
        "motion.independent",
    )


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def mobility_words(limbs: Limbs, at: Posture | None = None) -> list[str]:
    """Report on the motions of a mechanism for `check`, sentence by sentence without full stops."""
    home, near = mobility(limbs, at), [mobility(limbs, there) for there in displaced(limbs, at)]
    here = "home" if at is None else "this pose"
    count = home.platform.shape[1]
    names = ", ".join(motion_names(limbs, home.platform, at))
    words = [f"{_count(count, 'motion')}: {names}" if count else "no motion"]
    fewer = [m.platform.shape[1] for m in near if m.platform.shape[1] < count]
    if fewer:
        words.append(f"next to {here} it has {_count(min(fewer), 'motion')} only")
    more = int((limbs.state == DRIVEN).sum()) - count
    if more > 0:
        number = _NUMBERS[more] if more < len(_NUMBERS) else str(more)
        words.append(f"{number} drive{'s' * (more > 1)} more than motions: forces are shared by stiffness")
    words += _loose_words(limbs, home, near, at)
    if home.redundant:
        words.append(
            f"over-constrained: {_count(home.redundant, 'condition')} of its joints "
            f"{'says' if home.redundant == 1 else 'say'} what others say; forces there are shared by stiffness"
        )
    how: dict[str, list[int]] = {}
    for leg, what in home.internal:
        how.setdefault(what, []).append(leg)
    return words + [f"{_legs(legs)} can {what}" for what, legs in how.items()]


def _legs(legs: list[int]) -> str:
    if len(legs) == 1:
        return f"leg {legs[0]}"
    return f"legs {', '.join(map(str, legs[:-1]))} and {legs[-1]}"


def _loose_words(limbs: Limbs, home: Mobility, near: list[Mobility], at: Posture | None = None) -> list[str]:
    """Sentence on the motions that remain free with all drives locked; none where there are none."""
    loose = home.locked_platform.shape[1]
    if not loose:
        return []
    names = ", ".join(motion_names(limbs, home.locked_platform, at))
    here = f": singular at {'home' if at is None else 'this pose'}"
    only = all(m.locked_platform.shape[1] < loose for m in near)
    bends = ", but for what its welds and flexures (F) hold: on the rigid path these turn freely" * _bends(limbs)
    return [f"with all drives locked it still has {_count(loose, 'motion')}: {names}{here * only}{bends}"]


def _bends(limbs: Limbs) -> bool:
    """Test whether legs are clamped to the base or to the platform, or held by flexures."""
    return any("F" in (chain_of(chain).base, chain_of(chain).platform) for chain in limbs.chain)


def refuse_loose(limbs: Limbs) -> None:
    """Refuse a mechanism whose drives, all locked, do not hold the platform at home.

    Raises
    ------
    InputError
        Motions are left.
    """
    home = mobility(limbs)
    if home.locked_platform.shape[1]:
        near, bends = [mobility(limbs, at) for at in displaced(limbs)], _bends(limbs)
        raise InputError(
            _loose_words(limbs, home, near)[0],
            key="robot.type",
            allowed="drives that hold every motion of the platform" + " without welds and flexures" * bends,
            next_step="Drive more legs, or turn the axes of their joints"
            + ("; a path needs that. `flexapod modes` and `fx.stiffness` take the robot as it is" if bends else ""),
        )
