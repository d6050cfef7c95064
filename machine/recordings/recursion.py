"""Recursions of the first order over many samples, without a loop over them.

`scipy.signal.lfilter` gives the same as fast, and takes 0.35 s to load: a quarter of an `identify`.
"""

from __future__ import annotations

from typing import Any

import numpy as np


def decaying_sums(factor: complex, added: Any) -> Any:
    """Sums that decay by a factor from sample to sample: ``y[k] = factor y[k - 1] + added[k]``.

    Blocks of samples are summed at once, and what a block hands to the next by the same recursion.
    """
    block = 64
    count = len(added)
    if count <= block:
        return _doubled(factor, added.astype(complex)[None])[0]
    blocks = -(-count // block)
    padded = np.zeros(blocks * block, complex)
    padded[:count] = added
    sums = _doubled(factor, padded.reshape(blocks, block))
    at_ends = decaying_sums(factor**block, sums[:, -1])
    powers = factor ** np.arange(1, block + 1)
    sums[1:] += at_ends[:-1, None] * powers
    return sums.ravel()[:count]


def _doubled(factor: complex, sums: Any) -> Any:
    """The sums of each row by itself: of 1 sample, then of 2, of 4 and so on."""
    length = 1
    while length < sums.shape[1]:
        earlier = factor**length * sums[:, :-length]
        sums[:, length:] += earlier
        length *= 2
    return sums
