"""What a contest reports, against hand-made runs and against other code over its files."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from quietarm.studies.contest.measures import Field, arenas_of
from quietarm.studies.contest.store import Store
from small_contest import METHODS, NAME, area, documents, least_energy, median_of, rows_of, scaled

LEVELS = (1e-4, 1e-3, 5e-3)


class Hand(Field):
    """A field whose record is written down."""

    def __init__(self, evaluations, missing):
        object.__setattr__(self, "evaluations", np.array(evaluations))
        object.__setattr__(self, "missing", np.array(missing))
        spent = type("Front", (), {"evaluations": evaluations[-1]})
        run = type("Run", (), {"front": spent, "marks": evaluations})
        object.__setattr__(self, "runs", (run,) * len(missing))


def test_expected_running_time_of_hand_made_runs():
    field = Hand([10, 20, 40], [[0.5, 0.009, 0.001], [0.5, 0.5, 0.01], [0.5, 0.4, 0.3]])
    assert field.hits(0.01).tolist() == [20, 40, math.inf]
    assert field.expected_running_time(0.01) == (20 + 40 + 40) / 2  # COCO: by the successes
    assert field.expected_running_time(0.001) == 40 + 40 + 40
    assert field.expected_running_time(1e-4) == math.inf
    assert field.expected_running_time(0.6) == 10


@pytest.fixture(scope="module")
def arena(held):
    (only,) = arenas_of(Store(held))
    return only


def test_the_exact_hypervolume_is_that_of_its_own_points_and_a_little_more(held, arena):
    document = json.loads((held / f"exact/{NAME}.json").read_text())
    points = scaled(document)
    assert points[0] == pytest.approx((0, 1))
    assert points[-1] == pytest.approx((1, 0))
    own, steps = area(points), np.diff(points, axis=0)
    # between two points the true front is within the rectangle that they span
    assert own < document["hypervolume"] < own + np.abs(steps.prod(axis=1)).sum()


@pytest.mark.parametrize("method", METHODS)
def test_the_figures_are_those_of_the_files_by_other_code(held, arena, method):
    exact = json.loads((held / f"exact/{NAME}.json").read_text())
    files = [documents(held)[method, seed] for seed in (0, 1)]
    (field,) = (one for one in arena.fields if one.method == method)
    ends = [1 - file["marks"][-1]["hypervolume"] / exact["hypervolume"] for file in files]
    assert field.final == pytest.approx(ends)
    # the front's figures are of a finer rollout than the record's
    fronts = [1 - area(scaled(file)) / exact["hypervolume"] for file in files]
    assert ends == pytest.approx(fronts, abs=2e-4)
    rows = [row for row in rows_of(held, "runs")
            if row["method"] == method]  # fmt: skip
    for row, file, end in zip(rows, files, ends, strict=True):
        assert int(row["evaluations"]) == 130 == file["front"]["evaluations"]
        assert float(row["missing"]) == pytest.approx(end)
        for level in LEVELS:
            best = least_energy(exact["front"]["points"], level)
            share = least_energy(file["front"]["points"], level) / best - 1
            cell = row[f"energy_above_exact_at_{level:g}_m"]
            assert (float(cell) if cell else math.inf) == pytest.approx(share)
    anytime = [row for row in rows_of(held, "anytime")
               if row["method"] == method]  # fmt: skip
    assert len(anytime) == len(files[0]["marks"])
    for i, row in enumerate(anytime):
        shares = [1 - f["marks"][i]["hypervolume"] / exact["hypervolume"] for f in files]
        assert float(row["missing_median"]) == pytest.approx(median_of(shares))


def test_after_more_evaluations_no_more_is_missing(arena):
    for field in arena.fields:
        after = [field.missing_after(spent) for spent in range(150)]
        assert (np.diff(after, axis=0) <= 0).all()
        assert (after[0] == 1).all()
        assert after[-1].tolist() == field.final.tolist()


def test_over_time_a_run_keeps_what_it_had(arena):
    field = arena.fields[0]
    times = np.array([0.0, field.seconds[0, 0], field.seconds[:, -1].max()])
    found = field.after_times(times)
    assert found[:, 0].tolist() == [1.0, 1.0]
    assert found[0, 1] == field.missing[0, 0]
    assert found[:, 2].tolist() == field.final.tolist()
    assert (np.diff(field.missing, axis=1) <= 0).all()


def test_a_run_that_found_nothing_misses_everything(arena):
    # as under limits that no candidate keeps
    field = arena.fields[0]
    empty = replace(field.runs[0], front=replace(field.runs[0].front, points=()))
    nothing = Field("nothing", field.yardstick, (replace(empty, file="nothing.csv", marks=()),))
    assert nothing.final.tolist() == [1.0]
    assert nothing.energies.tolist() == [[math.inf] * len(LEVELS)]
    assert nothing.missing_by_thirds.tolist() == [[1.0] * 3]
