"""Give every picture that a notebook shows what a file of it has beside it.

A text in its place, made of what the picture says; and the same picture for a phone.
"""

import base64
import io
import re

from IPython.core import pylabtools
from PIL import Image

from quietarm.views.pictures import stack
from quietarm.views.pictures.axes import NARROW

_draw = pylabtools.print_figure


def alternative(figure):
    """Say what a figure shows: title, axes and curves, if they have names; else its words."""
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


def narrow(figure):
    """The figure for a phone, in base 64; empty where it is not wider than one, or stays whole."""
    stacked = stack(figure) if figure.get_figwidth() > NARROW else None
    if stacked is None:
        return ""
    drawn = io.BytesIO()
    stacked.savefig(drawn, format="png", dpi=150)
    packed = io.BytesIO()
    with Image.open(drawn) as image:  # few colours: a tenth of the bytes
        image.convert("RGB").quantize(64).save(packed, "png", optimize=True, dpi=(150, 150))
    return base64.b64encode(packed.getvalue()).decode()


def described(figure, *given, **options):
    """A picture as IPython draws it, with its alternative text and its variant for a phone."""
    drawn = _draw(figure, *given, **options)
    return drawn and (drawn, {"alt": alternative(figure), "narrow": narrow(figure)})


pylabtools.print_figure = described
