"""The error budget as a chart: how much each part adds, and in which legs."""

from __future__ import annotations

from textwrap import wrap

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from flexapod.plot.style import NOTE, PAGE, SMALL, TEXT, figure, needs, styled
from flexapod.study.budgets.words import part_words
from flexapod.study.words import scale
from flexapod.typing import Array

__all__ = ["budget"]

_SMALLEST = 0.005  # share below which parts go into one bar
_COLORS = {
    "calibratable": "#56B4E9",
    "repeatable": "#0072B2",
    "drifting": "#D55E00",
    "hysteretic": "#CC79A7",
    "random": "#8C8C8C",
    "dynamic": "#009E73",
}
_WORDS = {
    "calibratable": "systematic: calibration takes it out",
    "repeatable": "systematic: by load, repeatable",
    "drifting": "systematic: drifts with heat",
    "hysteretic": "play (bound)",
    "random": "random: tolerances, noise (3 sigma)",
    "dynamic": "dynamic (peak)",
}


@styled
@needs("budget", "share")
def budget(data: xr.Dataset) -> Figure:
    """Shares of the parts in the error of the tool's place, largest first, and of the legs in each part.

    Bars: sizes of a part's error of each kind, beside each other; they need not add up to the whole, as errors make up
    for each other and random ones add as squares. Squares: the sizes of the legs' shares in a part, dark where they are
    large.

    Parameters
    ----------
    data : xarray.Dataset
        From `flexapod.budget`.
    """
    order = np.argsort(-data.share.values, kind="stable")
    few = int((data.share.values >= _SMALLEST).sum())
    few += few == len(order) - 1  # a single smaller part has its name
    shown, rest = [int(i) for i in order[:few]], [int(i) for i in order[few:]]
    bars = [(part_words(str(data.part.values[i])), _sizes(data, [i]), float(data.share[i])) for i in shown]
    if rest:
        bars.append((f"{len(rest)} smaller parts", _sizes(data, rest), float(data.share[rest].sum())))
    fig = figure(PAGE, 1.9 + 0.25 * max(len(bars), 3))
    fig.suptitle("\n".join(wrap(data.attrs["summary"].splitlines()[0], 105)), x=0.01, ha="left", fontsize=TEXT)
    if not bars:
        return fig
    left, right = fig.subplots(1, 2, width_ratios=(2.6, 1), sharey=True)
    used = _bars(left, bars)
    _legs(right, np.array([_by_leg(data, i) for i in shown]).reshape(-1, data.sizes["leg"]), data.leg.values)
    left.set_ylim(len(bars) - 0.5, -0.5)
    handles = [Patch(color=_COLORS[kind], label=_WORDS[kind]) for kind in _COLORS if kind in used]
    fig.legend(handles=handles, loc="outside lower center", ncols=min(3, max(1, len(handles))))
    return fig


def _sizes(data: xr.Dataset, chosen: list[int]) -> dict[str, float]:
    """Sizes [m] of the error of the tool's place by kind, of systematic ones by nature."""
    found: dict[str, float] = {}
    for i in chosen:
        for kind in map(str, data.kind.values):
            if kind == "dynamic_rms":
                continue
            size = float(np.linalg.norm(data.budget.values[i, list(data.kind.values).index(kind), :3]))
            name = str(data.nature.values[i]) or "repeatable" if kind == "systematic" else kind.removesuffix("_peak")
            found[name] = found.get(name, 0.0) + (3 if kind == "random" else 1) * size
    return {name: size for name, size in found.items() if size > 0}


def _bars(axes: Axes, bars: list[tuple[str, dict[str, float], float]]) -> set[str]:
    small, used = scale([sum(sizes.values()) for _, sizes, _ in bars], "m"), set()
    for row, (_, sizes, share) in enumerate(bars):
        start = 0.0
        for name in _COLORS:
            if name in sizes:
                size = float(small(sizes[name]))
                axes.barh(row, size, left=start, color=_COLORS[name], height=0.72)
                start, used = start + size, used | {name}
        label = f"{100 * share:.0f} %" if share >= _SMALLEST else "< 1 %"
        axes.annotate(
            label, (start, row), xytext=(4, 0), textcoords="offset points", va="center", fontsize=NOTE, weight="bold"
        )
    axes.set_yticks(range(len(bars)), [words for words, _, _ in bars])
    axes.grid(axis="y", visible=False)
    axes.margins(x=0.12)
    axes.set_xlabel(f"error of the tool's place [{small.name}]")
    axes.set_title("By part")
    return used


def _by_leg(data: xr.Dataset, i: int) -> Array:
    """Share (legs,) of the legs in the sizes of a part's errors of all kinds."""
    kinds = [k for k, kind in enumerate(map(str, data.kind.values)) if kind != "dynamic_rms"]
    sizes = np.linalg.norm(data.budget_by_leg.values[i][kinds, :, :3], axis=-1).sum(axis=0)
    return np.divide(sizes, sizes.sum(), out=np.full_like(sizes, np.nan), where=sizes.sum() > 0)


def _legs(axes: Axes, shares: Array, legs: Array) -> None:
    axes.imshow(shares, cmap="Blues", vmin=0, vmax=max(0.5, float(np.nanmax(shares, initial=0.0))), aspect="auto")
    for row, column in np.ndindex(shares.shape):
        value = shares[row, column]
        if np.isfinite(value):
            ink = "white" if value > 0.3 else "#222222"
            axes.text(column, row, f"{100 * value:.0f}", ha="center", va="center", fontsize=SMALL, color=ink)
    axes.set_xticks(range(len(legs)), [str(leg) for leg in legs])
    axes.tick_params(left=False, labelleft=False)
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    axes.set_xlabel("leg")
    axes.set_title("By leg [%]")
