from .film import Film as Film
from .film import animate as animate
from .formats import export_moves as export_moves
from .formats import export_plan as export_plan
