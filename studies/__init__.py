"""The command line, and the studies behind it.

Rooms, each of which may import those after it: `cli`, then `study` and `reproduction`, `runs`,
`reports`, `figures`, `comparison`, `paper`, and last `display`, `methods` and `profiles`, the
registries of methods and of joint profiles, and `early`, for Ctrl-C while the command is being
loaded. All of them may import the other three packages, but for `early`, which comes before
everything. Of use from outside is `figures`, which draws.
"""

# ruff: noqa: E402  # what follows takes a third of a second
from studies.early import end_in_one_line

end_in_one_line()

import ocp  # noqa: F401  # pyright: ignore[reportUnusedImport]  # refuses a file that shadows models
