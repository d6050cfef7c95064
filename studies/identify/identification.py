"""The parameters of a plant from recordings of the machine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from math import pi

import numpy as np
from numpy.typing import NDArray
from quietarm.models import Plant
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.record import versions
from quietarm.ocp.uncertainty import refuse_unknown
from quietarm.studies.identify.answer import Estimate, Fitted, Identified, in_torque_alone
from quietarm.studies.identify.fit import Fit, Piece, fit, left, measured, not_told
from quietarm.studies.identify.recording import Recording
from quietarm.studies.identify.response import Joint, Response
from quietarm.studies.identify.ring_downs import (
    LEAST_PERIODS,
    ring_downs,
    standstills,
    strongest_frequency,
)

Array = NDArray[np.float64]
_FREQUENCY, _DAMPING = "rad/s", "zeta"
"""Unit of a mode's frequency, and how the name of its damping ratio begins."""
_LEVEL = 0.95
_SLOWEST, _FASTEST = 0.02, 500.0
"""Frequencies [Hz] beyond which a wrong unit of the time is more likely."""
_BAD = 0.9
"""Share of the signals' size that a fit may leave."""


@one_at_a_time
def identify(
    recordings: Sequence[Recording], plant: Plant, free: Sequence[str] | None = None
) -> Identified:
    """Fit a plant's parameters to recordings, by least squares on its own equations.

    Frequencies and dampings are told by ring-downs, which are found: where a recorded joint stands,
    or where a swing decays. All else, and they where the joint never stands, is told by how the
    plant answers the recorded motion of its joint.

    Parameters
    ----------
    recordings : sequence of Recording
        Of one machine, with the same signals.
    plant : Plant
        Its equations, and the values of what is not sought.
    free : sequence of str, optional
        The parameters that are sought; by default frequencies and dampings, and with a torque what
        nothing but the torque depends on.

    Returns
    -------
    Identified
        The plant, the intervals, and what the recordings do not tell.

    Raises
    ------
    ValueError
        When a parameter is unknown, the recordings have different signals, nothing in them rings
        for two periods, or no parameters of the plant meet them.
    """
    recordings = list(recordings)
    if not recordings:
        raise ValueError("no recording is given; give one")
    kinds = list(recordings[0].signals)
    for one in recordings[1:]:
        if list(one.signals) != kinds:
            raise ValueError(
                f"{one.name} has {' and '.join(one.signals)}, {recordings[0].name} "
                f"{' and '.join(kinds)}; give recordings of the same signals"
            )
    _check_tips(plant, recordings)
    names = _sought(plant, free, kinds)
    modal = [name for name in names if _is_modal(plant, name)]
    swings = _swings_alone(plant, names, kinds)
    pieces, left_out, frequency = _pieces(recordings, forced=not swings)
    plant = _started(plant, modal, frequency)
    answer = _Identification(plant, names, kinds, pieces, swings)
    return answer.made(left_out)


def fitted_parts(
    found: Identified, recordings: Sequence[Recording]
) -> list[tuple[Array, Array, Array]]:
    """Time, measured and fitted signals of every part, a row a sample."""
    kinds, names = list(recordings[0].signals), list(found.fitted)
    response = Response(found.plant, names, kinds)
    p, scaled = np.array([*found.fitted.values()]), _swings_alone(found.plant, names, kinds)
    drawn: list[tuple[Array, Array, Array]] = []
    for part in found.parts:
        (one,) = (each for each in recordings if each.name == part.recording)
        first, last = np.searchsorted(one.time, [part.begin, part.end])
        piece = Piece.of(one.part(int(first), int(last) + 1), Joint.of(one))
        fitted = left(response, piece, p, scaled).fitted
        drawn.append((piece.recording.time, measured(piece.recording), fitted))
    return drawn


def _swings_alone(plant: Plant, names: Sequence[str], kinds: Sequence[str]) -> bool:
    """Whether only frequencies and dampings are sought, which need no scale."""
    return "torque" not in kinds and all(_is_modal(plant, name) for name in names)


