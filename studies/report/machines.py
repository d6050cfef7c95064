"""An identified machine on the screen: what its recordings tell, and how well they are met."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, log10, pi
from typing import Any

from quietarm.models import Plant
from quietarm.studies.identify import Estimate, Identified, Part, Prediction
from quietarm.studies.report.words import span_words

Row = tuple[str, str]
_HUB = {"": "", "creeps": ", with the hub's motion", "moves": ", all of the hub's motion with it"}


def machine_rows(found: Identified) -> list[Row]:
    """The parameters with their intervals, then each part of the recordings."""
    rows = [("plant", found.plant.name)]
    rows += [
        (one.parameter, text) for one in found.estimates for text in _estimate(found.plant, one)
    ]
    rows += [
        (name, f"not identifiable: {why}; {getattr(found.plant, name):.4g} as given")
        for name, why in found.not_identifiable.items()
    ]
    given = _as_given(found)
    if given:
        rows.append(("as given", ", ".join(_with_unit(found.plant, name) for name in given)))
    rows += [(part.recording, _part(found.plant, part)) for part in found.parts]
    return rows + [(name, f"left out: {why}") for name, why in found.left_out.items()]


def _as_given(found: Identified) -> list[str]:
    """The parameters that no recording tells."""
    known = {one.parameter for one in found.estimates} | found.not_identifiable.keys()
    return [name for name in found.plant.measured if name not in known]


def prediction_rows(plant: Plant, predictions: Sequence[Prediction]) -> list[Row]:
    """How much of each ring-down a machine predicts."""
    rows = [("plant", plant.name)]
    for one in predictions:
        least = f"at least {max(one.worst, 0):.1%}, from {one.worst_at:.3g} s on"
        rows.append((one.recording, f"{span_words(one.begin, one.end)}: {one.share:.1%} of the "
                     f"swing predicted over five periods, {least}; by itself {one.frequency:.4g} Hz"
        ))  # fmt: skip
    return rows


def machine_notes(found: Identified, held: bool) -> list[str]:
    """What is to be known before the intervals are believed; of a joint that is taken as held."""
    given = _as_given(found)
    notes = [
        "Misfit: root mean square of the residuals, as a share of the swing's; likewise the noise."
    ]
    if given:
        notes.append(
            "Torque and energy depend on what is as given: set what you know by --set, as "
            f"{given[0]}={getattr(found.plant, given[0]):.4g}."
        )
    if held:
        notes.append(
            "The joint is taken to be held: name its angle's column by --angle, where a controller "
            "holds it. One that gives way shifts the frequency."
        )
    if len(found.parts) == 1:
        notes.append(
            "One ring-down does not tell how much the machine varies: record several. Until then "
            "--error takes errors of your own, as frequency=5%."
        )
    notes += [
        f"The machine varies: {one.parameter} differs between ring-downs by more than their fits "
        f"are uncertain{_by_amplitude(found, one)}."
        for one in found.estimates
        if one.varies
    ]
    notes += [f"warning: {text}" for text in found.warnings]
    return notes + [
        f"warning: {part.recording}, {span_words(part.begin, part.end)}: {part.warning}"
        for part in found.parts
        if part.warning
    ]


def _by_amplitude(found: Identified, one: Estimate) -> str:
    """Whether a parameter grows or falls with the amplitude, in words."""
    from scipy.stats import spearmanr  # not at the top: it takes long to load

    if len(found.parts) < 5:
        return ""
    sizes = [part.amplitude for part in found.parts]
    if max(sizes) < 1.3 * min(sizes):
        return ""
    values = [part.values[one.parameter] for part in found.parts]
    found_rank: Any = spearmanr(sizes, values)
    rank, chance = found_rank
    if chance > 0.05:
        return ""
    return f", and {'grows' if rank > 0 else 'falls'} with the amplitude"


def _part(plant: Plant, part: Part) -> str:
    values = ", ".join(_short(plant, name, value) for name, value in part.values.items())
    misfit = f"misfit {part.misfit:.1%}, noise {part.noise:.1%}"
    saturated = f"; {part.saturated} saturated samples excluded" if part.saturated else ""
    drift = "; a slow drift excluded" if part.drifts else ""
    small = ""
    if part.largest:
        small = f"; fitted from an amplitude of {part.amplitude:.3g} on, of {part.largest:.3g}"
    span = span_words(part.begin, part.end)
    return f"{span}: {values}, {misfit}{_HUB[part.hub]}{saturated}{drift}{small}"


def _short(plant: Plant, name: str, value: float) -> str:
    if plant.units()[name] == "rad/s":
        return f"{value / (2 * pi):.5g} Hz"
    return f"{name} {value:.3g}"


def _with_unit(plant: Plant, name: str) -> str:
    unit = plant.units()[name]
    return f"{name} {getattr(plant, name):.4g}{'' if unit == '-' else f' {unit}'}"


def _estimate(plant: Plant, one: Estimate) -> list[str]:
    """The value with the mean's interval, and below it the next swing's."""
    unit = plant.units()[one.parameter]
    size, words = 1.0, "" if unit == "-" else f" {unit}"
    if unit == "rad/s":
        size, words = 2 * pi, " Hz"
    share = max((one.high - one.low) / 2 / abs(one.value), 1e-12) if one.value else 1.0
    digits = max(4, 1 - floor(log10(share)))  # two of the interval
    text = lambda x: f"{x / size:.{digits}g}"  # noqa: E731
    lines = [f"{text(one.value)}{words}, within {text(one.low)} to {text(one.high)}{words} (95 %)"]
    if one.next_low is not None and one.next_high is not None:
        ends = f"{text(one.next_low)} to {text(one.next_high)}"
        lines.append(f"of the next swing within {ends}{words} (95 %)")
    return lines
