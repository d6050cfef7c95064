"""What a person runs: the command line, and the studies behind it.

Rooms, each of which may import those after it: `cli`, then `study` and `reproduction`, `runs`,
`reports`, `comparison`, `paper`, and last `display` and `methods`, the registry of methods. All of
them may import the other three packages.
"""

import ocp  # noqa: F401  # pyright: ignore[reportUnusedImport]  # refuses a file that shadows models