def _is_modal(plant: Plant, name: str) -> bool:
    return _unit(plant, name) == _FREQUENCY or name.startswith(_DAMPING)


def _unit(plant: Plant, name: str) -> str:
    return next(one.metadata.get("unit", "") for one in fields(plant) if one.name == name)


def _check_tips(plant: Plant, recordings: Sequence[Recording]) -> None:
    for one in recordings:
        for kind, values in one.signals.items():
            if kind != "torque" and values.shape[1] != plant.tips:
                raise ValueError(
                    f"{one.name} has {values.shape[1]} of {kind}; {plant.name} has {plant.tips} "
                    "tips, give one of each"
                )


def _sought(plant: Plant, free: Sequence[str] | None, kinds: Sequence[str]) -> list[str]:
    known = plant.measured
    if free is not None:
        refuse_unknown(plant, free, also=())
        return list(dict.fromkeys(free))
    names = [name for name in known if _is_modal(plant, name)]
    if "torque" in kinds:
        names += [name for name in known if name not in names and in_torque_alone(plant, name)]
    if not names:
        raise ValueError(
            f"{plant.name} has no parameter in rad/s and none that begins with zeta; name what is "
            "sought by free"
        )
    return names


def _pieces(recordings: Sequence[Recording], forced: bool) -> tuple[list[Piece], list[str], float]:
    """What is fitted, the names of what is not, and the frequency of the swing [Hz]."""
    joints = [Joint.of(one) for one in recordings]
    known = list(zip(recordings, joints, strict=True))
    stills = [still for one, joint in known for still in standstills(one, joint)]
    frequency = strongest_frequency(_loudest(stills) or recordings)
    if not _SLOWEST <= frequency <= _FASTEST:
        raise ValueError(
            f"{recordings[0].name} swings at {frequency:.3g} Hz, as no arm does; is its time in "
            "another unit?"
        )
    whole = [Piece.of(*each) for each in known if each[1].moves]
    found = [
        Piece.of(decay, joint)
        for one, joint in known
        for decay in ring_downs(one, joint, frequency)
    ]
    taken = whole if forced or not found else found
    if forced and len(whole) < len(known):
        name = next(one.name for one, joint in known if not joint.moves)
        raise ValueError(
            f"{name}: the joint does not move, and what is sought shows while it moves alone; "
            "record its angle during a move"
        )
    if not taken:
        raise _too_short(recordings, frequency)
    names = {piece.recording.name for piece in taken}
    return taken, [one.name for one in recordings if one.name not in names], frequency


def _too_short(recordings: Sequence[Recording], frequency: float) -> ValueError:
    longest = max(one.periods(frequency) for one in recordings)
    few = ""
    if longest < LEAST_PERIODS:
        few = f": it lasts {longest:.2g} periods of {frequency:.3g} Hz"
    angle = "" if recordings[0].angle is not None else ", or record the joint's angle, too"
    return ValueError(
        f"{recordings[0].name} has no ring-down{few}; record the tip for two periods and more "
        f"after a push, with the joint held{angle}"
    )


def _loudest(stills: Sequence[Recording]) -> list[Recording]:
    """Those that swing a tenth as much as the one that swings most."""
    sizes = [
        max(float(values.std(axis=0).max()) for values in one.signals.values()) for one in stills
    ]
    return [one for one, size in zip(stills, sizes, strict=True) if size > 0.1 * max(sizes)]


def _started(plant: Plant, modal: Sequence[str], frequency: float) -> Plant:
    """The plant with the frequency of the swing, where it has but one to be set."""
    of_modes = [name for name in modal if _unit(plant, name) == _FREQUENCY]
    if len(of_modes) != 1:
        return plant
    return replace(plant, **{of_modes[0]: 2 * pi * frequency})


