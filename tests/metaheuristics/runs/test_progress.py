"""The history of a search, its reports, and Ctrl-C."""

import numpy as np
import pytest
from quietarm.ocp import Front
from small_searches import (
    METHODS,
    SWARMS,
    assert_is_a_front,
    exactly,
    found,
    run,
    stop_after,
)

# -- history and reports --


def _hypervolume(front):
    """Share of the reference box by a sweep along the front."""
    inside = (front.residuals < front.reference[0]) & (front.energies < front.reference[1])
    F = np.column_stack([front.residuals, front.energies])[inside] / front.reference
    right = np.append(F[1:, 0], 1.0)
    return float(((right - F[:, 0]) * (1.0 - F[:, 1])).sum())


@METHODS
def test_hypervolume_by_generation(method):
    front = found(method)
    assert len(front.history) == 15
    shares = [entry.hypervolume for entry in front.history]
    assert 0 <= min(shares) < max(shares) < 1
    # the search's steps are coarser than those of the figures in the front: 1e-4 in energy
    assert shares[-1] == pytest.approx(_hypervolume(front), rel=1e-3)


@METHODS
def test_a_report_comes_after_every_generation(method):
    seen = []
    front = run(method, report=seen.append)
    assert exactly(front) == exactly(found(method))
    assert [progress.generation for progress in seen] == list(range(1, 16))
    assert {progress.generations for progress in seen} == {15}
    assert [p.evaluations for p in seen] == [entry.evaluations for entry in front.history]
    assert [p.hypervolume for p in seen] == [entry.hypervolume for entry in front.history]
    assert np.all(np.diff([progress.seconds for progress in seen]) >= 0)
    assert seen[-1].residual == pytest.approx(front.stillest().residual, rel=1e-3)
    assert seen[-1].energy == pytest.approx(front.cheapest().energy, rel=1e-3)
    for name in ("residual", "energy"):
        values = [getattr(progress, name) for progress in seen]
        assert values == sorted(values, reverse=True)  # the extremes of a front are kept


# -- Ctrl-C --


@METHODS
def test_ctrl_c_keeps_what_was_found(tmp_path, method):
    front = run(method, report=stop_after(6))
    assert not front.complete
    assert len(front.history) == 6
    assert front.history == found(method).history[:6]
    assert front.evaluations == SWARMS[method] * 20 * 6
    assert len(front.points) > 0
    assert_is_a_front(front)
    front.save(tmp_path / "front.json")
    loaded = Front.load(tmp_path / "front.json")
    assert loaded == front
    assert not loaded.complete
