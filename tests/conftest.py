"""Fixtures and checks that the tests of every package share."""

import gc
import os
import signal
from collections import Counter

import pytest
from hypothesis import Phase, settings

# The tests of two processes stand in the way of each other's threads; numpy reads it when loaded.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Numba compiles pymoo's AGE-MOEA anew in every process, which takes longer than its small searches.
os.environ.setdefault("NUMBA_OPT", "0")
# Tests are of what is computed here, not of what another version of the sources left.
os.environ["QUIETARM_CACHE"] = "off"

from pages import blocks

from quietarm.metaheuristics import Indicator, SearchMethod
from quietarm.models import DualLinkManipulator, Plant, compiled, known_plants, plant_file
from quietarm.ocp import FIGURES, QUANTITIES, Energy, JointProfile, remove_figure, remove_quantity
from quietarm.ocp.checks import ships
from quietarm.views import ExportFormat
from quietarm.views.pictures.panel import Panel

# The tests of a session share the functions that they compile: a tenth of their time.
compiled.RECENT = 48
# A shell lets what it starts in the background ignore Ctrl-C, which these tests send.
signal.signal(signal.SIGINT, signal.default_int_handler)

# Derandomised, so that a run on another day gives the same answer; `--hypothesis-profile=search`
# looks further. No deadline: the first example of a kind compiles.
settings.register_profile("repeatable", deadline=None, derandomize=True)
settings.register_profile("search", deadline=None, max_examples=1000)
# For mutation.py: a failing example is enough, whether or not a simpler one fails too.
settings.register_profile(
    "mutation", deadline=None, derandomize=True, phases=(Phase.explicit, Phase.generate)
)
settings.load_profile("repeatable")


def pytest_collection():
    """Collect no garbage while tests are: what is made then stays until the end."""
    gc.disable()


def pytest_collection_finish():
    """Look no more at what collecting has made, whenever garbage is looked for."""
    gc.freeze()
    gc.enable()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Mark the later cases of a test that is `slow_after` some: the first ones find its faults."""
    cases = Counter()
    for item in items:
        kept = item.get_closest_marker("slow_after")
        if kept is None:
            continue
        test = (item.fspath, item.originalname)
        cases[test] += 1
        if cases[test] > kept.args[0]:
            item.add_marker(pytest.mark.slow)


@pytest.fixture(scope="session")
def two_links():
    """The plant of two modes."""
    return DualLinkManipulator()


@pytest.fixture
def _plants_of_this_test_are_forgotten(monkeypatch):
    """Plants that a test defines are known by name during that test only."""
    monkeypatch.setattr(Plant, "_known", known_plants())


@pytest.fixture
def what_is_made_up_is_forgotten(monkeypatch, _plants_of_this_test_are_forgotten):
    """Forget what a test defines: it is known by name during that test only."""
    before = set(classes_with_a_name())
    quantities, figures = {*QUANTITIES}, {*FIGURES}
    monkeypatch.setattr(plant_file, "_module_of", dict(plant_file._module_of))
    yield
    for kind in classes_with_a_name():
        if kind not in before and not ships(kind):
            kind.name = None  # which is no name
    for name in {*QUANTITIES} - quantities:
        remove_quantity(name)
    for name in {*FIGURES} - figures:
        remove_figure(name)


def classes_with_a_name(family=object):
    """Classes of quietarm's families, shipped or not, that are known by a name."""
    families = [family]
    if family is object:
        families = [Energy, ExportFormat, Indicator, JointProfile, Panel, SearchMethod]
    for kind in families:
        if isinstance(vars(kind).get("name"), str):
            yield kind
        for below in kind.__subclasses__():
            yield from classes_with_a_name(below)


@pytest.fixture
def quick_pictures(monkeypatch):
    """Draw pictures coarsely, without a layout: tests/views/pictures looks at them."""
    from matplotlib.figure import Figure  # most tests draw nothing

    whole = Figure.savefig

    def draw(figure, *given, **settings):
        if settings.get("format") in ("raw", "rgba"):  # the frames of a film
            return whole(figure, *given, **settings)
        figure.set_layout_engine(None)
        return whole(figure, *given, **{**settings, "dpi": 40})

    monkeypatch.setattr(Figure, "savefig", draw)


@pytest.fixture
def crane_file(tmp_path, _plants_of_this_test_are_forgotten):
    """A user's file that defines a plant: that of docs/own_plant.md."""
    path = tmp_path / "crane.py"
    path.write_text(blocks("own_plant", "python")[0])
    return path
