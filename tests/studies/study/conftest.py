"""What the tests of the headline study share: a small one, run once."""

import pytest
import quietarm.studies.study.work as study_pieces
from quietarm.studies.study.work import run_study
from small_study import CASES, FLOOR, QUICK


@pytest.fixture(autouse=True)
def _floor_at_once(monkeypatch):
    monkeypatch.setattr(study_pieces, "energy_floor", lambda task: FLOOR)


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
