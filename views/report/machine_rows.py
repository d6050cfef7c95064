"""An identified machine on the screen: what its recordings tell, and how well they are met."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from math import floor, log10, pi
from typing import Any

from quietarm.machine.identify import Estimate, Identified, Part, Prediction
from quietarm.machine.identify.identified import is_frequency, is_modal
from quietarm.models import Plant, file_of_plant
from quietarm.models.plant import FREQUENCY
from quietarm.ocp.checks import joined
from quietarm.views.report.words import counted, span_words

Row = tuple[str, str]


def machine_rows(
    machine: Identified, given: Collection[str] = (), assumed: Collection[str] = ()
) -> list[Row]:
    """The parameters with their intervals, then each part of the recordings.

    `given` are those that the user gave, `assumed` those whose default the user keeps.
    """
    rows = [("plant", machine.plant.name)]
    for estimate in machine.estimates:
        mean, *next_swing = _estimate(machine.plant, estimate)
        rows.append((_called(machine.plant, estimate.parameter), mean))
        rows += [("  next swing", text) for text in next_swing]
    rows += [
        (name, f"not identifiable: {why}; {_instead(machine, name, given)}")
        for name, why in machine.not_identifiable.items()
    ]
    others = [name for name in machine.untold if name not in machine.not_identifiable]
    for words, names in {
        "as given": [name for name in others if name in given],
        "assumed": [name for name in others if name in assumed and name not in given],
        "default": [name for name in others if name not in {*given, *assumed}],
    }.items():
        if names:
            rows.append((words, ", ".join(_with_unit(machine.plant, name) for name in names)))
    if machine.recorded is not None:
        rows.append(("recorded", machine.recorded))
    several = len(machine.parts) > 1
    rows += [
        (part.recording, _part(machine.plant, part, with_values=several)) for part in machine.parts
    ]
    return rows + [(name, f"left out: {why}") for name, why in machine.left_out.items()]


def machine_answer(machine: Identified) -> str:
    """Return at which frequencies a machine swings, and how well they are known."""
    found = [one for one in machine.estimates if is_frequency(machine.plant, one.parameter)]
    by = f"by {counted(len(machine.parts), 'ring-down')}"
    if not found:
        names = joined([estimate.parameter for estimate in machine.estimates])
        return f"The recordings tell {names}, {by}." if names else "The recordings tell nothing."
    words = [
        f"{one.value / (2 * pi):.4g} Hz (+-{50 * (one.high - one.low) / one.value:.2g} %)"
        for one in found
    ]
    return f"The machine swings at {joined(words)}, {by}."


def prediction_answer(plant: Plant, predictions: Sequence[Prediction]) -> str:
    """Return how much of the swing a machine predicts, of its worst ring-down."""
    worst = min(predictions, key=lambda prediction: prediction.share)
    return f"{plant.name} predicts {worst.share:.1%} of the swing over five periods" + (
        f", in the worst of {len(predictions)} ring-downs." if len(predictions) > 1 else "."
    )


def _called(plant: Plant, name: str) -> str:
    """Return a parameter's name; of a frequency, which is shown in Hz, with that word."""
    return f"frequency {name}" if is_frequency(plant, name) else name


def _instead(machine: Identified, name: str, given: Collection[str]) -> str:
    """Say what a plant has of a parameter that is not identifiable, and whence."""
    whence = "the plant's default"
    if name in machine.rough:
        whence = "by the recordings"
    elif name in given:
        whence = "as given"
    return f"{_with_unit(machine.plant, name).removeprefix(f'{name} ')} {whence}"


def refuse_defaults(plant: Plant, names: Sequence[str]) -> None:
    """Refuse to save a machine whose plant has default values for these parameters, if any.

    The defaults of quietarm's own plants are of the machines that their sources describe; those of
    a plant of one's own are one's own.
    """
    if not names or file_of_plant(type(plant)) is not None:
        return
    remedy = f"give each by --set, such as --set {names[0]}=..."
    may_stand = [name for name in names if not is_modal(plant, name)]
    if may_stand:
        remedy += f", or keep the defaults that do not matter to you, by --assume {may_stand[-1]}"
    raise ValueError(
        f"cannot save the machine: the recordings do not tell {', '.join(names)}, and the defaults "
        f"of {plant.name} belong to another machine; {remedy}"
    )


def prediction_rows(plant: Plant, predictions: Sequence[Prediction]) -> list[Row]:
    """Say how much of each ring-down a machine predicts."""
    rows = [("plant", plant.name)]
    for prediction in predictions:
        span = span_words(prediction.begin, prediction.end)
        least = f"at least {max(prediction.worst, 0):.1%}, from {prediction.worst_at:.3g} s on"
        words = (
            f"{span}: {prediction.share:.1%} of the swing predicted over five periods, {least}; "
            f"by itself {prediction.frequency:.4g} Hz"
        )
        rows.append((prediction.recording, words))
    return rows


