"""A film is a file that opens, with frames that differ as the structures do."""

import math

import numpy as np
import pytest
from matplotlib.text import Text
from PIL import Image
from saved_figures import saved_figures

from quietarm.models import ArmOnFlexibleLink, LinearAxis
from quietarm.ocp import PointToPoint, energy_floor, evaluate_coefficients
from quietarm.views import animate
from quietarm.views.pictures import Line
from quietarm.views.pictures.structure import structures_of

SMALL = "--width 240 --rate 4 --quiet"


@pytest.mark.slow
def test_frames_differ_while_the_structure_moves_and_where_it_does(plan, cycloid, tmp_path):
    film = animate([Line(cycloid, "plain cycloid"), Line(plan, "plan")], width=240, rate=10)
    film.save(tmp_path / "film.gif")
    with Image.open(tmp_path / "film.gif") as image:
        # 0.8 s and two periods of 10.43 rad/s after it, 10 frames a second, the first one
        assert (image.n_frames, image.width, film.frames) == (21, 240, 21)
        assert (image.info["loop"], image.info["duration"]) == (0, 100)  # for ever, [ms]
        frames = []
        for number in range(image.n_frames):
            image.seek(number)
            frames.append(np.asarray(image.convert("RGB")).astype(int))
    frames = np.array(frames)
    top = frames[:, : frames.shape[1] * 6 // 10]
    left, right = np.split(top[:, 15:], 2, axis=2)  # below the clock
    changes = np.abs(np.diff(left, axis=0)).sum(axis=(1, 2, 3))
    assert (changes > 0).all()  # the plain cycloid rings to the end
    still = np.abs(np.diff(right, axis=0)).sum(axis=(1, 2, 3))
    assert (still[:6] > 0).all()
    # the plan has arrived: only the dot of its path gets darker
    assert still[9:].max() < changes[9:].min() / 10
    cursor = np.abs(np.diff(frames[:, frames.shape[1] * 7 // 10 :], axis=0)).sum(axis=(1, 2, 3))
    assert (cursor > 0).all()


def test_tips_are_drawn_at_the_joint_angle_and_the_displacement_of_the_plan(plan, cycloid):
    lines, times = [Line(cycloid, "plain cycloid"), Line(plan, "plan")], np.arange(19) / 10
    for scale in (1.0, 4.0):
        for structure in structures_of(lines, times, 1.8, scale):
            exact = structure.line.plan.sampled(times)
            angle = exact.joint[:, 0]
            radial = np.column_stack([np.cos(angle), np.sin(angle)])
            across = np.column_stack([-np.sin(angle), np.cos(angle)])
            expected = 0.475 * radial + scale * exact.tips * across  # section 3.1: 475 mm
            # between samples 1.2 ms apart the tip's motion is taken for straight
            assert structure.paths[0] == pytest.approx(expected, abs=scale * 2e-6)


def test_small_deflections_are_drawn_larger_and_those_of_one_plant_alike(plan, cycloid):
    arm = evaluate_coefficients(PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8), [])
    lines = [Line(cycloid, "a"), Line(plan, "b"), Line(arm, "c")]
    single, same, other = structures_of(lines, np.arange(37) / 20, 1.8)
    # docs/physics.md: 77 mm of the plate's 475 mm would be above a fifth at twice its size; the
    # arm's 15 mm of a drawing of 550 mm are not at five times
    assert (single.scale, same.scale, other.scale) == (1, 1, 5)
    assert np.abs(other.tips).max() * 5 <= 0.2 * 0.55 < np.abs(other.tips).max() * 10


def test_a_film_of_a_slow_swing_has_the_whole_move_and_ends_where_it_has_too_many_frames():
    # 16 s and two periods of 10 s are 900 frames at 25 a second, where 500 are the most
    crane = PointToPoint(LinearAxis(omega1=0.2 * math.pi), 8.0, 16.0)
    line = Line(evaluate_coefficients(crane, []), "crane")
    film = animate([line], rate=25)
    assert (film.frames, film.end) == (501, pytest.approx(20.0))
    with pytest.raises(ValueError, match="make 1800 frames, where 500 are the most"):
        animate([line], rate=50)
    whole = animate([line], rate=10)
    assert (whole.frames, whole.end) == (361, pytest.approx(36.0))


@pytest.mark.slow
def test_moves_of_different_durations_share_a_clock(plan, task):
    longer = evaluate_coefficients(PointToPoint(ArmOnFlexibleLink(), 0.5, 1.4), [])
    floor = energy_floor(task, starts=1, energy_tolerance=0.5)
    times = np.arange(25) / 10  # 1.4 s and its residual window
    lines = [Line(plan, "short"), Line(longer, "long"), Line(floor, "floor")]
    structures = structures_of(lines, times, 2.4)
    for structure in structures:
        assert structure.trajectory.time[-1] == pytest.approx(2.4)
    first, _, third = structures
    assert first.tips == pytest.approx(plan.sampled(times).tips, abs=2e-6)
    still = floor.trajectory  # up to 1.8 s
    expected = np.interp(times[:19], still.time, still.tips[:, 0])
    assert third.tips[:19, 0] == pytest.approx(expected, abs=2e-6)


@pytest.mark.slow
def test_plans_of_different_plants_and_durations_become_a_gif(done, folder, plan, two_links):
    plan.save("plan.json")
    evaluate_coefficients(PointToPoint(two_links, math.pi / 2, 0.9), []).save("links.json")
    out = done(f"export plan.json links.json --output move.gif {SMALL}")
    with Image.open("move.gif") as image:  # in 0.9 s and two periods of the slower link, 1.18 s
        assert (image.n_frames, image.width) == (9, 240)
    kilobytes = (folder / "move.gif").stat().st_size / 1e3
    assert out == f"wrote move.gif\n9 frames, 2.2 s, {kilobytes:.0f} kB\n"


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("count", [1, 2, 3, 6])
def test_letters_are_read_on_a_phone_and_panels_say_what_they_show(plan, cycloid, count, tmp_path):
    lines = [Line(plan, "plan"), *[Line(cycloid, "plain cycloid")] * (count - 1)]
    with saved_figures() as figures:
        animate(lines, rate=1.0, width=390).save(tmp_path / "film.gif")
    figure = figures[-1]
    with Image.open(tmp_path / "film.gif") as film:
        assert film.width == 390
    texts = [text for text in figure.findobj(Text) if text.get_text() and text.get_visible()]
    assert min(text.get_fontsize() * figure.dpi / 72 for text in texts) >= 9
    titles = [ax.get_title(loc="left") for ax in figure.axes]
    assert titles[0].endswith("residual: at rest")
    named = [ax for ax in figure.axes if ax.axison]
    assert len(named) == count + 2  # and the tip displacement and the power over time
    assert all(ax.get_xlabel().split("]")[0][-1] in "ms" for ax in named)
    units = [ax.get_ylabel() or title for ax, title in zip(figure.axes, titles) if ax.axison]
    assert [words.split("[")[1] for words in units] == [*["m]"] * count, "mm]", "W]"]
    (legend,) = figure.legends  # no line without one
    named = [text.get_text() for text in legend.get_texts()]
    lines = ["plan", "plain cycloid"][: max(1, min(count, 2))]
    assert named == [*lines, "without bending", "way of the tip after arrival"]


def test_without_ffmpeg_it_is_asked_for(plan, monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", "")
    with pytest.raises(ValueError, match="needs the program ffmpeg, which is not found here"):
        animate([Line(plan, "plan")]).save(tmp_path / "m.mp4")


@pytest.mark.parametrize(
    ("motions", "width", "why"),
    [
        (1, -5, "width is -5; give a whole number from 200 up"),
        (1, 5, "width is 5; give a whole number from 200 up"),
        (1, 9999, "width is 9999; give at most 2000"),
        (7, 240, "number of motions is 7; give at most 6"),
    ],
)
def test_a_film_that_could_not_be_seen_is_refused(plan, motions, width, why):
    with pytest.raises(ValueError, match=why):
        animate([Line(plan, "plan")] * motions, width=width)
