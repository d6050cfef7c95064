"""What a person runs: the paper recomputed, pictures, the command line."""

import ocp  # noqa: F401  # pyright: ignore[reportUnusedImport]  # refuses a file that shadows models
