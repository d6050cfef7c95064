"""Robots of two or three links whose answers take a second: an arm with a gripper, a gantry."""

from pathlib import Path

import casadi as ca
import numpy as np

INERTIAL = (
    '<inertial><origin xyz="0.2 0 0"/><mass value="2"/>'
    '<inertia ixx="0.01" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial>'
)
LIMIT = '<limit lower="-3" upper="3" effort="150" velocity="3"/>'
ARM = f"""<robot name="arm">
<link name="ground"/><link name="upper">{INERTIAL}</link><link name="fore">{INERTIAL}</link>
<link name="tool"/><link name="finger">{INERTIAL}</link>
<joint name="a" type="revolute"><parent link="ground"/><child link="upper"/><axis xyz="0 0 1"/>
{LIMIT}</joint>
<joint name="b" type="revolute"><parent link="upper"/><child link="fore"/>
<origin xyz="0.4 0 0"/><axis xyz="0 0 1"/>{LIMIT}</joint>
<joint name="t" type="fixed"><parent link="fore"/><child link="tool"/>
<origin xyz="0.3 0 0" rpy="0 1.5707963267948966 0"/></joint>
<joint name="grip" type="prismatic"><parent link="tool"/><child link="finger"/><axis xyz="1 0 0"/>
<limit lower="0" upper="0.04" effort="20" velocity="0.2"/></joint>
</robot>"""
# The names contain the letters of units.
GANTRY = f"""<robot name="gantry">
<link name="frame"/><link name="bridge">{INERTIAL}</link><link name="trolley">{INERTIAL}</link>
<link name="tool"/>
<joint name="x" type="prismatic"><parent link="frame"/><child link="bridge"/><axis xyz="1 0 0"/>
<limit lower="0" upper="3" effort="900" velocity="2"/></joint>
<joint name="radial-axis" type="prismatic"><parent link="bridge"/><child link="trolley"/>
<axis xyz="0 1 0"/><limit lower="0" upper="2" effort="500" velocity="2"/></joint>
<joint name="down" type="fixed"><parent link="trolley"/><child link="tool"/>
<origin xyz="0 0 -0.6" rpy="3.141592653589793 0 0"/></joint>
</robot>"""
MIXED = GANTRY.replace('radial-axis" type="prismatic">', 'radial-axis" type="revolute">').replace(
    '<axis xyz="0 1 0"/>', '<axis xyz="0 0 1"/>'
)
FILE = """urdf: robot.urdf
beam: {at: tool, length: 0.5, width: 6mm, height: 10mm, youngs_modulus: 70GPa, density: 2700,
       tip_mass: 0.3, damping: 0.5%, pieces: 2}
"""
ARM_FILE = f"{FILE}joints: [a, b]\nheld: {{grip: 20mm}}\n"


def write_robot(folder: Path, urdf: str, entries: str = FILE, limits: str = "") -> Path:
    """Write a robot's file, its URDF and a joint_limits.yaml into a folder."""
    (folder / "robot.urdf").write_text(urdf)
    if limits:
        (folder / "joint_limits.yaml").write_text(f"joint_limits:\n  {limits}\n")
        entries += "limits: joint_limits.yaml\n"
    (folder / "robot.yaml").write_text(entries)
    return folder / "robot.yaml"


def torques_of(robot, positions, speeds, accelerations):
    """Torques of all joints of a robot by its own equations, without springs and dampers."""
    motion = (ca.SX(ca.DM(row)) for row in (positions, speeds, accelerations))
    return np.array(ca.evalf(robot.dynamics.torques(*motion))).ravel()
