"""`quietarm search --function FILE.py:NAME`, and what other commands make of its fronts."""

import signal
import subprocess
import sys

import pytest

import quietarm as qa

SIMULATOR = """
import numpy as np

def parabolas(x):
    return [x[0] ** 2 + x[1] ** 2, (x[0] - 2) ** 2 + x[1] ** 2]

def boxed(x):
    return parabolas(x)
boxed.lower, boxed.upper, boxed.objectives, boxed.units = [-5, -5], 5, ("way", "work"), ("mm", "J")

def nan(x):
    return [np.nan, 1.0]
nan.lower, nan.upper = [-1, -1], 1

def three(x):
    return [1.0, 2.0, 3.0]
three.lower, three.upper = [-1, -1], 1

def stopped(x):
    with open("calls.txt", "a") as calls:  # each seed runs this file anew
        calls.write(".")
        if calls.tell() % 30 == 0:
            raise KeyboardInterrupt(15)
    return parabolas(x)
stopped.lower, stopped.upper = [-5, -5], 5

calls = 0
def crash(x):
    global calls
    calls += 1
    if calls > 20:
        raise RuntimeError("simulator crashed")
    return parabolas(x), [x[0] - 9]
crash.lower, crash.upper = [-5, -5], 5

def never(x):
    return parabolas(x), [1.0]
never.lower, never.upper, never.constraints = [-5, -5], 5, ["wall"]

def killed(x):
    import os, signal
    with open("calls.txt", "a") as calls:
        calls.write(".")
        if calls.tell() == 25:
            os.kill(os.getpid(), signal.SIGKILL)
    return parabolas(x)
killed.lower, killed.upper = [-5, -5], 5

number = 3
"""


@pytest.fixture
def simulator(folder):
    (folder / "simulator.py").write_text(SIMULATOR)


@pytest.mark.usefixtures("simulator")
def test_a_function_of_a_file_is_searched_saved_drawn_and_compared(call, folder):
    line = "search --function simulator.py:boxed --evaluations 60 --method es"
    code, out, err = call(f"{line} --output a.json --output a.csv --output a.png")
    assert code == 0, err
    assert "least way" in out
    assert "values are those that the function boxed gave" in out
    front = qa.Front.load(folder / "a.json")
    assert front.record.evaluations == 60
    assert (folder / "a.csv").read_text().startswith("way_mm,work_J,a_1,a_2\n")
    assert call(f"{line} --seed 1 --from a.json")[0] == 2  # es has no population to put it into
    bounds = "--lower=-5,-5 --upper 5"
    asked = "search --function simulator.py:parabolas --method nsga2 --evaluations 60"
    code, _, err = call(f"{asked} {bounds} --from a.json --output b.json")
    assert code == 0, err
    assert "residual" in err
    assert " mm" not in err  # the function's own unit, as in the answer
    code, out, err = call(f"{line} --seed 1 --output c.json")
    assert code == 0, err
    code, out, err = call("compare a.json c.json")
    assert code == 0, err
    assert "hypervolume gap [%]" in out


@pytest.mark.usefixtures("simulator")
@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("--function simulator.py", "give the file and the name"),
        ("--function other.py:f", "other.py is no file"),
        ("--function simulator.py:parabola", "did you mean 'parabolas'?"),
        ("--function simulator.py:number", "give the name of a function"),
        ("--function simulator.py:parabolas --evaluations 9", "Missing option '--lower'"),
        ("--function simulator.py:boxed", "Missing option '--evaluations'"),
        ("--quiet --function simulator.py:nan --evaluations 40", "no finite numbers"),
        ("--function simulator.py:three --evaluations 40", "shape (3,), not (2,)"),
        ("single-link --function simulator.py:boxed", "PLANT is for a move"),
        ("--function simulator.py:boxed --bound 1", "--bound is for a move"),
        ("--function simulator.py:boxed --evaluations 9 -o a.html", "a.html is for a front"),
        ("single-link --target 1 --duration 1 --bound 1 --lower 1", "--lower is for --function"),
        ("single-link --target 1 --duration 1 --bound 1 --constraints a", "a move has limits"),
        ("single-link --target 1 --duration 1 --bound 1 --state a", "--state is for --function"),
        ("--function simulator.py:boxed --generations 9 --state a", "--generations is not for a"),
        ("--function simulator.py:boxed --evaluations 9 --runs 2 --state a", "--runs is not for a"),
        (
            "--function simulator.py:boxed --evaluations 9 --state a.json -o a.json",
            "a.json is given twice",
        ),
    ],
)
def test_what_is_wrong_is_said_in_one_line(refused, line, words):
    assert words in refused(f"search {line}")


@pytest.mark.usefixtures("simulator")
@pytest.mark.parametrize("method", ["es", "nsga2 --population 8"])
def test_what_is_stopped_keeps_the_candidates_until_then(call, folder, method):
    line = f"search --function simulator.py:stopped --evaluations 60 --method {method} --quiet"
    code, out, err = call(f"{line} --output kept.json")
    assert code == 128 + 15  # that of SIGTERM
    assert "wrote kept.json" in out
    count = qa.Front.load(folder / "kept.json").record.evaluations
    assert 20 <= count < 30  # a generation is taken as a whole
    assert err == f"quietarm: interrupted: the front of the first {count} candidates is written\n"
    assert call("compare kept.json")[0] == 0
    _, out, err = call(line)
    assert f"the first {count} candidates is shown and not written" in err
    assert f"{count} candidates in" in out
    _, out, err = call(f"{line} --state kept.state")  # as many as without a state
    assert f"the front of the first {count} candidates" in err
    assert f"kept.state has {count} results, type the same command to go on" in err
    code, out, _ = call(f"{line} --state kept.state")
    assert f"{count} results from kept.state" in out


