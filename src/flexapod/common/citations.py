"""Works that flexapod builds on, by short name."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType

from flexapod.common.errors import InputError, suggest_word


@dataclass(frozen=True, kw_only=True)
class Citation:
    """A published work."""

    authors: str
    year: int
    title: str
    source: str

    def __str__(self) -> str:
        return f"{self.authors} ({self.year}). {self.title}. {self.source}."


_WORKS = {
    "nourian-akbarzadeh": Citation(
        authors="A. Nourian, A. Akbarzadeh",
        year=2025,
        title="Study of Lateral Vibrations of a Prismatic Actuator and Its Effects on the Accuracy of the 6UPS "
        "Stewart Robot",
        source="the paper that `flexapod replicate` repeats",
    ),
    "dasgupta-mruthyunjaya": Citation(
        authors="B. Dasgupta, T. S. Mruthyunjaya",
        year=1998,
        title="A Newton-Euler formulation for the inverse dynamics of the Stewart platform manipulator",
        source="Mechanism and Machine Theory 33(8), 1135-1152",
    ),
    "dietmaier": Citation(
        authors="P. Dietmaier",
        year=1998,
        title="The Stewart-Gough platform of general geometry can have 40 real postures",
        source="Advances in Robot Kinematics: Analysis and Control, Kluwer, 7-16",
    ),
    "ma-angeles": Citation(
        authors="O. Ma, J. Angeles",
        year=1991,
        title="Architecture singularities of platform manipulators",
        source="Proc. IEEE International Conference on Robotics and Automation, 1542-1547",
    ),
    "chung-hulbert": Citation(
        authors="J. Chung, G. M. Hulbert",
        year=1993,
        title="A time integration algorithm for structural dynamics with improved numerical dissipation: the "
        "generalized-alpha method",
        source="Journal of Applied Mechanics 60(2), 371-375",
    ),
    "arnold-bruls": Citation(
        authors="M. Arnold, O. Bruls",
        year=2007,
        title="Convergence of the generalized-alpha scheme for constrained mechanical systems",
        source="Multibody System Dynamics 18(2), 185-202",
    ),
    "bruls-cardona-arnold": Citation(
        authors="O. Bruls, A. Cardona, M. Arnold",
        year=2012,
        title="Lie group generalized-alpha time integration of constrained flexible multibody systems",
        source="Mechanism and Machine Theory 48, 121-137",
    ),
    "arnold-bruls-cardona": Citation(
        authors="M. Arnold, O. Bruls, A. Cardona",
        year=2015,
        title="Error analysis of generalized-alpha Lie group time integration methods for constrained mechanical "
        "systems",
        source="Numerische Mathematik 129(1), 149-179",
    ),
    "hairer-wanner": Citation(
        authors="E. Hairer, G. Wanner",
        year=1996,
        title="Solving Ordinary Differential Equations II: Stiff and Differential-Algebraic Problems",
        source="Springer, 2nd edition",
    ),
    "casadi": Citation(
        authors="J. A. E. Andersson, J. Gillis, G. Horn, J. B. Rawlings, M. Diehl",
        year=2019,
        title="CasADi: a software framework for nonlinear optimization and optimal control",
        source="Mathematical Programming Computation 11(1), 1-36",
    ),
}
CITATIONS = MappingProxyType(_WORKS)


def cite(*names: str) -> tuple[str, ...]:
    """Works that flexapod builds on, in full.

    Parameters
    ----------
    *names : str
        Short names, keys of `CITATIONS`; none for all of them.

    Returns
    -------
    tuple of str
        Authors, year, title and source of each.

    Raises
    ------
    InputError
        If a name is not in `CITATIONS`.

    Examples
    --------
    >>> print(fx.cite("chung-hulbert")[0][:23])
    J. Chung, G. M. Hulbert
    """
    for name in names:
        if name not in CITATIONS:
            raise InputError(
                "is not a known work", key=name, allowed=", ".join(CITATIONS), next_step=suggest_word(name, CITATIONS)
            )
    return tuple(str(CITATIONS[name]) for name in names or CITATIONS)
