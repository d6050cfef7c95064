"""`quietarm front` by a metaheuristic: whole runs of a small size."""

import math
from pathlib import Path

import numpy as np
import pytest
from quietarm.metaheuristics import search
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, Front, PointToPoint

MOVE = "single-link --target 30deg --duration 0.8 --bound 0.2 --terms 2"
SMALL = f"front {MOVE} --method vepso --population 8 --generations 4"
TASK = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8)


def directly(seed=0, **settings):
    """What `SMALL` is to find."""
    given = {"bound": 0.2, "population": 8, "generations": 4, **settings}
    return search(TASK, "vepso", profile=CycloidPolynomial(2), seed=seed, **given)


# One seed


def test_one_search_is_shown_and_written(call):
    code, out, err = call(f"{SMALL} --seed 3 --output f.json --figure f.svg")
    front = directly(seed=3)
    assert code == 0
    assert Front.load("f.json") == front
    assert "<svg" in Path("f.svg").read_text()
    lines = out.splitlines()
    assert lines[0].startswith(f"vepso, seed 3: {len(front.points)} points, 64 candidates in ")
    for line, point in zip(
        lines[1:4], (front.stillest(), front.knee(), front.cheapest()), strict=True
    ):
        assert line.endswith(f"{point.energy:.4g} J at {point.residual * 1e3:.3g} mm")
    assert lines[4:] == ["wrote f.json", "wrote f.svg"]
    assert "generation 4/4, residual " in err


def test_a_search_that_finds_nothing_says_why(call, folder):
    code, out, err = call(f"{SMALL} --torque-limit 0.001 --quiet --output f.json")
    assert (code, out) == (1, "")
    assert err == (
        "quietarm: vepso: the front has no point; 64 of 64 candidates break the limits (torque "
        "0.001); widen them or the bound, or search longer\n"
    )
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize("method", ["vepso", "nsga2"])
def test_an_interrupted_search_goes_on_to_the_same_front(call, interrupted_at, method):
    line = f"{SMALL} --quiet --method {method} --generations 6"
    assert call(f"{line} --output whole.json")[0] == 0
    interrupted_at(2)
    code, out, err = call(f"{line} --checkpoint state --output part.json")
    part = Front.load("part.json")
    assert (code, len(part.history), part.complete) == (1, 2, False)
    assert "(interrupted: what was found until then)" in out
    assert err.lstrip("\n") == "quietarm: interrupted; what was found until then is kept\n"
    interrupted_at(0)  # no more
    # the same file may be gone on in
    code, _, err = call(f"{line} --resume state --checkpoint state --output resumed.json")
    assert (code, err) == (0, "")
    assert Front.load("resumed.json") == Front.load("whole.json")


# Several seeds


def test_several_seeds_are_written_to_a_file_each_with_their_spread(call):
    code, out, err = call(f"{SMALL} --seed 4 --runs 3 --output f.json --figure f.png")
    fronts = [Front.load(f"f-seed{seed}.json") for seed in (4, 5, 6)]
    assert code == 0
    assert fronts == [directly(seed) for seed in (4, 5, 6)]
    assert out.splitlines()[-4:] == [*(f"wrote f-seed{s}.json" for s in (4, 5, 6)), "wrote f.png"]
    low, middle, high = np.quantile([f.history[-1].hypervolume for f in fronts], [0.25, 0.5, 0.75])
    assert (
        f"hypervolume: median {middle:.4f}, quartiles {low:.4f} to {high:.4f} of the box up to "
        in out
    )
    for seed in (4, 5, 6):
        assert f"\nvepso, seed {seed}: " in f"\n{out}"
        assert f"seed {seed} is done: hypervolume " in err
    assert not Path("f.json").exists()
