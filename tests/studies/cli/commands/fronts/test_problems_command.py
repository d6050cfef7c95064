"""`quietarm problems`: the list, and the exact fronts in files."""

from quietarm.metaheuristics import problem_of
from quietarm.ocp import Front

SMALL = "single-link-30deg-0.8s-2-terms"
THIRD = "single-link-30deg-0.8s-torque"


def test_exact_fronts_are_written_to_a_folder(call, folder):
    code, out, err = call(f"problems {SMALL} {THIRD} --output fronts --quiet")
    assert (code, err) == (0, "")
    assert out.splitlines()[-1] == "wrote 7 fronts to fronts"
    (front,) = problem_of(SMALL).fronts()
    assert Front.load(folder / "fronts" / f"{SMALL}.json") == front
    names = problem_of(THIRD).tasks()
    loaded = tuple(Front.load(folder / "fronts" / f"{name}.json") for name in names)
    assert loaded == problem_of(THIRD).fronts()
