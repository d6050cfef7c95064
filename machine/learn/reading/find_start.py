"""Find where in a recording the move of a plan begins, by the joint, the force or the tip.

What was recorded is compared with what the plan says of it, at every place of the recording: the
joint's angle with its path, the torque with what acceleration, swing and friction take, a tip's
displacement with the path and the swing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.identified import is_frequency
from quietarm.machine.recordings.recording import Recording
from quietarm.models.joint_motion import LINEAR
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.planning.plan import Plan

Array = NDArray[np.float64]
_POINTS = 200
"""In which the move is compared with the plan."""
_BEFORE = 0.1
"""Share of the duration that is compared before the start, where the joint rests."""
_LEAST_MET = {"angle": 0.99, "torque": 0.7, "tip": 0.7, "acceleration": 0.5}
"""Share of a signal's power during the move that the plan explains, or it is another move."""
_MOST_UNEXPLAINED = {"angle": 1e-4}
"""Share of a signal's power that the plan leaves unexplained by the right clock; a joint follows
the plan closely."""
_PER_CENT = 1e-2
_LEAST_STRETCH = 4e-3
"""Share by which a clock may be off."""
_SAME_WAY = 0.03
"""Share by which the recorded way of a joint may differ from the plan's."""


@dataclass(frozen=True)
class Start:
    """Place where a move begins in a recording.

    Attributes
    ----------
    time : float
        In the recording's own time [s].
    signal : str
        By which it was found.
    explained : float
        Share of that signal's power during the move that follows from the plan.
    deviation : float
        Standard deviation of the time [s], where it is told.
    """

    time: float
    signal: str
    explained: float
    deviation: float = 0.0


def find_start(plan: Plan, recording: Recording) -> Start:
    """The start of a plan's move in a recording of it.

    Raises
    ------
    ValueError
        When the recording is of another move, of one that an earlier plan made, or by another
        clock.
    """
    signal = next(name for name in _LEAST_MET if name in recording.measured)
    values = recording.measured[signal].reshape(len(recording.time), -1)[:, 0]
    search, lag, explained = best_search(plan, recording.time, values, signal)
    if explained < _LEAST_MET[signal]:
        most = _MOST_UNEXPLAINED.get(signal, 0.02)
        search.refuse_other_clock(recording.name, explained, most)
        refuse_unexplained(recording.name, _WORDS[signal], explained)
    lag, explained = search.refined(lag)
    _refuse_earlier(plan, recording, Start(lag, signal, explained))
    # a joint follows the plan closely, and a tip swings beside it
    search.refuse_stretched(recording.name, lag, explained, 1e-6 if signal == "angle" else 1e-4)
    if signal == "angle":
        _check_way(plan, recording, lag, float(search.sizes(lag)[0]))
    return Start(lag, signal, explained)


def refuse_unexplained(name: str, signal: str, explained: float) -> NoReturn:
    """Refuse a recording of whose signal a plan explains too small a share."""
    raise ValueError(
        f"{name}: it is of another move: of its {signal} the plan explains "
        f"{max(explained, 0.0):.0%} at best; give the recording of this plan's move"
    )


def compared_at(duration: float) -> Array:
    """Times since its start at which a move is compared with the plan, some before it [s]."""
    return duration * np.linspace(-_BEFORE, 1, _POINTS)


def best_search(
    plan: Plan, time: Array, values: Array, signal: str, enough: float = 0.98
) -> tuple[StartSearch, float, float]:
    """The search by the plant's frequencies, or by others that meet a tip's swing better.

    With its place and the share that is explained there. No other frequency is tried from a share
    on that is enough.
    """
    found = list[tuple[float, float, StartSearch]]()
    for factor in (1.0, *np.geomspace(0.7, 1.4, 21)):
        motion = _with_frequencies(plan, float(factor))
        if motion is None:
            break
        search = StartSearch(time, values, courses_of(motion, signal), plan.task.duration)
        lag, explained = search.best(1.0)
        found.append((explained, lag, search))
        if signal in ("angle", "torque") or explained > enough:
            break
    explained, lag, search = max(found, key=lambda each: each[0])
    return search, lag, explained


