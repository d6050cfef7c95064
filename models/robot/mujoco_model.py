"""A robot of MuJoCo as a URDF: its bodies, joints, springs and what of them follows others.

MuJoCo's own compiler has read the MJCF, so that what is left is numbers; MuJoCo is not imported.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from quietarm.models.joint_motion import Array
from quietarm.models.number_checks import listed, quoted
from quietarm.models.robot.elastic.flexibility import Spring
from quietarm.models.robot.frames import rotation_about, rotation_of_quaternion

_SLIDE, _HINGE = 2, 3
"""Of mjtJoint; a free joint is 0 and a ball 1."""
_JOINT_FOLLOWS = 2
"""Of mjtEq."""


def entries_of_mujoco(model: Any) -> dict[str, Any]:
    """Return the arguments of `Robot` that a mujoco.MjModel has: urdf, springs, rotors, gravity.

    Positions of the joints are MuJoCo's own; of a joint with a spring they are counted from where
    the spring is slack.

    Raises
    ------
    ValueError
        When it has a free or a ball joint, a loop, or a joint that follows another by a curve.
    """
    if not hasattr(model, "jnt_type"):
        raise TypeError(f"model is {quoted(model)}; give a mujoco.MjModel")
    _refuse_tendons(model)
    mimics, held = _followers(model)
    links = "".join(_links(model, mimics))
    springs = {
        _joint_name(model, joint): Spring(
            float(model.jnt_stiffness[joint]), float(model.dof_damping[_dof(model, joint)])
        )
        for joint in range(model.njnt)
        if model.jnt_stiffness[joint] > 0
    }
    rotors = {
        _joint_name(model, joint): float(model.dof_armature[_dof(model, joint)])
        for joint in range(model.njnt)
        if model.dof_armature[_dof(model, joint)] > 0
    }
    if unfit := [name for name in rotors if name in springs]:
        raise ValueError(
            f"joint {quoted(unfit[0])} has a spring and an armature; give its inertia to its body"
        )
    return {
        "urdf": f"<robot name={quoteattr(_name_of(model))}>{links}</robot>",
        "springs": springs,
        "rotor_inertia": rotors,
        "held": held,
        "gravity": tuple(model.opt.gravity.tolist()),
    }


def _name_of(model: Any) -> str:
    """The model's name, which is the first of its names."""
    name = bytes(model.names).split(b"\0", 1)[0].decode("utf-8", "replace")
    return name or "robot"


def _body_name(model: Any, body: int) -> str:
    return model.body(body).name or f"body {body}"


def _joint_name(model: Any, joint: int) -> str:
    return model.joint(joint).name or f"joint {joint}"


def _dof(model: Any, joint: int) -> int:
    return int(model.jnt_dofadr[joint])


def _refuse_tendons(model: Any) -> None:
    """Refuse tendons with springs or dampers, which are no joints."""
    if model.ntendon and (np.any(model.tendon_stiffness) or np.any(model.tendon_damping)):
        raise ValueError(
            "the model has tendons with springs or dampers; give joints with stiffness in their "
            "place"
        )


def _followers(model: Any) -> tuple[dict[int, str], dict[str, float]]:
    """Elements <mimic> by joint, and positions of joints that a constraint holds."""
    mimics = dict[int, str]()
    held = dict[str, float]()
    for number in range(model.neq):
        if not model.eq_active0[number]:
            continue
        if model.eq_type[number] != _JOINT_FOLLOWS:
            raise ValueError(
                "the model has a loop, or a body that is tied to another, by an equality; give a "
                "tree of bodies"
            )
        joint, leader = int(model.eq_obj1id[number]), int(model.eq_obj2id[number])
        constant, slope, *bends = model.eq_data[number][:5].tolist()
        name = _joint_name(model, joint)
        rest = float(model.qpos0[model.jnt_qposadr[joint]]) + constant
        if leader < 0:
            held[name] = rest
            continue
        if any(bends):
            raise ValueError(
                f"joint {quoted(name)} follows another by a curve, {listed(map(str, bends))}; give "
                "a polycoef of two numbers"
            )
        offset = rest - slope * float(model.qpos0[model.jnt_qposadr[leader]])
        mimics[joint] = (
            f"<mimic joint={quoteattr(_joint_name(model, leader))} "
            f'multiplier="{slope!r}" offset="{offset!r}"/>'
        )
    return mimics, held


