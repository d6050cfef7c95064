"""The reader of URDFs against Pinocchio's, on every URDF that example-robot-data ships."""

import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from robots import all_urdfs, urdf_of

import quietarm as qa
from quietarm.models import Base
from quietarm.models.robot.frames import Frame, rotation_about
from quietarm.models.robot.urdf.read_urdf import FIXED, PRISMATIC, Inertia, read_urdf
from quietarm.models.robot.urdf.urdf_text import dynamics_of

pinocchio = pytest.importorskip("pinocchio")
pytestmark = pytest.mark.slow

STIFF = Base(stiffness=(1e9, 1e9))  # something has to bend; it adds nothing with the base still
EMPTY = {"ur3.urdf": "has no links"}
"""Files of the package that no reader makes a robot of."""
SAMPLE = ("panda.urdf", "ur5_robot.urdf", "tiago_no_hand.urdf", "so101.urdf", "iris_simple.urdf")
"""A finger that mimics, an arm, inertias that no body has, an axis of 0, nothing that moves."""
NEGATIVE = {"romeo_laas_small.urdf": r"has a moment of inertia of -0\.0213 kg m\^2, below 0"}
"""Of a link that moves: Pinocchio takes it, and so does no equation that is to be solved."""
WITHOUT_MASS = {"romeo.urdf": "joint 'LHand' moves no mass"}
MOST_DRIVEN = 60
"""Of a robot with two arms, two hands and wheels not all are driven."""
ALL = [path for path in all_urdfs() if path.name not in EMPTY]


def of_robot(path):
    return f"{path.parents[1].name}-{path.stem}"


def _both(path):
    return read_urdf(dynamics_of(path.read_text())), pinocchio.buildModelFromUrdf(str(path))


def _entry(model, joint):
    return model.joints[model.getJointId(joint)]


def _positions(model, urdf, seed):
    """Positions of all joints at random, ours by name, Pinocchio's in a row."""
    random = np.random.default_rng(seed)
    q = pinocchio.neutral(model)
    at = {name: random.uniform(-1, 1) for name in urdf.moving}
    for name, position in at.items():
        entry = _entry(model, name)
        # a continuous joint of Pinocchio is a point of the unit circle
        turned = [np.cos(position), np.sin(position)]
        q[entry.idx_q : entry.idx_q + entry.nq] = position if entry.nq == 1 else turned
    return at, q


def check_places(path):
    """Axes and placements: where every link stands with the joints anywhere."""
    urdf, model = _both(path)
    at, q = _positions(model, urdf, 0)
    data = model.createData()
    pinocchio.framesForwardKinematics(model, data, q)
    places = {urdf.root: Frame()}
    for joint in urdf.outwards():
        place = places[joint.parent] @ joint.frame
        if joint.kind == PRISMATIC:
            place = place @ Frame(origin=at[joint.name] * joint.axis)
        elif joint.kind != FIXED:
            place = place @ Frame(rotation_about(joint.axis, at[joint.name]))
        places[joint.child] = place
    for link, place in places.items():
        theirs = data.oMf[model.getFrameId(link, pinocchio.BODY)]
        assert place.origin == pytest.approx(theirs.translation, abs=1e-9), link
        assert place.rotation == pytest.approx(theirs.rotation, abs=1e-9), link


def check_inertias(path):
    """Masses, centres and moments: of every link with those that are fixed to it."""
    urdf, model = _both(path)
    bodies = {urdf.root: (urdf.root, Frame())}
    sums = {urdf.root: Inertia()}
    for joint in urdf.outwards():
        body, frame = bodies[joint.parent]
        fixed = joint.kind == FIXED
        bodies[joint.child] = (body, frame @ joint.frame) if fixed else (joint.name, Frame())
        sums.setdefault(bodies[joint.child][0], Inertia())
    for link, (body, frame) in bodies.items():
        sums[body] = sums[body] + urdf.links[link].seen_from(frame)
    for name in urdf.moving:
        theirs = model.inertias[model.getJointId(name)]
        assert sums[name].mass == pytest.approx(theirs.mass, rel=1e-9, abs=1e-12), name
        if theirs.mass:
            assert sums[name].centre == pytest.approx(theirs.lever, rel=1e-9, abs=1e-9), name
        assert sums[name].moments == pytest.approx(theirs.inertia, rel=1e-8, abs=1e-12), name


