"""The page: everything that its scripts draw, as numbers and words, in one file."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import to_hex, to_rgb
from numpy.typing import NDArray

from quietarm.interrupts import interruptible
from quietarm.models import Plant
from quietarm.ocp import Front, Plan
from quietarm.ocp.checks import instance, positive
from quietarm.ocp.escapes import one_line, script_json
from quietarm.ocp.files import write_whole
from quietarm.ocp.rest import rest_of
from quietarm.views.page.page_moves import (
    Answers,
    Choice,
    KnownPoints,
    Move,
    moves_of,
)
from quietarm.views.page.page_words import (
    ShownFigures,
    figure_names,
    robust_note,
    sentence,
    spot_words,
    swing_words,
)
from quietarm.views.page.samples import needed_samples, packed, shapes_of
from quietarm.views.pictures.grammar import BLUE, FAINT, INK, MEANINGS, OTHERS, Look, looks
from quietarm.views.pictures.motion import (
    Line,
    is_distance,
    limits_in_sight,
    names_of_curves,
    short_curves,
    short_heading,
)
from quietarm.views.pictures.space import ELEVATION, Room
from quietarm.views.pictures.structure import DrawnPart, Structure, structures_of
from quietarm.views.report.method_rows import label_of
from quietarm.views.report.templates import templates
from quietarm.views.report.words import counted, raised, window_words
from quietarm.views.tips import tip_scale

Array = NDArray[np.float64]
MOST_BYTES = 1_500_000
"""Of a page: what is sent by mail, and opens at once."""
_OF_CODE = 100_000
"""Bytes that scripts and styles may take of them."""
_LIGHTER = 0.6
"""By which share colours without a meaning become white on a dark page."""
_READABLE = 0.18
"""The largest luminance of letters on white: a contrast of 4.5."""
_SWING = 9
"""How many times the duration is shown after it: of a move of milliseconds little would be seen
beside a residual window of a second."""
_OF_THIS = ("plan", "robust plan", "search")
"""Meanings that the chosen motion can have."""
_SCRIPTS = (
    "numbers.js", "drawing.js", "state.js", "front.js", "arm.js", "space.js", "panels.js",
    "main.js",
)  # fmt: skip
"""In the order in which they need each other."""
_ALIVE = ("dials.js", "robustness.js", "alive.js")
"""Of the page that a server answers."""
PANELS = ("torque", "power", "deflection")
"""Quantities that are drawn over time."""


@dataclass(frozen=True, eq=False)
class TradeOffPage:
    """A page on which a motion is chosen along a front: one file that needs no network."""

    title: str
    moves: tuple[Mapping[str, Any], ...]

    def html(self) -> str:
        """The page."""
        return page_html(self.title, self.moves)

    @interruptible
    def save(self, path: str | Path) -> None:
        """Write it, whole or not at all; ValueError where the name does not end in .html."""
        if Path(path).suffix.lower() not in (".html", ".htm"):
            raise ValueError(f"{path} is no page; end its name in .html")
        write_whole(path, self.html())


def trade_off(
    answers: Front | Plan | Sequence[Front | Plan] | Answers,
    *,
    deflection_scale: float | None = None,
    known_points: KnownPoints | None = None,
) -> TradeOffPage:
    """Make a page on which one drags along a front and sees each point's motion.

    On the left is energy against residual vibration, on the right the structure, with the plain
    cycloid as a ghost; below are torque, power and tip displacement over time, and the figures.

    Parameters
    ----------
    answers : Front, Plan, or a sequence or mapping of these
        What is shown, a mapping by what it is called. Of fronts of the same move the first is
        dragged along, and all others lie beside it, as do plans. Plans alone are chosen among
        themselves. Answers of different moves can be switched between.
    deflection_scale : float, optional
        Scale of the deflections, as of `animate`.
    known_points : callable, optional
        Known points of a task's fronts of some numbers of terms, as those of a paper; they lie
        beside the first front of a move.

    Returns
    -------
    TradeOffPage
        Its `save` writes it, at most 1.5 MB. Of a front with more than 60 points it has 60.

    Raises
    ------
    ValueError
        When there is no answer, or no point in a front; when there are more motions than a page
        holds.
    """
    if deflection_scale is not None:
        positive("deflection scale", deflection_scale)
    moves = moves_of(_by_name(answers), known_points)
    budget = (MOST_BYTES - _OF_CODE) / len(moves)
    shown = tuple(shown_move(move, budget, deflection_scale) for move in moves)
    title = moves[0].title if len(moves) == 1 else "quietarm"
    page = TradeOffPage(title, shown)
    size = len(page.html().encode())
    if size > MOST_BYTES:
        motions = sum(len(move.choices) for move in moves)
        raise ValueError(
            f"{motions} motions of {counted(len(moves), 'move')} make a page of {size / 1e3:.0f} "
            f"kB, where {MOST_BYTES / 1e3:.0f} kB are the most; give fewer answers"
        )
    return page


def page_html(
    title: str, moves: Sequence[Mapping[str, Any]], alive: Mapping[str, Any] | None = None
) -> str:
    """Fill the template: the page by itself, or alive, with what its sliders need."""
    environment = templates(autoescape=True)
    environment.filters["in_script"] = script_json
    template = environment.get_template("views/page/page.html")
    data = {"moves": moves} | ({"alive": alive} if alive else {})
    scripts = (*_SCRIPTS, *(_ALIVE if alive else ()))
    page = template.render(
        title=one_line(title), data=data, alive=bool(alive), light=_colours(dark=False),
        dark=_colours(dark=True), scripts=scripts,
    )  # fmt: skip
    return page.lstrip()


def _by_name(answers: Front | Plan | Sequence[Front | Plan] | Answers) -> Answers:
    """Answers by their names, or by their methods."""
    if isinstance(answers, Plan):
        answers = {"plan": answers}
    if isinstance(answers, Front):
        answers = [answers]
    if isinstance(answers, Mapping):
        named = dict(answers)
    else:
        named = dict[str, Any]()
        for number, answer in enumerate(answers, start=1):
            instance(f"answer {number}", answer, Front, Plan)
            label = label_of(answer.record.method)
            named[f"{label} ({number})" if label in named else label] = answer
    for label, answer in named.items():
        instance(label, answer, Front, Plan)
    if not named:
        raise ValueError("no front or plan is given; give one or more")
    return named


def _colours(dark: bool) -> dict[str, str]:
    """The colours of the grammar of pictures, by the names of the page's styles."""
    colours = {
        _css_name(name): to_hex(look.on_dark if dark else look.colour)
        for name, look in MEANINGS.items()
    }
    colours |= {
        f"other-{number}": _mixed(colour, 1.0, _LIGHTER * dark)
        for number, colour in enumerate(OTHERS)
    }
    for name in map(_css_name, _OF_THIS):
        colours[f"{name}-ink"] = colours[name] if dark else _readable(colours[name])
    return colours


