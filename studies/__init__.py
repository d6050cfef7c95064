"""What a person runs: the paper recomputed, pictures, the command line."""

from studies.figures import Line, four_panels, save_figure

__all__ = ["Line", "four_panels", "save_figure"]
