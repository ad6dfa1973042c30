"""Linear systems over frequency: responses by named channels, transmissibility, cumulative rms, vibration.

The rms of the tool's random vibration is of all above each frequency; its steps are named by mode.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MultipleLocator, NullFormatter
from numpy.typing import NDArray

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError, names_of
from flexapod.common.quantities import scale
from flexapod.common.ranking import descending_order
from flexapod.control.datasets import channel_units, join_complex, response_unit, significant_pairs
from flexapod.control.state_space import Names, channel_indices
from flexapod.output.figures.style import LINE_STYLES, NOTE, PAGE, figure, house_style, require_variables
from flexapod.output.scene.style import AXIS_COLORS, colors_of_legs

Several = xr.Dataset | Mapping[str, xr.Dataset]
MOST = 12  # curves that a reader tells apart
WIDTHS = (3.2, 1.3, 1.3)  # of lines: the second often lies upon the first
FLOOR = 1e-12  # of the largest: what is smaller is rounding


@house_style
@require_variables("frequency_response")
def bode(data: Several, inputs: Names = None, outputs: Names = None) -> Figure:
    """Size and phase of responses over frequency, a colour for each pair of channels, a stroke for each result.

    Parameters
    ----------
    data : xarray.Dataset or mapping of these
        From `.frequency_response` or `flexapod.read_frf`; several under the words that the legend shows.
    inputs, outputs : names, optional
        Channels (``drive:1``) and groups (``drive``) to show; by itself all.
    """
    results = _named(data)
    _check_frequencies(results)
    pairs, zero = _moved(results, _pairs(results, inputs, outputs))
    strokes = [name for name in results if any(_there(results[name], *pair) for pair in pairs)]
    fig = figure(PAGE, 5.0)
    size, phase = fig.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    by_result = len(pairs) == 1  # then results have the colours
    colors = colors_of_legs(len(strokes) if by_result else len(pairs))
    for (i, pair), (k, name) in product(enumerate(pairs), enumerate(strokes)):
        if not _there(results[name], *pair):
            continue
        f, values = _curve(results[name], *pair)
        words = " by ".join(pair) if len(results) == 1 else name if by_result else f"{' by '.join(pair)}, {name}"
        kind = {"color": colors[k if by_result else i], "linestyle": LINE_STYLES[k % len(LINE_STYLES)], "label": words}
        size.plot(f, np.where(np.abs(values) > 0, np.abs(values), np.nan), **kind)
        phase.plot(f, _angles(values), **kind)
    size.set_yscale("log")
    title = " by ".join(pairs[0]) if len(pairs) == 1 else "Response of outputs to inputs"
    size.set_title(title + (f", without {zero} that are zero but for rounding" if zero else ""))
    size.set_ylabel(_unit_words(results, pairs))
    phase.set_ylabel("phase [deg]")
    phase.set_ylim(-185, 185)
    phase.yaxis.set_major_locator(MultipleLocator(90))
    _over_frequency(phase)
    if len(pairs) * len(strokes) > 1:
        size.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    fig.align_ylabels([size, phase])
    return fig


@house_style
def transmissibility(data: Several) -> Figure:
    """Norm of transmissibility or compliance over frequency, and each axis by itself.

    Parameters
    ----------
    data : xarray.Dataset or mapping of these
        From `flexapod.transmissibility` or `flexapod.compliance`; several under the words that the legend shows.
    """
    results = _named(data) if isinstance(data, Mapping) else {}
    known = [getattr(one, "data_vars", ()) for one in results.values()]
    name = next((n for n in ("transmissibility", "compliance") if all(n in one for one in known)), None)
    if name is None or not results:
        raise InputError(
            "cannot be drawn", key="transmissibility", allowed="results of flexapod.transmissibility, or of compliance"
        )
    _check_frequencies(results)
    fig = figure(PAGE, 5.4)
    panels = fig.subplots(2, 1, sharex=True)
    units = {"transmissibility": ("1", "1"), "compliance": ("m/N", "rad/(N m)")}[name]
    words = (f"{name}, along axes", f"{name}, about axes")
    for k, (label, one) in enumerate(results.items()):
        values = np.abs(join_complex(one[name]).transpose("frequency", "output", "input").values)
        style = LINE_STYLES[k % len(LINE_STYLES)]
        own = "" if len(results) == 1 else f", {label}"
        for panel, at in zip(panels, (slice(0, 3), slice(3, 6)), strict=True):
            for j, (axis, color) in enumerate(AXIS_COLORS.items()):
                direct = values[:, at, at][:, j, j]
                panel.plot(one.frequency, direct, color=color, linestyle=style, linewidth=WIDTHS[j], label=axis + own)
            norm = np.sqrt((values[:, at, at] ** 2).sum(axis=(1, 2)))
            panel.plot(one.frequency, norm, color="black", linestyle=style, linewidth=1.8, label=f"norm{own}", zorder=1)
    for panel, unit, title in zip(panels, units, words, strict=True):
        panel.set_yscale("log")
        panel.set_ylabel(f"size [{unit}]" if unit != "1" else "size")
        panel.set_title(title[0].upper() + title[1:])
        panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    _over_frequency(panels[-1])
    fig.align_ylabels(panels)
    return fig


@house_style
@require_variables("cumulative_rms", "psd")
def cumulative(data: Several, outputs: Names = None) -> Figure:
    """Rms of what is at each frequency and above, a panel for each unit.

    Parameters
    ----------
    data : xarray.Dataset or mapping of these
        From `.psd`; several under the words that the legend shows.
    outputs : names, optional
    """
    results = _named(data)
    first = next(iter(results.values()))
    shared = [x for x in first.output.values.tolist() if all(x in one.output.values for one in results.values())]
    names = [shared[i] for i in channel_indices(outputs, shared, "outputs")]
    if not names:
        raise InputError("are in none of the results, or not in all", key="outputs", value=outputs)
    unit_of = channel_units(first, "output")
    units = list(dict.fromkeys(unit_of[name] for name in names))
    fig = figure(PAGE, 1.2 + 2.1 * len(units))
    panels = np.atleast_1d(fig.subplots(len(units), 1, sharex=True))
    for panel, unit in zip(panels, units, strict=True):
        shown = [name for name in names if unit_of[name] == unit]
        colors = colors_of_legs(len(shown))
        small = scale(
            np.concatenate([one.cumulative_rms.sel(output=shown).values.ravel() for one in results.values()]), unit
        )
        for (i, name), (k, (label, one)) in product(enumerate(shown), enumerate(results.items())):
            words = name if len(results) == 1 else f"{name}, {label}"
            values = small(one.cumulative_rms.sel(output=name).values)
            kind = {"linestyle": LINE_STYLES[k % len(LINE_STYLES)], "linewidth": WIDTHS[min(i, 2)], "label": words}
            panel.plot(one.spectrum_frequency, values, color=colors[i], **kind)
        panel.set_ylim(bottom=0)
        panel.set_ylabel(f"rms from here up [{small.name}]")
        panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    panels[0].set_title("Random vibration: what each frequency adds")
    _over_frequency(panels[-1])
    fig.align_ylabels(panels)
    return fig


def _named(data: Several) -> Mapping[str, xr.Dataset]:
    """Results by words; a single one has none."""
    return {"": data} if isinstance(data, xr.Dataset) else data


def _check_frequencies(results: Mapping[str, xr.Dataset]) -> None:
    """Refuse what has no place on an axis of logarithms."""
    if not any((one.frequency > 0).any() for one in results.values()):
        raise InputError("has no frequency above 0 Hz", key="frequency", allowed="one at least")


def _pairs(results: Mapping[str, xr.Dataset], inputs: Names, outputs: Names) -> list[tuple[str, str]]:
    """Pairs of output and input that some result has, in the order of the first."""
    found: dict[tuple[str, str], None] = {}
    for one in results.values():
        names = {key: one[key].values.tolist() for key in ("output", "input")}
        with_names = len(results) == 1
        out = list(_some(outputs, names["output"], "outputs", with_names))
        into = list(_some(inputs, names["input"], "inputs", with_names))
        found |= dict.fromkeys((o, i) for o in out for i in into)
    if not found:
        raise InputError("are in none of the results", key="outputs, inputs", value=f"{outputs}, {inputs}")
    return list(found)


def _moved(results: Mapping[str, xr.Dataset], pairs: list[tuple[str, str]]) -> tuple[list[tuple[str, str]], int]:
    """Pairs that are more than rounding beside outputs alike by the same input, and how many are not."""
    sizes = {pair: max(_largest(data, *pair) for data in results.values()) for pair in pairs}
    units = {name: unit for data in results.values() for name, unit in channel_units(data, "output").items()}
    kept = significant_pairs(sizes, units)
    if not any(sizes[pair] > 0 for pair in kept):
        raise InputError(
            "are 0 at all frequencies, which an axis of logarithms does not have, or not known",
            key="outputs, inputs",
            value=", ".join(" by ".join(pair) for pair in pairs[:3]),
            allowed="channels with a response",
        )
    if len(kept) > MOST:
        raise InputError(
            f"are {len(kept)} pairs of channels", key="outputs, inputs", allowed=f"{MOST} curves in a figure",
            next_step='Choose some, for example outputs="tool:z", inputs="wrench"',
        )  # fmt: skip
    return kept, len(pairs) - len(kept)


def _largest(data: xr.Dataset, output: str, input: str) -> float:
    return float(np.abs(_curve(data, output, input)[1]).max(initial=0.0)) if _there(data, output, input) else 0.0


def _some(given: Names, among: Sequence[str], key: str, must: bool) -> Iterator[str]:
    for name in [None] if given is None else names_of(given, key):
        try:
            yield from (among[i] for i in channel_indices(name, among, key))
        except InputError:
            if must:
                raise


def _there(data: xr.Dataset, output: str, input: str) -> bool:
    return output in data.output.values and input in data.input.values


def _curve(data: xr.Dataset, output: str, input: str) -> tuple[Array, NDArray[np.complex128]]:
    values = join_complex(data.frequency_response.sel(output=output, input=input)).values
    return data.frequency.values, values


def _angles(values: NDArray[np.complex128]) -> Array:
    """Phases [deg] from -180 to 180, lines cut where they jump; none of what is nothing."""
    angle = np.degrees(np.angle(values))
    jumps = np.flatnonzero(np.abs(np.diff(angle)) > 180) + 1
    angle[jumps] = np.nan
    angle[np.abs(values) <= FLOOR * np.abs(values).max(initial=0.0)] = np.nan
    return angle


def _unit_words(results: Mapping[str, xr.Dataset], pairs: list[tuple[str, str]]) -> str:
    """Name of the vertical axis: the unit that all pairs share, or that they are in SI units."""
    units = set()
    for one, (output, input) in product(results.values(), pairs):
        if _there(one, output, input):
            units.add(
                response_unit(one.output_units.sel(output=output).item(), one.input_units.sel(input=input).item())
            )
    return f"size [{units.pop()}]" if len(units) == 1 else "size [SI units of the channels]"


def _over_frequency(axes: Axes) -> None:
    axes.set_xscale("log")
    axes.set_xlabel("frequency [Hz]")
    axes.xaxis.set_major_locator(LogLocator(numticks=12))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.tick_params(labelsize=NOTE)


NAMED = 3  # modes with the largest steps
ROW = 10  # height of a name [points]
LEAST = 0.05  # share of a mode in the variance that is worth a name
ROUNDING = 1e-9  # of the largest, a radian as a metre: what symmetry makes zero comes out at 1e-13 and less
DECADES = 1e4  # from the lowest to the highest frequency, from which on each has one number


@house_style
@require_variables("vibration_cumulative", "vibration_by_mode")
def vibration(data: xr.Dataset) -> Figure:
    """Cumulative rms of the tool along and about the axes over frequency.

    Each curve starts at the whole rms and falls by what each frequency adds; modes with the largest steps are named.

    Parameters
    ----------
    data : xarray.Dataset
        From `flexapod.vibration`.
    """
    fig = figure(PAGE, 5.2)
    panels = fig.subplots(2, 1, sharex=True)
    for axes, names, unit, title in zip(
        panels, (("x", "y", "z"), ("rx", "ry", "rz")), ("m", "rad"),
        ("displacement of the tool", "rotation of the tool"), strict=True,
    ):  # fmt: skip
        part = data.vibration_cumulative.sel(component=list(names))
        moves = bool(part.max() >= ROUNDING * data.vibration_cumulative.max())
        part = part if moves else 0 * part
        small = scale(part, unit)
        for name, color, width in zip(names, AXIS_COLORS.values(), (3.2, 1.3, 1.3), strict=True):
            values = small(part.sel(component=name))  # x broad: y often lies upon it
            axes.plot(data.spectrum_frequency.values, values, color=color, linewidth=width, label=name)
        axes.set_xscale("log")
        axes.set_ylim(bottom=0)
        axes.set_ylabel(f"rms from here up [{small.name}]")
        words = title[0].upper() + title[1:] + ("" if moves else ", zero but for rounding")
        axes.set_title(words, pad=4 + ROW * NAMED)
        if moves:
            _name_modes(axes, data, list(names))
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    panels[-1].set_xlabel("frequency [Hz]")
    f = data.spectrum_frequency.values
    panels[-1].xaxis.set_major_locator(LogLocator(subs=(1, 2, 5) if f[-1] < DECADES * f[0] else (1,)))
    panels[-1].xaxis.set_major_formatter("{x:g}")
    panels[-1].xaxis.set_minor_formatter(NullFormatter())
    fig.align_ylabels(panels)
    return fig


def _name_modes(axes: Axes, data: xr.Dataset, names: list[str]) -> None:
    """Lines at the modes that take the largest shares of the variance; those of one frequency once."""
    part = (data.vibration_by_mode * data.vibration_rms).sel(component=names).sum("component").values
    whole = float((data.vibration_rms.sel(component=names) ** 2).sum())
    if not whole > 0:
        return
    f = data.frequency.values
    groups = np.cumsum(np.append(0, np.diff(f) > 1e-3 * f[1:]))
    sizes = np.bincount(groups, weights=part)
    named = [group for group in descending_order(np.asarray(sizes, float))[:NAMED] if sizes[group] > LEAST * whole]
    for row, group in enumerate(sorted(named, reverse=True)):
        at = np.flatnonzero(groups == group)
        axes.axvline(f[at[0]], color="#777777", linewidth=0.8, linestyle=":")
        number = ("modes " if at.size > 1 else "mode ") + ", ".join(str(k + 1) for k in at)
        axes.annotate(
            f"{number}: {f[at[0]]:.3g} Hz", (f[at[0]], 1.0), xycoords=("data", "axes fraction"),
            xytext=(0, 2 + ROW * row), textcoords="offset points", ha="center", fontsize=NOTE,
        )  # fmt: skip
