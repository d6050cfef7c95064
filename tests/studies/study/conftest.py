"""What the tests of the headline study share: a small one, run once."""

import pytest
import quietarm.studies.study.pieces as study_pieces
from quietarm.studies.display.html_page import element
from quietarm.studies.study import page
from quietarm.studies.study.work import run_study
from small_study import CASES, FLOOR, QUICK


@pytest.fixture(autouse=True)
def _floor_at_once(monkeypatch):
    monkeypatch.setattr(study_pieces, "energy_floor", lambda task: FLOOR)


@pytest.fixture
def no_pictures(monkeypatch):
    """Those of the page that `test_page.py` reads are enough: they take long to draw."""
    nothing = element("figure", "")
    monkeypatch.setattr(page, "picture", lambda figure, alternative, caption: nothing)


@pytest.fixture(scope="session")
def announced():
    """The names that the small study reported as it began its pieces of work."""
    return []


@pytest.fixture(scope="session")
def small(announced):
    """Two tasks, with searches cut short."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study_pieces, "energy_floor", lambda task: FLOOR)
        return run_study(CASES, QUICK, announced.append)
