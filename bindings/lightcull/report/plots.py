"""The plot of error against time."""

from __future__ import annotations

import io
import re
from typing import TYPE_CHECKING, Any

import numpy as np

from .figures import ComparisonFigures

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INK, FAINT = "#1c1f24", "#9aa1ab"
KNOWN_COLORS = {
    "culled": "#c8102e",
    "light_bvh": "#1f6fb4",
    "uniform": "#6b7280",
    "power": "#b7791f",
    "paper": "#7b3fa0",
    "exhaustive": "#1b8a5a",
    "clamped": "#0f8b8d",
}
_LONGEST_LABEL = 25
"""Of a curve, in characters."""
OTHER_COLORS = ("#d35c94", "#5d6b1f", "#e07a1f", "#3b3f8f", "#8a5a44")


def sampler_colors(names: list[str]) -> dict[str, str]:
    """A colour for each sampler, the same in every report for the well-known ones."""
    spare = [color for name, color in KNOWN_COLORS.items() if name not in names]
    others = iter([*OTHER_COLORS, *spare] * (1 + len(names)))
    return {name: KNOWN_COLORS.get(name) or next(others) for name in names}


def error_against_time(figures: ComparisonFigures) -> Figure:
    """Log-log, a curve for each sampler with a band of its 95 % intervals, a 1/t guide, and the noise
    of the reference itself.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 4.6), layout="constrained")
    axes = figure.subplots()
    axes.set(xscale="log", yscale="log", xlabel="seconds", ylabel="relMSE")
    colors = sampler_colors(list(figures.samplers))
    ends = {}
    for name, run in figures.samplers.items():
        points = [p for p in run.error_curve if p.seconds > 0 and p.relmse and p.relmse > 0]
        if points:
            seconds, errors = np.array([(p.seconds, p.relmse) for p in points]).T
            axes.plot(seconds, errors, color=colors[name], linewidth=2, marker="o", markersize=3.5)
            ends[name] = (seconds[-1], errors[-1])
    _style(axes)
    if ends:
        limits = axes.get_ylim()  # of the curves: a wide band must not press them together
        _draw_bands(axes, figures, colors, limits)
        axes.set_ylim(limits)
        _draw_guides(axes, figures.reference.relmse_of_itself)
        _label_ends(axes, ends, colors)
    return figure


def to_svg(figure: Figure) -> str:
    """The figure as an <svg> element to be put into HTML."""
    import matplotlib

    stream = io.StringIO()
    nothing = {"Date": None, "Creator": None, "Format": None, "Type": None}
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": "lightcull"}):
        figure.savefig(stream, format="svg", transparent=True, metadata=nothing)
    text = stream.getvalue()
    # HTML needs neither the prologue nor the namespaces, and a page free of addresses is easily
    # seen to load nothing.
    return re.sub(r'\sxmlns(:\w+)?="[^"]*"', "", text[text.index("<svg") :])


def _style(axes: Any) -> None:
    from matplotlib.ticker import FuncFormatter

    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color(FAINT)
    axes.tick_params(which="both", color=FAINT, labelcolor=INK)
    axes.grid(which="major", color="#e6e8eb", linewidth=0.8)
    axes.set_axisbelow(True)
    plain = FuncFormatter(lambda value, _: f"{value:g}")
    axes.xaxis.set_major_formatter(plain)
    low, high = axes.get_xlim()
    if high < 30 * low:  # too few powers of ten to read the axis by
        axes.xaxis.set_minor_formatter(FuncFormatter(_first_digits))
        axes.tick_params(axis="x", which="minor", labelcolor=INK)


def _first_digits(value: float, _: Any) -> str:
    return f"{value:g}" if f"{value:e}"[0] in "25" else ""


def shortened(name: str) -> str:
    """A name that leaves room for the curves: its middle goes."""
    if len(name) <= _LONGEST_LABEL:
        return name
    half = (_LONGEST_LABEL - 1) // 2
    return f"{name[:half]}…{name[-half:]}"


def _draw_bands(
    axes: Any, figures: ComparisonFigures, colors: dict[str, str], limits: tuple[float, float]
) -> None:
    """A lower end below 0, which a logarithmic axis has not, is drawn below the axis."""
    for name, run in figures.samplers.items():
        points = [p for p in run.error_curve if p.low is not None and p.high is not None]
        if points:
            axes.fill_between(
                [p.seconds for p in points],
                [max(p.low or 0.0, limits[0] / 10) for p in points],
                [max(p.high or 0.0, limits[0] / 10) for p in points],
                color=colors[name], alpha=0.18, linewidth=0,
            )  # fmt: skip


def _draw_guides(axes: Any, floor: float | None) -> None:
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    start = np.sqrt(low * high) * np.sqrt(right / left)
    seconds = np.array([left, right])
    for shift in (0.1, 1.0, 10.0):
        axes.plot(
            seconds, shift * start * left / seconds, color=FAINT, linewidth=0.9, dashes=(5, 4)
        )
    at = left * (right / left) ** 0.04
    axes.annotate("1/t", (at, start * left / at), (2, 3), textcoords="offset points", color=FAINT)
    if floor and floor > low / 100:  # else it says no more than that it is far below
        low = min(low, floor / 2)
        axes.axhline(floor, color=INK, linewidth=1, dashes=(1, 2))
        axes.annotate(
            "noise of the reference", (left, floor), (4, 3), textcoords="offset points", color=INK,
            fontsize=8,
        )  # fmt: skip
    axes.set(xlim=(left, right), ylim=(low, high))


def _label_ends(axes: Any, ends: dict[str, tuple[float, float]], colors: dict[str, str]) -> None:
    """Names the curves at their right ends, pushed apart where they would overlap."""
    low, high = np.log(axes.get_ylim())
    gap, below = 0.055 * (high - low), -np.inf
    for name, (_, error) in sorted(ends.items(), key=lambda item: item[1][1]):
        below = max(np.log(error), below + gap)
        axes.annotate(
            shortened(name), (1.0, np.exp(below)), (6, 0), xycoords=("axes fraction", "data"),
            textcoords="offset points", color=colors[name], va="center", weight="bold",
            annotation_clip=False,
        )  # fmt: skip