def nothing_predicted(plant: Plant, predictions: Sequence[Prediction]) -> ValueError | None:
    """Return the error if a machine predicts nothing of a ring-down; None if it predicts of all."""
    failed = [prediction for prediction in predictions if prediction.share <= 0]
    if not failed:
        return None
    worst = min(failed, key=lambda prediction: prediction.share)
    return ValueError(
        f"{plant.name} predicts nothing of {worst.recording}, "
        f"{span_words(worst.begin, worst.end)} ({worst.share:.0%}): {worst.why}"
    )


def machine_notes(
    machine: Identified,
    at_rest: bool,
    given: Collection[str] = (),
    assumed: Collection[str] = (),
) -> list[str]:
    """Return notes to read before the intervals are believed; of a joint that is taken as held.

    `given` are the parameters that the user gave, `assumed` those whose default the user keeps.
    """
    notes = list[str]()
    untold = [name for name in machine.untold if name not in {*given, *assumed}]
    if untold:
        notes.append(
            "The recordings do not tell the values in the row 'default', which belong to another "
            f"machine. Set what you know, such as --set {untold[0]}=...; torque and energy depend "
            "on them."
        )
    notes += [
        f"--set {estimate.parameter} is not used, because the recordings tell its value."
        for estimate in machine.estimates
        if estimate.parameter in given
    ]
    if at_rest:
        notes.append(
            "The joint is taken to be held: name its angle's column by --angle, where a controller "
            "holds it. One that gives way shifts the frequency. A --drive needs --recorded."
        )
    if len(machine.parts) == 1:
        notes.append(
            "One ring-down does not tell how much the machine varies: record several. Until then "
            "--error takes errors of your own, such as frequency=5%."
        )
    notes += [
        f"The machine varies: {estimate.parameter} differs between ring-downs by more than their "
        f"fits are uncertain{_by_amplitude(machine, estimate.parameter)}."
        for estimate in machine.estimates
        if estimate.varies
    ]
    notes += [f"warning: {text}" for text in machine.warnings]
    return notes + [
        f"warning: {part.recording}, {span_words(part.begin, part.end)}: {part.warning}"
        for part in machine.parts
        if part.warning
    ]


def _by_amplitude(machine: Identified, name: str) -> str:
    """Say whether a parameter grows or falls with the amplitude."""
    from scipy.stats import spearmanr  # not at the top: it takes long to load

    if len(machine.parts) < 5:
        return ""
    sizes = [part.amplitude for part in machine.parts]
    if max(sizes) < 1.3 * min(sizes):
        return ""
    values = [part.values[name] for part in machine.parts]
    correlation: Any = spearmanr(sizes, values)
    rank, chance = correlation
    if chance > 0.05:
        return ""
    return f", and {'grows' if rank > 0 else 'falls'} with the amplitude"


def _part(plant: Plant, part: Part, *, with_values: bool) -> str:
    """Return the span of a ring-down, its values, and the root mean square of what is misfit."""
    hub = {
        "": "",
        "creeps": ", with the hub's motion",
        "moves": ", all of the hub's motion with it",
    }
    values = [_short(plant, name, value) for name, value in part.values.items()]
    fit = f"misfit {part.misfit:.1%}, noise {part.noise:.1%} of the swing"
    told = ", ".join([*(values if with_values else []), fit])
    saturated = f"; {part.saturated} saturated samples excluded" if part.saturated else ""
    drift = "; a slow drift excluded" if part.drifts else ""
    small = ""
    if part.largest:
        small = f"; fitted from an amplitude of {part.amplitude:.3g} on, of {part.largest:.3g}"
    span = span_words(part.begin, part.end)
    return f"{span}: {told}{hub[part.hub]}{saturated}{drift}{small}"


def _short(plant: Plant, name: str, value: float) -> str:
    if plant.parameter_kinds()[name] == FREQUENCY:
        return f"{value / (2 * pi):.5g} Hz"
    return f"{name} {value:.3g}"


def _with_unit(plant: Plant, name: str) -> str:
    unit = plant.units()[name]
    return f"{name} {getattr(plant, name):.4g}{'' if unit == '-' else f' {unit}'}"


def _estimate(plant: Plant, estimate: Estimate) -> list[str]:
    """The value with the mean's interval, and below it the next swing's."""
    unit = plant.units()[estimate.parameter]
    size = 1.0
    words = "" if unit == "-" else f" {unit}"
    if plant.parameter_kinds()[estimate.parameter] == FREQUENCY:
        size = 2 * pi
        words = " Hz"
    share = (
        max((estimate.high - estimate.low) / 2 / abs(estimate.value), 1e-12)
        if estimate.value
        else 1.0
    )
    digits = max(4, 1 - floor(log10(share)))  # two of the interval
    text = lambda x: f"{x / size:.{digits}g}"  # noqa: E731
    ends = f"{text(estimate.low)} to {text(estimate.high)}"
    lines = [f"{text(estimate.value)}{words}, within {ends}{words} (95 %)"]
    if estimate.next_low is not None and estimate.next_high is not None:
        ends = f"{text(estimate.next_low)} to {text(estimate.next_high)}"
        lines.append(f"within {ends}{words} (95 %)")
    return lines
