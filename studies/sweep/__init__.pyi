from .learn_set import LearnedSet as LearnedSet
from .learn_set import learn_set as learn_set
from .library import MoveLibrary as MoveLibrary
from .library import plan_from as plan_from
from .run import sweep as sweep
