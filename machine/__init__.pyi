from . import identify as identify
from . import learn as learn
from .recordings.recording import Recording as Recording
from .recordings.robot_recording import RobotRecording as RobotRecording
