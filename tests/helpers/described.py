"""Give every picture that a notebook shows a text in its place, made of what the picture says."""

import re

from IPython.core import pylabtools

_SIGNS = re.compile(r"[$\\]")
"""Of formulas, which are not read aloud."""
_draw = pylabtools.print_figure


def alternative(figure):
    """What a figure shows: title, axes and curves, as far as they have names."""
    panels = [_panel(ax) for ax in figure.axes]
    boxes = [*figure.legends, *(ax.get_legend() for ax in figure.axes)]
    names = dict.fromkeys(text.get_text() for box in boxes if box for text in box.get_texts())
    parts = [figure.get_suptitle(), "; ".join(filter(None, panels))]
    if names:
        parts.append(f"Shown are {', '.join(names)}")
    text = ". ".join(filter(None, parts)).replace("\n", " ")
    return _SIGNS.sub("", text) or "a drawing"


def _panel(ax):
    x, y = ax.get_xlabel(), ax.get_ylabel()
    title = next(filter(None, (ax.get_title(loc=loc) for loc in ("left", "center", "right"))), "")
    axes = f"{y} over {x}" if x and y else y or (f"over {x}" if x else "")
    words = " ".join(text.get_text() for text in ax.texts) if not (title or axes) else ""
    return ", ".join(filter(None, (title, axes))) or words


def described(figure, *given, **options):
    """A picture as IPython draws it, with its alternative text."""
    drawn = _draw(figure, *given, **options)
    return drawn and (drawn, {"alt": alternative(figure)})


pylabtools.print_figure = described