def check_limits(path):
    """Ranges, speeds, efforts, damping and friction of every joint that moves."""
    urdf, model = _both(path)
    for name in urdf.moving:
        joint = urdf.joints[name]
        entry = _entry(model, name)
        speed = model.upperVelocityLimit[entry.idx_v]
        effort = model.upperEffortLimit[entry.idx_v]
        # by the letter of the format a range without both ends is 0 to 0, in which nothing moves
        if entry.nq == 1 and (joint.lower, joint.upper) != (-np.inf, np.inf):
            ends = (model.lowerPositionLimit[entry.idx_q], model.upperPositionLimit[entry.idx_q])
            assert (joint.lower, joint.upper) == ends, name
        # where a continuous joint has no limit, Pinocchio has infinite ones or the largest number
        assert joint.velocity == (speed if speed < 1e300 else 0.0), name
        assert joint.effort == (effort if effort < 1e300 else 0.0), name
        assert joint.damping == model.damping[entry.idx_v], name
        assert joint.friction == model.upperDryFrictionLimit[entry.idx_v], name


def check_masses(path):
    """The mass matrix with the joints anywhere: those that mimic others follow them, as their own
    tag says; what is not driven rests at 0.
    """
    urdf, model = _both(path)
    free = [name for name in urdf.moving if urdf.joints[name].mimics is None][:MOST_DRIVEN]
    if not free:
        return
    robot = qa.Robot(urdf=path, base=STIFF, joints=free)
    at = dict(zip(free, np.random.default_rng(1).uniform(-1, 1, len(free))))
    columns = {name: at_one for at_one, name in enumerate(free)}
    slopes = np.zeros((model.nv, len(free)))
    q = pinocchio.neutral(model)
    for name in urdf.moving:
        leader, multiplier, offset = _leader(path, name)
        entry = _entry(model, name)
        position = multiplier * at.get(leader, 0.0) + offset
        turned = [np.cos(position), np.sin(position)]
        q[entry.idx_q : entry.idx_q + entry.nq] = position if entry.nq == 1 else turned
        if leader in columns:
            slopes[entry.idx_v, columns[leader]] = multiplier
    theirs = pinocchio.crba(model, model.createData(), q)
    theirs = slopes.T @ (np.triu(theirs) + np.triu(theirs, 1).T) @ slopes
    mine = robot.dynamics.masses(np.append(list(at.values()), [0.0, 0.0]))
    size = len(free)
    # quietarm takes a rpy of pi/2 to ten digits as pi/2
    accuracy = 1e-9 * np.abs(theirs).max()
    assert mine[:size, :size] == pytest.approx(theirs, rel=1e-8, abs=accuracy)


def _leader(path, joint):
    """Which joint leads one by the URDF's own text, and multiplier and offset of the chain."""
    root = ElementTree.parse(path).getroot()
    mimics = {element.get("name"): element.find("mimic") for element in root.findall("joint")}
    multiplier, offset = 1.0, 0.0
    while mimics.get(joint) is not None:
        mimic = mimics[joint]
        offset += multiplier * float(mimic.get("offset", 0))
        multiplier *= float(mimic.get("multiplier", 1))
        joint = mimic.get("joint")
    return joint, multiplier, offset


CHECKS = (check_places, check_inertias, check_limits, check_masses)


@pytest.mark.parametrize("check", CHECKS)
@pytest.mark.parametrize("name", SAMPLE)
def test_what_is_read_is_what_pinocchio_reads(name, check):
    check(urdf_of(name))


@pytest.mark.slow
@pytest.mark.parametrize("check", CHECKS)
@pytest.mark.parametrize("path", ALL, ids=of_robot)
def test_every_urdf_is_read_as_pinocchio_does(path, check):
    refused = {**NEGATIVE, **WITHOUT_MASS}.get(path.name)
    if check is check_masses and refused:
        with pytest.raises(ValueError, match=refused):
            check(path)
        return
    check(path)


@pytest.mark.parametrize("name", EMPTY)
def test_a_file_without_links_is_refused(name):
    with pytest.raises(ValueError, match=EMPTY[name]):
        read_urdf(dynamics_of(urdf_of(name).read_text()))
