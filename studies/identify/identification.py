"""The parameters of a plant from recordings of the machine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import tau

import numpy as np
from quietarm.models import Plant
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.record import versions
from quietarm.ocp.uncertainty import refuse_unknown
from quietarm.studies.identify.answer import Identified, Part, in_torque_alone
from quietarm.studies.identify.combine import combine
from quietarm.studies.identify.forced import (
    Forced,
    ForcedModel,
    described,
    fit_forced,
    not_identifiable,
)
from quietarm.studies.identify.parameters import is_modal, started_at, values_of
from quietarm.studies.identify.parts import candidates, longest_rest, moves, prominence
from quietarm.studies.identify.recording import Recording
from quietarm.studies.identify.response import Response
from quietarm.studies.identify.ring_down import RingDowns
from quietarm.studies.identify.swing import Swing, averaged

_SLOWEST, _FASTEST = 0.02, 500.0
"""Frequencies [Hz] that no arm has: a wrong unit of the time is more likely."""
_COARSE, _DOUBTFUL = 0.2, 0.1
"""A step [s] and a frequency [Hz] that may come from a time in milliseconds."""
_TURNS = 2 * tau
"""A joint that turns further may be in degrees."""
_BAD = 0.9
"""Share of the signal's size that a forced fit may leave."""
_FACTORS = (1.0, 0.8, 1.25, 0.6, 1.6)
"""Of the spectrum's frequency, from which forced fits start, beside the plant's own."""
_SAMPLES = 200
"""A period, of what is fitted to the joint's motion."""


@one_at_a_time
def identify(
    recordings: Sequence[Recording],
    plant: Plant,
    free: Sequence[str] | None = None,
    parts: Sequence[tuple[float, float]] = (),
) -> Identified:
    """Fit a plant's parameters to recordings, by least squares on its own equations.

    Frequencies and dampings are identified by ring-downs, each found and fitted alone: where a
    recorded joint is at rest or creeps. All else, and they where the joint never rests, by how the
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
    parts : sequence of (float, float), optional
        Begin and end [s] of each ring-down, in every recording; found by default.

    Returns
    -------
    Identified
        The plant, the intervals of the mean and of the next swing, and what is not identifiable.

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
    frequencies = find_frequencies(recordings)
    warnings = _doubts(recordings, frequencies)
    fitted, left_out, unknown = list[Part](), dict[str, str](), dict[str, str]()
    if _swings_alone(plant, names, kinds):
        fitter = RingDowns(plant, names)
        for one, frequency in zip(recordings, frequencies, strict=True):
            found, why = fitter.fit(one, frequency, parts)
            fitted += found
            if why:
                left_out[one.name] = why
        if not fitted and not any(moves(one) for one in recordings):
            raise ValueError("; ".join(f"{name}: {why}" for name, why in left_out.items()))
    if not fitted:
        fitted, unknown = _forced(recordings, plant, names, frequencies)
        left_out = {}
    known = [name for name in names if name not in unknown]
    estimates, wide = combine(known, fitted)
    unknown |= wide
    return Identified(
        replace(plant, **{one.parameter: one.value for one in estimates}),
        tuple(estimates), {name: unknown[name] for name in names if name in unknown},
        tuple(fitted), left_out, tuple(warnings), versions(),
    )  # fmt: skip


def fit_again(found: Identified, part: Part, recordings: Sequence[Recording]) -> Swing | Forced:
    """The fit of a part, as it was made from the recordings."""
    recording = next(one for one in recordings if one.name == part.recording)
    names = list(part.values)
    if part.hub == "equations":
        model = _model(found.plant, names, _thinned(recording, find_frequencies([recording])[0]))
        return fit_forced(model, [found.plant], names)
    return RingDowns(found.plant, names).again(part, recording)


def _swings_alone(plant: Plant, names: Sequence[str], kinds: Sequence[str]) -> bool:
    """Whether only frequencies and dampings are sought, which need no scale."""
    return "torque" not in kinds and all(is_modal(plant, name) for name in names)


def _model(plant: Plant, names: Sequence[str], recording: Recording) -> ForcedModel:
    kinds = list(recording.signals)
    return ForcedModel(Response(plant, names, kinds), recording, _swings_alone(plant, names, kinds))


def _thinned(recording: Recording, frequency: float) -> Recording:
    """A recording averaged to what a forced fit needs."""
    given = {
        k: v for k, v in vars(recording).items() if isinstance(v, np.ndarray) and k != "values"
    }
    share = _SAMPLES * frequency * recording.step
    if not share or share > 0.5:
        return recording
    mean = {
        k: averaged(v.reshape(len(v), -1), share).reshape(-1, *v.shape[1:])
        for k, v in given.items()
    }
    return replace(recording, **mean)


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
    names = [name for name in known if is_modal(plant, name)]
    if "torque" in kinds:
        names += [name for name in known if name not in names and in_torque_alone(plant, name)]
    if not names:
        raise ValueError(
            f"{plant.name} has no parameter in rad/s and none that begins with zeta; name what is "
            "sought by free"
        )
    return names


def find_frequencies(recordings: Sequence[Recording]) -> list[float]:
    """The frequency of every recording's swing [Hz]: that of all, where it is a candidate."""
    rests = [longest_rest(one) for one in recordings]
    tables = [{f: prominence(one, f) for f in candidates(one)} for one in rests]
    for one, table in zip(recordings, tables, strict=True):
        if not any(table.values()):
            if len(recordings) == 1:
                raise ValueError(
                    f"{one.name}: no swing stands out of the noise; push harder, or record longer "
                    "and with more samples"
                )
            table[0.0] = 0.0
    pooled: dict[float, float] = {}
    for table in tables:
        total = sum(table.values()) + 1e-300
        for frequency, loud in table.items():
            key = next((k for k in pooled if k and abs(frequency / k - 1) < 0.3), frequency)
            pooled[key] = pooled.get(key, 0.0) + loud / total
    common = max(pooled, key=lambda key: pooled[key])
    found: list[float] = []
    for table in tables:
        near = {f: v for f, v in table.items() if common and abs(f / common - 1) < 0.3}
        own = max(table, key=lambda f: table[f])
        best = max(near, key=lambda f: near[f]) if near else own
        found.append(best if near and near[best] > 0.05 * table[own] else own)
    for one, frequency in zip(recordings, found, strict=True):
        if frequency and not _SLOWEST <= frequency <= _FASTEST:
            raise ValueError(
                f"{one.name} swings at {frequency:.3g} Hz, as no arm does; is its time in another "
                "unit? say so by --units, as time:ms"
            )
    return found