def _css_name(meaning: str) -> str:
    return meaning.replace(" ", "-")


def _readable(colour: str) -> str:
    """A colour, or a darker one, in which letters are read on white."""
    weights = np.array([0.2126, 0.7152, 0.0722])  # WCAG 2: relative luminance
    darker = colour
    for share in np.linspace(0.0, 0.9, 10):
        darker = _mixed(colour, 0.0, float(share))
        channels = np.array(to_rgb(darker))
        linear = np.where(
            channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4
        )
        if weights @ linear <= _READABLE:
            return darker
    return darker


def _mixed(colour: str, towards: float, share: float) -> str:
    """A colour on its way to black, 0, or white, 1."""
    red, green, blue = ((1 - share) * channel + share * towards for channel in to_rgb(colour))
    return to_hex((red, green, blue))


def shown_move(
    move: Move, budget: float, scale: float | None = None, quantities: Sequence[str] = PANELS
) -> dict[str, Any]:
    """Return all that the scripts need of a move, within a number of bytes.

    Parameters
    ----------
    move : Move
        The motions that can be chosen, and what lies beside them.
    budget : float
        Bytes within which it is, as far as coarser curves can make it.
    scale : float, optional
        Scale of the deflections, as of `animate`.
    quantities : sequence of str
        What is drawn over time.
    """
    # a share of a curve's peak that a line between its samples may miss it by: half a pixel
    tolerance = 0.005
    coarsest = 0.08
    curves_of_all = {
        name: np.array([short_curves(plan, name) for plan in move.motions]) for name in quantities
    }
    while True:
        times, places = _sampled_times(move, curves_of_all, tolerance)
        structure = _structure(move, times, scale, tolerance)
        panels = {
            name: _panel(move, name, values[:, :, places]) for name, values in curves_of_all.items()
        }
        content = _content(move, times, structure, panels)
        if tolerance >= coarsest or len(json.dumps(content)) <= budget:
            return content
        tolerance *= 2


