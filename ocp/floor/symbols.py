"""Small helpers around casadi's symbols."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np


def split(vector: ca.MX, sizes: Sequence[int]) -> list[ca.MX]:
    """Cut a column into parts of these sizes, which add up to its length."""
    return ca.vertsplit(vector, [0, *np.cumsum(sizes).tolist()])
