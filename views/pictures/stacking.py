"""A figure for a narrow place: its panels below each other, for a phone or a column of a paper."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec
from matplotlib.legend import Legend
from matplotlib.text import Text
from matplotlib.ticker import AutoLocator

from quietarm.ocp.checks import positive, takes
from quietarm.views.pictures.axes import NARROW, TITLE, broken_into_lines, head, letters_an_inch

MOST_PANELS = 8
"""More, as all quantities of six joints, would be a scroll of many screens."""
_PANEL_HIGH = 2.7
_LINE_HIGH = 0.19
_AROUND = 0.4
"""Heights of a panel, of a line of a head or a legend, and around all of them [inch]."""
_BESIDE = 1.2
"""Width that titles and legends leave free for numbers and labels at the left [inch]."""
_SAMPLE = 0.5
"""Width of the line beside the words of a legend, with the room around it [inch]."""


@takes(figure=Figure)
def stack(figure: Figure, width: float = NARROW) -> Figure | None:
    """Put the panels of a figure below each other, for a phone or for a column of a paper.

    Letters keep their size; titles and legends are broken into lines that fit.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        Any with axes on a grid, such as those of `motion_figure`. It stays as it is.
    width : float
        Of the stacked figure [inch].

    Returns
    -------
    matplotlib.figure.Figure or None
        A copy, stacked; None where there are more than eight panels, or several of them share a
        scale of colours: such a figure stays together.

    Raises
    ------
    ValueError
        When the width is not positive.
    """
    positive("width", width)
    stacked = copy.deepcopy(figure)
    panels = [ax for ax in stacked.axes if not _is_scale(ax)]
    shared_scale = any(_is_scale(ax) and len(_parents_of(ax)) > 1 for ax in stacked.axes)
    if not 0 < len(panels) <= MOST_PANELS or shared_scale:
        return None
    panels.sort(key=_reading_order)
    _label_every_panel([ax for ax in panels if ax.axison])
    lines = sum(_set_narrow(legend, width) for legend in [*stacked.legends])
    heights = [_narrowed(ax, width) for ax in panels]
    grid = GridSpec(len(panels), 1, figure=stacked, height_ratios=heights)
    for number, ax in enumerate(panels):
        ax.set_subplotspec(grid[number])
    for scale in filter(_is_scale, stacked.axes):  # from where the layout begins
        scale.set_position(_parents_of(scale)[0].get_position())
    title = stacked._suptitle  # pyright: ignore[reportAttributeAccessIssue]
    stacked.set_size_inches(width, 1.0)  # by which the head is broken into lines
    if title is not None and title.get_text():
        head(stacked, *(title.get_label() or title.get_text()).split("\n", 1))
        lines += title.get_text().count("\n") + 1
    stacked.set_size_inches(width, sum(heights) + _LINE_HIGH * lines + _AROUND)
    return stacked


def _is_scale(ax: Axes) -> bool:
    """Return whether axes are the scale of the colours of a panel."""
    return hasattr(ax, "_colorbar_info")


def _parents_of(scale: Axes) -> Sequence[Axes]:
    return scale._colorbar_info["parents"]  # pyright: ignore[reportAttributeAccessIssue]


def _reading_order(ax: Axes) -> tuple[bool, int, int]:
    """Row by row, also where a grid stands in a grid; a legend in place of a panel comes last."""
    place = ax.get_subplotspec()
    if place is None:
        return (True, 0, 0)
    return (_is_legend_alone(ax), place.get_topmost_subplotspec().num1, place.num1)


def _label_every_panel(panels: Sequence[Axes]) -> None:
    """Numbers and labels at every panel, where one at the edge had them for all."""
    for ax in panels:
        ax.tick_params(labelbottom=True, labelleft=True)
        if not ax.get_xlabel():
            ax.set_xlabel(_label_of("x", ax, panels))
        if not ax.get_ylabel():
            ax.set_ylabel(_label_of("y", ax, panels))


def _label_of(which: str, ax: Axes, panels: Sequence[Axes]) -> str:
    """Return the label of the panels that share an axis with this one."""
    together = getattr(ax, f"get_shared_{which}_axes")()
    labels = [getattr(far, f"get_{which}label")() for far in panels if together.joined(ax, far)]
    return next(filter(None, labels), "")


def _narrowed(ax: Axes, width: float) -> float:
    """Break the words of a panel into lines that fit; its height [inch]."""
    if _is_legend_alone(ax):
        legend = ax.get_legend()
        lines = _set_narrow(legend, width - _BESIDE) if legend is not None else 1
        return _LINE_HIGH * lines
    beside = _BESIDE if ax.axison else 0.0
    for side in ("left", "center"):
        if title := ax.get_title(loc=side):
            text = ax.set_title(title, loc=side, fontsize=TITLE["fontsize"])
            text.set_text(broken_into_lines(title, width - beside, _size_of(text)))
    if not ax.axison:
        return _height_of_drawing(ax, width)
    if isinstance(ax.xaxis.get_major_locator(), AutoLocator):
        ax.locator_params(axis="x", nbins=5)  # whose numbers stay apart
    # the middle of a panel is right of that of the figure
    for axis, room in ((ax.xaxis, width - _BESIDE / 2), (ax.yaxis, _PANEL_HIGH - _AROUND)):
        text = axis.label
        text.set_text(broken_into_lines(text.get_text(), room, _size_of(text)))
    return _PANEL_HIGH + _LINE_HIGH * _legend_below(ax, width)


def _is_legend_alone(ax: Axes) -> bool:
    """Return whether a legend stands in place of a panel."""
    return not ax.axison and not ax.has_data()


def _height_of_drawing(ax: Axes, width: float) -> float:
    """Return the height of a drawing to scale that fills the width, with its title [inch]."""
    across = abs(np.diff(ax.get_xlim())[0])
    upwards = abs(np.diff(ax.get_ylim())[0])
    return float(width * upwards / across) + _LINE_HIGH * 2


def _size_of(text: Text) -> float:
    """Return the size of a text's letters [points]."""
    return float(text.get_fontsize())


