"""Give every picture that a notebook shows a text in its place, made of what the picture says."""

import re

from IPython.core import pylabtools

_draw = pylabtools.print_figure


def alternative(figure):
    """What a figure shows: title, axes and curves, as far as they have names; else its words."""
    boxes = [*figure.legends, *filter(None, (ax.get_legend() for ax in figure.axes))]
    names = dict.fromkeys(text.get_text() for box in boxes for text in box.get_texts())
    parts = [figure.get_suptitle(), "; ".join(filter(None, map(_panel, figure.axes)))]
    if names:
        parts.append(f"Shown are {', '.join(names)}")
    text = ". ".join(filter(None, parts)).replace("\n", " ")
    return re.sub(r"[$\\]", "", text) or "a drawing"  # signs of formulas are not read aloud


def _panel(ax):
    title = ax.get_title(loc="left") or ax.get_title()
    axes = " over ".join(filter(None, (ax.get_ylabel(), ax.get_xlabel())))
    return ", ".join(filter(None, (title, axes))) or " ".join(text.get_text() for text in ax.texts)


def described(figure, *given, **options):
    """A picture as IPython draws it, with its alternative text."""
    drawn = _draw(figure, *given, **options)
    return drawn and (drawn, {"alt": alternative(figure)})


pylabtools.print_figure = described
