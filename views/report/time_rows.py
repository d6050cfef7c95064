"""A front of time and energy in lines: what each duration takes, and what a millisecond costs."""

from __future__ import annotations

from quietarm.ocp.front.time_front import TimeFront
from quietarm.views.report.acting_words import ranges_words
from quietarm.views.report.words import counted, moved
from quietarm.views.tips import tip_words

_JOULE_A_MILLISECOND = 1e3
"""[J/s]."""


def time_front_lines(front: TimeFront) -> list[str]:
    """A front of time and energy, the answer first: what its ends take."""
    band = tip_words(front.task.band or 0.0, "m")
    prices = [f"{price / 1e3:.3g} J" for price in front.prices] + ["-"]
    rows = [
        (f"{point.duration:.4g} s", f"{point.acts_after:.4g} s", f"{point.energy:.4g} J", price)
        for point, price in zip(front.points, prices)
    ]
    return [
        _answer(front),
        _worth(front),
        moved(front.task),
        f"{front.record.method}: {counted(len(front.points), 'point')} in "
        f"{front.record.seconds:.1f} s, within {band} {ranges_words(front.task.ranges)}",
        f"{'duration':>12}{'acts after':>14}{'energy':>12}   for a millisecond less",
        *(
            f"{duration:>12}{acts:>14}{energy:>12}   {price}"
            for duration, acts, energy, price in rows
        ),
        *(f"no plan in {failure}" for failure in front.failures),
    ]


def _answer(front: TimeFront) -> str:
    """Say what the fastest and the cheapest move take."""
    if not front.points:
        return "No duration has a plan."
    ends = [
        f"{point.energy:.3g} J to act after {point.acts_after:.3g} s"
        for point in (front.points[0], front.points[-1])
    ]
    return f"From {' to '.join(dict.fromkeys(ends))}."


def _worth(front: TimeFront) -> str:
    duration = front.duration_at(_JOULE_A_MILLISECOND)
    if duration is not None:
        return f"a joule is worth a millisecond in a duration of {duration:.3g} s"
    if not len(front.prices):
        return "no duration takes less energy than the shortest"
    dear = front.prices.min() > _JOULE_A_MILLISECOND
    least = front.prices.min() / 1e3 if dear else front.prices.max() / 1e3
    side = "more" if dear else "less"
    end = "least" if dear else "most"
    return (
        f"a millisecond takes {side} than a joule in each of these durations, {least:.3g} J at "
        f"{end}"
    )