@dataclass(frozen=True)
class _Identification:
    plant: Plant
    names: list[str]
    kinds: list[str]
    pieces: list[Piece]
    scaled: bool

    def made(self, left_out: Sequence[str]) -> Identified:
        start = np.array([getattr(self.plant, name) for name in self.names])
        everything = Response(self.plant, self.names, self.kinds)
        untold = not_told(everything, self.pieces, start, self.scaled)
        names = [name for name in self.names if name not in untold]
        if not names:
            raise ValueError(
                f"the recordings tell nothing of {', '.join(self.names)}; name others by free"
            )
        response = Response(self.plant, names, self.kinds)
        start = np.array([getattr(self.plant, name) for name in names])
        among = fit(response, self.pieces, start, self.scaled)
        self._check(among)
        fitted = dict(zip(names, map(float, among.p), strict=True))
        swung = self._long_enough(fitted)
        if len(swung) < len(self.pieces):
            there = {piece.recording.name for piece in swung}
            every = dict.fromkeys(piece.recording.name for piece in self.pieces)
            more = [name for name in every if name not in there]
            return replace(self, pieces=swung).made([*left_out, *more])
        alone = [fit(response, [one], among.p, self.scaled) for one in among.pieces]
        estimates: list[Estimate] = []
        for k, name in enumerate(names):
            one = self._estimate(name, among, np.array([each.p[k] for each in alone]), k)
            if one.low <= 0 or one.error >= 1:
                ends = f"{max(one.low, 0.0):.3g} to {one.high:.3g}"
                untold[name] = f"its interval, {ends}, is as wide as its value"
            else:
                estimates.append(one)
        untold = {name: untold[name] for name in self.names if name in untold}
        plant = replace(self.plant, **{one.parameter: one.value for one in estimates})
        parts = tuple(self._part(response, among, alone, k) for k in range(len(alone)))
        return Identified(
            plant, fitted, tuple(estimates), untold, parts, tuple(left_out), versions()
        )

    def _long_enough(self, found: Mapping[str, float]) -> list[Piece]:
        """The pieces that last two periods of what was found: the spectrum of a short one errs."""
        rates = [value for name, value in found.items() if _unit(self.plant, name) == _FREQUENCY]
        if len(rates) != 1 or not self.scaled:
            return self.pieces
        frequency = rates[0] / (2 * pi)
        long = [one for one in self.pieces if one.recording.periods(frequency) >= LEAST_PERIODS]
        if not long:
            raise _too_short([one.recording for one in self.pieces], frequency)
        return long

    def _check(self, among: Fit) -> None:
        misfits = [
            _misfit(piece, one.fitted) for piece, one in zip(among.pieces, among.parts, strict=True)
        ]
        if min(misfits) > _BAD:
            raise ValueError(
                f"{self.pieces[0].recording.name}: with no {' and '.join(self.names)} does "
                f"{self.plant.name} move so, {min(misfits):.0%} of the signal is left; check "
                "columns and units"
            )

    def _estimate(self, name: str, among: Fit, alone: Array, k: int) -> Estimate:
        """The interval of the fit, or of the spread of its parts, whichever is wider."""
        from scipy.stats import t  # not at the top: it takes long to load

        value, half, by = float(among.p[k]), float(among.half_widths(_LEVEL)[k]), "fit"
        if len(alone) > 1:
            spread = float(
                alone.std(ddof=1) / len(alone) ** 0.5 * t.ppf((1 + _LEVEL) / 2, len(alone) - 1)
            )
            if spread > half:
                half, by = spread, "spread"
        return Estimate(name, value, value - half, value + half, by)

    def _part(self, response: Response, among: Fit, alone: Sequence[Fit], k: int) -> Fitted:
        piece = among.pieces[k]
        others = [*among.pieces[:k], *among.pieces[k + 1 :]]
        held_back = None
        if others:
            p = fit(response, others, among.p, self.scaled).p
            held_back = _misfit(piece, left(response, piece, p, self.scaled).fitted)
        recording = piece.recording
        return Fitted(
            recording.name, float(recording.time[0]), float(recording.time[-1]),
            tuple(map(float, alone[k].p)), _misfit(piece, among.parts[k].fitted), held_back,
        )  # fmt: skip


def _misfit(piece: Piece, fitted: Array) -> float:
    """What is left, as a share of the signals' deviation; of several the largest."""
    y = measured(piece.recording)
    return float(((y - fitted).std(axis=0) / np.maximum(y.std(axis=0), 1e-300)).max())
