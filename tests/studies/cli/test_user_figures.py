"""A quantity and a figure of a user's own beside a plant: those of docs/extend.md, in a file."""

import csv
import json
from pathlib import Path

import pytest
from pages import shown_file

import quietarm as qa
from quietarm.ocp import remove_figure, remove_quantity

PLANT = """
import quietarm as qa


class Mine(qa.SingleLinkManipulator):
    name = "mine"
"""
FILE = "".join(shown_file("extend", name) for name in ("tip_acceleration.py", "rms_torque.py"))
MOVE = "mine --plant-file mine.py --target 30deg --duration 1.2 --quiet"
LIMIT = "--tip-acceleration-limit 2"


@pytest.fixture
def own(folder, request):
    """The file, in the folder of the test; its entries are known in that alone."""
    text = f"{FILE}{PLANT}\n# {request.node.name}: a file of the same content would not run again\n"
    (folder / "mine.py").write_text(text)
    yield
    remove_quantity("tip_acceleration")
    remove_figure("rms_torque")


def heading(path):
    with Path(path).open() as file:
        return next(csv.reader(file))


@pytest.mark.slow
def test_a_file_of_ones_own_makes_options_rows_and_entries(own, done):
    out = done(f"plan {MOVE} {LIMIT} --terms 8 --output plan.json")
    assert "tip acceleration 2 m/s^2" in out
    assert "peak tip acceleration 2 m/s^2" in " ".join(out.split())
    plan = qa.Plan.load("plan.json")
    stated = json.loads(Path("plan.json").read_text())["stated"]
    assert list(stated) == ["residual", "energy", "rms_torque"]
    words = f"{plan.figures['rms_torque']:.4g} N m"
    assert f"RMS torque {words}" in " ".join(out.split())
    done("export plan.json --plant-file mine.py --output move.c")
    assert f"RMS torque {words}" in " ".join(Path("move.h").read_text().split())
    done("export plan.json --plant-file mine.py --output page.html")
    assert '"RMS torque [N m]"' in Path("page.html").read_text()
    done("compare plan.json --plant-file mine.py --baselines zv --output compared")
    columns = ["peak tip acceleration [m/s^2]", "RMS torque [N m]"]
    assert set(columns) <= set(heading("compared/motions.csv"))


def test_a_stated_figure_that_nobody_knows_is_named(own, done, refused):
    done(f"evaluate {MOVE} --coefficients=0.1 --output plan.json")
    remove_figure("rms_torque")
    assert "'rms_torque', which is no figure here; import" in refused("compare plan.json")


def test_fronts_and_searches_have_them(own, done):
    done(f"front {MOVE} {LIMIT} --terms 6 --points 2 --output front.csv")
    assert "rms_torque_Nm" in heading("front.csv")
    out = done(
        f"search {MOVE} --tip-acceleration-limit 9 --terms 2 --bound 0.2 --population 20 "
        "--generations 3 --objectives residual,energy,peak-tip-acceleration --output found.csv"
    )
    assert "peak_tip_acceleration_m_per_s2" in heading("found.csv")
    assert "tip acceleration" in out


@pytest.mark.slow
def test_so_has_the_fastest_move(own, done):
    line = MOVE.replace("--duration 1.2", "--duration fastest")
    assert "tip acceleration 2 m/s^2" in done(f"plan {line} {LIMIT}")


def test_an_option_of_a_file_that_is_not_named_is_none(own, refused):
    remove_quantity("tip_acceleration")
    assert "--tip-acceleration-limit" in refused(f"plan single-link --target 30deg {LIMIT}")