@pytest.mark.slow_after(1)
@pytest.mark.usefixtures("simulator")
@pytest.mark.parametrize("method", ["es", "gp", "nsga2 --population 8 --reevaluate 2"])
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
def test_a_killed_command_goes_on_with_what_its_file_has(folder, method):
    """No candidate is evaluated again, and the front is that of a search without a stop."""
    begin = [sys.executable, "-m", "quietarm", "search", "--quiet", "--evaluations", "60"]
    begin += ["--method", *method.split()]
    line = [*begin, "--function", "simulator.py:killed", "--state", "run.json", "-o", "a.json"]
    assert subprocess.run(line, check=False).returncode == -signal.SIGKILL
    subprocess.run(line, check=True)
    once = 25 + (60 - 24)  # the call in which it was killed had returned nothing
    assert len((folder / "calls.txt").read_text()) == once
    subprocess.run([*begin, "--function", "simulator.py:killed", "-o", "b.json"], check=True)
    kept, whole = (qa.Front.load(folder / name) for name in ("a.json", "b.json"))
    assert kept == whole
    subprocess.run(line, check=True)  # nothing is left to do
    assert len((folder / "calls.txt").read_text()) == once + 60


@pytest.mark.usefixtures("simulator")
def test_a_damaged_state_is_named_with_what_to_do(call, refused, folder):
    line = "search --function simulator.py:boxed --evaluations 30 --quiet --state a.state"
    assert call(line)[0] == 0
    text = (folder / "a.state").read_text()
    for damaged in ("", text[:300], text.replace("0.1", "0.2")):
        (folder / "a.state").write_text(damaged)
        assert refused(line).endswith("; delete it to begin again, or give another file\n")
        assert (folder / "a.state").read_text() == damaged


@pytest.mark.usefixtures("simulator")
def test_a_state_that_does_not_fit_leaves_the_front_that_was_written(call, refused, folder):
    """With more evaluations the population is larger: other candidates are asked for."""
    line = "search --function simulator.py:boxed --method nsga2 --quiet --state a.state -o a.json"
    assert call(f"{line} --evaluations 40")[0] == 0
    before = (folder / "a.json").read_text()
    said = refused(f"{line} --evaluations 1000")
    assert said.endswith("; give 40, or another file\n")
    assert (folder / "a.json").read_text() == before


@pytest.mark.usefixtures("simulator")
def test_threads_keep_each_result(call, folder):
    """The slowest of a block does not hold back the results of the others."""
    line = "search --function simulator.py:stopped --evaluations 60 --method nsga2 --quiet"
    code, _, err = call(f"{line} --threads 4 --state kept.state")
    assert code == 128 + 15
    calls = len((folder / "calls.txt").read_text())
    assert calls >= 30
    failed = calls // 30
    assert f"kept.state has {calls - failed} results" in err


@pytest.mark.usefixtures("simulator")
def test_a_function_that_fails_keeps_the_candidates_until_then(call, folder):
    line = "search --function simulator.py:crash --evaluations 60 --method es --quiet --output"
    code, out, err = call(f"{line} kept.json --constraints wall --objectives way,work")
    assert code == 2
    assert "wrote kept.json" in out
    assert "RuntimeError: simulator crashed; mend it" in err
    assert err.endswith("; the front of the first 20 candidates is written\n")
    front = qa.Front.load(folder / "kept.json")
    assert front.record.evaluations == 20
    assert front.objectives == ("way", "work")
    assert front.task.constraints == ("wall",)


@pytest.mark.usefixtures("simulator")
def test_where_nothing_is_feasible_no_hypervolume_is_said(call):
    code, out, err = call("search --function simulator.py:never --evaluations 20 --method es")
    assert (code, out) == (1, "")
    assert "no point" in err
    assert "20 of 20 candidates violate the constraints (wall)" in err
    assert "area up to" not in err


@pytest.mark.usefixtures("simulator")
def test_of_several_seeds_the_one_that_is_stopped_has_a_file_as_well(call, folder):
    line = "search --function simulator.py:stopped --evaluations 16 --method es --runs 3 --quiet"
    _, out, err = call(f"{line} --output front.json")
    done, cut_short = (qa.Front.load(folder / f"front-seed{seed}.json") for seed in (0, 1))
    count = cut_short.record.evaluations
    assert done.record.evaluations == 16
    assert 0 < count < 16
    assert err.endswith(
        f"1 of 3 seeds are done; 1 front and the front of the first {count} candidates of seed 1 "
        "are written\n"
    )
    assert "seed 1" not in out  # its candidates are fewer, and stand in no statistics


@pytest.mark.usefixtures("simulator")
def test_commands_that_need_a_move_say_so(refused, call):
    line = "search --function simulator.py:boxed --evaluations 30 --method es --output a.json"
    assert call(line)[0] == 0
    for command in (
        "front --polish a.json",
        "explore a.json --no-browser",
    ):
        assert "has no plant and no task" in refused(command)
    assert "make NamedProblem.of_function('mine'" in refused("bench a.json --output b")


def test_a_file_that_fails_is_named_with_its_line(refused, folder):
    (folder / "bad.py").write_text("x = 1\ny = x / 0\n")
    assert "bad.py, line 2 fails: ZeroDivisionError" in refused("search --function bad.py:f")
