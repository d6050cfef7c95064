"""Runs that cannot be compared are not put into one folder."""

import json

import pytest
import quietarm.studies.contest.asked as asked
from quietarm.studies.contest.measures import arenas_of
from quietarm.studies.contest.report.notes import unequal
from quietarm.studies.contest.report.paragraph import methods_paragraph
from quietarm.studies.contest.store import Store
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
        (LINE.replace("130", "260"), "has runs of 130 evaluations"),
        (LINE.replace("--population 20", "--population 24"), "a run whose population is 20"),
        (LINE.replace("--population 20", ""), "and the method's own is asked for"),
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


MORE = LINE.replace("--runs 2", "--runs 3")
"""A line with runs that are still to be done."""


def of_version(copy, **versions):
    """Let a run be of other versions."""
    path = copy / f"runs/{NAME}/vepso/seed1.json"
    front = json.loads(path.read_text())["front"]
    _spoil(path, front={**front, "versions": {**front["versions"], **versions}})


@pytest.mark.parametrize("name", ["pymoo", "quietarm"])
def test_runs_of_another_version_are_not_added_to(refused, copy, name):
    of_version(copy, **{name: "0.0.9"})
    ours = asked.search_versions()[name]
    assert refused(MORE) == (
        f"quietarm: {copy} has runs of {name} 0.0.9 (vepso on {NAME} from seed 1), and new ones "
        f"would be of {ours}; install {name} 0.0.9, or give another --output\n"
    )


def test_other_versions_are_shown_where_nothing_is_added(call, copy):
    of_version(copy, pymoo="0.0.9")
    assert call(f"{LINE} --output {copy}")[0] == 0
    ours = asked.search_versions()["pymoo"]
    assert f"pymoo 0.0.9 or {ours}" in (copy / "contest.html").read_text()


def test_other_versions_of_what_rounds_are_named_and_go_on(call, copy):
    of_version(copy, casadi="3.0.0")
    arenas = arenas_of(Store(copy))
    assert "casadi 3.0.0 or " in methods_paragraph(arenas)
    assert f"{NAME}: the runs are of different versions: casadi 3.0.0 and" in " ".join(
        unequal(arenas)
    )


def test_an_exact_front_of_another_box_is_refused(refused, copy):
    _spoil(copy / f"exact/{NAME}.json", bound=0.3)
    assert f"has another move or box of the name {NAME}; give another" in refused(LINE)


def test_a_run_on_another_move_is_refused(refused, copy):
    path = copy / f"runs/{NAME}/nsga2/seed0.json"
    front = json.loads(path.read_text())["front"]
    _spoil(path, front={**front, "task": {**front["task"], "duration": 0.9}})
    assert f"(nsga2 on {NAME} from seed 0); remove it" in refused(LINE)


def test_figures_that_were_altered_are_not_believed(refused, copy):
    path = copy / f"runs/{NAME}/nsga2/seed0.json"
    front = json.loads(path.read_text())["front"]
    for point in front["points"]:
        point["energy"] *= 0.9
    _spoil(path, front=front)
    said = refused(LINE)
    assert "states energy" in said
    assert "nsga2/seed0.json" in said
