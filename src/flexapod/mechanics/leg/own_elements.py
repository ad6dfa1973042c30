"""Check of external elements' energies and forces before code is made of them: which have no equations of motion.

What fails here would fail later in casadi or in the compiler, without a name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from flexapod.common.arrays import Array
from flexapod.mechanics.elements.frames import Energies
from flexapod.mechanics.elements.slot import Slot
from flexapod.mechanics.elements.trial import hook_error
from flexapod.mechanics.symbolic.c_functions import without_text
from flexapod.mechanics.symbolic.functions import Interpreted, NamedFunction
from flexapod.mechanics.symbolic.vocabulary import (
    SX,
    depends_on,
    gradient,
    hessian,
    jacobian,
    substitute,
    vertcat,
    zeros,
)

PARTS = ("kinetic", "gravity", "strain", "dissipation")
TRIALS, LEFT = 5, 1e-9  # random states; share of a force that counts as none
BEGUN, JUMPS = 1e-9, 1e-2  # share of the rates, and of the force at these that it may have there: roots have 3e-5

Variables = Sequence[tuple[str, SX]]  # q, v and p


def refuse_unfit(slot: Slot, e: Energies, forces: Mapping[str, SX], variables: Variables) -> None:
    """Refuse what has no equations of motion: energies of an element, and damping forces on coordinates by name.

    Raises
    ------
    InputError
        With class, hook and file.
    """
    kind, (q, v, _) = slot.kind, (symbols for _, symbols in variables)
    for part in PARTS:
        if SX(getattr(e, part)).numel() != 1:
            raise hook_error(kind, "energy", f"gives a {part} energy that is not one number", value=getattr(e, part))
    for part in ("gravity", "strain"):
        if depends_on(SX(getattr(e, part)), v):
            words = f"gives a {part} energy that depends on rates"
            raise hook_error(
                kind, "energy", words, allowed="coordinates; what brakes is a dissipation or a damping_force"
            )
    if depends_on(hessian(SX(e.kinetic), v), v):
        raise hook_error(kind, "energy", "gives a kinetic energy that is not quadratic in the rates")
    made = NamedFunction("element", variables, list(_with_derivatives(e, forces, q, v)))
    if missing := without_text(made.build()):
        raise hook_error(
            kind, "energy", f"uses what has no C text: {', '.join(missing)}",
            allowed="functions of flexapod.mechanics.symbolic.vocabulary and .elementary",
        )  # fmt: skip
    _refuse_at_rest(slot, e, forces, variables)


def _with_derivatives(e: Energies, forces: Mapping[str, SX], q: SX, v: SX) -> Iterator[tuple[str, SX]]:
    """Parts of the energies and damping forces by name, with the derivatives that the equations have."""
    for part in PARTS:
        value = SX(getattr(e, part))
        yield part, vertcat(value, *(gradient(value, x) for x in (q, v)), _column(hessian(value, q)))
        yield f"{part}_rates", _column(hessian(value, v))
    for name, force in forces.items():
        yield name, vertcat(SX(force), _column(jacobian(SX(force), v)))


def _column(matrix: SX) -> SX:
    return matrix.reshape((matrix.numel(), 1))


def _refuse_at_rest(slot: Slot, e: Energies, forces: Mapping[str, SX], variables: Variables) -> None:
    """Refuse what damps at rest, by numbers at states taken at random; where they are none nothing is said here."""
    v = dict(variables)["v"]
    still = zeros(v.numel())
    parts = {"energy": gradient(SX(e.dissipation), v)} | dict.fromkeys(forces and ("damping_force",), _all(forces))
    for hook, force in parts.items():
        if not depends_on(force, v) and not force.nnz():
            continue
        rates = (("rest", still), ("begun", BEGUN * v), ("moving", v))
        outputs = [(name, substitute(force, (v,), (rate,))) for name, rate in rates]
        trial = Interpreted(NamedFunction("rest", variables, outputs))
        for at in range(TRIALS):
            rng = np.random.default_rng(at)
            rest, begun, moving = trial(*(rng.uniform(0.2, 1.0, x.numel()) for _, x in variables))
            rest, begun, moving = (float(np.abs(np.nan_to_num(x)).max()) for x in (rest, begun, moving))
            if rest > LEFT * moving:
                raise hook_error(
                    slot.kind, hook, "has a force at rest, too", value=rest, allowed="what is 0 while all rates are 0",
                    next_step="Say a force at rest by a strain energy",
                )  # fmt: skip
            if begun > JUMPS * moving:
                raise hook_error(
                    slot.kind, hook, "jumps where a rate changes its sign", value=begun,
                    allowed="what grows from 0 with the rates", next_step="Say friction by `ways` and `slides`",
                )  # fmt: skip


def _all(forces: Mapping[str, SX]) -> SX:
    return vertcat(*map(SX, forces.values()))


def parts_without_number(
    e: Energies, forces: Mapping[str, SX], variables: Variables, values: Sequence[Array]
) -> list[str]:
    """Parts of an element, derivatives included, that are no finite number for values of `variables`."""
    q, v = (symbols for _, symbols in variables[:2])
    outputs = list(_with_derivatives(e, forces, q, v))
    found = Interpreted(NamedFunction("element", variables, outputs))(*values)
    names = [name.removesuffix("_rates") for name, _ in outputs]
    return list(dict.fromkeys(name for name, x in zip(names, found, strict=True) if not np.isfinite(x).all()))
