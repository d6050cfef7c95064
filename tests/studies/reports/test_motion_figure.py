"""The paper's four panels, and pictures that are saved whole or not at all."""

import dataclasses
import os
import xml.etree.ElementTree as ElementTree

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.colors import to_rgba

from ocp import PointToPoint, evaluate_coefficients
from studies.display.picture_names import SUFFIXES, check_figure
from studies.display.pictures import save_figure
from studies.reports.motion_figure import Line, four_panels

TITLES = [  # the order of the paper's Figs 2 and 5
    "(a) joint angle [rad]",
    "(b) angular velocity [rad/s]",
    "(c) tip displacement [mm]",
    "(d) motor torque [N m]",
]
HEADS = {".png": b"\x89PNG\r\n\x1a\n", ".pdf": b"%PDF-", ".svg": b"<?xml"}
TAILS = {".png": b"IEND\xaeB`\x82", ".pdf": b"%%EOF\n", ".svg": b"</svg>\n"}


@pytest.fixture
def figure(plan):
    return four_panels(plan, "A title")


def motions(axis):
    """The drawn motions of a panel, without its arrival mark."""
    return [line for line in axis.get_lines() if len(line.get_xdata()) > 2]


def test_four_panels_name_their_quantity_with_its_unit(figure):
    assert [axis.get_title(loc="left") for axis in figure.axes] == TITLES
    assert figure.get_suptitle() == "A title"


def test_time_stands_under_the_lower_panels_with_its_unit(figure):
    assert all(axis.get_xlabel().startswith("time [s]") for axis in figure.axes[2:])


def test_a_plan_alone_is_drawn_over_the_plain_cycloid_of_its_task(figure, plan, cycloid):
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["plain cycloid", "this plan"]
    for axis in figure.axes:
        assert [line.get_label() for line in motions(axis)] == ["plain cycloid", "this plan"]
    tips = [line.get_ydata() for line in motions(figure.axes[2])]
    times = motions(figure.axes[2])[0].get_xdata()
    after = times >= plan.task.duration
    # In millimetres; 2.28 * 33.82 mm is the ringing in docs/physics.md's table.
    assert np.abs(tips[0][after]).max() == pytest.approx(2.28 * 33.82, rel=1e-3)
    assert np.abs(tips[1][after]).max() < 1e-3
    assert cycloid.residual == pytest.approx(np.abs(tips[0][after]).max() * 1e-3, rel=1e-3)


def test_panels_hold_what_they_name(figure, plan):
    drawn = [motions(axis)[1] for axis in figure.axes]
    times = np.asarray(drawn[0].get_xdata())
    on_the_way = times <= plan.task.duration
    angle, speed, tip, torque = (np.asarray(line.get_ydata()) for line in drawn)
    path = plan.path
    np.testing.assert_allclose(angle[on_the_way], path(times[on_the_way]), atol=1e-9)
    np.testing.assert_allclose(speed[on_the_way], path(times[on_the_way], 1), atol=1e-9)
    assert np.abs(tip[on_the_way]).max() == pytest.approx(
        plan.motion.peak_deflection * 1e3, rel=1e-3
    )
    assert np.abs(torque[on_the_way]).max() == pytest.approx(plan.motion.peak_torque, rel=1e-3)


@pytest.mark.parametrize("window", [0.3, 1.0])
def test_time_goes_on_through_the_residual_window(task, window):
    move = dataclasses.replace(task, residual_window=window)
    figure = four_panels(evaluate_coefficients(move, []))
    for axis in figure.axes:
        for line in motions(axis):
            assert line.get_xdata()[0] == 0.0
            assert line.get_xdata()[-1] == pytest.approx(move.duration + window)
            assert move.duration in line.get_xdata()
        assert axis.get_xlim() == pytest.approx((0.0, move.duration + window))
    angle, speed = (motions(axis)[0] for axis in figure.axes[:2])
    after = np.asarray(angle.get_xdata()) > move.duration
    assert set(np.asarray(angle.get_ydata())[after]) == {move.target}
    assert set(np.asarray(speed.get_ydata())[after]) == {0.0}


def test_every_panel_marks_the_arrival(figure, plan):
    for axis in figure.axes:
        (mark,) = [line for line in axis.get_lines() if len(line.get_xdata()) == 2]
        assert list(mark.get_xdata()) == [plan.task.duration] * 2
        assert mark.get_linestyle() == "--"


