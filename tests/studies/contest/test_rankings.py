"""What a contest of enough runs says of them: on the page, in tables and in pictures."""

import math
import re
from dataclasses import replace
from html import unescape

import pytest
from quietarm.studies.contest.measures import Arena, Field, arenas_of
from quietarm.studies.contest.page import contest_document, report_files
from quietarm.studies.contest.store import Store
from quietarm.studies.contest.tables import over_table
from quietarm.studies.document.files import page as page_of
from small_contest import NAME, rows_of

MISSING = {
    "vepso": (0.20, 0.21, 0.22, 0.23, 0.24),
    "nsga2": (0.10, 0.11, 0.12, 0.13, 0.14),
    "gde3": (0.105, 0.115, 0.125, 0.135, 0.145),
}
"""Shares of the exact hypervolume: on every seed the methods have the same order."""
ORDER = ["nsga2", "gde3", "vepso"]
STATISTIC = 10.0
"""Friedman's largest: five blocks times three methods less one; of two degrees of freedom."""
P_VALUE = math.exp(-STATISTIC / 2)
WITHIN = 12 / (15 * 16) * 5 * (5**2 + 6**2 + 13**2) - 3 * 16
"""Kruskal and Wallis's of mean ranks 5, 6 and 13 among 15 runs, again of two degrees of freedom."""
CRITICAL = 2.343 * math.sqrt(3 * 4 / (6 * 5))
"""Nemenyi's, with Demsar's quantile for three (Journal of Machine Learning Research 7 (2006))."""
APART = 3 * 2 / math.comb(10, 5)
"""Mann and Whitney's p of five that are all below five, by Holm for the first of three pairs."""


@pytest.fixture(scope="module")
def arena(held):
    """Five runs of three methods on one problem, that missed what is written down."""
    (known,) = arenas_of(Store(held))
    given = known.fields[0].runs[0]

    def run(method, seed, missing):
        mark = replace(given.marks[-1], hypervolume=(1 - missing) * known.yardstick.hypervolume)
        front = replace(given.front, seed=seed)
        return replace(given, method=method, marks=(mark,), front=front)

    fields = [
        Field(method, known.yardstick, tuple(run(method, *one) for one in enumerate(shares)))
        for method, shares in MISSING.items()
    ]
    return Arena(known.yardstick, tuple(fields))


@pytest.fixture(scope="module")
def arenas(arena):
    """The same on five problems."""

    def called(name):
        yardstick = replace(arena.yardstick, problem=name)
        return Arena(yardstick, tuple(replace(one, yardstick=yardstick) for one in arena.fields))

    return [called(f"{NAME}-{number}") for number in range(5)]


def cells(page, heading):
    """What stands in the first line of a table that has this heading."""
    line = re.search(rf"<th[^>]*>{heading}</th>(.*?)</tr>", page, re.DOTALL)[1]
    return re.findall(r"<td[^>]*>([^<]*)", line)


def test_tables_hold_ranks_and_pairs(arenas, folder):
    for place, write in report_files(arenas, folder):
        if place.parent.name == "tables":
            place.parent.mkdir(exist_ok=True)
            write(place)
    ranks = rows_of(folder, "ranks")
    assert [row["method"] for row in ranks] == 6 * ORDER
    assert [row["on"] for row in ranks[::3]] == [*(one.problem for one in arenas), "all problems"]
    assert [row["over"] for row in ranks[::3]] == 5 * ["15 runs"] + ["5 problems"]
    assert [float(row["mean_rank"]) for row in ranks] == 5 * [5, 6, 13] + [1, 2, 3]
    for row in ranks[:15]:
        assert row["test"] == "The Kruskal-Wallis test"
        assert float(row["statistic"]) == pytest.approx(WITHIN, rel=1e-6)
        assert float(row["p"]) == pytest.approx(math.exp(-WITHIN / 2), rel=1e-3)
    for row in ranks[15:]:
        assert row["test"] == "Friedman's test"
        assert float(row["statistic"]) == pytest.approx(STATISTIC, rel=1e-6)
        assert float(row["p"]) == pytest.approx(P_VALUE, rel=1e-3)
        assert float(row["critical_difference"]) == pytest.approx(CRITICAL, rel=1e-3)
    pairs = rows_of(folder, "pairs")
    known = {
        (row["method"], row["other"]): float(row["probability_that_it_misses_less"])
        for row in pairs[:3]
    }
    # of 25 pairs of runs, GDE3's is the lower one in 4 + 3 + 2 + 1
    assert known == {("vepso", "nsga2"): 0, ("vepso", "gde3"): 0, ("nsga2", "gde3"): 15 / 25}
    assert len(pairs) == 15
    for row in pairs:
        if row["method"] == "vepso":
            assert float(row["p_after_holm"]) == pytest.approx(APART, rel=1e-3)


def test_pictures_are_those_of_every_problem_and_of_all(arenas, folder):
    names = {place.name for place, _ in report_files(arenas, folder)}
    assert {f"ranks-{one.problem}.png" for one in arenas} < names
    assert {"ranks-all-problems.png", "ranks-all-problems.pdf"} < names


def test_the_page_says_it_for_a_problem(arena, quick_pictures):
    text = unescape(page_of(contest_document([arena])))
    assert "no winner: the tests do not tell apart those that end nearest" in text
    assert re.search(r"middle runs: NSGA-II \([\d.]+ %\), GDE3 \([\d.]+ %\)\)\.", text)
    assert "Over 15 runs. The Kruskal-Wallis test" in text
    assert f"chi2 = 9.5, p = {math.exp(-WITHIN / 2):.2g}, the methods differ at 5 %" in text
    # a square: how likely a run of the line's method misses less than one of the column's
    square = text[text.index("How likely a run misses less") :]
    assert cells(square, "NSGA-II") == ["1.00*", "-", "0.60"]
    assert cells(square, "VEPSO") == ["-", "0.00*", "0.00*"]
    assert "Differences are tested at 5 %: on each problem by the Kruskal-Wallis" in text
    for author in ("Kruskal, William H.", "Mann, Henry B.", "Holm, Sture", "Vargha"):
        assert author in text
    # over one problem nothing is tested, and nothing else is named than what was
    assert "Friedman" not in text
    assert re.search(r"moocore [\d.]+, scipy [\d.]+\.", text)


def test_over_problems_those_that_are_equal_share_their_places(arenas, quick_pictures):
    tied = [
        replace(one, fields=(*one.fields, replace(one.fields[0], method="gde3+polish")))
        for one in arenas
    ]
    ranks = {row[0]: row[-1] for row in over_table(tied).rows}
    assert ranks["VEPSO"] == ranks["GDE3, then polished"] == "3.50"
    assert (ranks["NSGA-II"], ranks["GDE3"]) == ("1.00", "2.00")
    text = unescape(page_of(contest_document(tied)))
    assert text.index("missing in the middle run") < text.index("ends nearest")
