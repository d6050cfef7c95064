"""All of a recording fitted by how the plant answers its joint's motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.fits.part_fitter import FEW_SAMPLES, PartFitter
from quietarm.machine.identify.identified import Part

Array = NDArray[np.float64]


def wide_range(frequency: float) -> Array:
    """Frequencies from half to twice one, from which fits start."""
    return frequency * np.geomspace(0.5, 2, 15)


def fit_whole(fitter: PartFitter, rows: slice = slice(None)) -> Part:
    """All of the recording, or some rows, from the better of the two best starts.

    How the joint moves in a hole is unknown: the longest stretch without one is all.
    """
    part = fitter.part(_longest(fitter, rows), hub="moves")
    starts = [fitter.of_plant, *fitter.starts(wide_range(fitter.frequency))]
    rough = fitter.model(part, samples=FEW_SAMPLES)
    best_starts = sorted(starts, key=rough.cost)[:2]
    fits = [fitter.fit_model(rough, part, start) for start in best_starts]
    best = min(fits, key=lambda fitted: fitted.misfit)
    return fitter.fit(part, best.p)[0]


def _longest(fitter: PartFitter, rows: slice) -> slice:
    """The longest stretch of some rows without a hole; all of them where none is long enough."""
    first, last, _ = rows.indices(len(fitter.recording.time))
    stretches = fitter.recording.part(rows).stretches
    longest = max(stretches, key=lambda run: run.stop - run.start, default=slice(0, last - first))
    return slice(first + longest.start, first + longest.stop)


def sensitivities(fitter: PartFitter) -> Array:
    """Return the sensitivities of the whole recording to the plant's values, a column each.

    What amplitudes and trend can do instead does not count.
    """
    model = fitter.model(fitter.part(_longest(fitter, slice(None)), hub="moves"))
    p = fitter.of_plant
    x = model.start(p)
    size = model.values.std(axis=0)[:, None, None]
    slopes = (model.jacobian(x) / size).reshape(-1, len(x))
    by_p, by_amplitudes = np.split(slopes, [model.count], axis=1)
    share = np.linalg.lstsq(by_amplitudes, by_p, rcond=None)[0]
    by_p = by_p - by_amplitudes @ share
    return by_p * np.where(p != 0, np.abs(p), 1e-2)
