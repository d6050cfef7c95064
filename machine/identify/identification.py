"""The parameters of a plant from recordings of the machine."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from math import tau

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.combine import Combined, combine
from quietarm.machine.identify.fits.part_fitter import PartFitter
from quietarm.machine.identify.fits.swing_model import SwingModel
from quietarm.machine.identify.fits.whole_recording import fit_whole, sensitivities
from quietarm.machine.identify.identified import (
    Identified,
    Part,
    in_torque_alone,
    is_damping,
    is_frequency,
    is_modal,
)
from quietarm.machine.identify.swings.frequencies import (
    doubt_units,
    find_frequencies,
    may_be_alias,
)
from quietarm.machine.identify.swings.recording_parts import NO_SWING, fit_parts
from quietarm.machine.identify.swings.ring_downs import moves
from quietarm.machine.recordings.mending import without_glitches
from quietarm.machine.recordings.recording import LEAST_ROWS, Recording, checked_recordings
from quietarm.models import Plant
from quietarm.models.drive import Recorded
from quietarm.ocp.checks import finite, several, takes
from quietarm.ocp.record import versions
from quietarm.ocp.uncertainty import refuse_unknown

Array = NDArray[np.float64]


@takes(plant=Plant)
def identify(
    recordings: Sequence[Recording],
    plant: Plant,
    free: Sequence[str] | None = None,
    parts: Sequence[tuple[float, float]] = (),
    recorded: Recorded | None = None,
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
    recorded : str, optional
        How the joint was while it was recorded, "held" or "moving" under its servo, which a `Drive`
        has to know. By default it is held where its angle is recorded, since its motion is then an
        input of the fit; else it is not known.

    Returns
    -------
    Identified
        The plant, the intervals of the mean and of the next swing, and what is not identifiable.
        What recordings tell roughly is in the plant as well; of what they tell nothing it keeps
        the values that it had.

    Raises
    ------
    ValueError
        When a parameter is unknown, the recordings have different signals, nothing in them rings
        for two periods, or no parameters of the plant meet them.
    """
    recordings = checked_recordings(recordings)
    kinds = _check(recordings, plant)
    names = _sought(plant, free, kinds)
    parts = _checked_parts(parts)
    cut, left_out = _cut_to(parts, recordings)
    recordings, doubts = without_glitches(cut)
    doubts = [*dict.fromkeys(doubts)]  # those of one recording stand in each of its parts
    frequencies = find_frequencies(recordings)
    fitters = [
        PartFitter(plant, names, recording, frequency)
        for recording, frequency in zip(recordings, frequencies)
    ]
    at_rest = "torque" not in kinds and all(is_modal(plant, name) for name in names)
    # a joint that is held tells nothing of other parameters, which is said further down
    _refuse_other_frequency([one for one in fitters if at_rest or moves(one.recording)])
    if parts and not at_rest:
        raise ValueError(
            "a part selects ring-downs, and what is sought needs all of the recording; leave the "
            "parts out, or seek frequencies and dampings alone, without a torque"
        )
    fitted = list[Part]()
    moving = list[PartFitter]()
    for fitter in fitters:
        ring_downs = list[Part]()
        if coarse := may_be_alias(fitter.recording, fitter.frequency):
            left_out[fitter.recording.name] = coarse
            continue
        why = NO_SWING
        if at_rest:
            ring_downs, why = fit_parts(fitter, by_hand=bool(parts))
        if ring_downs and (coarse := may_be_alias(fitter.recording, fitter.frequency)):
            ring_downs, why = [], coarse
        fitted += ring_downs
        if not ring_downs and fitter.frequency and (moves(fitter.recording) or not at_rest):
            moving.append(fitter)
        elif not ring_downs:
            left_out[fitter.recording.name] = why
    left_out = {name: why for name, why in left_out.items() if not _is_read(name, fitted)}
    if not fitted and not moving:
        if not any(frequencies):
            raise ValueError(
                f"{recordings[0].name}: {NO_SWING}; push harder, or record longer and with more "
                "samples"
            )
        raise ValueError(_by_recording(left_out))
    unknown = {} if fitted else _not_identifiable(moving)
    sought = [name for name in names if name not in unknown]
    fitted += [fit_whole(fitter.of(sought)) for fitter in moving]
    fitted, worthless = _worth_pooling(plant, fitted)
    combined = combine(sought, fitted)
    unknown |= combined.wide
    doubts += doubt_units(recordings, [fitter.frequency for fitter in fitters], plant.joint)
    doubts += _drifts(plant, combined, fitted)
    values = {estimate.parameter: estimate.value for estimate in combined.estimates}
    return Identified(
        plant=replace(plant, **values, **combined.rough),
        estimates=tuple(combined.estimates),
        not_identifiable={name: unknown[name] for name in names if name in unknown},
        parts=tuple(fitted),
        left_out=left_out | worthless,
        warnings=tuple(doubts),
        versions=versions(),
        rough=combined.rough,
        recorded=recorded or _recorded(recordings, fitted),
    )


