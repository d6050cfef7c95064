"""The colours that a picture is drawn in."""

from typing import Any

from matplotlib.artist import Artist
from matplotlib.collections import Collection, QuadMesh
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Text

OF_MATPLOTLIB = {"#000000", "#ffffff", "#b0b0b0", "#cccccc"}
"""Frames, letters and paper; the grid, and the edge of a legend."""
OVER_AN_AREA = (QuadMesh, AxesImage)
"""These have a scale of colours, beside which a bar says what they mean."""


def inks_of(figure: Figure) -> set[str]:
    """Colours of all that a figure shows, without their opacity, beside matplotlib's own."""
    inks = set()
    for artist in figure.findobj():
        if not artist.get_visible() or has_a_scale(artist):
            continue
        if isinstance(artist, Line2D):
            inks |= {artist.get_color(), artist.get_markerfacecolor()}
        elif isinstance(artist, Text) and artist.get_text():
            inks.add(artist.get_color())
        elif isinstance(artist, Patch) and not artist.get_hatch():
            inks |= {artist.get_facecolor(), artist.get_edgecolor()}
        elif isinstance(artist, Collection):
            inks |= {*map(tuple, artist.get_facecolor()), *map(tuple, artist.get_edgecolor())}
    hexadecimal = {to_hex(ink) for ink in inks - {"none"}}
    return hexadecimal - OF_MATPLOTLIB


def has_a_scale(artist: Artist) -> bool:
    """Return whether colours are values: of an area, or of points coloured by a quantity."""
    by_value = isinstance(artist, Collection) and artist.get_array() is not None
    return by_value or isinstance(artist, OVER_AN_AREA)


def scales_of(figure: Figure) -> set[str]:
    """Names of the scales of colours."""
    scaled: Any = filter(has_a_scale, figure.findobj())
    return {artist.get_cmap().name for artist in scaled}
