"""A robot of two links in a URDF that tests change, on a base that rocks."""

import quietarm as qa
from quietarm.models import Base

INERTIA = '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>'
INERTIAL = f'<inertial><origin xyz="0.2 0 0"/><mass value="1"/>{INERTIA}</inertial>'
LIMIT = '<limit lower="-2" upper="2" effort="50" velocity="3"/>'
SHOULDER = f"""<joint name="shoulder" type="revolute"><parent link="ground"/><child link="upper"/>
<origin xyz="0 0 0"/><axis xyz="0 0 1"/>{LIMIT}</joint>"""
ELBOW = f"""<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/>
<origin xyz="0.5 0 0"/><axis xyz="0 0 1"/>{LIMIT}</joint>"""
URDF = f"""<robot name="two"><link name="ground"/><link name="upper">{INERTIAL}</link>
<link name="lower">{INERTIAL}</link>{SHOULDER}{ELBOW}</robot>"""
BASE = Base((1e4, 1e4))


def robot_of(text, **entries):
    return qa.Robot(urdf=text, **{"base": BASE, **entries})


def words_of(robot):
    return " / ".join(note.words for note in robot.notes)


def with_elbow(more, urdf=URDF):
    """The URDF with more in its last joint."""
    return urdf.replace("</joint></robot>", f"{more}</joint></robot>")


def limits_of(folder, urdf, entries=""):
    """The limits of a robot whose file takes those of its URDF."""
    (folder / "robot.urdf").write_text(urdf)
    file = folder / "robot.yaml"
    file.write_text(f"urdf: robot.urdf\nbase: {{stiffness: 2e4}}\nlimits: urdf\n{entries}")
    return qa.Robot.load(file).limits