def _recorded(recordings: Sequence[Recording], parts: Sequence[Part]) -> Recorded | None:
    """Return "held" if the joint's angle was recorded, at rest or as an input of every fit."""
    known = all(recording.angle is not None for recording in recordings)
    return "held" if known and all(part.cause != "hub" for part in parts) else None


@takes(plant=Plant)
def sought(
    recordings: Sequence[Recording], plant: Plant, free: Sequence[str] | None = None
) -> tuple[str, ...]:
    """The parameters that `identify` seeks; the plant keeps the values of all others.

    Parameters
    ----------
    recordings : sequence of Recording
        Of one machine, with the same signals.
    plant : Plant
        Its equations.
    free : sequence of str, optional
        As of `identify`.

    Returns
    -------
    tuple of str
        Their names.
    """
    recordings = checked_recordings(recordings)
    return tuple(_sought(plant, free, _check(recordings, plant)))


def curve_of(
    machine: Identified, part: Part, recordings: Sequence[Recording]
) -> tuple[SwingModel, Array]:
    """Return the model fitted in a part, and its signals (rows, signals)."""
    named = [recording for recording in recordings if recording.name == part.recording]
    (recording, *_), _ = without_glitches(named)
    fitter = PartFitter(machine.plant, list(part.values), recording, 1.0)
    fitter.frequency = fitter.frequency_of(part.vector)
    model = fitter.model(part)
    return model, model.fitted(part.vector)


def _refuse_other_frequency(fitters: Sequence[PartFitter]) -> None:
    """Refuse to fit at a plant's own frequencies where a recording swings at none of them."""
    same = 0.3  # share of a frequency: further off a fit finds nothing
    for fitter in fitters:
        if fitter.are_rates.any() or not fitter.frequency:
            continue
        own = fitter.frequencies
        nearest = float(own[np.abs(own - fitter.frequency).argmin()])
        if abs(fitter.frequency / nearest - 1) > same:
            rates = [name for name in fitter.plant.measured if is_frequency(fitter.plant, name)]
            raise ValueError(
                f"{fitter.recording.name} swings at {fitter.frequency:.4g} Hz, and "
                f"{fitter.plant.name} has {nearest:.4g} Hz; seek {rates[0] if rates else 'it'} as "
                "well, by free, or set it"
            )


def _by_recording(reasons: dict[str, str]) -> str:
    """Say why each recording is left out, in a line."""
    return "; ".join(f"{name}: {why}" for name, why in reasons.items())


def _check(recordings: Sequence[Recording], plant: Plant) -> list[str]:
    """The kinds of the recordings' signals, that are the same in all of them."""
    first = recordings[0]
    kinds = [*first.signals]
    for recording in recordings:
        if [*recording.signals] != kinds:
            raise ValueError(
                f"{recording.name} has {' and '.join(recording.signals)}, {first.name} "
                f"{' and '.join(kinds)}; give recordings of the same signals"
            )
        for kind, values in recording.signals.items():
            count = values.shape[1]
            if kind != "torque" and count != plant.tips:
                raise ValueError(
                    f"{recording.name} has {count} of {kind}; {plant.name} has {plant.tips} tips, "
                    "give one of each"
                )
    return kinds