def _sampled_times(
    move: Move, curves_of_all: Mapping[str, Array], tolerance: float
) -> tuple[Array, NDArray[np.intp]]:
    """Times at which all motions are sampled [s], and which of the fine samples these are."""
    task = move.task
    times = move.cycloid.trajectory.time
    times = times[times <= task.duration + min(task.residual_window, _SWING * task.duration)]
    rows = [_angles(plan)[None, : len(times)] for plan in move.motions]
    for values in curves_of_all.values():
        peak = np.abs(values).max() or 1.0
        rows += list((values / peak)[:, :, : len(times)])
    arrival = np.flatnonzero(times == move.task.duration)
    places = needed_samples(times, np.vstack(rows), arrival, tolerance)
    return times[places], places


def _angles(plan: Plan) -> Array:
    """The joint's way, from 0 to 1."""
    return (plan.trajectory.motion.angle - plan.task.start) / plan.task.span


def _structure(move: Move, times: Array, scale: float | None, tolerance: float) -> dict[str, Any]:
    """The moving parts of all motions, as sums of a few shapes."""
    lines = [Line(plan, "", BLUE) for plan in move.motions]
    end = move.task.duration + move.task.residual_window
    structures = structures_of(lines, times, end, scale)
    coordinates = np.array([_coordinates(structure) for structure in structures])
    flat = coordinates.reshape(-1, coordinates.shape[-1])
    first, *_ = structures
    in_space = move.task.plant.in_space
    points = flat.reshape(len(flat), -1, 3 if in_space else 2)
    corners = [points.min(axis=(0, 1)), points.max(axis=(0, 1))]
    size = float(np.ptp(corners, axis=0).max()) or 1.0
    shapes = shapes_of(flat, 0.2 * tolerance * size)
    scores = shapes.scores.reshape(*coordinates.shape[:2], -1).transpose(0, 2, 1)
    at_the_end = replace(first, times=times[-1:]).unbent
    still = [part for part in at_the_end if part.colour != FAINT]
    return {
        "scale": first.scale_words.replace(" x ", " \u00d7 "),
        "in_space": in_space,
        "room": _room(Room.of(structures)) if in_space else None,
        "on_support": in_space and first.on_support,
        "parts": [_part(part) for part in first.bent],
        "trails": len(first.paths),
        "mean": shapes.mean.round(6).tolist(),
        "shapes": shapes.shapes.round(6).tolist(),
        "scores": packed(scores),
        "target": [part.points[-1].round(6).tolist() for part in still],
        "corners": [corner.round(6).tolist() for corner in corners],
    }


def _room(room: Room) -> dict[str, Any]:
    """Return where structures in space move, and from where they are seen at first."""
    lengths = {
        "reach": room.reach,
        "half": room.half,
        "floor": room.floor,
        "square": room.square,
        "away": room.away,
        "seen_from": room.seen_from,
        "elevation": ELEVATION,
    }
    return {
        "middle": room.middle.round(6).tolist(),
        **{name: round(length, 6) for name, length in lengths.items()},
        "square_words": room.square_words,
    }


def _coordinates(structure: Structure) -> Array:
    """All points of the parts, then where the tips are drawn, shape (frames, coordinates) [m]."""
    frames = len(structure.times)
    parts = [part.points.reshape(frames, -1) for part in structure.bent]
    return np.hstack([*parts, *structure.paths])


