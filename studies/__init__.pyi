from . import answers as answers
from . import bench as bench
from . import compare as compare
from . import sweep as sweep
