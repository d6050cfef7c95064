"""`quietarm compare`: fronts, plans, folders; what it shows, writes and refuses."""

import json
from dataclasses import replace

import pandas as pd
import pytest
from saved_files import edit

from quietarm.studies.answers import read_answers


@pytest.fixture
def files(good, poor, folder, monkeypatch):
    """Two invented fronts, in the folder of the test; nothing can be evaluated between points."""
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.setattr(read_answers, "check_figures", lambda front, name: None)
    good.save("good.json")
    poor.save("poor.json")
    return folder


def test_fronts_fill_a_folder(done, files):
    out = done("compare good.json poor.json --no-free-motion --output compared")
    names = {"report.md", "methods.csv", "runs.csv", "fronts.png"}
    assert {path.name for path in (files / "compared").iterdir()} == names
    runs = pd.read_csv(files / "compared" / "runs.csv").set_index("name")
    assert runs.loc["good.json", "energy_J_at_5mm"] == 0.5
    assert "epsilon constraint" in out


EFFORT = ("record/evaluations", "record/seconds", "record/method", "record/iterations")


@pytest.mark.parametrize("place", EFFORT)
def test_the_effort_of_a_front_is_what_was_written(refused, files, place):
    def other(value):
        return f"{value}x" if isinstance(value, str) else value + 1

    edit("poor.json", place, other, seal=False)
    words = "poor.json is not a valid front: it was changed since it was written, as its checksum"
    assert words in refused("compare good.json poor.json --no-free-motion")
    assert words in refused("compare good.json --reference poor.json")


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("place", ["record/seconds", "status", "steps"])
def test_so_is_that_of_a_plan(refused, folder, plan, place):
    plan.save("mine.json")

    def other(value):
        return "not optimised" if isinstance(value, str) else value + 1

    edit("mine.json", place, other, seal=False)
    words = "mine.json is not a valid plan: it was changed since it was written"
    assert words in refused("compare mine.json")
    assert words in refused("export mine.json --output mine.csv")


def test_a_file_that_another_program_saves_again_is_the_same(done, files):
    text = json.dumps(json.loads((files / "good.json").read_text()), indent=None, sort_keys=True)
    (files / "good.json").write_text(text.replace(".0,", ",").replace(".0}", "}"))
    assert "epsilon constraint" in done("compare good.json --no-free-motion")


def test_runs_of_a_bench_are_runs_of_one_method(done, files, front_of):
    for seed in (0, 1):
        front = front_of([(1 + seed, 0.9), (6, 0.6)], seed=seed)
        settings = {**front.record.settings, "checksum": f"{seed}"}
        front.restated(settings=settings).save(f"seed{seed}.json")
    done("compare seed0.json seed1.json --no-free-motion --output compared")
    methods = pd.read_csv(files / "compared" / "methods.csv")
    assert methods["seeds"].tolist() == [2]
    assert "checksum" not in methods["method"][0]
    assert methods["residual window [s]"].tolist() == [front.task.residual_window]


def test_a_folder_is_compared_move_by_move(call, files, front_of, task):
    (files / "bench" / "deep").mkdir(parents=True)
    (files / "good.json").rename(files / "bench" / "good.json")
    (files / "poor.json").rename(files / "bench" / "deep" / "poor.json")
    front_of([(1, 0.5)], task=replace(task, duration=1.0)).save("bench/other.json")
    code, out, _ = call("compare bench --no-free-motion --output compared")
    assert code == 0
    assert "0 to 30 deg in 0.8 s" in out
    assert "0 to 30 deg in 1 s" in out
    assert (files / "compared" / "fronts-2.png").exists()


def test_plans_are_compared_with_baselines_under_errors(done, plan, cycloid):
    plan.save("ours.json")
    line = "compare ours.json --baselines zv,cycloid --error frequency=8% --samples 50"
    out = done(f"{line} --output out")
    table = pd.read_csv("out/motions.csv").set_index("motion")
    assert list(table.index) == ["ours", "zv", "cycloid"]
    assert table.loc["ours", "energy [J]"] == pytest.approx(plan.energy, rel=1e-9)
    there = cycloid.candidate.perturbed({"frequency": 0.08}).residual
    assert table.loc["cycloid", "worst case [mm]"] >= 1e3 * there * (1 - 1e-9)
    assert "+-8 % of frequency" in " ".join(out.split())


def test_tables_of_fronts_fit_into_100_columns(done, files, monkeypatch):
    monkeypatch.setenv("COLUMNS", "100")
    out = done("compare good.json poor.json --no-free-motion")
    assert max(map(len, out.splitlines())) <= 100
    assert "additive epsilon" in out


def test_by_a_band_the_answer_is_who_acts_first(done, plan):
    """In 100 columns, in a terminal as in a pipe, by the energy that is typed."""
    plan.save("ours.json")
    line = "compare ours.json --baselines zvd --band 1mm --energy positive+copper:0.12"
    out = done(f"{line} --output out")
    assert "may act first" in out.splitlines()[0]
    assert "within 1 mm for frequency errors up to 5 %" in " ".join(out.split())
    assert "positive+copper:0.12" in " ".join(out.split())
    assert max(map(len, out.splitlines())) <= 100
    table = pd.read_csv("out/motions.csv").set_index("motion")
    errors = [f"acts after [s] at {error:g} %" for error in (0, 2, 5, 10)]
    assert table[errors].notna().all(axis=None)
    # the plan has no limits: no time is the shortest
    assert table["duration [s]"].tolist() == [plan.task.duration] * 2


def test_tables_without_a_band_fit_into_100_columns(done, plan, cycloid):
    plan.save("ours.json")
    cycloid.save("plain.json")
    out = done("compare ours.json plain.json --baselines zv --error frequency=8% --samples 50")
    assert max(map(len, out.splitlines())) <= 100


REFUSED_BANDS = {
    "--band 0": "band is 0 m; give a positive number",
    "--band 0.1mm --samples 9": "--samples is for residuals, which a band leaves out",
    "--margin 2": "--margin is of a --band, and none is given",
    "--band 1mm --durations own": "the move has no limits, so that no time is the shortest",
    "--durations now": "unknown durations 'now'; did you mean 'own'?",
}


@pytest.mark.parametrize(("options", "why"), REFUSED_BANDS.items(), ids=REFUSED_BANDS)
def test_a_band_that_has_no_meaning_is_refused(refused, folder, plan, options, why):
    plan.save("ours.json")
    assert why in refused(f"compare ours.json {options}")


def test_a_folder_without_fronts_is_refused(refused, folder):
    (folder / "empty").mkdir()
    assert "empty holds no fronts; give a folder of a bench, or files" in refused("compare empty")


@pytest.mark.parametrize("figure", ["residual", "energy"])
def test_a_plan_is_a_claim(refused, folder, cycloid, figure):
    cycloid.save("plan.json")
    edit("plan.json", f"stated/{figure}", lambda stated: 1.01 * stated)
    assert f"plan.json states {figure}" in refused("compare plan.json")