def _with_frequencies(plan: Plan, factor: float) -> JudgedMotion | None:
    """The motion of a plan whose plant swings so much faster; None where it has no frequency."""
    if factor == 1:
        return plan.candidate
    plant = plan.task.plant
    rates = {name: value for name, value in plant.measured.items() if is_frequency(plant, name)}
    if not rates:
        return None
    faster = replace(plant, **{name: factor * value for name, value in rates.items()})
    task = replace(plan.task.certain, plant=faster)
    return JudgedMotion.of_profile(task, plan.profile, plan.coefficients)


def off_the_path(plan: Plan, recording: Recording, start: Start) -> str:
    """Say that a joint leaves the plan's path by more than a servo does; empty where not.

    It may be another plan's move.
    """
    much = 3e-5  # share of the way's power
    if start.signal != "angle" or 1 - start.explained < much:
        return ""
    assert recording.angle is not None
    rows = recording.rows(start.time, start.time + plan.task.duration)
    size = float(recording.angle[rows].std()) * (1 - start.explained) ** 0.5
    linear = plan.task.plant.joint == LINEAR
    words = f"{1e3 * size:.2g} mm" if linear else f"{np.degrees(size):.2g} deg"
    return (
        f"warning: {recording.name}: the joint is {words} (rms) off the plan's path: is it the "
        "recording of this plan?"
    )


def refuse_exchanged(plan: Plan, recording: Recording, start: Start) -> None:
    """Refuse a tip that follows the joint's path far better than what was given as the joint.

    A tip swings beside the path, and a joint does not.
    """
    far_better = 0.1  # times what the joint leaves unexplained
    if start.signal != "angle" or recording.tip is None:
        return
    values = recording.tip.reshape(len(recording.time), -1)[:, 0]
    search = StartSearch(
        recording.time, values, courses_of(plan.candidate, "angle"), plan.task.duration
    )
    _, explained = search.refined(start.time)
    if 1 - explained < far_better * (1 - start.explained):
        raise ValueError(
            f"{recording.name}: its tip follows the path of the plan's joint, and its joint swings "
            "beside it; were --tip and --angle exchanged?"
        )


def _refuse_earlier(plan: Plan, recording: Recording, start: Start) -> None:
    """Refuse a recording of an earlier move of a plan's history, not of the plan."""
    far_better = 0.2  # times what the plan leaves unexplained
    if start.signal not in ("angle", "tip") or plan.learned is None:
        return
    values = recording.measured[start.signal].reshape(len(recording.time), -1)[:, 0]
    for number, move in enumerate(plan.learned.moves, start=1):
        task = replace(plan.task.certain, duration=move.move[2], final=None)
        motion = JudgedMotion.of_profile(task, move.profile, move.coefficients)
        if move.coefficients == plan.coefficients:
            continue
        search = StartSearch(
            recording.time, values, courses_of(motion, start.signal), task.duration
        )
        _, explained = search.refined(start.time)
        if 1 - explained < far_better * (1 - start.explained):
            raise ValueError(
                f"{recording.name}: it is of move {number}, which an earlier plan made, and not of "
                "this plan; give the recording of this plan's move"
            )


def tip_share(motion: JudgedMotion, recording: Recording) -> float | None:
    """Return the share of the plant's swing that a tip shows during a motion with its frequency.

    None where the tip was not seen during the move, or follows another course.
    """
    enough = 0.99
    if recording.tip is None:
        return None
    values = recording.tip.reshape(len(recording.time), -1)[:, 0]
    search = StartSearch(recording.time, values, courses_of(motion, "tip"), motion.task.duration)
    lag, explained = search.best(1.0)
    if explained < enough:
        return None
    lag, _ = search.refined(lag)
    return float(search.sizes(lag)[1])


_WORDS = {"angle": "joint", "torque": "torque", "tip": "tip", "acceleration": "accelerometer"}


def courses_of(motion: JudgedMotion, signal: str) -> Sequence[Array]:
    """Return a signal's parts during the move, each of unknown size: rows of `_POINTS`.

    `served` is the angle as a servo without feed-forward lets it follow.
    """
    task = motion.task
    times = compared_at(task.duration)
    moving = times >= 0
    sampled = motion.sample(times[moving])
    place, speed, acceleration = sampled.joint.T
    tip = sampled.tips[:, 0]
    # of the tip from the joint; quicker to differentiate than to ask each plant of its own
    tip_acceleration = np.gradient(np.gradient(tip, times[moving]), times[moving])
    courses = {
        "angle": [place - task.start],
        "served": [place - task.start, acceleration],
        "torque": [acceleration, tip_acceleration, speed, np.sign(np.round(speed, 6))],
        "tip": [place - task.start, tip],
        "acceleration": [acceleration, tip_acceleration],
    }
    resting = np.count_nonzero(~moving)
    return [np.concatenate([np.zeros(resting), course]) for course in courses[signal]]


