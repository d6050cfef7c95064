"""The checks of the exercises: right, how far off, and what an answer should be."""

import re

import numpy as np
import pytest
from answers import EXERCISES, MOVE
from checks import AtRest, Checks, Choice, Numbers, checks_of
from notebook_files import PATHS, code_cells, read

NOTHING_SENSIBLE = (
    None,
    "nonsense",
    [[1.0, 2.0], [3.0, 4.0]],
    [1.0, [2.0]],
    np.zeros(7),
    np.nan,
    True,
    object(),
)

LENGTH = Numbers("the length", "m", lambda: 0.125)
ANGLE = Numbers("the angle", "degrees", lambda: 30.0)
PAIR = Numbers("both energies", "mJ", lambda: [20.0, 40.0], count=2)
UNEQUAL = Numbers("both residuals", "mm", lambda: [0.25, 50.0], count=2)
PRICES = Numbers("both prices", "mJ/(N m)", lambda: [240.0, 0.0], count=2, tolerance=0.1)
METHOD = Choice("the better method", ("gradient", "search"), lambda: "gradient")
POPULATION = Choice("the population", (60, 24, 8), lambda: 8)
PLATE_AT_REST = AtRest("a1 and a2", MOVE, count=2, limit=1e-4)


def said(exercise, answer, capsys):
    """The line that a student sees."""
    Checks([exercise])(1, answer)
    (line,) = capsys.readouterr().out.splitlines()
    return line.removeprefix("exercise 1: ")


@pytest.mark.parametrize(
    ("exercise", "answer", "line"),
    [
        (LENGTH, 0.125, "right"),
        (LENGTH, np.array([0.126]), "right"),  # within 2 %
        (LENGTH, 0.14, "too large by 12 %"),
        (LENGTH, 0.1, "too small by 20 %"),
        (LENGTH, 1.25, "too large by a factor of 10"),
        (LENGTH, 0.0, "too small: it is not 0"),
        (LENGTH, -0.125, "right, but for the sign"),
        (LENGTH, 125.0, "right in mm, but m is asked for"),
        (LENGTH, 12.5, "right in cm, but m is asked for"),
        (ANGLE, np.radians(30.0), "right in rad, but degrees is asked for"),
        (Numbers("the angle", "rad", lambda: 0.5), 28.65, "right in degrees, but rad is asked for"),
        (Numbers("the share", "-", lambda: 0.3), 30, "right in %, but a plain number is asked for"),
        (PAIR, [20.1, 39.9], "right"),
        (PAIR, (20.0, 30.0), "number 1 is right; number 2 is too small by 25 %"),
        (UNEQUAL, [0.3, 50.0], "number 1 is too large by 20 %; number 2 is right"),
        (UNEQUAL, [0.25, 0.0], "number 1 is right; number 2 is too small: it is not 0"),
        (PRICES, [230.0, 1.0], "right"),  # 0 within a share of the largest
        (PRICES, [230.0, 60.0], "number 1 is right; number 2 is too large"),
        (PAIR, [30.0, 60.0], "each number is too large by 50 %"),
        (PAIR, [0.02, 0.04], "right in J, but mJ is asked for"),
        (METHOD, "Gradient", "right"),
        (METHOD, "search", "it is not 'search'"),
        (POPULATION, 8.0, "right"),
        (POPULATION, 60.0, "it is not 60"),
        (PLATE_AT_REST, [0.0036, -0.17009], "right"),  # notebook 03, exercise 1
        (PLATE_AT_REST, [0.0, -0.1], "not at rest: 33.79 mm remain"),  # its first step
    ],
)
def test_an_answer_is_right_or_off_by_so_much(exercise, answer, line, capsys):
    assert said(exercise, answer, capsys) == line


@pytest.mark.parametrize(
    ("exercise", "answer", "line"),
    [
        (LENGTH, None, "asks for the length [m]; this is None"),
        (LENGTH, "0.125", "asks for the length [m]; this is '0.125'"),
        (LENGTH, [1.0, 2.0], "asks for the length [m]; this is 2 numbers in place of one"),
        (LENGTH, np.inf, "asks for the length [m]; this is not finite"),
        (PAIR, 20.0, "asks for both energies [mJ]; this is one number in place of 2"),
        (POPULATION, 8.5, "asks for the population: 60, 24 or 8; this is 8.5"),
        (METHOD, 3, "asks for the better method: 'gradient' or 'search'; this is 3"),
        (
            PLATE_AT_REST,
            [0.1],
            "asks for a1 and a2, at rest within 0.1 mm; this is one number in place of 2",
        ),
    ],
)
def test_nonsense_is_told_what_is_asked_for(exercise, answer, line, capsys):
    assert said(exercise, answer, capsys) == line


def test_all_that_is_asked_for_is_listed_and_other_numbers_are_refused(capsys):
    check = Checks([LENGTH, METHOD])
    check()
    check(3, 0.1)
    assert capsys.readouterr().out.splitlines() == [
        "exercise 1: the length [m]",
        "exercise 2: the better method: 'gradient' or 'search'",
        "no exercise 3: there are 1 to 2",
    ]
    with pytest.raises(ValueError, match="no notebook '99'; there are 01, 02"):
        checks_of("99")


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_the_cell_for_an_attempt_says_what_the_check_asks_for(path):
    exercises = EXERCISES[path.stem.partition("_")[0]]
    attempts = [c.source for c in code_cells(read(path)) if c.source.startswith("# Your attempt")]
    for number, (attempt, exercise) in enumerate(zip(attempts, exercises, strict=True), 1):
        lines = attempt.splitlines()
        assert lines[-2:] == [f"# answer: {exercise.asked}", f"# check({number}, answer)"]


def wrong_answers(exercise):
    """An answer that is wrong, and not only in its unit."""
    if isinstance(exercise, Choice):
        return next(choice for choice in exercise.among if choice != exercise.solution)
    return 1.5 * np.asarray(exercise.solution, dtype=float)


@pytest.mark.slow  # the solutions are computed
@pytest.mark.parametrize("notebook", EXERCISES)
def test_every_check_knows_right_from_wrong_and_never_shows_the_solution(notebook, capsys):
    if notebook == "15":
        pytest.importorskip("mujoco", reason="its simulator is MuJoCo, of the extra `notebook`")
    for exercise in EXERCISES[notebook]:
        assert said(exercise, exercise.solution, capsys) == "right"
        far = said(exercise, wrong_answers(exercise), capsys)
        assert "right" not in far.split("; ")
        assert re.search(r"by 50 %|it is not|mm remain", far)
        if not isinstance(exercise, Choice):
            for value in np.atleast_1d(exercise.solution):
                assert f"{value:.3g}" not in far.split()
        for nonsense in NOTHING_SENSIBLE:
            line = said(exercise, nonsense, capsys)
            assert line.startswith(f"asks for {exercise.asked}; this is ")
