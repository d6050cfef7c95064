"""Point-to-point moves of flexible robot arms that arrive at rest and take little energy.

    import quietarm as qa

    task = qa.PointToPoint(qa.SingleLinkManipulator(), target=qa.deg(30), duration=0.8)
    plan = qa.plan_move(task)

Here is what most people need; the stub beside this file lists it. The rest has its package:
`qa.models`, `qa.ocp`, `qa.metaheuristics`, `qa.machine`, `qa.views` and `qa.studies`; of the last
two `qa.pictures`, `qa.compare` and `qa.bench` are rooms. Each is imported with the first of its
names that is asked for.
"""

import os.path  # pathlib takes longer to load than all of this: a command hears no signal before
import sys

from quietarm.loading import attach
from quietarm.moved import MOVED, MovedRooms

_FOLDER = os.path.dirname(__file__)
# in a checkout without the links of an editable installation
if not os.path.isdir(os.path.join(_FOLDER, "ocp")):
    __path__.append(os.path.dirname(_FOLDER))

__version__ = "2.1.0"

sys.meta_path.append(MovedRooms())

__getattr__, __dir__, __all__ = attach(__name__, __file__, moved=MOVED)