def _checked_parts(parts: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Begins and ends of parts as numbers, each begin before its end."""
    checked = list[tuple[float, float]]()
    for part in several("parts", parts, "pairs of begin and end, such as [(3.2, 7.3)]"):
        ends = several("a part", part, "its begin and end, such as (3.2, 7.3)")
        if len(ends) != 2:
            raise ValueError(f"a part is {part!r}; give its begin and end, such as (3.2, 7.3)")
        begin, end = (finite("an end of a part", value, "s") for value in ends)
        if begin >= end:
            raise ValueError(f"a part is {part!r}; give its begin before its end")
        checked.append((begin, end))
    return checked


def _cut_to(
    parts: Sequence[tuple[float, float]], recordings: Sequence[Recording]
) -> tuple[list[Recording], dict[str, str]]:
    """Each part of each recording as a recording of its own, and why some have none.

    No sample outside a part then changes what is found in it: its swing's frequency, what its noise
    is, and what is a glitch. Without parts these are the recordings themselves.
    """
    if not parts:
        return list(recordings), {}
    cut = list[Recording]()
    without = dict[str, str]()
    for recording in recordings:
        inside = [_inside(recording, *ends) for ends in parts]
        enough = [rows for rows in inside if rows.stop - rows.start >= LEAST_ROWS]
        cut += [recording.part(rows) for rows in enough]
        if not enough:
            first, last = recording.time[[0, -1]]
            without[recording.name] = (
                f"no part has {LEAST_ROWS} rows of it; it lasts from {first:.6g} to {last:.6g} s"
            )
    if not cut:
        raise ValueError(_by_recording(without))
    return cut, without


def _inside(recording: Recording, begin: float, end: float) -> slice:
    """The rows from one time to another, and none beyond."""
    first = int(np.searchsorted(recording.time, begin, side="left"))
    return slice(first, int(np.searchsorted(recording.time, end, side="right")))


def _is_read(name: str, parts: Sequence[Part]) -> bool:
    """Return whether one of the parts is of the recording of a name."""
    return any(part.recording == name for part in parts)


def _sought(plant: Plant, free: Sequence[str] | None, kinds: Sequence[str]) -> list[str]:
    if free is not None:
        free = several("free", free, "names of parameters, such as ['omega']")
        for name in free:
            if not isinstance(name, str):
                raise TypeError(f"a name in free is {name!r}; give a parameter's, such as 'omega'")
        if not free:
            raise ValueError("free names no parameter; name one, or leave it out")
        refuse_unknown(plant, free, also=())
        _refuse_undeclared(plant, free)
        return [*dict.fromkeys(free)]
    _refuse_undeclared(plant, plant.measured)
    names = [name for name in plant.measured if is_modal(plant, name)]
    if "torque" in kinds:
        names += [
            name for name in plant.measured if name not in names and in_torque_alone(plant, name)
        ]
    if not names:
        raise ValueError(
            f"{plant.name} has no parameter that is a mode's frequency or damping; name what is "
            "sought by free, or declare its kind by qa.parameter"
        )
    return names


def _refuse_undeclared(plant: Plant, names: Iterable[str]) -> None:
    """Refuse the name of a damping ratio whose kind is not declared.

    Version 2.0.0 took it for one by its name.
    """
    declared = {entry.name: entry.metadata.get("kind") for entry in plant.parameter_fields()}
    for name in names:
        if name.startswith("zeta") and declared[name] is None:
            raise ValueError(
                f"{plant.name} does not say what {name} is; write it with qa.parameter(..., "
                "kind='damping') if it is the damping ratio of a mode, else kind='other'"
            )


def _worth_pooling(plant: Plant, parts: Sequence[Part]) -> tuple[list[Part], dict[str, str]]:
    """The parts that tell of the machine, and why others do not, by recording.

    Each is judged by itself, however many there are. ValueError where none is left.
    """
    most_unexplained = 0.4  # share of the swing's size beside the noise
    worth = list[Part]()
    why = dict[str, list[str]]()
    for part in parts:
        stretch = f"{part.begin:.6g} to {part.end:.6g} s"
        driven = [
            value
            for name, value in part.values.items()
            if is_damping(plant, name) and value + part.deviations[name] < 0
        ]
        if part.unexplained > most_unexplained:
            reason = (
                f"{stretch}: a misfit of {part.misfit:.0%} of the swing; look at its signal, and "
                "select the free decay by --part"
            )
        elif driven:
            reason = (
                f"{stretch}: a damping of {min(driven):.2g}: something drives it, so that it is no "
                "free decay; switch it off, or select another part by --part"
            )
        else:
            worth.append(part)
            continue
        why.setdefault(part.recording, []).append(reason)
    left_out = {name: "; ".join(reasons) for name, reasons in why.items()}
    if not worth:
        raise ValueError(_by_recording(left_out))
    return worth, left_out


def _drifts(plant: Plant, combined: Combined, parts: Sequence[Part]) -> list[str]:
    """Say which of the identified parameters drift from one recording to the next."""
    recordings = {part.recording for part in parts}
    what = "recordings" if len(recordings) > 1 else "ring-downs"
    return [
        f"{name} drifts over the {what}, from {_with_unit(plant, name, trend.first)} to "
        f"{_with_unit(plant, name, trend.last)}: the intervals hold the drift, that of the next "
        "swing one step more, and no later ones; find what drifts, as what warms up or comes "
        "loose, and record again, or state errors of your own, such as --error frequency=5%"
        for name, trend in combined.trends.items()
        if name not in combined.wide
    ]


def _with_unit(plant: Plant, name: str, value: float) -> str:
    if is_frequency(plant, name):
        return f"{value / tau:.5g} Hz"
    return f"{value:.3g}"


def _not_identifiable(fitters: Sequence[PartFitter]) -> dict[str, str]:
    """The parameters that recordings of moving joints do not identify, and why."""
    least_apart = 1e-3  # share of what a parameter does that the others may not explain
    for fitter in fitters:
        if not moves(fitter.recording):
            raise ValueError(
                f"{fitter.recording.name}: the joint does not move, and these parameters only "
                "matter while it does; record its angle during a move"
            )
    names = fitters[0].names
    slopes = np.concatenate([sensitivities(fitter) for fitter in fitters])
    sizes = np.linalg.norm(slopes, axis=0)
    told_apart = list[int]()
    reasons = dict[str, str]()
    for k, name in enumerate(names):
        if sizes[k] <= 1e-9 * sizes.max():
            reasons[name] = "nothing that was recorded depends on it"
            continue
        before = slopes[:, told_apart]
        share, *_ = np.linalg.lstsq(before, slopes[:, k], rcond=None)
        apart = np.linalg.norm(slopes[:, k] - before @ share)
        if told_apart and apart < least_apart * sizes[k]:
            nearest = names[told_apart[int(np.abs(share).argmax())]]
            reasons[name] = f"it does what {nearest} does"
        else:
            told_apart.append(k)
    if not told_apart:
        raise ValueError(
            f"the recordings tell nothing of {', '.join(reasons)}; name others by free"
        )
    return reasons
