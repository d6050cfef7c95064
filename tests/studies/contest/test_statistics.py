"""Ranks, tests and effect sizes on samples whose verdict is known."""

import numpy as np
import pytest
from quietarm.studies.contest.statistics import (
    LEAST_RUNS,
    holm,
    pairs_on,
    ranking,
    ranking_on,
    why_none,
)

DEMSAR = 1 - np.array([
    [0.763, 0.768, 0.771, 0.798], [0.599, 0.591, 0.590, 0.569], [0.954, 0.971, 0.968, 0.967],
    [0.628, 0.661, 0.654, 0.657], [0.882, 0.888, 0.886, 0.898], [0.936, 0.931, 0.916, 0.931],
    [0.661, 0.668, 0.609, 0.685], [0.583, 0.583, 0.563, 0.625], [0.775, 0.838, 0.866, 0.875],
    [1.000, 1.000, 1.000, 1.000], [0.940, 0.962, 0.965, 0.962], [0.619, 0.666, 0.614, 0.669],
    [0.972, 0.981, 0.975, 0.9749], [0.957, 0.978, 0.946, 0.970],
])  # fmt: skip
"""Table 6 of Demsar, Journal of Machine Learning Research 7 (2006): areas under the curve of four
classifiers on 14 data sets, here as what is missing; of two that round to 0.975 his ranks say which
is less."""
NAMES = ("C4.5", "m", "cf", "m+cf")


def test_demsars_example_has_his_ranks_verdict_and_critical_difference():
    found = ranking(DEMSAR, NAMES, "data sets")
    ranks = dict(zip(found.methods, found.ranks, strict=True))
    assert ranks == pytest.approx({"C4.5": 3.143, "m": 2.0, "cf": 2.893, "m+cf": 1.964}, abs=1e-3)
    assert found.methods[0] == "m+cf"
    assert found.critical == pytest.approx(1.25, abs=0.005)  # his 2.569 sqrt(4 5 / (6 14))
    assert found.differ  # his chi2 = 9.28, p < 0.05
    # scipy corrects for ties, he does not: of 3 pairs and one four, t^3 - t each
    ties = 1 - (3 * (2**3 - 2) + 4**3 - 4) / (14 * (4**3 - 4))
    assert found.statistic * ties == pytest.approx(9.28, abs=0.005)
    assert found.alike == [(0, 3)]  # C4.5 and m+cf are 1.18 apart: less than 1.25


def test_methods_that_are_always_in_one_order_are_told_apart():
    values = np.arange(4.0) + 0.1 * np.arange(31)[:, None]
    found = ranking(values, "abcd", "seeds")
    assert (found.methods, found.ranks) == (("a", "b", "c", "d"), (1, 2, 3, 4))
    assert found.statistic == pytest.approx(31 * 3)  # its largest: blocks times methods less one
    assert found.differ
    assert found.alike == []


def test_bars_join_what_the_tests_of_pairs_do_not_tell_apart():
    # five runs each: a and b mixed, c beyond both, so that Mann and Whitney tell it from either
    mixed = Arena(a=[1, 3, 5, 7, 9], b=[2, 4, 6, 8, 10], c=[11, 12, 13, 14, 15])
    found = ranking_on(mixed)
    assert (found.methods, found.ranks) == (("a", "b", "c"), (5, 6, 13))
    assert found.statistic == pytest.approx(9.5)  # 12 / (15 16) 5 (5^2 + 6^2 + 13^2) - 3 16
    assert found.alike == [(0, 1)]
    alike = ranking_on(Arena(a=[1, 2, 3, 4, 5], b=[1, 2, 3, 4, 5], c=[1, 2, 3, 4, 5]))
    assert not alike.differ
    assert alike.alike == [(0, 2)]
    # whichever runs stand beside each other: no seed makes a pair of two methods
    other = Arena(a=[9, 7, 5, 3, 1], b=[4, 2, 6, 8, 10], c=[15, 12, 13, 14, 11])
    assert ranking_on(other) == found


def test_equal_methods_are_not_told_apart():
    found = ranking(np.ones((10, 3)), "abc", "seeds")
    assert found.ranks == (2, 2, 2)
    assert not found.differ
    assert found.alike == [(0, 2)]


def test_holm_by_hand():
    # 4 x 0.005, 3 x 0.01, 2 x 0.03, then not less than the one before
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.6, 0.7]) == [1.0, 1.0]
    assert holm([]) == []


class Field:
    """A method with figures that are written down."""

    def __init__(self, method, final):
        self.method, self.final = method, np.array(final, dtype=float)
        self.runs = [type("Run", (), {"front": type("Front", (), {"seed": seed})})
                     for seed in range(len(final))]  # fmt: skip


class Arena:
    """A problem with such methods."""

    problem = "by hand"

    def __init__(self, **finals):
        self.fields = [Field(name, final) for name, final in finals.items()]
        self.own = self.alike = self.fields


def test_the_effect_is_how_likely_the_first_misses_less():
    (pair,) = pairs_on(Arena(one=[1, 2, 3, 4, 5], other=[3, 4, 5, 6, 7]))
    # by hand: of 25 pairs 19 are less and 3 are equal
    assert pair.effect == pytest.approx((19 + 3 / 2) / 25)
    (pair,) = pairs_on(Arena(one=[1, 2, 3, 4, 5], other=[11, 12, 13, 14, 15]))
    assert pair.effect == 1.0
    assert pair.p_value == pytest.approx(2 / 252)  # both orders, of 10 over 5
    assert pair.adjusted == pair.p_value


def test_with_fewer_than_five_runs_statistics_are_left_out_and_it_is_said():
    few, enough = [1.0] * (LEAST_RUNS - 1), list(range(LEAST_RUNS))
    assert why_none([Arena(a=few, b=enough)]) == (
        "fewer than 5 runs of each method: statistics are left out"
    )
    assert why_none([Arena(a=enough, b=enough)]) == ""
    assert pairs_on(Arena(a=few, b=enough)) == []
    assert ranking_on(Arena(a=few, b=enough, c=enough)) is None
    assert ranking_on(Arena(a=enough, b=enough, c=enough)) is not None
    assert "one method alone" in why_none([Arena(a=enough)])
