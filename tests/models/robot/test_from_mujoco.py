"""Robots of MuJoCo models: masses and torques are MuJoCo's own at any posture."""

import numpy as np
import pytest
from small_robots import torques_of

import quietarm as qa

mujoco = pytest.importorskip("mujoco")
pytestmark = pytest.mark.slow

MODEL = """<mujoco model="crane &amp; arm"><compiler angle="radian"/><option gravity="1 -2 -9"/>
<worldbody><body name="post" pos="0 0.1 1" quat="0.8 0.6 0 0">
  <geom type="box" size="0.1 0.1 0.1" mass="3"/>
  <body name="bridge" pos="0.1 0.2 0.3">
    <joint name="x" type="slide" axis="1 0 0.5" range="-1 2" limited="true" armature="0.7"
      damping="4" ref="0.2"/>
    <inertial pos="0.1 0 0.05" quat="0.9 0.1 0.2 0.3" mass="5" diaginertia="0.3 0.2 0.15"/>
    <body name="upper" pos="0.2 0 0" quat="0.7 0 0.7 0.1">
      <joint name="turn" axis="0 0 1" pos="0.05 0 0.02" ref="0.3" damping="1.5" armature="0.2"/>
      <joint name="lean" axis="0 1 0" pos="0 0.03 0" range="-1 1" limited="true"/>
      <inertial pos="0.2 0.1 0" mass="2" diaginertia="0.03 0.02 0.015"/>
      <body name="rod" pos="0.4 0 0">
        <joint name="bend" axis="0 0 1" pos="0 0.01 0" stiffness="300" damping="0.4"
          springref="0.1"/>
        <inertial pos="0.3 0 0" mass="0.8" diaginertia="0.001 0.02 0.02"/>
        <body pos="0.6 0 0"><geom type="sphere" size="0.03" mass="0.5"/></body>
      </body>
      <body name="finger"><joint name="f" axis="0 1 0"/>
        <inertial pos="0 0 0.1" mass="0.3" diaginertia="0.001 0.001 0.001"/></body>
    </body>
  </body>
</body></worldbody>
<equality><joint joint1="f" joint2="lean" polycoef="0.1 -0.5 0 0 0"/></equality>
</mujoco>"""


def model_of(text=MODEL):
    return mujoco.MjModel.from_xml_string(text)


def torques_in(model, robot, x, v, a):
    """Return torques of the driven joints, then the spring, by virtual work with the follower."""
    data = mujoco.MjData(model)
    names = [*robot.joints, "bend"]
    slopes = np.zeros((model.nv, len(names)))
    for number, name in enumerate(names):
        slopes[model.joint(name).dofadr[0], number] = 1.0
    slopes[model.joint("f").dofadr[0], names.index("lean")] = -0.5
    data.qpos[:] = slopes @ x
    data.qpos[model.joint("f").qposadr[0]] += 0.1  # polycoef, from reference positions of 0
    data.qpos[model.joint("bend").qposadr[0]] += 0.1  # counted from where it is slack
    data.qvel[:] = slopes @ v
    mujoco.mj_fwdPosition(model, data)
    mujoco.mj_fwdVelocity(model, data)
    masses = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, masses)
    damping = np.array(model.dof_damping)
    damping[model.joint("bend").dofadr[0]] = 0.0  # of the spring, which is apart
    forces = masses @ (slopes @ a) + data.qfrc_bias + damping * data.qvel
    return slopes.T @ forces


def test_torques_are_mujocos_at_any_posture():
    model = model_of()
    robot = qa.Robot.from_mujoco(model)
    assert robot.joints == ("x", "turn", "lean")
    assert robot.description.name == "crane & arm"
    rng = np.random.default_rng(5)
    for _ in range(4):
        x, v, a = rng.normal(size=(3, 4)) * np.array([[0.4], [1.0], [2.0]])
        expected = torques_in(model, robot, x, v, a)
        assert torques_of(robot, x, v, a) == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_ranges_springs_and_rotors_are_the_models():
    robot = qa.Robot.from_mujoco(model_of())
    assert robot.ranges()[0] == (-1.0, 2.0)
    assert robot.ranges()[1] == (-np.inf, np.inf)
    assert robot.rotor_inertia["x"] == 0.7
    assert robot.friction["turn"] == 1.5
    assert robot.gravity == (1.0, -2.0, -9.0)
    assert (robot.springs["bend"].stiffness, robot.springs["bend"].damping) == (300.0, 0.4)
    beam = qa.Beam(at="rod", length=0.3, bending_stiffness=5.0, mass_per_length=0.1, tip_mass=0.1)
    other = qa.Robot.from_mujoco(model_of(), beam=beam, gravity=(0, 0, 0))
    assert (other.tip, other.gravity) == ("beam end", (0.0, 0.0, 0.0))


@pytest.mark.parametrize(("change", "words"), [
    (('<joint name="f" axis="0 1 0"/>', '<joint name="f" type="ball"/>'), "joint 'f' is a free"),
    (("0.1 -0.5 0 0 0", "0.1 -0.5 0.2 0 0"), "joint 'f' follows another by a curve"),
    (("</equality>", '<connect body1="finger" body2="post" anchor="0 0 0"/></equality>'),
     "the model has a loop"),
    (('stiffness="300"', 'stiffness="300" armature="0.1"'), "joint 'bend' has a spring and an arm"),
])  # fmt: skip
def test_what_is_no_tree_of_hinges_and_slides_is_refused(change, words):
    text = MODEL.replace(*change)
    if "ball" in text:
        text = text.split("<equality>")[0] + "</mujoco>"
    with pytest.raises(ValueError, match=words):
        qa.Robot.from_mujoco(model_of(text))


def test_what_is_no_model_is_refused():
    with pytest.raises(TypeError, match=r"model is 'robot\.xml'; give a mujoco"):
        qa.Robot.from_mujoco("robot.xml")
