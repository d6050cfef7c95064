"""Evidence of a machine from all moves of a plan's history: its model, then its arrivals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from math import tau

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.identified import Estimate, Identified, Part, is_frequency
from quietarm.machine.learn.arrival_map import ArrivalMap, faster_by, map_of
from quietarm.machine.learn.reading.find_start import tip_share
from quietarm.machine.learn.reading.read_move import ReadMove
from quietarm.machine.learn.reading.read_swing import modal_names
from quietarm.machine.learn.tip_modes import TipModes
from quietarm.machine.learn.weigh_moves import weigh_moves
from quietarm.models import Plant
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.planning.executed import ExecutedMove, MoveHistory, RecordedArrival
from quietarm.ocp.planning.plan import Plan
from quietarm.ocp.record import versions
from quietarm.ocp.task import PointToPoint

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
_LEAST_CHANGE = 5e-4
"""Share of a frequency, below which a difference from the model is left to the arrival state."""
_LEAST_CHANGE_OF_DAMPING = 0.2
"""The same of a damping."""
_OF_TORQUES = 5e-4
"""Share of a frequency that torques hide in every recording alike: a belt's stretch, the servo."""
_OF_DAMPING = 0.3
"""Share by which a plan's damping is usually wrong."""
_OF_FEW = (4.0, 4.0, 4.0, 3.18, 2.78, 2.57, 2.45, 2.36, 2.31, 2.26)
"""Deviations that hold 95 of 100, by how many frequencies they follow from: Student's, and 4 where
that is more, as a machine hardly varies without bounds."""


def motion_of(move: ExecutedMove, task: PointToPoint, plant: Plant) -> JudgedMotion:
    """An executed move on a plant, with what else a task says."""
    start, target, duration = move.move
    executed = replace(
        task.certain, plant=plant, start=start, target=target, duration=duration, final=None
    )
    return JudgedMotion.of_profile(executed, move.profile, move.coefficients)


def told_of(move: ExecutedMove, task: PointToPoint, plant: Plant) -> ComplexArray:
    """Return each mode's swing at arrival by a plant, from the set points of an executed move."""
    motion = motion_of(move, task, plant)
    return TipModes(plant, move.move[1]).amplitudes(motion.arrival[0])


def evidence_of(plan: Plan, read: Sequence[ReadMove]) -> Evidence:
    """Combine the moves of a plan's history and recordings of the last one."""
    return Evidence(plan, history_with(plan, [one.after.measured for one in read]), read)


def history_with(plan: Plan, measured: Sequence[RecordedArrival]) -> MoveHistory:
    """The history of a plan with what was measured of it now."""
    plant = plan.task.plant
    model = {name: getattr(plant, name) for name in modal_names(plant)}
    history = plan.learned or MoveHistory(wanted=plan.task.final, model=model)
    now = ExecutedMove(plan.profile, plan.coefficients, plan.task.move, tuple(measured))
    *before, last = [*history.moves, None] if not history.moves else history.moves
    if last is not None and _same_motion(last, now):
        now = replace(now, measured=(*last.measured, *measured))
        return replace(history, moves=(*before, now))
    return replace(history, moves=(*history.moves, now))


def _name_of(number: int, measured: RecordedArrival) -> str:
    """The name of a recording of a move of the history."""
    return f"move {number}, {measured.recording}"


def _same_motion(first: ExecutedMove, second: ExecutedMove) -> bool:
    return (first.profile, first.coefficients, first.move) == (
        second.profile, second.coefficients, second.move,
    )  # fmt: skip