def _links(model: Any, mimics: Mapping[int, str]) -> Iterator[str]:
    """The elements of links and of the joints before them; a link stands at its last joint."""
    at_joint = np.zeros((model.nbody, 3))
    yield f"<link name={quoteattr(_body_name(model, 0))}/>"
    for body in range(1, model.nbody):
        joints = range(
            int(model.body_jntadr[body]),
            int(model.body_jntadr[body]) + int(model.body_jntnum[body]),
        )
        name = _body_name(model, body)
        parent = int(model.body_parentid[body])
        before = _body_name(model, parent)
        origin = model.body_pos[body] - at_joint[parent]
        quaternion = model.body_quat[body]
        turned = _rotation(quaternion)
        place = np.zeros(3)
        for joint in joints:
            _check_kind(model, joint)
            here = model.jnt_pos[joint]
            origin = origin + turned @ (here - place)
            place = here
            last = joint == joints[-1]
            child = name if last else f"{name} at {_joint_name(model, joint)}"
            if not last:
                yield f"<link name={quoteattr(child)}/>"
            yield _joint(model, joint, before, child, origin, turned, mimics.get(joint, ""))
            before, origin, turned = child, np.zeros(3), np.eye(3)
        at_joint[body] = place
        if not len(joints):
            yield (
                f'<joint name={quoteattr(f"{name} is fixed")} type="fixed">'
                f"{_ends(before, name)}{_origin(origin, turned)}</joint>"
            )
        yield _link(model, body, name, place)


def _check_kind(model: Any, joint: int) -> None:
    if model.jnt_type[joint] not in (_SLIDE, _HINGE):
        raise ValueError(
            f"joint {quoted(_joint_name(model, joint))} is a free joint or a ball; give hinges and "
            "slides alone"
        )


def _joint(
    model: Any, joint: int, parent: str, child: str, origin: Array, turned: Array, mimic: str
) -> str:
    """A joint; where its frame stands at position 0 is that of MuJoCo at position 0."""
    hinge = model.jnt_type[joint] == _HINGE
    axis = model.jnt_axis[joint]
    address = int(model.jnt_qposadr[joint])
    slack = model.qpos_spring[address] if model.jnt_stiffness[joint] > 0 else 0.0
    shift = float(slack - model.qpos0[address])
    if hinge:
        turned = turned @ rotation_about(axis, shift)
    else:
        origin = origin + shift * (turned @ axis)
    limited = bool(model.jnt_limited[joint])
    lower, upper = (float(end - slack) for end in model.jnt_range[joint])
    kind = "prismatic" if not hinge else "revolute" if limited else "continuous"
    entries = f' lower="{lower!r}" upper="{upper!r}"' if limited else ""
    if getattr(model, "jnt_actfrclimited", None) is not None and model.jnt_actfrclimited[joint]:
        entries += f' effort="{float(np.abs(model.jnt_actfrcrange[joint]).min())!r}"'
    dynamics = ""
    if model.jnt_stiffness[joint] == 0:
        dof = _dof(model, joint)
        rubbing = (float(model.dof_damping[dof]), float(model.dof_frictionloss[dof]))
        dynamics = f'<dynamics damping="{rubbing[0]!r}" friction="{rubbing[1]!r}"/>'
    return (
        f'<joint name={quoteattr(_joint_name(model, joint))} type="{kind}">{_ends(parent, child)}'
        f'{_origin(origin, turned)}<axis xyz="{_text(axis)}"/><limit{entries}/>{dynamics}{mimic}'
        "</joint>"
    )


def _link(model: Any, body: int, name: str, place: Array) -> str:
    """A link with the mass and the moments of a body, about its own principal axes."""
    mass = float(model.body_mass[body])
    if mass == 0:
        return f"<link name={quoteattr(name)}/>"
    about_x, about_y, about_z = map(float, model.body_inertia[body])
    centre = _origin(model.body_ipos[body] - place, _rotation(model.body_iquat[body]))
    return (
        f'<link name={quoteattr(name)}><inertial>{centre}<mass value="{mass!r}"/>'
        f'<inertia ixx="{about_x!r}" iyy="{about_y!r}" izz="{about_z!r}" ixy="0" ixz="0" iyz="0"/>'
        "</inertial></link>"
    )


def _ends(parent: str, child: str) -> str:
    return f"<parent link={quoteattr(parent)}/><child link={quoteattr(child)}/>"


def _origin(origin: Array, turned: Array) -> str:
    """An origin by a quaternion, which loses nothing where an angle is a quarter of a turn."""
    from scipy.spatial.transform import Rotation  # takes a quarter of a second to load

    quaternion = Rotation.from_matrix(turned).as_quat()
    return f'<origin xyz="{_text(origin)}" quat_xyzw="{_text(quaternion)}"/>'


def _rotation(quaternion: Array) -> Array:
    """Return the rotation by a quaternion w, x, y, z."""
    return rotation_of_quaternion(np.roll(quaternion, -1))


def _text(numbers: Array) -> str:
    return " ".join(repr(float(number)) for number in numbers)
