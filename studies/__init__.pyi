from . import answers as answers
from . import bench as bench
from . import compare as compare
from . import sweep as sweep
from .trajectory_messages import MessagePlanner as MessagePlanner
from .trajectory_messages import PlannedMessage as PlannedMessage
