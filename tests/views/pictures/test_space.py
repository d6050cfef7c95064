"""The view of structures in space: perspective, and capsules."""

import numpy as np
import pytest

from quietarm.views.pictures.space import Camera, Room, capsules

ROOM = Room(middle=np.array([0.3, -0.2, 0.5]), reach=1.0, half=0.75, seen_from=0.4)


def test_near_is_larger_and_the_middle_stays():
    camera = Camera(ROOM, azimuth=0.4, elevation=0.3)
    towards = np.array([np.cos(0.3) * np.cos(0.4), np.cos(0.3) * np.sin(0.4), np.sin(0.3)])
    points = ROOM.middle + np.outer([0.0, 1.0, -1.0], towards)
    seen = camera.seen(points)
    # by similar triangles: 4 hypot(1, 0.75) = 5 m away, 1 m nearer and 1 m farther
    assert seen == pytest.approx(np.array([[0, 0, 1], [0, 0, 5 / 4], [0, 0, 5 / 6]]), abs=1e-12)


def test_up_is_up_and_right_is_right():
    seen = Camera(ROOM, azimuth=0.0, elevation=0.0).seen(ROOM.middle + np.eye(3))
    assert seen[1] == pytest.approx([1.0, 0.0, 1.0])  # from +x, y is to the right
    assert seen[2] == pytest.approx([0.0, 1.0, 1.0])


def test_a_capsule_is_around_its_line_by_its_radius():
    line = np.array([[0.0, 0.0, 1.0], [1.0, 0.5, 1.0], [1.4, 0.2, 2.0]])
    first, second = capsules(line, 0.1)
    along = np.array([1.0, 0.5]) / np.hypot(1.0, 0.5)
    across = (first - line[0, :2]) @ [-along[1], along[0]]
    assert (across.min(), across.max()) == pytest.approx((-0.1, 0.1))
    # the nearer end is twice as thick
    assert np.linalg.norm(second - line[2, :2], axis=1).min() == pytest.approx(0.2)
    (ball,) = capsules(line[:1], 0.1)
    assert np.linalg.norm(ball, axis=1) == pytest.approx(np.full(len(ball), 0.1))


@pytest.mark.parametrize(("reach", "words"), [(0.7, "20 cm"), (3.0, "1 m"), (0.15, "5 cm")])
def test_squares_of_the_floor_say_how_large_they_are(reach, words):
    assert Room(ROOM.middle, reach, 0.5, 0.0).square_words == f"squares of {words}"
