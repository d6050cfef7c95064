"""`quietarm search`: whole runs of a small size."""

import math
import signal
import time
from pathlib import Path

import pytest
from lines import MOVE, run

from quietarm.metaheuristics import search
from quietarm.metaheuristics.score import final_share_of_box
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, Front, PointToPoint
from quietarm.views.report.captions import caption_of_front

TERMS = "--bound 0.2 --terms 2 --population 8 --generations 4"
SMALL = f"search {MOVE} {TERMS} --method vepso"
TASK = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8)


def directly(method="vepso", seed=0, **settings):
    """Return the front that `SMALL` is to find."""
    given = {"bound": 0.2, "population": 8, "generations": 4, **settings}
    return search(TASK, CycloidPolynomial(2), algorithm=method, seed=seed, **given)


def test_one_search_is_shown_and_written(call):
    code, out, err = call(f"{SMALL} --seed 3 --output f.json --output f.csv --output f.svg")
    front = directly(seed=3)
    assert code == 0
    assert Front.load("f.json") == front
    assert "<svg" in Path("f.svg").read_text()
    lines = out.splitlines()
    assert lines[0] == f"{caption_of_front(front)}."
    ends = (front.smallest_residual(), front.cheapest())
    assert lines[2] == "  knee           none between the ends"
    for line, point in zip(lines[1:4:2], ends, strict=True):
        assert line.endswith(f"{point.energy:.4g} J at {point.residual * 1e3:.3g} mm")
    assert lines[4].startswith(f"vepso, seed 3: {len(front.points)} points, 64 candidates in ")
    assert lines[5] == "residuals are at the tip within 1.205 s"  # two periods of 10.43 rad/s
    assert lines[6:] == ["wrote f.json", "wrote f.csv", "wrote f.svg"]
    assert "generation 4/4, residual " in err


@pytest.mark.parametrize("spelling", ["rvea", "RVEA"])
def test_a_method_with_settings(done, spelling):
    settings = "--setting alpha=3 --setting crossover=0.5"
    out = done(f"search {MOVE} {TERMS} --method {spelling} {settings} --quiet --output f.json")
    assert "\nrvea, seed 0: " in out
    wanted = directly("rvea", settings={"alpha": 3, "crossover": 0.5})
    assert Front.load("f.json") == wanted != directly("rvea")


def test_an_obvious_spelling_is_understood(call):
    for spelling in ("NSGA-II", "nsga-2", "nsga_ii"):
        code, out, _ = call(f"search {MOVE} {TERMS} --method {spelling} --quiet")
        assert code == 0
        assert "\nnsga2, seed 0" in out


def test_a_search_that_finds_nothing_says_why(refused):
    said = refused(f"{SMALL} --torque-limit 0.001 --quiet --output f.json", status=1)
    assert "64 of 64 candidates break the limits (torque 0.001" in said


def test_several_seeds_are_written_to_a_file_each_with_their_spread(call):
    code, out, err = call(f"{SMALL} --seed 4 --runs 3 --output f.json --output f.png")
    fronts = [Front.load(f"f-seed{seed}.json") for seed in (4, 5, 6)]
    assert code == 0
    assert fronts == [directly(seed=seed) for seed in (4, 5, 6)]
    assert out.splitlines()[-4:] == [*(f"wrote f-seed{s}.json" for s in (4, 5, 6)), "wrote f.png"]
    low, middle, high = sorted(map(final_share_of_box, fronts))
    assert f"hypervolume: {middle:.4f} ({low:.4f} to {high:.4f}) of the area" in out
    for seed in (4, 5, 6):
        assert f"\nvepso, seed {seed}: " in f"\n{out}"
        assert f"seed {seed} is done in " in err
    assert not Path("f.json").exists()


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_seeds_that_are_done_survive_a_kill(at_a_terminal, stop, folder, workers):
    process = at_a_terminal(
        f"{SMALL} --quiet --runs 10000 --workers {workers} --output f.json --output f.csv"
    )
    done = [Path(f"f-seed{seed}.csv") for seed in range(2)]  # written after the .json
    while not all(path.exists() for path in done):
        assert process.poll() is None
        time.sleep(0.01)
    stop(process, signal.SIGKILL)
    for seed in range(2):
        assert Front.load(f"f-seed{seed}.json") == directly(seed=seed)
    assert all(path.read_text().startswith("residual_m,energy_J,a_1,a_2") for path in done)


@pytest.mark.slow
def test_workers_share_the_runs(folder):
    """The installed command: each worker starts by running its file."""
    ran = run(f"{SMALL} --quiet --runs 2 --workers 2 --output f.json")
    assert (ran.returncode, ran.stderr) == (0, "")
    assert all(Front.load(f"f-seed{seed}.json").points for seed in range(2))
