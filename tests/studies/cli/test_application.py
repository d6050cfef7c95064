"""The commands together: names, help, the options of all, plants of one's own, endings."""

import os
import re
import signal

import pytest
from lines import MOVE

from quietarm.metaheuristics import drawn_problems, problem_of
from quietarm.models import Plant, SingleLinkManipulator, load_plant_file
from quietarm.ocp import Front, Plan, PointToPoint, evaluate_coefficients
from quietarm.studies.cli.application import COMMANDS, command_of
from quietarm.studies.cli.options import Command

CRANE = "--target 1 --duration 3"


@pytest.fixture(autouse=True)
def _unwrapped(_as_typed, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")


def test_every_command_has_help_with_what_all_commands_take(done):
    for name in COMMANDS:
        assert isinstance(command_of(name), Command)
        out = done(f"{name} --help")
        assert out.startswith(f"Usage: quietarm {name} ")
        assert all(option in out for option in ("--plant-file", "--quiet", "--help"))


# Plants of one's own, parameters


@pytest.mark.parametrize("named", ["", "crane "])
def test_a_plant_of_a_file_is_evaluated_as_from_python(done, crane_file, named):
    out = done(
        f"evaluate {named}{CRANE} --plant-file crane.py --set omega=2.5 --coefficients=0.1 --quiet "
        "--output plan.json"
    )
    assert "crane with omega = 2.5 rad/s, 0 to" in out
    crane = load_plant_file("crane.py")["crane"](omega=2.5)
    assert Plan.load("plan.json") == evaluate_coefficients(PointToPoint(crane, 1.0, 3.0), [0.1])


def test_what_was_saved_is_read_with_the_plant_file_alone(call, refused, crane_file):
    line = f"search {CRANE} --plant-file crane.py --population 20 --generations 3 --bound 0.2"
    assert call(f"{line} --quiet --output f.json")[0] == 0
    polish = "front --polish f.json --quiet --output p.json"
    Plant._known.pop("crane", None)  # as another process would not know it
    code, out, err = call(polish)
    assert (code, out, "by --plant-file" in err) == (2, "", True)
    assert call(f"{polish} --plant-file crane.py")[0] == 0
    crane_file.write_text(crane_file.read_text().replace("0.4", "0.5"))
    assert "sha" in refused(f"{polish} --plant-file crane.py").lower()


def test_parameters_are_set(done):
    out = done(
        f"evaluate {MOVE} --coefficients=0.1 --quiet --set omega=2Hz --set zeta=1% --output p.json"
    )
    assert "single-link with zeta = 0.01, omega = 12.566 rad/s, 0" in out
    plant = Plan.load("p.json").task.plant
    assert plant == SingleLinkManipulator(omega=4 * 3.141592653589793, zeta=0.01)


# `list`


def test_plants_problems_and_methods_are_listed(call, done, crane_file):
    out = done("list")
    assert all(f"  {name} " in out for name in ("dual-link", "single-link-30deg-0.8s", "nsga2"))
    assert "omega   10.43 rad/s: frequency of the mode, hub held" in call("list single-link")[1]
    assert "crossover_eta " in call("list NSGA-II")[1]
    assert "  crane " in call("list plants --plant-file crane.py")[1]


@pytest.mark.slow
def test_reference_fronts_are_written_to_a_folder(done, folder):
    two, torque = (problem_of(f"single-link-30deg-0.8s-{name}") for name in ("2-terms", "torque"))
    out = done(f"list {two.name} {torque.name} --output fronts")
    assert out.splitlines()[-1] == "wrote 8 fronts to fronts"
    for problem in (two, torque):
        loaded = tuple(Front.load(folder / "fronts" / f"{name}.json") for name in problem.tasks())
        assert loaded == problem.fronts()


# The end of a command


def test_ctrl_c_while_files_are_written_waits_until_they_are_there(call, folder, monkeypatch):
    sync = os.fsync

    def interrupted(handle):
        signal.raise_signal(signal.SIGINT)
        sync(handle)

    monkeypatch.setattr(os, "fsync", interrupted)
    code, out, err = call(f"evaluate {MOVE} --coefficients=0 --output o.json --output o.csv")
    assert (code, err) == (130, "quietarm: interrupted; wrote o.json, o.csv\n")
    assert out.splitlines()[-2:] == ["wrote o.json", "wrote o.csv"]
    assert sorted(path.name for path in folder.iterdir()) == ["o.csv", "o.json"]


def test_drawn_problems_are_listed_by_group_and_say_what_reference_they_have(call):
    limited = "single-link-m4-6-absolute-torque-tight"
    code, everything, _ = call("list drawn")
    assert code == 0
    listed = set(re.findall(r"[\w-]+-m\d+-[\w-]+", everything))
    assert listed == set(drawn_problems())
    _, short, _ = call("list")
    assert "MOVE-6-absolute-torque-tight" in short
    assert "`quietarm list drawn` has all names" in " ".join(short.split())
    assert limited not in short
    _, one, _ = call(f"list {limited}")
    # docs/results/limits.csv: a torque limit of 0.7236 N m
    assert "limits torque 0.723575 N m" in one
    assert "the gradient finds a reference front" in one
    assert f"did you mean '{limited}'" in call(f"list {limited[:-1]}")[2]
