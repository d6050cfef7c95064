"""Narrow terminals, degrees without their unit, and words that are not Python's own."""

import pytest
from lines import MOVE
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import Plan


@pytest.mark.parametrize("columns", ["1", "20", "45", "80", "0", "-5", "many"])
def test_no_word_is_cut_on_a_terminal_of_any_width(call, monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", columns)
    code, out, _ = call(f"evaluate {MOVE} --coefficients=0.003347,-0.1697 --output o.json")
    assert code == 0
    assert "\u2026" not in out
    figures = Plan.load("o.json").motion
    for word in ("coefficients", "acceleration", "deflection", "verified", "optimised"):
        assert word in out
    assert f"{figures.peak_torque:.4g}" in out


def test_tables_of_fronts_are_whole_on_a_narrow_terminal(call, monkeypatch):
    monkeypatch.setenv("COLUMNS", "20")
    line = f"front {MOVE} --terms 2 --bound 0.3 --points 3 --quiet --method"
    assert call(f"{line} epsilon --output a.json")[0] == 0
    assert call(f"{line} weighted --output b.json")[0] == 0
    code, out, _ = call("compare a.json b.json --no-floor")
    assert code == 0
    assert "\u2026" not in out
    assert "  method: epsilon constraint\n" in out
    assert "hypervolume (more is better): 0." in out


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("single-link --target 30 --duration 0.8", "target 30 is in radians, 1718.87 degrees"),
        ("single-link --start=-90 --target 0.5 --duration 1", "start -90 is in radians, -5156.62"),
    ],
)
@pytest.mark.parametrize("command", ["plan", "evaluate --coefficients=0", "floor", "study"])
def test_degrees_without_their_unit_are_asked_for(call, folder, command, line, words):
    code, out, err = call(f"{command} {line}")
    assert (code, out, err.count("\n")) == (2, "", 1)
    number = line.replace("=", " ").split()[2]
    assert words in err
    assert f"were degrees meant? give {number}deg, or {number}rad" in err
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize("target", ["30rad", "720deg", "4pi", "6.2"])
def test_a_move_of_several_turns_may_be_meant(call, target):
    code, _, err = call(f"evaluate single-link --target {target} --duration 8 --coefficients=0")
    assert (code, err) == (0, "")


def test_a_short_move_far_from_zero_is_not_asked_about(call):
    line = "evaluate single-link --start 30 --target 31 --duration 1 --coefficients=0"
    assert call(line)[0] == 0


def test_a_motion_beyond_small_deflections_is_warned_of(call):
    # docs/physics.md: the plain cycloid leaves 77 mm, the paper's two terms stay below 42 mm;
    # the plate is 475 mm long
    assert SingleLinkManipulator.small_deflection == pytest.approx(0.0475)
    _, out, _ = call(f"evaluate {MOVE} --coefficients=0")
    assert "warning: beyond 47.5 mm" in out
    _, out, _ = call(f"evaluate {MOVE} --coefficients=0.003347,-0.1697")
    assert "warning" not in out


def test_one_is_one(call, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    line = f"front {MOVE} --method weighted --terms 1 --bound 1e-15 --points 2 --quiet"
    code, out, _ = call(line)
    assert code == 0
    assert "weighted: 1 point, " in out
