"""Axes and figures, and the axis of residuals that pictures of fronts share."""

from __future__ import annotations

import re
from collections.abc import Sequence
from textwrap import fill
from typing import Any, Literal

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator
from numpy.typing import NDArray

from quietarm.views.report.words import raised, window_words
from quietarm.views.tips import tip_scale

Array = NDArray[np.float64]
LOGARITHMIC_FROM = 5.0
"""Residuals that span less than this factor are drawn on a linear axis."""

NARROW = 3.85
"""Width of a figure for a phone [inch]: at 390 pixels its letters of 7 points are 9 high."""
TITLE: dict[str, Any] = {"loc": "left", "fontsize": 10}
"""How the title of a panel is set."""
_NO_BREAK = "\N{NO-BREAK SPACE}"
"""Where no line ends."""
_BEFORE_UNIT = re.compile(
    r"(?<=\d) (?=(?:%|[nm\u00b5]?J|[cm]?m|m?s|m?rad|deg|k?Hz|k?g|k?N|[km]?W)(?![a-z]))"
    r"|(?<=\dN) (?=m\b)|(?<=\d N) (?=m\b)"
)
"""The space between a number and its unit, and within newton metres."""


def new_figure(width: float, height: float) -> Figure:
    """An empty figure of this size [inch] that pyplot does not know of."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def axes_or_new(ax: Axes | None) -> Axes:
    """The axes that were given, or new ones in a figure of their own; with a light grid."""
    if ax is None:
        ax = new_figure(6.4, 4.4).subplots()
    ax.grid(alpha=0.25)
    return ax


def head(figure: Figure, sentence: str, facts: str = "") -> None:
    """Set what is seen, and below it of what, at the left above a figure.

    The label of the title has both, each in one line.
    """
    size = 11
    paragraphs = [raised(words) for words in (sentence, facts) if words]
    if paragraphs:
        width = figure.get_figwidth()
        broken = [broken_into_lines(words, width, size) for words in paragraphs]
        figure.suptitle(
            "\n".join(broken), x=0.01, ha="left", fontsize=size, linespacing=1.35,
            label="\n".join(paragraphs),
        )  # fmt: skip


def broken_into_lines(words: str, width: float, size: float) -> str:
    """Words in lines that fit into a width [inch] in letters of a size [points]."""
    return in_lines(words, max(1, int(letters_an_inch(size) * width)))


def in_lines(words: str, letters: int) -> str:
    """Words in lines of at most so many letters; none ends between a number and its unit."""
    together = _BEFORE_UNIT.sub(_NO_BREAK, words)
    lines = [fill(line, letters) for line in together.splitlines()]
    return "\n".join(lines).replace(_NO_BREAK, " ")


def letters_an_inch(size: float) -> float:
    """Return how many letters of a size [points] stand on an inch."""
    return 132 / size


def side_by_side(
    panels: int, sentence: str, facts: str = "", width: float = 4.2
) -> tuple[Figure, list[Axes]]:
    """A figure with its head and this many panels side by side."""
    figure = new_figure(width * panels, 4.3)
    head(figure, sentence, facts)
    return figure, list(figure.subplots(1, panels, squeeze=False).flat)


def draw_front(
    ax: Axes,
    residuals: Array,
    energies: Array,
    tip_unit: str,
    exact: bool = False,
    width: float = 0.8,
    **style: Any,
) -> None:
    """Draw a front [tip's unit, J]: a line where its points are exact, else a staircase.

    Between two points of a search the stiller one is the best known motion.
    """
    steps = "default" if exact else "steps-post"
    ax.plot(residuals * tip_scale(tip_unit)[1], energies, linewidth=width, drawstyle=steps, **style)


def letter(axes: Sequence[Axes]) -> None:
    """Put (a), (b) ... before the titles of panels."""
    for name, ax in zip("abcdefghi", axes):
        ax.set_title(f"({name}) {ax.get_title(loc='left')}", **TITLE)


def legend_below(figure: Figure, axes: Sequence[Axes], columns: int, size: float) -> None:
    """One legend for several panels, below them."""
    figure.legend(
        *legend_of(axes), loc="outside lower center", ncols=columns, fontsize=size, frameon=False
    )


def name_objectives(ax: Axes, tip_unit: str, window: float | None = None) -> None:
    """Label the axes of a front; residuals by their window [s], where one is given."""
    ax.set(xlabel=residual_label(tip_unit, window), ylabel="energy [J]")


def residual_label(tip_unit: str, window: float | None = None) -> str:
    """The label of residuals in the unit that is shown, within a window [s] where there is one."""
    within = "" if window is None else f" {window_words(window)}"
    return f"residual{within} [{tip_scale(tip_unit)[0]}]"


def legend_of(axes: Sequence[Axes]) -> tuple[list[Artist], list[str]]:
    """Handles and labels of several axes, each label once."""
    entries: dict[str, Artist] = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels()):
            entries.setdefault(label, handle)
    return list(entries.values()), list(entries)


def logarithmic(
    ax: Axes, values: Sequence[float] | Array, which: Literal["x", "y"] = "x", least_span: float = 1
) -> None:
    """Make an axis logarithmic, unless its positive values span less than a factor.

    Its ticks are plain numbers: saved pictures hold no formulas, so that a name with $ is a name.
    """
    positive = [value for value in values if value > 0] or [1.0]
    span = max(positive) / min(positive)
    if span < least_span:
        return
    ax.set(**{f"{which}scale": "log"})
    axis = ax.xaxis if which == "x" else ax.yaxis
    subs = (1.0, 2.0, 5.0) if span < 100 else (1.0,)
    axis.set_major_locator(LogLocator(subs=subs, numticks=7))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter("")
