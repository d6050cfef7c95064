"""How a search is going: a line that renews itself on a terminal, plain lines elsewhere."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from metaheuristics import SearchProgress

_PLAIN_SECONDS = 2.0


@contextmanager
def search_display(
    console: Console, *, quiet: bool = False
) -> Iterator[Callable[[SearchProgress], None]]:
    """Show a search's generation, best residual, least energy, hypervolume, speed and time left.

    Parameters
    ----------
    console : rich.console.Console
        Where to, usually standard error.
    quiet : bool
        Show nothing.

    Yields
    ------
    callable
        To be called with a `SearchProgress` after every generation.
    """
    if quiet:
        yield lambda progress: None
    elif not console.is_terminal:
        yield _plain(console)
    else:
        columns = (BarColumn(), TextColumn("{task.description}"), TimeRemainingColumn())
        with Progress(*columns, console=console, transient=True) as bar:
            task = bar.add_task("", total=None)

            def renew(progress: SearchProgress) -> None:
                bar.update(
                    task,
                    total=progress.generations,
                    completed=progress.generation,
                    description=_figures(progress),
                )

            yield renew


def _plain(console: Console) -> Callable[[SearchProgress], None]:
    last = time.perf_counter()

    def line(progress: SearchProgress) -> None:
        nonlocal last
        now = time.perf_counter()
        if now - last >= _PLAIN_SECONDS or progress.generation == progress.generations:
            last = now
            left = (progress.generations - progress.generation) / max(progress.generation, 1)
            console.print(
                f"{_figures(progress)}, {left * progress.seconds:.0f} s left",
                markup=False, highlight=False, soft_wrap=True,
            )  # fmt: skip

    return line


def _figures(progress: SearchProgress) -> str:
    speed = progress.evaluations / max(progress.seconds, 1e-9)
    return (
        f"generation {progress.generation}/{progress.generations}, "
        f"residual {progress.residual * 1e3:.3g} mm, energy {progress.energy:.4g} J, "
        f"hypervolume {progress.hypervolume:.4f}, {speed:.0f} candidates/s"
    )
