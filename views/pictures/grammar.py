"""The grammar of pictures: one look for one meaning, in figures, films, notebooks and pages.

docs/pictures.md states it for readers. Whoever draws takes looks from here; a test walks every
public figure and holds its colours against `INKS`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count

Dash = str | tuple[int, tuple[float, ...]]

BLUE = "#0072B2"
"""Of a plan."""
GREY = "#8B939C"
"""Of the plain cycloid, and of arrival."""
GREEN = "#009E73"
"""Of a robust plan."""
ORANGE = "#CF7600"
"""Of a search."""
RED = "#B3203F"
"""Of what has no meaning of its own, as the first of `OTHERS`."""
SKY = "#56B4E9"
INDIGO = "#332288"
BROWN = "#7A4B1E"
PINK = "#CC79A7"
OLIVE = "#5C6300"
PURPLE = "#7B1E7A"
PETROL = "#0F5A66"
INK = "#333333"
"""Axes' marks, limits, the paper's points, discs and hubs: what is given and not computed."""
FAINT = "#BFC4CA"
"""Zero lines, levels, the floor of a scene: what is there for the eye alone."""
PALE = "#E9ECF0"
"""Areas behind what is drawn."""


@dataclass(frozen=True)
class Look:
    """Appearance of a line.

    Parameters
    ----------
    colour : str
        On white, as ``"#0072B2"``.
    dash : str or tuple
        Its dashes, as matplotlib has them.
    mark : str
        The mark of its points, as matplotlib has them.
    width : float
        Of the line [points].
    on_dark : str
        The colour of the same meaning on a dark page.
    """

    colour: str
    dash: Dash = "-"
    mark: str = "o"
    width: float = 1.6
    on_dark: str = ""


PLAN = Look(BLUE, on_dark="#3AA0E0")
CYCLOID = Look(GREY, mark="s", on_dark="#727C87")
ROBUST = Look(GREEN, mark="D", on_dark="#2FC79B")
SEARCH = Look(ORANGE, "--", mark="o", on_dark="#F0A22E")
LIMIT = Look(INK, ":", width=1.1, on_dark="#E8EBEF")
ARRIVAL = Look(GREY, "--", width=0.8, on_dark="#9EA9B5")
PAPER = Look(INK, "-.", mark="*", width=1.2, on_dark="#E8EBEF")
FLOOR = Look(INK, (0, (7, 2)), mark="D", width=1.2, on_dark="#E8EBEF")
"""The best motion without a parametrisation."""
ZV = Look(OLIVE, "--", mark="^", on_dark="#D9DB7A")
ZVD = Look(PURPLE, (0, (4, 1, 1, 1)), mark="v", on_dark="#D6B8F5")
EI = Look(PETROL, (0, (7, 2)), mark="P", on_dark="#C8F0F5")

MEANINGS: Mapping[str, Look] = {
    "plan": PLAN,
    "plain cycloid": CYCLOID,
    "robust plan": ROBUST,
    "search": SEARCH,
    "limit": LIMIT,
    "arrival": ARRIVAL,
    "paper": PAPER,
    "floor": FLOOR,
    "ZV": ZV,
    "ZVD": ZVD,
    "EI": EI,
}
"""What each look means."""

AFTER_ARRIVAL = 0.45
"""Opacity of what is drawn after arrival, where the motion before it is opaque."""

OTHERS = (RED, SKY, INDIGO, BROWN, PINK)
"""Of what has no meaning of its own: a second plan, a mode; never one of `MEANINGS`."""

COLOURS = (BLUE, *OTHERS)
"""Of lines by their number, where none has a meaning."""

INKS = frozenset({look.colour for look in MEANINGS.values()} | {*OTHERS, INK, FAINT, PALE})
"""All colours that a picture is drawn in, beside black and white."""

HEAT = "viridis"
"""The colours of a quantity over an area, from little to much."""

_DASHES: Sequence[Dash] = ("-", "--", (0, (5, 1, 1, 1, 1, 1)), (0, (4, 1, 1, 1)), (0, (7, 2)))
"""None is dotted, as a limit is."""
_MARKS = "os^Dv<>PX"


def look(number: int) -> Look:
    """The look of a line without a meaning, by its number from 0; the first is blue.

    No two are alike among the first 90.
    """
    return Look(
        COLOURS[number % len(COLOURS)],
        _DASHES[number % len(_DASHES)],
        _MARKS[number % len(_MARKS)],
    )


def looks(meanings: Sequence[str]) -> list[Look]:
    """A look for each of several lines, by what each of them is.

    The first line of a meaning has its look. Further ones of that meaning, and lines without one,
    have a colour of `OTHERS`, with dashes and a mark to match; no two of the first 25 of them have
    both alike.
    """
    with_meaning = set[str]()
    further = count()
    answer = list[Look]()
    for meaning in meanings:
        if meaning in MEANINGS and meaning not in with_meaning:
            with_meaning.add(meaning)
            answer.append(MEANINGS[meaning])
        else:
            place = next(further)
            answer.append(_further_look(place))
    return answer


def _further_look(place: int) -> Look:
    """The look of a line that has none by its meaning, by its place from 0 among such lines."""
    rounds = place // len(OTHERS)  # in each, colours meet other dashes
    return Look(
        OTHERS[place % len(OTHERS)],
        _DASHES[(place + 1 + rounds) % len(_DASHES)],
        _MARKS[(place + 1) % len(_MARKS)],
    )


def variants(meaning: str, number: int) -> list[Look]:
    """Looks of several lines of one meaning, as the seeds of a search: one colour, many marks."""
    common = MEANINGS[meaning]
    return [
        replace(common, dash=_DASHES[i % len(_DASHES)], mark=_MARKS[i % len(_MARKS)])
        for i in range(number)
    ]
