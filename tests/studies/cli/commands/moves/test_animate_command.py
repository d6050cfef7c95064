"""`quietarm animate`: what it writes and says, what it refuses, Ctrl-C."""

import math

import pytest
from PIL import Image
from quietarm.ocp import PointToPoint, evaluate_coefficients

SMALL = "--width 240 --frames-per-second 4 --quiet"


@pytest.fixture(autouse=True)
def plans(folder, plan, cycloid, two_links):
    """The files of three plans, of two plants and durations."""
    plan.save("plan.json")
    cycloid.save("cycloid.json")
    evaluate_coefficients(PointToPoint(two_links, math.pi / 2, 0.9), []).save("links.json")


def test_plans_of_different_plants_and_durations_share_a_picture(call, folder):
    code, out, err = call(f"animate plan.json links.json --output move.gif {SMALL}")
    assert (code, err) == (0, "")
    with Image.open("move.gif") as image:
        # in 1.9 s, 7 after the first
        assert (image.n_frames, image.width) == (8, 240)
    kilobytes = (folder / "move.gif").stat().st_size / 1e3
    assert out == f"8 frames, 2.5 s, {kilobytes:.0f} kB\nwrote move.gif\n"


def test_ctrl_c_leaves_nothing_behind(at_a_terminal, ctrl_c, folder):
    before = set(folder.iterdir())
    line = "animate plan.json --output m.gif --width 2000 --frames-per-second 50 --speed 20%"
    process = at_a_terminal(line)
    assert "of 451 frames" in process.stderr.readline()
    _, err = ctrl_c(process)
    assert process.returncode == 1
    assert err.endswith("quietarm: interrupted; what was written until then is kept\n")
    assert set(folder.iterdir()) == before
