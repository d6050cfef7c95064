from . import bench as bench
from . import compare as compare
from . import export as export
from . import figures as figures
from . import identify as identify
from . import sweep as sweep