def _part(part: DrawnPart) -> dict[str, Any]:
    looks_of = {INK: "rigid", FAINT: "ground"}
    return {
        "points": part.points.shape[1],
        "look": looks_of.get(part.colour, "link"),
        "width": part.width,
        "radius": round(part.radius, 6),
    }


def _panel(move: Move, quantity: str, values: Array) -> dict[str, Any]:
    """Curves over time: of several joints or tips one is shown, by its name."""
    plant = move.task.plant
    title, _, unit = short_heading(plant, quantity).partition(" [")
    count = values.shape[1]
    peaks = np.abs(values).max(axis=(0, 2))
    return {
        "title": title[0].upper() + title[1:],
        "unit": unit.removesuffix("]"),
        "limits": [_limits(move, quantity, values, curve) for curve in range(count)],
        "names": _names(plant, quantity) if count > 1 else [""],
        "first": int(peaks.argmax()),
        "values": packed(values),
    }


def _names(plant: Plant, quantity: str) -> list[str]:
    """Return the names of several curves of a quantity: joints, or tips."""
    return list(plant.joint_names) if quantity == "angle" else names_of_curves(plant, quantity)


def _limits(move: Move, quantity: str, values: Array, curve: int) -> list[float]:
    """The limits of a joint or a tip that its curves come near."""
    if quantity in ("power", "angle") or is_distance(move.task.plant, quantity):
        return []
    lines = [Line(plan, "") for plan in move.motions]
    return limits_in_sight(lines, quantity, values[:, curve].ravel(), curve)


def _content(
    move: Move, times: Array, structure: Mapping[str, Any], panels: Mapping[str, Any]
) -> dict[str, Any]:
    task = move.task
    cycloid = Choice(move.cycloid, move.cycloid.residual, move.cycloid.energy)
    unit, factor = tip_scale(task.plant.tip_unit)
    count = len(move.choices)
    looks_of_all = looks([move.meaning, *(beside.meaning for beside in move.beside)])
    left_out = f"{count} of the front's {count + move.left_out} points. " if move.left_out else ""
    return {
        "label": move.label,
        "title": raised(move.title),
        "this": _css_name(move.meaning),
        "mark": looks_of_all[0].mark,
        "method": move.method,
        "joined": move.joined,
        "duration": task.duration,
        "arrival": int(np.searchsorted(times, task.duration)),
        "end": float(times[-1]),
        "residual": f"residual vibration {window_words(task.residual_window)}",
        "rest": rest_of(task),
        "unit": unit,
        "factor": factor,
        "swings_about_rest": task.final is None and not task.ranges,
        "times": [float(f"{time:.9g}") for time in times],
        "structure": structure,
        "panels": panels,
        "figure_names": figure_names(task),
        "points": [_point(move, choice) for choice in move.choices],
        "cycloid": _place(move, cycloid),
        "beside": [
            {
                "label": beside.label,
                "kind": beside.kind,
                "colour": colour_name(look),
                "mark": look.mark,
                "points": beside.points,
            }
            for beside, look in zip(move.beside, looks_of_all[1:], strict=True)
        ],
        "note": left_out + robust_note(task),
    }


def colour_name(look: Look) -> str:
    """Return the name of a look's colour in the page's styles."""
    if look.colour in OTHERS:
        return f"other-{OTHERS.index(look.colour)}"
    return next(_css_name(name) for name, meant in MEANINGS.items() if meant == look)


def _point(move: Move, choice: Choice) -> dict[str, Any]:
    """A motion that can be chosen, and what it trades."""
    return {**_place(move, choice), "sentence": sentence(move, choice)}


def _place(move: Move, choice: Choice) -> dict[str, Any]:
    """A motion's place on the front, and its figures."""
    figures = ShownFigures.of(choice.plan, choice.residual, choice.energy)
    return {
        "name": choice.name,
        "residual": choice.residual,
        "energy": choice.energy,
        "cells": figures.cells(move.task),
        "notes": figures.notes(),
        "spot": spot_words(choice),
        "swing": swing_words(choice),
    }
