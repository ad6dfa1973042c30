"""Colours of legs and axes, the same in figures, on the page and in reports; they load without matplotlib."""

from __future__ import annotations

__all__ = ["AXIS_COLORS", "LEG_COLORS"]

#: Okabe & Ito's palette, in an order whose neighbours also differ in lightness.
LEG_COLORS = ("#0072B2", "#E69F00", "#009E73", "#D55E00", "#56B4E9", "#A23B72")
AXIS_COLORS = {"x": "#7A5195", "y": "#0072B2", "z": "#D55E00"}
