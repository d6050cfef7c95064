from .library import MoveLibrary as MoveLibrary
from .library import plan_from as plan_from
from .run import sweep as sweep
