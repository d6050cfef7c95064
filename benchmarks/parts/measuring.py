"""Tools that the benchmarks share: cold starts, timing, tables that fit a screen."""

from __future__ import annotations

import gc
import os
import platform
import sys
import time
from collections.abc import Callable
from importlib import metadata
from typing import TypeVar

import casadi as ca
from rich.console import Console

Result = TypeVar("Result")


def load_plugins() -> None:
    """Load casadi's shared libraries, which would otherwise count against whoever is first."""
    ca.load_nlpsol("ipopt")
    ca.load_integrator("cvodes")


def forget_compiled() -> None:
    """Empty every cache, so that the next plan or search builds all of its functions anew."""
    for name, module in list(sys.modules.items()):
        if name.startswith(("quietarm.ocp.", "quietarm.metaheuristics.")):
            for value in vars(module).values():
                if hasattr(value, "cache_clear"):
                    value.cache_clear()


def timed(
    action: Callable[[], Result], clock: Callable[[], float] = time.perf_counter
) -> tuple[float, Result]:
    """Time [s] of an action by a clock, and what it returned; garbage is collected beforehand.

    `time.process_time` as the clock gives the processor's time, all threads together: for work on
    one thread it is the wall time of an idle machine, which other work disturbs much less.
    """
    gc.collect()
    began = clock()
    result = action()
    return clock() - began, result


def machine(*distributions: str) -> str:
    """A line about the machine and the versions that the figures belong to."""
    versions = [f"{name} {metadata.version(name)}" for name in ("casadi", *distributions)]
    python = f"Python {platform.python_version()}"
    return f"{platform.machine()}, {os.cpu_count()} cores, {python}, {', '.join(versions)}"


def console() -> Console:
    """A console whose tables keep their width in a file or a pipe."""
    return Console(width=None if sys.stdout.isatty() else 110, highlight=False)
