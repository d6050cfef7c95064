"""Many seeds: the same fronts however many processes, and none lost to Ctrl-C or to a death."""

import math
import multiprocessing
import signal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from quietarm.metaheuristics import search
from quietarm.metaheuristics.ensemble import (
    SEARCH_RESIDUAL,
    Spread,
    energies_at,
    energy_at,
    search_many,
)
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, Front, FrontPoint, Generation, PointToPoint

TASK = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8)
SMALL = {"bound": 0.2, "population": 8, "generations": 3}
LONG = {**SMALL, "population": 40, "generations": 100_000}  # it never ends by itself


def front(points=(), seed=0, shares=(), complete=True):
    """A front of these residuals [m] and energies [J], with these hypervolumes on the way."""
    return Front(
        task=TASK,
        profile=CycloidPolynomial(2),
        points=tuple(FrontPoint((0.0, 0.0), *point) for point in points),
        method="vepso",
        settings={},
        seed=seed,
        reference=(0.08, 0.4),
        evaluations=10 * len(shares),
        history=tuple(Generation(10 * (i + 1), share) for i, share in enumerate(shares)),
        complete=complete,
    )


@pytest.fixture(autouse=True)
def _no_process_is_left():
    yield
    assert multiprocessing.active_children() == []


# -- the spread --


@given(st.lists(st.floats(-1e6, 1e6) | st.just(math.nan) | st.just(math.inf), max_size=9))
def test_quartiles_are_numpys_where_seeds_without_the_figure_count_as_beyond_all(values):
    spread, found = Spread.of(values), [value for value in values if math.isfinite(value)]
    assert (spread.count, spread.seeds) == (len(found), len(values))
    # numpy's with a very large number for what is not there: its share of it is beyond all
    large = np.array(found + [1e30] * (len(values) - len(found)) or [1e30])
    for quartile, expected in zip(
        (spread.lower, spread.median, spread.upper),
        np.quantile(large, [0.25, 0.5, 0.75]),
        strict=True,
    ):
        if expected > 1e20:
            assert quartile == math.inf
        else:
            assert quartile == pytest.approx(expected, rel=1e-12, abs=1e-9)


def test_the_energy_is_that_of_the_cheapest_point_still_enough():
    points = [(0.2e-3, 0.3), (SEARCH_RESIDUAL, 0.2), (2e-3, 0.1)]
    assert energy_at(front(points)) == 0.2
    assert energy_at(front(points), 1.9e-3) == 0.2
    assert energy_at(front(points), 2e-3) == 0.1
    assert math.isnan(energy_at(front(points), 0.1e-3))
    assert math.isnan(energy_at(front()))


def test_seeds_that_never_arrive_still_are_counted():
    fronts = [front([(0.5e-3, 0.25)]), front([(3e-3, 0.1)]), front([(0.9e-3, 0.5)]), front()]
    # 0.25, 0.5 and two that never arrive: a quarter of the way is three quarters of a step on
    assert energies_at(fronts) == Spread(0.4375, math.inf, math.inf, count=2, seeds=4)
    assert energies_at(fronts, 5e-3).count == 3
    none = energies_at(fronts, 0.1e-3)
    assert (none.count, none.seeds) == (0, 4)
    assert none.median == math.inf


# -- the searches --


def test_the_fronts_are_those_of_single_searches_whatever_the_workers():
    alone = [search(TASK, "vepso", seed=seed, **SMALL) for seed in (4, 5, 6)]
    for workers in (1, 2):
        done, heard = [], set()
        fronts = search_many(
            TASK, "vepso", 3, seed=4, workers=workers, **SMALL,
            report=lambda progress, seed, heard=heard: heard.add((seed, progress.generations)),
            done=done.append,
        )  # fmt: skip
        assert fronts == alone
        assert sorted(front.seed for front in done) == [4, 5, 6]
        assert heard == {(4, 3), (5, 3), (6, 3)}


def interrupt_at(seeds, generation=1):
    """A report that sends this process Ctrl-C as soon as every one of these seeds is on its way."""
    heard, sent = set(), []

    def report(progress, seed):
        if progress.generation >= generation:
            heard.add(seed)
        if heard >= seeds and not sent:
            sent.append(seed)
            signal.raise_signal(signal.SIGINT)

    return report


def test_ctrl_c_ends_processes_and_keeps_what_they_found():
    report = interrupt_at({0, 1})
    fronts = search_many(TASK, "nsga2", 4, workers=2, report=report, **LONG)
    assert [(front.seed, front.complete) for front in fronts] == [(0, False), (1, False)]
    for found in fronts:
        assert found.points
        assert found.evaluations == 40 * len(found.history)  # whole generations