def _doubts(recordings: Sequence[Recording], frequencies: Sequence[float]) -> list[str]:
    """What units may be wrong."""
    found: list[str] = []
    for one, frequency in zip(recordings, frequencies, strict=True):
        if one.step >= _COARSE or 0 < frequency < _DOUBTFUL:
            found.append(
                f"{one.name}: {frequency:.3g} Hz by samples {one.step:.3g} s apart; is its time in "
                "milliseconds? say so by --units time:ms"
            )
        if frequency > _FASTEST / 2:
            found.append(
                f"{one.name}: {frequency:.4g} Hz is fast for an arm; is its time in seconds? say "
                "so by --units time:s"
            )
        if one.angle is not None and np.ptp(one.angle) > _TURNS:
            found.append(
                f"{one.name}: its joint turns by {np.ptp(one.angle):.3g} rad, more than two turns; "
                "is it in degrees? say so by --units angle:deg"
            )
    return found


def _forced(
    recordings: Sequence[Recording], plant: Plant, names: list[str], frequencies: Sequence[float]
) -> tuple[list[Part], dict[str, str]]:
    """Every recording by all of its joint's motion, and what these do not tell."""
    for one in recordings:
        if not moves(one):
            raise ValueError(
                f"{one.name}: the joint does not move, and what is sought shows while it moves "
                "alone; record its angle during a move"
            )
    modal, loudest = [name for name in names if is_modal(plant, name)], max(frequencies)
    starts = [plant, *(started_at(plant, modal, loudest * factor) for factor in _FACTORS)]
    thin = [_thinned(one, f) for one, f in zip(recordings, frequencies, strict=True)]
    p = values_of(plant, names)
    unknown = not_identifiable([_model(plant, names, one) for one in thin], names, p)
    names = [name for name in names if name not in unknown]
    if not names:
        raise ValueError(
            f"the recordings tell nothing of {', '.join(unknown)}; name others by free"
        )
    fits = [
        fit_forced(_model(plant, names, one), list(dict.fromkeys(starts)), names) for one in thin
    ]
    least = min(fit.misfit for fit in fits)
    if least > _BAD:
        raise ValueError(
            f"{thin[0].name}: with no {' and '.join(names)} does {plant.name} move so, {least:.0%} "
            "of the signal is left; check columns and units"
        )
    each = zip(thin, fits, frequencies, strict=True)
    return [described(one, names, fit, frequency) for one, fit, frequency in each], unknown
