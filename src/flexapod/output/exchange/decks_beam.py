"""A solid beam with one end clamped as a deck: frequencies, or its release from a bent shape."""

from __future__ import annotations

import numpy as np

from flexapod.output.exchange.decks import Deck, Numbers, number
from flexapod.solve.fem.mesh import SolidMesh

#: The element of both programs for a kind of ours; R: integrated at 2 x 2 x 2 points.
ELEMENTS = {
    ("hex8", False): "C3D8",
    ("hex8r", False): "C3D8R",
    ("hex8i", False): "C3D8I",
    ("hex20", False): "C3D20",
    ("hex20", True): "C3D20R",
}


def clamped_frequencies(mesh: SolidMesh, *, E: float, density: float, poisson: float, reduced: bool) -> str:
    """Deck for the lowest six frequencies of a solid whose end x = 0 is clamped at all nodes.

    `mesh` is of the whole section; `E` [Pa], `density` [kg/m^3]; `reduced`: reduced integration, of quadratic elements.
    """
    deck, _ = _clamped(mesh, E, density, poisson, reduced)
    deck.write("*STEP", "*FREQUENCY", "6", "*END STEP")
    return deck.text


def clamped_release(mesh: SolidMesh, *, E: float, density: float, force: float, duration: float, step: float) -> str:
    """Deck for the static shape under a `force` [N] along y on the end, then free vibration from rest.

    The force is shared by the nodes of the end face alike, which at Poisson's ratio 0 only moves it within the section.
    The average acceleration method (ALPHA = 0) keeps the energy. Displacements of set TIP are printed at every step.
    `duration`, `step` [s].
    """
    deck, tip = _clamped(mesh, E, density, 0.0, False)
    share = [f"{node}, 2, {number(force / len(tip))}" for node in tip]
    deck.write("*STEP", "*STATIC", "*CLOAD", *share, "*NODE PRINT, NSET=TIP", "U")
    deck.write("*EL PRINT, ELSET=BODY, TOTALS=ONLY", "ELSE", "*END STEP")  # CalculiX wants the energy from the start
    deck.write(
        f"*STEP, INC={2 * round(duration / step)}", "*DYNAMIC, DIRECT, ALPHA=0.", f"{number(step)}, {number(duration)}"
    )
    deck.write("*CLOAD, OP=NEW", *(f"{node}, 2, 0." for node in tip), "*NODE PRINT, NSET=TIP", "U", "*END STEP")
    return deck.text


def _clamped(mesh: SolidMesh, E: float, density: float, poisson: float, reduced: bool) -> tuple[Deck, Numbers]:
    """The beam without steps, and the nodes at its end."""
    deck = Deck("Clamped beam")
    deck.say("Written by flexapod. Units: m, kg, s, N, Pa, Hz. Along x, clamped at x = 0.")
    nodes = deck.nodes(mesh.nodes, "BEAM")
    deck.elements(ELEMENTS[mesh.kind, reduced], nodes[mesh.elements.astype(np.int64)], "BODY")
    deck.solid("BODY", E=E, density=density, poisson=poisson)
    deck.fixed(nodes[mesh.plane(0).astype(np.int64)])
    tip = nodes[mesh.plane(1).astype(np.int64)]
    deck.nset("TIP", tip)
    return deck, tip
