"""The figure of a robot in space, held against the poses of its links."""

from functools import lru_cache

import numpy as np
import pytest
from small_robots import ARM, GANTRY

import quietarm as qa

BEAM = {
    "at": "tool", "length": 0.5, "width": 0.006, "height": 0.01, "youngs_modulus": 70e9,
    "density": 2700.0, "tip_mass": 0.3, "pieces": 2, "direction": (1.0, 0.0, 0.0),
    "offset": (0.0, 0.05, 0.02),
}  # fmt: skip
PATH = qa.GeometricPath.line([0.2, -0.1], [1.1, 0.6])
HALFWAY = [0.65, 0.25]


@lru_cache
def arm():
    """It hangs from a ceiling; its second gear gives."""
    return qa.Robot(
        urdf=ARM, joints=("a", "b"), held={"grip": 0.02}, beam=qa.Beam(**BEAM),
        elastic_joints={"b": (3e3, 1.0)}, rotor_inertia={"b": 0.3}, gravity=(0.0, 0.0, 9.81),
    )  # fmt: skip


def upright(point):
    """A point that is seen from a floor to which the root link's z axis points."""
    x, y, z = point
    return np.array([x, -y, -z])


@pytest.mark.slow
def test_tip_clamp_and_joints_are_where_the_links_are():
    plant = arm().along(PATH)
    bodies = plant.structure(0.5, [0.0] * plant.tips)
    (beam,) = [body for body in bodies if body.tip]
    end = arm().kinematics("beam end").pose(np.array(HALFWAY))
    hanging = end.origin + end.rotation @ arm().sag(HALFWAY)
    assert beam.points[-1] == pytest.approx(upright(hanging), abs=2e-3)
    assert len(beam.points) > 5
    # the gear gives by its load: hardly
    tool = arm().kinematics("tool").pose(np.array(HALFWAY))
    clamp = tool.origin + tool.rotation @ BEAM["offset"]
    assert beam.points[0] == pytest.approx(upright(clamp), abs=2e-3)
    elbow = arm().kinematics("fore").pose(np.array(HALFWAY)).origin
    links = [body.points for body in bodies if body.rigid and len(body.points) == 2]
    assert any(np.abs(ends - [[0, 0, 0], upright(elbow)]).max() < 1e-3 for ends in links)
    (load,) = [body for body in bodies if len(body.points) == 1 and not body.ground]
    assert load.points[0] == pytest.approx(beam.points[-1])


@pytest.mark.slow
def test_the_tip_moves_by_its_displacement_and_what_gives_is_not_rigid():
    plant = arm().along(PATH)
    displaced = [1e-4 * (k + 1) for k in range(plant.tips)]
    still, moved = (plant.structure(0.5, tips) for tips in ([0.0] * plant.tips, displaced))
    ends = [next(body.points[-1] for body in bodies if body.tip) for bodies in (still, moved)]
    assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(np.linalg.norm(displaced), rel=0.05)
    # the beam and the joint of the gear; the motor's own joint is not drawn beside it
    gives = [body for body in still if not body.rigid and not body.ground]
    assert [len(body.points) for body in gives] == [2, len(gives[1].points)]
    joints = [body for body in still if len(body.points) == 2 and body not in gives]
    assert all(body.radius > 0 for body in (*gives, *joints))


def test_a_robot_that_slides_stands_on_its_floor_and_is_seen_from_the_side():
    gantry = qa.Robot(urdf=GANTRY, beam=qa.Beam(**{**BEAM, "direction": (0.0, 0.0, 1.0)}))
    plant = gantry.along(qa.GeometricPath.line([0.5, 0.5], [1.5, 0.5]))
    post, *bodies = plant.structure(0.0, [0.0] * plant.tips)
    assert post.ground
    lowest = min(body.points[:, 2].min() for body in bodies)
    assert post.points[:, 2].tolist() == [pytest.approx(lowest), 0.0]  # the bar hangs below it
    # the tip goes along x: seen along y
    assert abs(np.sin(plant.seen_from)) == pytest.approx(1.0, abs=1e-3)
