"""`quietarm front --over duration`."""

import csv

import pytest

LINE = "front single-link --target 30deg --over duration --quiet"


def test_a_longer_move_costs_less_and_too_short_a_one_has_no_plan(call, folder):
    code, out, err = call(
        f"{LINE} --duration 400ms:1.2s --points 3 --acceleration-limit 40 --csv times.csv "
        "--figure times.png"
    )
    assert (code, err) == (0, "")
    assert "0.4 s: found no motion" in out
    assert (folder / "times.png").read_bytes().startswith(b"\x89PNG")
    none, short, long = csv.DictReader((folder / "times.csv").read_text().splitlines())
    assert (none["duration_s"], none["plan_J"], none["plan_mm"]) == ("0.4", "", "")
    # the README's plan of 0.8 s; its floor is below it
    assert float(short["plan_J"]) == pytest.approx(0.0252178, rel=1e-3)
    assert float(long["plan_J"]) < float(short["plan_J"]) < float(short["cycloid_J"])
    assert 0.7 < float(short["floor_J"]) / float(short["plan_J"]) < 1
    assert float(short["plan_mm"]) < 1e-3 < float(short["cycloid_mm"])