class StartSearch:
    """The places of a recording, and how much of its signal a plan explains there.

    Parameters
    ----------
    time, values : array
        The recorded signal.
    courses : sequence of array
        What it consists of during the move, as `courses_of` gives them.
    duration : float
        Of the move [s].
    """

    def __init__(
        self, time: Array, values: Array, courses: Sequence[Array], duration: float
    ) -> None:
        self._time = time
        self._values = values
        self._duration = duration
        basis = np.column_stack([np.ones(_POINTS), *courses])
        self._norms = np.linalg.norm(basis, axis=0)
        self._spread = basis[:, 1:].std(axis=0)
        self._courses, self._triangle = np.linalg.qr(basis / self._norms)
        self._at = compared_at(duration)

    def best(self, stretch: float) -> tuple[float, float]:
        """The place that is met best [s], and the share that is explained there."""
        step = stretch * float(self._at[1] - self._at[0])
        pad = round(_BEFORE * self._duration * stretch / step) + 2
        count = int(np.ptp(self._time) / step) + 1
        even = self._time[0] + step * np.arange(-pad, count)
        values = np.interp(even, self._time, _averaged(self._time, self._values, step))
        if len(values) < _POINTS:
            return float(self._time[0]), 0.0
        windows = np.lib.stride_tricks.sliding_window_view(values, _POINTS)
        explained = self._explained(windows)
        place = int(explained.argmax())
        return float(even[place]) - stretch * float(self._at[0]), float(explained[place])

    def _explained(self, windows: Array) -> Array:
        """Share of the power of each window, its mean not counted; 0 where it goes the other way.

        It does so where the course that explains most has the other sign.
        """
        centred = windows - windows.mean(axis=-1, keepdims=True)
        power = (centred**2).sum(axis=-1)
        least = 1e-6 * float(power.max()) + 1e-300
        amplitudes = centred @ self._courses
        explained = (amplitudes**2).sum(axis=-1) / np.maximum(power, least)
        sizes = self._sizes(amplitudes) * self._spread
        largest = np.abs(sizes).argmax(axis=-1)
        forward = np.take_along_axis(sizes, largest[..., None], axis=-1)[..., 0] > 0
        return np.where(forward, explained, 0.0)

    def _sizes(self, amplitudes: Array) -> Array:
        """The sizes of the courses (..., courses), by amplitudes of the orthogonal ones."""
        scaled = np.linalg.solve(self._triangle, np.moveaxis(amplitudes, -1, 0))
        return np.moveaxis(scaled, 0, -1)[..., 1:] / self._norms[1:]

    def _window(self, lag: float, stretch: float) -> Array:
        return np.interp(lag + stretch * self._at, self._time, self._values)

    def refined(self, lag: float) -> tuple[float, float]:
        """The place [s] between samples, near one, and the share that is explained there."""
        step = float(self._at[1] - self._at[0])
        found: Any = _least(lambda x: self._unexplained(lag + step * x[0], 1.0), 1)
        return lag + step * float(found.x[0]), 1 - float(found.fun)

    def refuse_stretched(self, name: str, lag: float, explained: float, met: float) -> None:
        """Refuse a move that is met by a clock off by some per mille, and not by the plan's.

        A move is met where no more than a share is unexplained, and far less than by the plan.
        """
        far_better = 0.05  # a servo's own error has no clock that explains it: at least 0.38
        if 1 - explained < 0.1 * met:
            return
        begin, stretch, unexplained = self._with_clock(lag, 1.0)
        is_met = unexplained < min(met, far_better * (1 - explained))
        off = abs(stretch - 1) > _LEAST_STRETCH and is_met
        if off and self._holds_all(begin, stretch):
            raise ValueError(_other_clock(name, stretch, self._duration))

    def _unexplained(self, lag: float, stretch: float) -> float:
        return 1 - float(self._explained(self._window(lag, stretch)[None])[0])

    def _with_clock(self, lag: float, stretch: float) -> tuple[float, float, float]:
        """The place [s], the clock's stretch near one, and the share left unexplained there."""
        step = stretch * float(self._at[1] - self._at[0])

        def unexplained(x: Array) -> float:
            return self._unexplained(lag + step * x[0], stretch * (1 + _PER_CENT * x[1]))

        found: Any = _least(unexplained, 2)
        place, clock = found.x
        return lag + step * float(place), stretch * (1 + _PER_CENT * float(clock)), float(found.fun)

    def _holds_all(self, begin: float, stretch: float) -> bool:
        """Return whether the move, by a clock, is all the recorded way, and no piece of it."""
        if not 0.2 <= stretch <= 5:
            return False
        nearly = 0.9  # share of the way; a swing after the move goes beyond it
        return float(np.ptp(self._window(begin, stretch))) > nearly * float(np.ptp(self._values))

    def sizes(self, lag: float) -> Array:
        """The size of each course at a place, over what the plan says."""
        window = self._window(lag, 1.0)
        return self._sizes((window - window.mean()) @ self._courses)

    def refuse_other_clock(self, name: str, explained: float, most: float) -> None:
        """Refuse a move that is met by a clock that runs faster or slower.

        A move is met where no more than a share is unexplained.
        """
        far_better = 0.1
        longest = float(np.ptp(self._time)) / self._duration
        stretches = [s for s in np.geomspace(0.2, 5, 65) if s < longest]
        found = [(*self.best(s), s) for s in stretches]
        begin, best, stretch = max(found, key=lambda each: each[1], default=(0.0, 0.0, 1.0))
        if 1 - best >= far_better * (1 - explained):
            return
        begin, stretch, unexplained = self._with_clock(begin, float(stretch))
        if unexplained < most and self._holds_all(begin, stretch):
            raise ValueError(_other_clock(name, stretch, self._duration))