def test_lines_keep_their_label_colour_and_style(plan, cycloid):
    figure = four_panels([Line(cycloid, "first", "black"), Line(plan, "second", "tab:red", "--")])
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["first", "second"]
    for axis in figure.axes:
        first, second = motions(axis)
        assert (to_rgba(first.get_color()), first.get_linestyle()) == (to_rgba("black"), "-")
        assert (to_rgba(second.get_color()), second.get_linestyle()) == (to_rgba("tab:red"), "--")


def test_every_tip_of_a_plant_with_two_is_drawn_and_named(two_links):
    figure = four_panels(evaluate_coefficients(PointToPoint(two_links, 1.5, 0.9), []))
    names = [f"{who}, tip {i}" for who in ("plain cycloid", "this plan") for i in (1, 2)]
    assert [line.get_label() for line in motions(figure.axes[2])] == names
    assert [text.get_text() for text in figure.legends[0].get_texts()] == names
    assert [len(motions(axis)) for axis in figure.axes] == [2, 2, 4, 2]


def test_no_picture_is_left_to_pyplot(figure):
    # pyplot would keep every figure alive, and open a window.
    assert plt.get_fignums() == []
    assert len(figure.axes) == 4


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_pictures_are_saved_whole(figure, tmp_path, suffix):
    path = tmp_path / f"move{suffix}"
    save_figure(figure, path)
    content = path.read_bytes()
    assert content.startswith(HEADS[suffix])
    assert content.endswith(TAILS[suffix])
    assert list(tmp_path.iterdir()) == [path]


def test_the_ending_may_be_in_capitals(figure, tmp_path):
    save_figure(figure, tmp_path / "MOVE.PNG")
    assert (tmp_path / "MOVE.PNG").read_bytes().startswith(HEADS[".png"])


def test_svg_text_is_well_formed(figure, tmp_path):
    save_figure(figure, tmp_path / "move.svg")
    root = ElementTree.parse(tmp_path / "move.svg").getroot()
    assert root.tag == "{http://www.w3.org/2000/svg}svg"


def test_a_picture_takes_the_place_of_an_older_one(figure, tmp_path):
    path = tmp_path / "move.png"
    path.write_text("old")
    save_figure(figure, str(path))
    assert path.read_bytes().startswith(HEADS[".png"])


@pytest.mark.parametrize("name", ["move.txt", "move.jpg", "move", "move.png.bak", "png"])
def test_other_endings_are_refused_and_the_endings_named(figure, tmp_path, name):
    with pytest.raises(ValueError, match=r"is no picture; .* \.png, \.pdf, \.svg") as refused:
        save_figure(figure, tmp_path / name)
    assert str(tmp_path / name) in str(refused.value)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_not_there_is_refused(figure, tmp_path):
    path = tmp_path / "nowhere" / "move.png"
    with pytest.raises(ValueError, match="does not exist") as refused:
        save_figure(figure, path)
    assert str(path.parent) in str(refused.value)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_is_no_picture(tmp_path):
    (tmp_path / "a.png").mkdir()
    with pytest.raises(ValueError, match="is a folder"):
        check_figure(tmp_path / "a.png")


def test_check_gives_the_path_back_and_writes_nothing(tmp_path):
    assert check_figure(str(tmp_path / "move.pdf")) == tmp_path / "move.pdf"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("there", [True, False])
@pytest.mark.parametrize("where", ["drawing", "writing"])
def test_nothing_is_half_written_when_it_fails(figure, tmp_path, monkeypatch, there, where):
    path = tmp_path / "move.png"
    if there:
        path.write_text("old")

    def fail(*arguments, **settings):
        raise OSError(28, "No space left on device")

    def half(content, **settings):
        content.write(HEADS[".png"])
        fail()

    if where == "drawing":
        monkeypatch.setattr(figure, "savefig", half)
    else:
        monkeypatch.setattr(os, "replace", fail)
    with pytest.raises((OSError, ValueError), match=r"(?i)no space left on device"):
        save_figure(figure, path)
    assert [entry.name for entry in tmp_path.iterdir()] == (["move.png"] if there else [])
    if there:
        assert path.read_text() == "old"
