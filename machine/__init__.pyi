from . import identify as identify
from . import learn as learn
from .held_robots.identify_robot import IdentifiedRobot as IdentifiedRobot
from .held_robots.identify_robot import identify_robot as identify_robot
from .recordings.recording import Recording as Recording
from .recordings.robot_recording import RobotRecording as RobotRecording
