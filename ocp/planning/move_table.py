"""A move as rows of numbers: chosen columns, units and rate."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from quietarm.models import Plant
from quietarm.models.dimensions import words_of
from quietarm.models.joint_motion import LINEAR, ROTARY, JointMotion
from quietarm.ocp.checks import positive, unknown
from quietarm.ocp.escapes import csv_table
from quietarm.ocp.joint_words import heading_unit

if TYPE_CHECKING:
    from quietarm.ocp.planning.plan import Plan

Array = NDArray[np.float64]
USUAL_COLUMNS = "time,angle,speed,acceleration,tip,torque,power"
"""Columns of a table that is not asked for others."""
USUAL_RATE = 1000.0
"""Rows of it in a second [Hz]."""
_MOST_ROWS = 500_000
_WAYS: Mapping[str, Mapping[str, float]] = {
    ROTARY: {"rad": 1.0, "deg": math.degrees(1.0), "mrad": 1e3, "rev": 0.5 / np.pi},
    LINEAR: {"m": 1.0, "mm": 1e3},
}


_FORCES: Mapping[str, Mapping[str, float]] = {
    ROTARY: {"Nm": 1.0, "mNm": 1e3},
    LINEAR: {"N": 1.0, "kN": 1e-3},
}


def units_of(joint: str, tip_unit: str) -> Mapping[str, Mapping[str, float]]:
    """Return what a column may hold of a kind of joint, and its units, the one by default first.

    Names are those of a rotary joint.
    """
    # by the plant's `tip_unit`
    tips = {"m": _WAYS[LINEAR], "rad": _WAYS[ROTARY]}
    way = _WAYS[joint]
    speeds = {"rpm": 30 / np.pi} if joint == ROTARY else {}
    return {
        "time": {"s": 1.0, "ms": 1e3, "us": 1e6},
        "angle": way,
        "speed": {f"{unit}/s": factor for unit, factor in way.items()} | speeds,
        "acceleration": {f"{unit}/s^2": factor for unit, factor in way.items()},
        "jerk": {f"{unit}/s^3": factor for unit, factor in way.items()},
        "tip": tips[tip_unit],
        "torque": _FORCES[joint],
        "power": {"W": 1.0, "mW": 1e3},
    }


Units = dict[str, tuple[str, float]]
"""A column's unit and the factor to it, by the kind of joint."""


def columns_of(text: str, plant: Plant) -> dict[str, Units]:
    """Read columns as `time:ms,angle:deg,speed`, by their names of a rotary joint.

    Of joints that slide `position` and `force` are the same as `angle` and `torque`. A unit is that
    of the joints that can have it; others keep theirs. So a robot of both kinds of joints may have
    `angle:deg,position:mm`.

    ValueError where one or its unit is unknown, or one comes twice.
    """
    kinds = [*plant.joint_kinds, *map(plant.kind_of, plant.followers)]
    by_kind = {kind: units_of(kind, plant.tip_unit) for kind in dict.fromkeys(kinds)}
    words = {words_of(name).of(kind): name for kind in by_kind for name in by_kind[kind]}
    words |= {name: name for units in by_kind.values() for name in units}
    columns = dict[str, Units]()
    for heading in text.split(","):
        word, _, unit = (part.strip() for part in heading.partition(":"))
        if word not in words:
            raise ValueError(unknown("column", word, words))
        name = words[word]
        units = {
            kind: known[name] for kind, known in by_kind.items() if word == name or kind == LINEAR
        }
        chosen = {
            kind: (unit, known[unit]) if unit else next(iter(known.items()))
            for kind, known in units.items()
            if not unit or unit in known
        }
        if not chosen:
            known = dict.fromkeys(unit for one in units.values() for unit in one)
            raise ValueError(unknown(f"unit of {word}", unit, known))
        before = columns.setdefault(name, {})
        if before.keys() & chosen.keys():
            raise ValueError(f"column {word} is given twice; give it once")
        before |= chosen
    for name, units in columns.items():
        for kind, known in by_kind.items():
            units.setdefault(kind, next(iter(known[name].items())))
    return columns


