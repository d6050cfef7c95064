"""Floors that begin on coarser grids: how low they are is asked in tests/ocp/floor."""

from contextlib import contextmanager

import pytest

from quietarm.ocp.floor import energy_floor

INTERVALS = 24


@contextmanager
def coarse_floors():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(energy_floor, "FIRST_INTERVALS", INTERVALS)
        yield
