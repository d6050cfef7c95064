"""Blends: straight between waypoints, round where the tip is within a radius of one."""

from itertools import pairwise

import numpy as np
import pytest
from small_robots import ARM

import quietarm as qa

BEAM = {"length": 0.5, "bending_stiffness": 30.0, "mass_per_length": 0.2, "tip_mass": 0.3}
POINTS = np.array([[0.0, 0.1], [0.5, 0.3], [0.2, 0.9], [0.8, 1.2]])


@pytest.fixture(scope="module")
def robot():
    return qa.Robot(urdf=ARM, joints=("a", "b"), held={"grip": 0.02}, beam=qa.Beam("tool", **BEAM))


def tip(positions):
    """By the links, 0.4 m and 0.3 m, and the beam beyond them, in the plane [m]."""
    a, b = np.asarray(positions).T
    return 0.4 * np.exp(1j * a) + 0.8 * np.exp(1j * (a + b))


def off_lines(positions):
    """Return how far positions are from the nearest of the lines."""
    ways = np.diff(POINTS, axis=0)
    rel = positions[:, None] - POINTS[:-1]
    share = np.clip((rel * ways).sum(axis=2) / (ways**2).sum(axis=1), 0, 1)
    return np.linalg.norm(rel - share[..., None] * ways, axis=2).min(axis=1)


@pytest.mark.parametrize("radius", [0.02, 0.1, [0.05, 0.01]])
def test_the_tip_leaves_the_lines_only_within_the_radius_of_a_waypoint(robot, radius):
    path = qa.GeometricPath.blended(robot, POINTS, radius)
    positions = path(np.linspace(0.0, 1.0, 4001))
    near = np.abs(tip(positions)[:, None] - tip(POINTS[1:-1])) <= np.array(radius) * (1 + 1e-6)
    off = off_lines(positions)
    assert off[~near.any(axis=1)].max() < 1e-9
    assert off.max() > 1e-4  # there it does
    assert path(0.0) == pytest.approx(POINTS[0], abs=1e-12)
    assert path(1.0) == pytest.approx(POINTS[-1], abs=1e-12)
    nearest = np.abs(tip(positions)[:, None] - tip(POINTS[1:-1])).min(axis=0)
    assert np.all(nearest < radius)
    shown = [float(words.split(" mm, ")[0].split()[-1]) for words in path.remarks]
    assert shown == pytest.approx(1e3 * nearest, rel=0.06)  # two digits


def test_a_radius_beyond_half_of_a_line_ends_there(robot):
    path = qa.GeometricPath.blended(robot, POINTS, 5.0)
    halves = [tip((before + after) / 2) for before, after in pairwise(POINTS)]
    first = [abs(tip(POINTS[1]) - half) for half in halves[:2]]
    within = float(path.remarks[0].split("within ")[1].split()[0])
    assert within <= 1e3 * max(first) * 1.001
    assert within < 5e3


def test_joints_may_stand_in_another_order_and_beside_others(robot):
    columns = np.column_stack([POINTS[:, 1], np.zeros(4), POINTS[:, 0]])
    path = qa.GeometricPath.blended(robot, columns, 0.05, joints=("b", "grip", "a"))
    assert path == qa.GeometricPath.blended(robot, POINTS, 0.05)


@pytest.mark.parametrize(("points", "radius", "words"), [
    (POINTS[:2], 0.05, "a blend is at a waypoint between two others, and there is none"),
    (POINTS, [0.05], "there are 1 radii and 2 waypoints between the first and the last"),
    (POINTS, 0.0, "radius of a blend is 0"),
    (POINTS[[0, 1, 0]], 0.05, "turns back at waypoint 2"),
    (POINTS[:, :1], 0.05, "the robot drives a, b; give a position of each"),
])  # fmt: skip
def test_what_is_no_blend_is_refused(robot, points, radius, words):
    with pytest.raises(ValueError, match=words):
        qa.GeometricPath.blended(robot, points, radius)
