"""Results of other tools in a contest."""

import json
import math
import shutil
from html import unescape

import numpy as np
import pytest
from quietarm.studies.contest.measures import arenas_of
from quietarm.studies.contest.store import Store
from small_contest import LINE, NAME, OTHER, TINY, area, least_energy, rows_of

pytestmark = pytest.mark.usefixtures("no_pictures")

(EXACT,) = TINY.fronts()
X = np.array([point.coefficients for point in EXACT.points])


@pytest.fixture
def results(folder):
    """A folder of two files of coefficients: every sixth motion of the exact front."""
    (folder / "results").mkdir()
    for number in (0, 1):
        save(folder / f"results/run{number}.csv", X[number::6])
    return folder / "results"


def save(path, table, **claims):
    names = [*(f"a_{i + 1}" for i in range(table.shape[1])), *claims]
    rows = np.column_stack([table, *claims.values()]).tolist()
    path.write_text("\n".join([",".join(names), *(",".join(map(repr, r)) for r in rows)]) + "\n")


def test_files_of_a_folder_are_runs_whose_ends_are_measured_alike(call, copy, results):
    given = "--import 'my swarm=results' --import-evaluations 130"
    code, out, err = call(f"{LINE} {given} --output held")
    assert (code, err) == (0, "")
    assert "my swarm" in out
    assert "does not compare" not in out
    yardstick = json.loads((copy / f"exact/{NAME}.json").read_text())
    (r0, e0), (r1, e1) = yardstick["scale"]["ideal"], yardstick["scale"]["nadir"]
    rows = [row for row in rows_of(copy, "runs") if row["method"] == "my swarm"]
    for number, row in enumerate(rows):
        own = EXACT.points[number::6]
        points = [((p.residual - r0) / (r1 - r0), (p.energy - e0) / (e1 - e0)) for p in own]
        assert (row["file"], row["evaluations"], row["seed"]) == (f"run{number}.csv", "130", "")
        # the exact front's figures are by CVODES as well
        assert float(row["missing"]) == pytest.approx(
            1 - area(points) / yardstick["hypervolume"], abs=1e-6
        )
        for level in (1e-4, 1e-3, 5e-3):
            cell = row[f"energy_above_exact_at_{level:g}_m"]
            pairs = [{"residual": p.residual, "energy": p.energy} for p in own]
            best = least_energy(yardstick["front"]["points"], level)
            assert (float(cell) if cell else math.inf) == pytest.approx(
                least_energy(pairs, level) / best - 1, abs=1e-6
            )
        assert {row["seconds"], row["evaluations_to_0.01"]} == {""}
    assert len(rows) == 2
    assert {row["method"] for row in rows_of(copy, "anytime")} == {"nsga2", "vepso"}


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("", "It does not compare: its evaluations are not known, those of the others 130."),
        ("--import-evaluations 260", "It does not compare: its evaluations are 260, those"),
    ],
)
def test_runs_of_other_evaluations_are_marked(call, copy, results, given, words):
    code, out, err = call(f"{LINE} --import=results {given} --output held")
    assert (code, err) == (0, "")
    assert f"{NAME}: results ends with" in out
    assert words in out
    assert words in unescape((copy / "contest.html").read_text())


def test_motions_all_along_the_exact_front_miss_nothing_of_it(call, copy, folder):
    shares = np.arange(8)[:, None, None] / 8
    save(folder / "mine.csv", (X[:-1] * (1 - shares) + X[1:] * shares).reshape(-1, 2))
    assert call(f"{LINE} --import mine.csv --output held")[0] == 0
    (arena,) = arenas_of(Store(copy))
    (found,) = arena.imports
    # a staircase misses half of each of its steps
    assert np.abs(found.final) == pytest.approx(0, abs=4e-3)
    assert found.missing_by_thirds == pytest.approx(np.zeros((1, 3)), abs=8e-3)
    assert (found.missing_by_thirds > -1e-4).all()


def test_what_a_file_states_otherwise_is_said(call, copy, folder):
    energies = np.array([point.energy for point in EXACT.points[::6]])
    energies[1] *= 2
    save(folder / "mine.csv", X[::6], energy_J=energies)
    code, out, _ = call(f"{LINE} --import mine.csv --output held")
    assert code == 0
    words = f"mine.csv of mine on {NAME}: the file's energy is wrong for 1 of {len(energies)} mot"
    assert words in out
    assert words in unescape((copy / "contest.html").read_text())


REFUSED = [
    ("--import nowhere", "there is no file or folder nowhere"),
    ("--import empty", "empty has no files"),
    ("--import 'nsga2=results'", "'nsga2' is a method that is run here"),
    ("--import '../a=results'", "the name '../a' does not do for a method"),
    ("--import wide.csv", "wide.csv: motion 1: got 3 coefficients for a profile of 2"),
    ("--import beyond.csv", "beyond the stated bound of 0.2"),
    ("--import text.csv", "text.csv: line 2"),
    ("--import a=results --import a=other", "a has two files run0.csv"),
    ("--import a=results --import b=results", "run0.csv of b holds the same as run0.csv of a"),
    ("--import results --import-evaluations 0", "evaluations is 0"),
    ("--import-evaluations 100", "give --import too"),
    (f"{OTHER} --import results", "results are imported for one problem, and 2 are named"),
]


@pytest.mark.parametrize(("given", "words"), REFUSED)
def test_files_that_do_not_fit_are_refused_before_any_work(call, folder, results, given, words):
    (folder / "empty").mkdir()
    shutil.copytree(results, folder / "other")
    save(folder / "wide.csv", np.zeros((2, 3)))
    save(folder / "beyond.csv", np.full((2, 2), 0.3))
    (folder / "text.csv").write_text("a_1,a_2\n0.1,much\n")
    code, out, err = call(f"{LINE} {given} --output new")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert words in err
    assert not (folder / "new").exists()