def move_csv(plan: Plan, columns: str = USUAL_COLUMNS, rate: float = USUAL_RATE) -> str:
    """Return a move as comma-separated values under a heading: the one csv of a plan."""
    return csv_table(move_table(plan, columns, rate), "%.12g")


def move_table(plan: Plan, columns: str, rate: float) -> dict[str, Array]:
    """Columns, as `columns_of` reads them, by their headings, as `angle_deg`, at a rate [Hz].

    The last row is the first tick at or after arrival. Each of several joints has columns of its
    own, `elbow_angle_deg`, and so has each joint that follows one. Each tip has a column, or of a
    robot each axis of its tip's frame along which that moves, `tip_x_mm`; of a robust plan in each
    scenario, which its heading names.
    """
    motion = plan.commanded(rate)
    times = motion.time
    plant = plan.task.plant
    sample = motion.sample
    values: dict[str, list[Array]] = {
        "time": [motion.time],
        "angle": [joint.angle for joint in sample.joints],
        "speed": [joint.speed for joint in sample.joints],
        "acceleration": [joint.acceleration for joint in sample.joints],
        "jerk": [joint.jerk for joint in sample.joints],
        "torque": list(sample.torques),
        "power": [motion.power],
    }
    following = {name: how.motion(sample.joints[at]) for name, (at, how) in plant.followers.items()}

    def of_joints(name: str, units: Units) -> dict[str, Array]:
        """A column for each joint, by its heading."""
        of_name = values[name]
        fronts = [f"{joint}_" for joint in plant.joint_names] if len(of_name) > 1 else [""]
        rows = list(zip(fronts, plant.joint_kinds, of_name))
        if name in JointMotion._fields:
            rows += [
                (f"{joint}_", plant.kind_of(joint), getattr(motion, name))
                for joint, motion in following.items()
            ]
        return {
            _heading(f"{front}{words_of(name).of(kind)}", units[kind][0]): units[kind][1] * column
            for front, kind, column in rows
        }

    table: dict[str, Array] = {}
    for name, units in columns_of(columns, plant).items():
        if name != "tip":
            table |= of_joints(name, units)
            continue
        unit, factor = next(iter(units.values()))
        for (tip, scenario), column in _tips(plan, times).items():
            table[f"{_heading(tip, unit)}{scenario}"] = factor * column
    return table


def _heading(name: str, unit: str) -> str:
    """A column's name and its unit, as in angle_deg."""
    return f"{name}_{heading_unit(unit)}"


def _tips(plan: Plan, times: Array) -> dict[tuple[str, str], Array]:
    """Displacements of every tip in every scenario, by what stands before and after the unit."""
    by_name: dict[tuple[str, str], Array] = {}
    for candidate, errors in zip(plan.candidate.scenarios, plan.task.scenarios):
        named = zip(plan.task.error_names, errors)
        scenario = "".join(f" {name} {100 * error:+.4g} %" for name, error in named if error)
        tips = candidate.sample(times).tips.T
        names = plan.task.plant.tip_names
        by_name |= {(name, scenario): tip for name, tip in zip(names, tips)}
    return by_name


def times_of(plan: Plan, rate: float) -> Array:
    """Times of the rows [s] at a rate [Hz], up to the first at or after arrival."""
    return np.arange(ticks_of_move(plan.task.duration, rate) + 1) / rate


def ticks_of_move(duration: float, sample_rate: float) -> int:
    """Ticks from the start to the first at or after arrival."""
    ticks = duration * positive("sample rate", sample_rate, "Hz")
    if ticks < 1e-4:
        raise ValueError(
            f"sample rate is {sample_rate:g} Hz, a tick long after the arrival; give a higher rate"
        )
    if ticks > _MOST_ROWS:
        raise ValueError(
            f"sample rate {sample_rate:g} Hz asks for {ticks:.0f} rows, of at most "
            f"{_MOST_ROWS}; give at most {_MOST_ROWS / duration:.6g} Hz"
        )
    return max(1, math.ceil(ticks - 1e-9))
