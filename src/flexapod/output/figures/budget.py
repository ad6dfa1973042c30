"""The error budget as a chart: how much each part adds, and in which legs."""

from __future__ import annotations

from textwrap import wrap

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from flexapod.analysis.error_budget.text import Bar, bars
from flexapod.common.arrays import Array
from flexapod.common.quantities import scale
from flexapod.output.figures.style import NOTE, PAGE, SMALL, TEXT, figure, house_style, require_variables
from flexapod.output.scene.style import ERRORS


@house_style
@require_variables("budget", "share")
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
    rows = bars(data)
    fig = figure(PAGE, 1.9 + 0.25 * max(len(rows), 3))
    fig.suptitle("\n".join(wrap(data.attrs["summary"].splitlines()[0], 105)), x=0.01, ha="left", fontsize=TEXT)
    if not rows:
        return fig
    left, right = fig.subplots(1, 2, width_ratios=(2.6, 1), sharey=True)
    used = _bars(left, rows)
    _legs(
        right,
        np.array([_by_leg(data, row.at) for row in rows if row.at is not None]).reshape(-1, data.sizes["leg"]),
        data.leg.values,
    )
    left.set_ylim(len(rows) - 0.5, -0.5)
    handles = [Patch(color=color, label=words) for kind, (words, color) in ERRORS.items() if kind in used]
    fig.legend(handles=handles, loc="outside lower center", ncols=min(3, max(1, len(handles))))
    return fig


def _bars(axes: Axes, rows: list[Bar]) -> set[str]:
    small, used = scale([sum(row.sizes.values()) for row in rows], "m"), set()
    for place, row in enumerate(rows):
        start = 0.0
        for name, (_, color) in ERRORS.items():
            if name in row.sizes:
                size = float(small(row.sizes[name]))
                axes.barh(place, size, left=start, color=color, height=0.72)
                start, used = start + size, used | {name}
        axes.annotate(
            row.share_words, (start, place), xytext=(4, 0), textcoords="offset points", va="center", fontsize=NOTE,
            weight="bold",
        )  # fmt: skip
    axes.set_yticks(range(len(rows)), [row.words for row in rows])
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
