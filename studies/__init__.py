"""The command line, and the studies behind it.

Rooms, each of which may import those after it: `cli`, then `contest`, `reproduction` and `study`,
then `runs`, `animation`, `figures`, `comparison`, `paper`, and last `display`, `registry`, which
names methods and joint profiles, and `early`, for Ctrl-C while the command is being loaded. All of
them may import the other three packages, but for `early`, which comes before everything. Of use
from outside are `figures` and `animation`, which draw.
"""

# ruff: noqa: E402  # what follows takes a third of a second
from quietarm.studies.early import end_in_one_line

end_in_one_line()

from quietarm import ocp  # noqa: F401  # pyright: ignore[reportUnusedImport]  # refuses a file that shadows models
