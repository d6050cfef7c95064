"""What the tests of contests share: one contest that is held once, on a small problem."""

import shutil

import pytest
from quietarm.studies.contest import page, store
from quietarm.studies.document.blocks import Section
from small_contest import LINE


def _small(patch):
    patch.setattr(store, "_FILL", 500)


@pytest.fixture(autouse=True)
def _small_problems(monkeypatch):
    _small(monkeypatch)


@pytest.fixture
def no_pictures(monkeypatch):
    """Those of the contest that is held once are enough: they take long to draw."""
    monkeypatch.setattr(page, "section", lambda arena, methods: Section(arena.problem, []))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder of the test's own, and standing in it; lines are not wrapped."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "1000")
    return tmp_path


@pytest.fixture(scope="session")
def held(tmp_path_factory):
    """The folder of a small contest."""
    from quietarm.studies.cli.application import quietarm

    place = tmp_path_factory.mktemp("contest") / "held"
    with pytest.MonkeyPatch.context() as patch:
        _small(patch)
        quietarm.main([*LINE.split(), "--output", str(place)], standalone_mode=False)
    return place


@pytest.fixture
def copy(held, folder):
    """A copy of the small contest's folder, to spoil."""
    return shutil.copytree(held, folder / "held")
