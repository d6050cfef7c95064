"""Colours, dashes and marks that stay apart for colour-blind readers and in print."""

from __future__ import annotations

from dataclasses import dataclass

Dash = str | tuple[int, tuple[float, ...]]

BLUE = "#0072B2"
RED = "#D55E00"
GREEN = "#009E73"
ORANGE = "#E69F00"
PINK = "#CC79A7"
SKY = "#56B4E9"
WINE = "#882255"
INDIGO = "#332288"
COLOURS = (BLUE, RED, GREEN, ORANGE, PINK, SKY, WINE, INDIGO)
"""Okabe and Ito's without yellow, which is too pale, and black, which is for marks; and two dark
ones of Tol's, https://personal.sron.nl/~pault/."""
GREY = "0.62"
"""For what stays in the background, such as the plain cycloid."""


@dataclass(frozen=True)
class Look:
    """How one of several lines looks: its colour, dashes and mark."""

    colour: str
    dash: Dash
    mark: str


def look(number: int) -> Look:
    """The look of a line by its number, from 0; no two alike among the first 360."""
    marks = "os^Dv<>PX"
    dashes = ("-", "--", (0, (1, 1)), (0, (4, 1, 1, 1)), (0, (7, 2)))
    return Look(
        COLOURS[number % len(COLOURS)], dashes[number % len(dashes)], marks[number % len(marks)]
    )
