"""Runs that cannot be compared are not put into one folder."""

import json
import re

import pytest
from small_contest import LINE, NAME

pytestmark = pytest.mark.usefixtures("no_pictures")


@pytest.fixture
def refused(call, copy):
    """Run a line that is refused in one line, which it returns, and writes nothing."""

    def run(line):
        before = {path: path.read_bytes() for path in copy.rglob("*.json")}
        code, out, err = call(f"{line} --output {copy}")
        assert (code, out, err.count("\n")) == (2, "", 1)
        assert {path: path.read_bytes() for path in copy.rglob("*.json")} == before
        return err

    return run


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (LINE.replace("130", "260"), "another number of evaluations (nsga2 on"),
        (LINE.replace("--population 20", "--population 24"), ": 20, not 24; give --population 20"),
        (LINE.replace("--population 20", ""), ": 20, not the method's own; give --population 20"),
    ],
)
def test_runs_that_differ_are_not_put_into_one_folder(refused, line, words):
    err = refused(line)
    assert words in err
    assert "or another --output" in err


def _spoil(path, **entries):
    document = json.loads(path.read_text())
    path.write_text(json.dumps({**document, **entries}))


def test_a_missing_exact_front_is_not_made_anew_behind_the_runs(refused, copy):
    (copy / f"exact/{NAME}.json").unlink()
    err = refused(LINE)
    assert f"has runs on {NAME} without its exact front" in err


def _spoil_front(copy, **entries):
    path = copy / f"runs/{NAME}/vepso/seed1.json"
    front = json.loads(path.read_text())["front"]
    _spoil(path, front={**front, **{name: front[name] | entries[name] for name in entries}})


@pytest.mark.parametrize("name", ["pymoo", "quietarm"])
def test_runs_of_another_version_are_shown_and_not_added_to(refused, call, copy, name):
    _spoil_front(copy, versions={name: "0.0.9"})
    said = refused(LINE.replace("--runs 2", "--runs 3"))
    assert f"another version of {name} (vepso on {NAME} from seed 1): 0.0.9, not" in said
    assert f"install {name} 0.0.9" in said
    assert call(f"{LINE} --output {copy}")[0] == 0  # which adds nothing
    page = (copy / "contest.html").read_text()
    assert re.search(rf"the runs are of different versions: {name} \S+ and 0.0.9", page)
    assert re.search(rf"Computed with .*{name} \S+ and 0.0.9", page)


def test_a_run_on_another_move_is_refused(refused, copy):
    _spoil_front(copy, task={"duration": 0.9})
    assert f"on another move or against another exact front (vepso on {NAME}" in refused(LINE)


def test_figures_that_were_altered_are_not_believed(refused, copy):
    path = copy / f"runs/{NAME}/nsga2/seed0.json"
    front = json.loads(path.read_text())["front"]
    for point in front["points"]:
        point["energy"] *= 0.9
    _spoil(path, front=front)
    said = refused(LINE)
    assert "states energy" in said
    assert "nsga2/seed0.json" in said
