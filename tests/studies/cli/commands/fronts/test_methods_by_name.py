"""Methods of pymoo by name, and their settings, in `front`, `plan` and `study`."""

import math

import pytest
import quietarm.studies.cli.commands.plan
import quietarm.studies.study.work
from lines import MOVE
from quietarm.metaheuristics import PRESETS, search
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, Front, Plan, PointToPoint
from quietarm.studies.study.page import method_lines

TASK = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8)
FRONT = f"front {MOVE} --bound 0.2 --terms 2"
SMALL = {"population": 8, "generations": 4}
SMALL_WORDS = "--population 8 --generations 4 --quiet"


def directly(method, **settings):
    return search(TASK, method, profile=CycloidPolynomial(2), bound=0.2, **SMALL, **settings)


def test_a_front_by_any_method_with_settings(call):
    line = f"{FRONT} --method rvea --setting alpha=3 --setting crossover=0.5 {SMALL_WORDS}"
    code, out, err = call(f"{line} --output f.json --figure f.png")
    assert (code, err) == (0, "")
    assert out.startswith("rvea, seed 0: ")
    wanted = directly("rvea", settings={"alpha": 3, "crossover": 0.5})
    assert Front.load("f.json") == wanted != directly("rvea")


def test_several_seeds_of_any_method(call):
    line = f"{FRONT} --method gde3 --setting repair=midway --runs 2 {SMALL_WORDS} --output f.json"
    code, _, err = call(line)
    assert (code, err) == (0, "")
    for seed in (0, 1):
        wanted = directly("gde3", settings={"repair": "midway"}, seed=seed)
        assert Front.load(f"f-seed{seed}.json") == wanted


def test_a_plan_by_any_method_with_settings(call, monkeypatch):
    asked = {}

    def small(task, method, **given):
        asked.update(given, method=method)
        return directly(method, settings=given["settings"])

    monkeypatch.setattr(quietarm.studies.cli.commands.plan, "search", small)
    line = f"plan {MOVE} --bound 0.2 --terms 2 --method spea2 --setting normalise=false"
    code, _, err = call(f"{line} --residual-limit 50mm --quiet --output p.json")
    assert (code, err) == (0, "")
    assert (asked["method"], asked["settings"]) == ("spea2", {"normalise": False})
    plan = Plan.load("p.json")
    assert plan.provenance.method == "spea2"
    assert plan.provenance.search["population"] == 8


def test_a_study_of_the_methods_that_are_asked_for(call, monkeypatch):
    asked = []

    def at_once(cases, settings, begin):
        asked.append(settings)
        raise ValueError("enough")

    monkeypatch.setattr(quietarm.studies.study.work, "run_study", at_once)
    line = "study --method smsemoa --method nsga2 --method smsemoa --setting smsemoa.mutation=1"
    call(f"{line} --quiet")
    (settings,) = asked
    assert settings.methods == ("smsemoa", "nsga2")
    assert settings.settings == {"smsemoa": {"mutation": 1}}
    lines = method_lines(settings)
    assert (
        "SMS-EMOA (Beume, Naujoks and Emmerich 2007): from 3 seeds, with a population of 100 and "
        "400 generations, mutation 1."
    ) in lines
    assert any(line.startswith("NSGA-II: the paper's search, from 3 seeds") for line in lines)
    assert not any(line.startswith("VEPSO") for line in lines)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (f"{FRONT} --method smsmoa", "unknown method 'smsmoa'; did you mean 'smsemoa'? (known: "),
        (f"plan {MOVE} --method nsga4", "unknown method 'nsga4'; did you mean 'nsga"),
        ("study --method epsilon", "unknown metaheuristic 'epsilon'; did you mean"),
        (f"{FRONT} --method rvea --setting alfa=3", "rvea has no setting 'alfa'; did you mean 'al"),
        (f"{FRONT} --method rvea --setting alpha", "'alpha' sets nothing; give a setting and its"),
        (f"{FRONT} --method rvea --setting alpha=0", "alpha is 0; give a positive number"),
        (f"{FRONT} --method rvea --setting alpha=x", "alpha is 'x'; give a number"),
        (f"{FRONT} --method rvea --setting alpha=1 --setting alpha=2", "alpha is given twice"),
        (f"{FRONT} --method epsilon --setting alpha=1", "--setting is for a metaheuristic, not"),
        (f"plan {MOVE} --setting alpha=1", "--setting is for a metaheuristic, not for gradient"),
        (f"plan {MOVE} --profile zv --setting alpha=1", "--setting is for "),
        ("study --setting mutation=1", "begin it with one of these and a dot: nsga2"),
        ("study --setting rvea.alpha=1", "begin it with one of these and a dot: nsga2"),
        ("study --setting nsga2.alpha=1", "nsga2 has no setting 'alpha'"),
        (f"{FRONT} --method moead --torque-limit 1", "moead cannot search a task with limits"),
    ],
)  # fmt: skip
def test_what_a_method_does_not_have_is_refused_in_one_line(call, folder, line, words):
    code, out, err = call(line)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert words in err
    assert list(folder.iterdir()) == []


def test_every_method_can_be_asked_for(call):
    _, out, _ = call("front --help")
    assert all(name in out for name in PRESETS)