def _legend_below(ax: Axes, width: float) -> int:
    """Set a legend that would cover a narrow panel below it; the number of its lines there."""
    widest = 0.5 * width
    legend = ax.get_legend()
    if legend is None or _width_of(legend) < widest:
        return 0
    lines = _set_narrow(legend, width - _BESIDE)
    anew: Any = ax.get_legend()
    anew.set_loc("upper left")
    anew.set_bbox_to_anchor((0.0, -0.2))  # below numbers and label of the axis
    return lines


def _width_of(legend: Legend) -> float:
    """About how wide a legend is [inch]."""
    texts = [text.get_text() for text in legend.get_texts()]
    letters = max(len(line) for text in texts for line in text.splitlines())
    columns: int = legend._ncols  # pyright: ignore[reportAttributeAccessIssue]
    return columns * (_SAMPLE + letters / letters_an_inch(_size_of(legend.get_texts()[0])))


def _set_narrow(legend: Legend, width: float) -> int:
    """Set a legend of a figure, or in place of a panel, anew; its number of lines."""
    texts = [text.get_text() for text in legend.get_texts()]
    size = _size_of(legend.get_texts()[0])
    letters = max(len(line) for text in texts for line in text.splitlines())
    columns = max(1, int(width / (_SAMPLE + letters / letters_an_inch(size))))
    labels = [broken_into_lines(text, width - _SAMPLE, size) for text in texts]
    title = broken_into_lines(legend.get_title().get_text(), width, size)
    options: dict[str, Any] = {"fontsize": size, "frameon": False, "title": title or None}
    handles: list[Any] = [*legend.legend_handles]
    panel: Any = legend.axes  # none of a legend of a figure
    if panel is not None:
        panel.legend(handles, labels, loc="center left", borderaxespad=0, **options)
        columns = 1
    else:
        figure: Any = legend.get_figure()
        figure.legends.remove(legend)  # a copy does not know how to remove itself
        figure.legend(handles, labels, loc="outside lower center", ncols=columns, **options)
    in_title = title.count("\n") + 1 if title else 0
    return -(-sum(label.count("\n") + 1 for label in labels) // columns) + in_title + 1
