from .library import MoveLibrary as MoveLibrary
from .made import sweep as sweep
