"""A made-up figure stands in whatever every command prints, draws and writes."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from pages import shown_file

import quietarm as qa
from quietarm.models import load_plant_file
from quietarm.ocp import (
    FileFormatError,
    JudgedMotion,
    evaluate_coefficients,
    remove_figure,
    remove_quantity,
)
from quietarm.studies.cli.application import COMMANDS
from quietarm.studies.sweep.store import Store
from quietarm.views.explore.by_hand import open_plant
from quietarm.views.explore.live_page import LivePage

zarr = pytest.importorskip("zarr")
pytestmark = pytest.mark.usefixtures("what_is_made_up_is_forgotten")

MOVE = "single-link --plant-file mine.py --target 30deg --duration 0.8 --quiet"
BENCH = "bench single-link-30deg-0.8s-2-terms --plant-file mine.py --quiet --runs 2"
WITHOUT_MOTIONS = {"list", "identify", "learn", "reproduce"}
"""Commands that show no motion of a user's task: names, recordings, the paper's own figures."""
LABEL = "RMS torque"
FIRST = [
    f"plan {MOVE} --terms 4 --output plan.json --output plan.png --output plan.html",
    f"evaluate {MOVE} --profile zv --output zv.json --output zv.png",
    f"front {MOVE} --terms 3 --bound 0.3 --points 4 --output front.json --output front.csv "
    "--output front.png",
    f"search {MOVE} --terms 2 --bound 0.2 --population 40 --generations 40 --runs 2 "
    "--output found.json --output found.csv --output found.png",
    "front --polish found-seed1.json --plant-file mine.py --output polished.json --quiet",
    "sweep single-link --plant-file mine.py --target 20deg,30deg --duration 0.8 --terms 4 --quiet "
    "--output moves.zarr --output moves.png",
    "plan --from moves.zarr --plant-file mine.py --target 25deg --quiet",
    "export plan.json --plant-file mine.py --output move.c --quiet",
    "export front.json plan.json --plant-file mine.py --output page.html --quiet",
    "compare plan.json zv.json --plant-file mine.py --samples 5 --output plans --quiet",
    "compare front.json found-seed0.json found-seed1.json --plant-file mine.py --no-free-motion "
    "--output fronts --quiet",
    f"{BENCH} --methods nsga2,random --evaluations 200 --output bench",
]
PRINTED = ("plan", "evaluate", "front", "search", "sweep", "compare")


@pytest.fixture
def own(folder):
    """The file of the figure in docs/extend.md."""
    Path("mine.py").write_text(shown_file("extend", "rms_torque.py"))


@pytest.fixture
def captions(monkeypatch, quick_pictures):
    """Return what stands above each picture that is saved."""
    said = []
    whole = Figure.savefig

    def note(figure, *given, **settings):
        said.append(" ".join(figure.get_suptitle().split()))
        return whole(figure, *given, **settings)

    monkeypatch.setattr(Figure, "savefig", note)
    return said


def test_every_command_is_either_walked_or_shows_no_motion():
    walked = {line.split()[0] for line in FIRST} | {"explore"}
    assert walked | WITHOUT_MOTIONS == {*COMMANDS}


@pytest.mark.slow
def test_every_command_knows_it(own, done, captions):
    for line in FIRST:
        captions.clear()
        printed = done(line)
        if line.startswith(PRINTED):
            assert LABEL in printed, line
        pictures = line.count(".png") + line.startswith("compare")
        assert sum(LABEL in caption for caption in captions) >= pictures, line
    for name in ("plan.html", "page.html", "move.h", "plans/report.md", "fronts/report.md"):
        assert LABEL in Path(name).read_text(), name
    plan = qa.Plan.load("plan.json")
    assert json.loads(Path("plan.json").read_text())["stated"]["rms_torque"] == pytest.approx(
        plan.figures["rms_torque"]
    )
    for answer in (plan, qa.Front.load("front.json")):
        assert LABEL in answer._repr_html_()
    for name in ("front.csv", "found-seed0.csv"):
        assert "rms_torque_Nm" in pd.read_csv(name)
    assert f"{LABEL} [N m]" in pd.read_csv("plans/motions.csv")
    assert f"{LABEL} [N m] within 1 mm" in pd.read_csv("fronts/methods.csv")
    assert "rms_torque_Nm_at_1mm" in pd.read_csv("fronts/runs.csv")
    assert "rms_torque_Nm_5mm" in pd.read_csv("bench/runs.csv")


def test_a_sweep_holds_it_for_every_cell(own, done, refused):
    line = "sweep single-link --target 20deg,30deg --duration 0.8 --terms 2 --quiet"
    with Path("mine.py").open("a") as file:  # and the peak of a quantity, which nothing limits
        file.write(shown_file("extend", "tip_acceleration.py"))
    printed = done(f"{line} --plant-file mine.py --output moves.zarr")
    store = Store(Path("moves.zarr"))
    values = store.read("rms_torque")
    grid = store.definition
    for task, row, value in zip(
        grid.grid.tasks((slice(0, 2),)), store.read("coefficients"), values
    ):
        motion = JudgedMotion.of_profile(task, grid.profile, row)
        assert value == pytest.approx(motion.figures["rms_torque"], rel=1e-9)
        assert f"{value:.4g}" in printed
    assert store.dataset["rms_torque"].attrs["units"] == "N m"
    # who does not know the figure reads the rest, and goes on with no sweep that has it
    remove_figure("rms_torque")
    remove_quantity("tip_acceleration")
    without = Store(Path("moves.zarr"))
    without.check()
    assert np.isfinite(without.read("energy")).all()
    assert "it differs in peak_tip_acceleration, rms_torque" in refused(
        f"{line} --output moves.zarr"
    )
    # of which variables the digests are is no more believed than the rest
    zarr.open_group("moves.zarr", mode="r+")["digest"].attrs["variables"] = ["energy", {}]
    with pytest.raises(FileFormatError, match="its digests are of"):
        Store(Path("moves.zarr"))


def test_a_figure_of_the_name_of_a_variable_is_refused(own, refused):
    text = Path("mine.py").read_text().replace('"rms_torque", EFF', '"iterations", EFF')
    Path("mine.py").write_text(text)
    line = f"sweep {MOVE.replace('30deg', '20deg,30deg')} --terms 2 --output moves.zarr"
    assert "iterations is a variable of a dataset already" in refused(line)


def test_the_page_alive_has_it(own):
    load_plant_file("mine.py")
    page = LivePage(open_plant(qa.SingleLinkManipulator()))
    answer = page.answer("motion", b"{}", lambda done, total: None)
    rows = dict(page.answer("rows", b"{}", lambda done, total: None)["rows"])
    plan = evaluate_coefficients(qa.PointToPoint(qa.SingleLinkManipulator(), qa.deg(30), 0.8), [])
    value = f"{plan.figures['rms_torque']:.4g}"
    assert value in json.dumps(answer)
    assert rows[LABEL] == f"{value} N m"