def _least(function: Callable[[Array], float], unknowns: int) -> Any:
    """The least of a function near zeros, by a method that needs no derivatives."""
    from scipy.optimize import minimize  # not at the top: it takes long to load

    options = {"xatol": 1e-4, "fatol": 1e-12}
    return minimize(function, np.zeros(unknowns), method="Nelder-Mead", options=options)


def _averaged(time: Array, values: Array, step: float) -> Array:
    """Means over about a step, where samples are denser: noise is not taken for a move."""
    from scipy.ndimage import uniform_filter1d  # not at the top: it takes long to load

    size = max(1, round(step / float(np.median(np.diff(time)))))
    smoothed: Array = uniform_filter1d(values, size, mode="nearest")
    return smoothed


def _other_clock(name: str, stretch: float, duration: float) -> str:
    return (
        f"{name}: its clock is off: the move takes {stretch * duration:.4g} s there, and "
        f"{duration:.4g} s in the plan; give the samples per second by --rate, the time's unit by "
        "--units, or the recording of this plan's move"
    )


def _check_way(plan: Plan, recording: Recording, lag: float, share: float) -> None:
    """Refuse a joint that moved another way than the plan's, or as far by another path."""
    if abs(share - 1) <= _SAME_WAY:
        return
    linear = plan.task.plant.joint == LINEAR
    size, unit = (1e3, "mm") if linear else (180 / np.pi, "deg")
    went = size * _way(recording, lag, plan.task.duration)
    span = size * plan.task.span
    if abs(went / span - 1) <= _SAME_WAY:
        raise ValueError(
            f"{recording.name}: it is of another move: its joint goes {went:.4g} {unit}, as "
            "the plan's does, by another path; give the recording of this plan's move"
        )
    raise ValueError(
        f"{recording.name}: it is of another move: its joint goes {went:.4g} {unit}, and that of "
        f"the plan {span:.4g}; give the recording of this plan's move, or its unit by --units"
    )


def _way(recording: Recording, begin: float, duration: float) -> float:
    """Return how far a joint goes in a recording, from before a move to after it."""
    assert recording.angle is not None
    time, angle = recording.time, recording.angle
    margin = _BEFORE * duration
    before, after = angle[time <= begin - margin], angle[time >= begin + duration + margin]
    first = np.median(before) if len(before) else angle[0]
    last = np.median(after) if len(after) else angle[-1]
    return float(last - first)
