"""Figures of matplotlib as they are saved, for tests of what they show."""

from contextlib import contextmanager

import pytest
from matplotlib.figure import Figure


@contextmanager
def saved_figures():
    """Figures of frames that are saved meanwhile."""
    figures = []
    with pytest.MonkeyPatch.context() as patch:
        save = Figure.savefig
        patch.setattr(
            Figure, "savefig",
            lambda figure, *place, **how: (figures.append(figure), save(figure, *place, **how)),
        )  # fmt: skip
        yield figures