class Evidence:
    """Evidence that all moves together give of a machine.

    Parameters
    ----------
    plan : Plan
        That was executed last.
    history : MoveHistory
        All moves, the last one with it.
    read : sequence of ReadMove
        What was read of the last one.
    """

    def __init__(self, plan: Plan, history: MoveHistory, read: Sequence[ReadMove]) -> None:
        self._plan = plan
        self.history = history
        self._read = read
        self.modes = TipModes(self.plant, plan.task.target)

    @property
    def by_joint(self) -> bool:
        """Return whether no tip was recorded."""
        return all(one.by_joint for one in self._read)

    # The model

    @property
    def frequencies(self) -> dict[str, tuple[float, float]]:
        """Frequencies of modes that are no parameters, as planned and as told [Hz]: none here."""
        return {}

    @cached_property
    def _parts(self) -> list[Part]:
        """Parts by which each recording of the history tells the plant's parameters."""
        read = {part.recording: part for one in self._read if (part := one.after.part)}
        parts = list[Part]()
        for number, move in enumerate(self.history.moves, start=1):
            is_last = number == len(self.history.moves)
            for one in move.measured:
                if not one.values:
                    continue
                known = read.get(one.recording) if is_last else None
                name = _name_of(number, one)
                values, deviations = dict(one.values), dict(one.deviations)
                part = known or Part(one.recording, 0.0, 0.0, values, deviations)
                parts.append(replace(part, recording=name))
        return parts

    @cached_property
    def estimates(self) -> tuple[Estimate, ...]:
        """Frequencies and dampings by all recordings."""
        estimates = list[Estimate]()
        for name in modal_names(self._plan.task.plant):
            telling = [part for part in self._parts if name in part.values]
            estimated = weigh_moves(name, telling, self._swung) if telling else None
            estimates += [self._with_plan(estimated)] if estimated else []
        return tuple(estimates)

    def _with_plan(self, estimate: Estimate) -> Estimate:
        """A damping that torques tell, weighed with what the first plan said; others as they are.

        One move's torque tells it to a third, and the plan hardly better.
        """
        name, value = estimate.parameter, estimate.value
        if not self.by_joint or is_frequency(self._plan.task.plant, name):
            return estimate
        known = self.history.model.get(name, getattr(self._plan.task.plant, name))
        deviation = max((estimate.high - estimate.low) / 4, 1e-9 * known)
        weights = np.array([deviation, _OF_DAMPING * known]) ** -2.0
        mean, unsure = float(weights @ [value, known] / weights.sum()), float(weights.sum() ** -0.5)
        return replace(estimate, value=mean, low=mean - 2 * unsure, high=mean + 2 * unsure)

    @cached_property
    def _swung(self) -> dict[str, float]:
        """Swing of the tip after each recording's move [m], by its part's recording.

        All are 1 where the frequency follows from a torque, during the move.
        """
        return {
            _name_of(number, one): 1.0 if self.by_joint else sum(s.amplitude for s in one.swings)
            for number, move in enumerate(self.history.moves, start=1)
            for one in move.measured
        }

    @cached_property
    def changed(self) -> dict[str, tuple[float, float]]:
        """Parameters that are changed: the model's value, and the new one.

        A frequency is that during the moves, by what the swings at arrival tell beside it.
        """
        if not self._changed_by_swings:
            return {}
        plant = self._plan.task.plant
        swings = {name: value for name, (_, value) in self._changed_by_swings.items()}
        rates = [name for name in plant.measured if is_frequency(plant, name)]
        after = replace(plant, **swings)
        factor = 1 + self._faster_by(after, rates)
        moving = swings | {name: factor * getattr(after, name) for name in rates}
        return {name: (getattr(plant, name), value) for name, value in moving.items()}

    def _faster_by(self, plant: Plant, rates: Sequence[str]) -> float:
        """Share by which the slowest mode is faster during the moves than after them."""
        step = 1e-3
        faster = replace(plant, **{name: (1 + step) * getattr(plant, name) for name in rates})
        told = self._told_by(plant)
        slope = (self._told_by(faster) - told) / step
        share = self.seen_share(plant)
        if self.by_joint:
            return 0.0  # the swing is what this frequency makes of the joint's motion
        return faster_by(
            told[:, 0], slope[:, 0], self._left[:, 0], self._noise[:, 0], self._size, share
        )

    @cached_property
    def _changed_by_swings(self) -> dict[str, tuple[float, float]]:
        """Parameters that the recordings clearly have otherwise: the model's and their values.

        The model is that of the first plan: what was learned since is no evidence of its own.
        """
        plant = self._plan.task.plant
        changed = dict[str, tuple[float, float]]()
        for estimate in self.estimates:
            name = estimate.parameter
            model = getattr(plant, name)
            rate = is_frequency(plant, name)
            least = abs(model) * (_LEAST_CHANGE if rate else _LEAST_CHANGE_OF_DAMPING)
            first = self.history.model.get(name, model)
            outside = not estimate.low <= first <= estimate.high
            if outside and abs(estimate.value - model) > least:
                changed[name] = (model, estimate.value)
        if not any(is_frequency(plant, name) for name in changed):
            return {}  # a damping alone is left to the arrival state
        return changed if self._explains(changed) else {}

    def _explains(self, changed: dict[str, tuple[float, float]]) -> bool:
        """Return whether what is changed leaves less of the last move to explain.

        A small swing may show another frequency that the move does not have.
        """
        if self.by_joint:
            return True  # the swing is computed by it
        plant = self._plan.task.plant
        rest = list[float]()
        known = {name: getattr(plant, name) for name in changed}
        first = {name: self.history.model.get(name, value) for name, value in known.items()}
        for values in (first, {name: new for name, (_, new) in changed.items()}):
            other = replace(plant, **values)
            share = self.seen_share(other) or 1.0
            rest.append(float(np.abs(self._left[-1] - share * self._told_by(other)[-1]).sum()))
        return rest[1] < rest[0]

    @cached_property
    def plant(self) -> Plant:
        """The plant with what is changed: its frequencies are those during the moves."""
        new = {name: value for name, (_, value) in self.changed.items()}
        return replace(self._plan.task.plant, **new)

    @cached_property
    def told_plant(self) -> Plant:
        """The plant with each frequency and damping that the recordings tell, changed or not."""
        values = {estimate.parameter: estimate.value for estimate in self.estimates}
        return replace(self._plan.task.plant, **values)

    def machine(self) -> Identified:
        """The plant with all that recordings tell of it."""
        names = modal_names(self._plan.task.plant)
        told = {estimate.parameter for estimate in self.estimates}
        return Identified(
            plant=self.told_plant,
            estimates=self.estimates,
            not_identifiable={
                name: "the swings after the moves are too small"
                for name in names
                if name not in told
            },
            parts=tuple(self._parts),
            left_out={},
            warnings=(),
            versions=versions(),
        )

    # The arrival

    def _motion(self, move: ExecutedMove, plant: Plant) -> JudgedMotion:
        """An executed move on a plant."""
        return motion_of(move, self._plan.task, plant)

    @cached_property
    def _told(self) -> ComplexArray:
        """Swing that the plant with what is changed says of the set points of each move."""
        return self._told_by(self.plant)

    def _told_by(self, plant: Plant) -> ComplexArray:
        """Return the swing that a plant says of the set points of each move (moves, modes)."""
        return np.stack([told_of(move, self._plan.task, plant) for move in self.history.moves])

    @lru_cache(maxsize=4)  # noqa: B019  # it lives as long as the evidence
    def seen_share(self, plant: Plant) -> float | None:
        """Return the share of a plant's swing that the tip shows during the move; None if unseen.

        1 where the swing is what the plant makes of the joint's motion.
        """
        if self.by_joint:
            return 1.0
        recordings = [one.recording for one in self._read]
        motion = self._motion(self.history.moves[-1], plant)
        seen = [tip_share(motion, recording) for recording in recordings]
        known = [share for share in seen if share is not None]
        return float(np.median(known)) if known else None

    @cached_property
    def _swings(self) -> list[ComplexArray]:
        """Measured swings of each move (recordings, modes)."""
        return [
            np.array([[s.complex_amplitude for s in one.swings] for one in move.measured])
            for move in self.history.moves
        ]

    @cached_property
    def _left(self) -> ComplexArray:
        """The mean of what each move left (moves, modes)."""
        return np.stack([swings.mean(axis=0) for swings in self._swings])

    @cached_property
    def _wanted(self) -> ComplexArray:
        """The swing at arrival that was asked for, of each mode."""
        wanted = self.history.wanted
        if wanted is None:
            return np.zeros(len(self.modes.values), complex)
        return self.modes.amplitudes([*wanted.W, *wanted.dW])

    @cached_property
    def _of_one(self) -> Array:
        """Standard deviation of what one recording of each move shows, of each mode: its noise."""
        noise = [
            [[s.deviation for s in one.swings] for one in m.measured] for m in self.history.moves
        ]
        return np.stack([np.sqrt((np.array(each) ** 2).mean(axis=0)) for each in noise])

    @cached_property
    def _scatter(self) -> Array | None:
        """Scatter of swings between recordings of one move, by mode; None if each move has one."""
        repeated = [swings for swings in self._swings if len(swings) > 1]
        if not repeated:
            return None
        squares = sum((np.abs(s - s.mean(axis=0)) ** 2).sum(axis=0) for s in repeated)
        freedom = 2 * sum(len(s) - 1 for s in repeated)
        return np.sqrt(squares / freedom)

    @cached_property
    def _noise(self) -> Array:
        """Standard deviation of each move's mean, by mode (moves, modes)."""
        counts = np.array([len(swings) for swings in self._swings])[:, None]
        single = self._of_one if self._scatter is None else np.hypot(self._of_one, self._scatter)
        return single / np.sqrt(counts)

    @cached_property
    def _size(self) -> float:
        """The tip's largest displacement from the joint during the last move [m]."""
        times = np.linspace(0, self._plan.task.duration, 200)
        return float(np.abs(self._plan.sampled(times).tips).max())

    @cached_property
    def maps(self) -> list[ArrivalMap]:
        """Map of each mode from what the plant says of set points to its swing at arrival."""
        share = self.seen_share(self.plant)
        # what earlier moves left by the joint was computed with another frequency
        rows = slice(-1, None) if self.by_joint else slice(None)
        told, left, noise = self._told[rows], self._left[rows], self._noise[rows]
        return [
            map_of(told[:, k], left[:, k], noise[:, k], self._size, share)
            for k in range(len(self.modes.values))
        ]

    @cached_property
    def _again(self) -> ComplexArray:
        """Swing that the last move would leave if executed again, beside what was wanted."""
        return np.array([m.swing(t) for m, t in zip(self.maps, self._told[-1])]) - self._wanted

    @cached_property
    def step(self) -> float:
        """Share of the correction that is worth making: 0 where what is left may be noise."""
        if self.is_as_allowed:
            return 0.0
        left = np.abs(self._again)
        unsure = np.array([m.deviation_of(t) for m, t in zip(self.maps, self._told[-1])])
        unseen = self.beyond if self.by_joint else 0.0
        if left.sum() <= self.floor + unseen and (self.by_joint or not self.changed):
            return 0.0
        power = float((left**2).sum())
        return power / (power + 2 * float((unsure**2).sum()))

    @cached_property
    def allowed(self) -> float:
        """Swing that the last plan may leave by its residual limit, as this machine shows it [m].

        0 where the plan arrives at rest.
        """
        limit = self._plan.residual_limit or 0.0
        if limit == 0.0:
            return 0.0
        task = self._plan.task
        (missed,) = task.missed(self._plan.candidate.arrival[:1])
        leaves = self._reach(TipModes(task.plant, task.target).amplitudes(missed))
        return max(limit, leaves) * max(1.0, *(abs(m.share) for m in self.maps))

    @cached_property
    def is_as_allowed(self) -> bool:
        """Return whether the last move left what its plan allows, so that another leaves as much.

        Either all of it is within that, or what the plan missed of its arrival state explains all
        but noise.
        """
        if self.allowed == 0.0:
            return False
        stays = self.floor + (self.beyond if self.by_joint else 0.0)
        if self._reach(self._again) <= self.allowed + stays:
            return True
        aimed = self.modes.amplitudes(self._plan.task.final_state)
        missed = [m.swing(t) - w for m, t, w in zip(self.maps, aimed, self._wanted)]
        return not self.changed and self._reach(np.array(missed)) <= stays

    def _reach(self, amplitudes: ComplexArray) -> float:
        """Return how far the tip gets from where it rests by swings of all modes [m]."""
        return float(np.abs(amplitudes).sum())

    def told_next(self, step: float) -> ComplexArray:
        """Return what the plant is to say of the next set points, by mode."""
        aim = self._wanted + (1 - step) * self._again
        return np.array([m.told_for(swing) for m, swing in zip(self.maps, aim)])

    def at_most(self, told: ComplexArray) -> float:
        """Return the most that the next move leaves, in 95 of 100 cases.

        By what the plant says of its set points: what the plan itself leaves is in it.
        """
        many = 2.0  # deviations
        aimed = np.abs([m.swing(t) - w for m, t, w in zip(self.maps, told, self._wanted)])
        unsure = np.array([m.deviation_of(t) for m, t in zip(self.maps, told)])
        foreseen = float((aimed + many * unsure).sum()) + self.floor
        return foreseen + self.beyond + self.settling + self._by_changes

    @property
    def settling(self) -> float:
        """Motion of the tip beside its swing, while the servo settles [m]."""
        return max(one.after.settling for one in self._read)

    @cached_property
    def _by_changes(self) -> float:
        """Swing that the last move would have, were the frequency as far off as it varies [m].

        In 95 of 100 cases, as far as the moves tell; 0 where they do not clearly differ.
        """
        largest = 0.0
        for name, telling in self._changing:
            values = np.array([part.values[name] for part in telling])
            spread = float(values.std(ddof=1)) * (1 + 1 / len(values)) ** 0.5
            many = _OF_FEW[min(len(values), len(_OF_FEW)) - 1]
            for away in (-many * spread, many * spread):
                other = getattr(self.plant, name) + away
                told = self._told_by(replace(self.plant, **{name: other}))[-1]
                largest = max(largest, float(np.abs(told - self._told[-1]).sum()))
        return largest

    @property
    def left(self) -> float:
        """Swing of all modes at arrival of the last move: the mean of its recordings."""
        return float(np.abs(self._swings[-1]).sum(axis=1).mean())

    @cached_property
    def _frequency_share(self) -> ComplexArray:
        """Part of the last move's swing that follows from the changed parameters, by mode."""
        if not self.changed:
            return np.zeros(len(self.modes.values), complex)
        before = self._motion(self.history.moves[-1], self._plan.task.plant)
        modes = TipModes(self._plan.task.plant, self._plan.task.target)
        told_before = modes.amplitudes(before.arrival[0])
        return np.array([m.share for m in self.maps]) * (self._told[-1] - told_before)

    @property
    def by_frequency(self) -> float:
        """Size of the same."""
        return float(np.abs(self._frequency_share).sum())

    @property
    def repeatable(self) -> float:
        """Swing left beside what changed parameters explain, and beside what was wanted."""
        rest = self._left[-1] - self._frequency_share - self._wanted
        return float(np.abs(rest).sum())

    @property
    def scatter(self) -> float | None:
        """Standard deviation of what is left from recording to recording, of all modes."""
        return None if self._scatter is None else float(np.sqrt(2) * self._scatter.sum())

    @property
    def floor(self) -> float:
        """Swing that no plan takes away: twice the deviation of one move."""
        single = self._of_one[-1]
        if self._scatter is not None:
            single = np.hypot(single, self._scatter)
        return 2 * float(single.sum())

    @property
    def beyond(self) -> float:
        """Motion of the tip beside its modes, and what a torque does not tell [m]."""
        return self._unseen + max(one.after.other for one in self._read)

    @cached_property
    def _unseen(self) -> float:
        """Swing that a torque's frequency and damping do not tell: twice its deviation [m].

        0 where a tip was recorded.
        """
        if not self.by_joint:
            return 0.0
        power = 0.0
        for estimate in self.estimates:
            name, deviation = estimate.parameter, (estimate.high - estimate.low) / 4
            if is_frequency(self.plant, name):
                deviation = float(np.hypot(deviation, _OF_TORQUES * estimate.value))
            other = replace(self.plant, **{name: getattr(self.plant, name) + deviation})
            power += float(np.abs(self._told_by(other)[-1] - self._told[-1]).sum()) ** 2
        return 2 * power**0.5

    @property
    def doubts(self) -> list[str]:
        """Doubts whether moves repeat, and whether the machine stays what it is."""
        return [*self._changes, *self._differences]

    @property
    def _changes(self) -> list[str]:
        """Words on a frequency that clearly was another in another move of the history."""
        words = list[str]()
        for name, telling in self._changing:
            low, high = (choose(part.values[name] for part in telling) for choose in (min, max))
            share = 100 * (high - low) / (high + low)
            words.append(
                f"warning: the machine changes from move to move: it swung at {low / tau:.4g} and "
                f"{high / tau:.4g} Hz, which no correction foresees; make a robust plan, by "
                f"--error frequency={share:.2g}%"
            )
        return words

    @property
    def _changing(self) -> list[tuple[str, list[Part]]]:
        """Frequencies that clearly were others in other moves, with the parts that tell them."""
        least = 0.01  # share of a frequency; less is what amplitude and friction make of it
        clear = 5.0  # deviations
        changing = list[tuple[str, list[Part]]]()
        for name in (name for name in self.plant.measured if is_frequency(self.plant, name)):
            telling = [part for part in self._parts if name in part.values]
            if len(telling) < 2:
                continue
            low, high = (choose(telling, key=lambda p: p.values[name]) for choose in (min, max))
            apart = high.values[name] - low.values[name]
            unsure = float(np.hypot(low.deviations[name], high.deviations[name]))
            if apart > max(least * high.values[name], clear * unsure):
                changing.append((name, telling))
        return changing

    @property
    def _differences(self) -> list[str]:
        """Words on recordings of the last move that differ."""
        most = 0.5  # share of what is left, by which moves may differ
        beyond = 3.0  # deviations of the noise, by which they differ at any rate
        noise = beyond * float(np.sqrt(2) * self._of_one[-1].sum())
        if self.scatter is None or self.scatter <= max(most * self.left, noise):
            return []
        sizes = [f"{1e3 * float(s):.3g}" for s in np.abs(self._swings[-1]).sum(axis=1)]
        return [
            f"warning: the moves do not repeat: they leave {', '.join(sizes)} mm; record more of "
            "them, or make a robust plan, by --error"
        ]
