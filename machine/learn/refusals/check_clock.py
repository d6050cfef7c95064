"""Check that a recording's times can be those of a plan's move: length, rate and unit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_LEAST_SAMPLES = 4
"""A period of the fastest mode: fewer look like another frequency."""
_FINER = {"ms": 1e3, "us": 1e6, "ns": 1e9}
"""Units of clocks that may be taken for seconds, each with how many a second has."""


def check_clock(name: str, time: Array, duration: float, fastest: float) -> None:
    """Refuse a recording that is shorter than a move, or sampled too seldom for a mode.

    Parameters
    ----------
    name : str
        Of the recording.
    time : array
        Its times [s].
    duration : float
        Of the move [s].
    fastest : float
        Frequency of the fastest mode [Hz].

    Raises
    ------
    ValueError
        With the unit that the clock may have in place of seconds, where there is one.
    """
    span = float(np.ptp(time))
    step = float(np.median(np.diff(time)))
    if span < duration:
        raise ValueError(
            f"{name}: it lasts {span:.4g} s, and the move of the plan {duration:.4g} s; record "
            "from its start until two periods after its end, or give the time's unit by --units, "
            "such as time:s"
        )
    least = _LEAST_SAMPLES * fastest
    if 1 / step >= least:
        return
    for unit, count in _FINER.items():
        if span / count >= duration and count / step >= least:
            raise ValueError(
                f"{name}: it lasts {span:.4g} s with a sample every {step:.3g} s, and the move of "
                f"the plan {duration:.4g} s; if its clock is in {unit}, give --units time:{unit}"
            )
    raise ValueError(
        f"{name}: it has {1 / step:.3g} samples a second of a swing of {fastest:.3g} Hz, which "
        f"looks like another frequency; record {20 * fastest:.3g} or more"
    )
