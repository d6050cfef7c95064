"""An animation is a file that opens, with frames that differ as the structures do."""

import io
import math

import numpy as np
import pytest
from PIL import Image
from quietarm.models import ArmOnFlexibleLink
from quietarm.ocp import PointToPoint, energy_floor, evaluate_coefficients
from quietarm.studies.animation import animate
from quietarm.studies.animation.cast import cast_of
from quietarm.studies.figures import Line


def opened(content):
    """Every frame of a GIF as red, green and blue, and for how long it stays [ms]."""
    image, frames, holds = Image.open(io.BytesIO(content)), [], []
    for number in range(image.n_frames):
        image.seek(number)
        frames.append(np.asarray(image.convert("RGB")).astype(int))
        holds.append(image.info["duration"])
    return np.array(frames), holds


def test_the_gif_opens_and_takes_its_time(film):
    frames, holds = opened(film.content)
    # 0.8 s and a second after it, 10 frames a second, the first one; that one stays 0.5 s more
    assert len(frames) == film.frames == 19
    assert frames.shape[2] == 240
    assert holds == [600, *[100] * 18]
    assert film.seconds == pytest.approx(sum(holds) / 1e3)
    assert Image.open(io.BytesIO(film.content)).info["loop"] == 0  # for ever


def test_frames_differ_while_the_structure_moves_and_where_it_does(film):
    frames, _ = opened(film.content)
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
        for actor in cast_of(lines, times, 1.8, scale):
            exact = actor.line.plan.sampled(times)
            angle = exact.joint[:, 0]
            radial = np.column_stack([np.cos(angle), np.sin(angle)])
            across = np.column_stack([-np.sin(angle), np.cos(angle)])
            expected = 0.475 * radial + scale * exact.tips * across  # section 3.1: 475 mm
            # between samples 1.2 ms apart the tip's motion is taken for straight
            assert actor.paths[0] == pytest.approx(expected, abs=scale * 2e-6)


def test_small_deflections_are_drawn_larger_and_those_of_one_plant_alike(plan, cycloid):
    arm = evaluate_coefficients(PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8), [])
    lines = [Line(cycloid, "a"), Line(plan, "b"), Line(arm, "c")]
    single, same, other = cast_of(lines, np.arange(37) / 20, 1.8)
    # docs/physics.md: 77 mm of the plate's 475 mm would be above a fifth at twice its size; the
    # arm's 15 mm of a drawing of 550 mm are not at five times
    assert (single.scale, same.scale, other.scale) == (1, 1, 5)
    assert np.abs(other.tips).max() * 5 <= 0.2 * 0.55 < np.abs(other.tips).max() * 10


def test_moves_of_different_durations_share_a_clock(plan, task):
    longer = evaluate_coefficients(PointToPoint(ArmOnFlexibleLink(), 0.5, 1.4), [])
    floor = energy_floor(task, starts=1, tolerance=0.5)
    times = np.arange(25) / 10  # 1.4 s and its residual window
    lines = [Line(plan, "short"), Line(longer, "long"), Line(floor, "floor")]
    first, second, third = cast_of(lines, times, 2.4)
    for actor in (first, second, third):
        assert actor.trajectory.time[-1] == pytest.approx(2.4)
    assert first.tips == pytest.approx(plan.sampled(times).tips, abs=2e-6)
    still = floor.trajectory  # up to 1.8 s
    expected = np.interp(times[:19], still.time, still.tips[:, 0])
    assert third.tips[:19, 0] == pytest.approx(expected, abs=2e-6)


# -- MP4 --


def test_without_ffmpeg_it_is_asked_for(plan, monkeypatch):
    monkeypatch.setenv("PATH", "")
    with pytest.raises(ValueError, match="needs the program ffmpeg, which is not found here"):
        animate([Line(plan, "plan")], format="mp4")
