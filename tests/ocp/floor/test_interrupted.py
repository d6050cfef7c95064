"""Ctrl-C while a floor is found: the starts and grids that were solved are not lost."""

import signal

import pytest
import quietarm.ocp.floor.search as search
from quietarm.ocp import Floor, energy_floor

pytestmark = pytest.mark.usefixtures("coarse")


@pytest.fixture
def ctrl_c_in(monkeypatch):
    """Let Ctrl-C come when a function of the search is called for the nth time."""

    def put(name, number):
        known, calls = getattr(search, name), []

        def interrupted(*given, **settings):
            calls.append(name)
            if len(calls) == number:
                signal.raise_signal(signal.SIGINT)
            return known(*given, **settings)

        monkeypatch.setattr(search, name, interrupted)

    return put


@pytest.mark.parametrize("number", [2, 3])  # of one start, the first call is for the second grid
def test_the_grids_that_were_solved_are_kept(tasks, ctrl_c_in, tmp_path, number):
    ctrl_c_in("_refined", number)
    floor = energy_floor(tasks["arm"], starts=1, tolerance=1e-4)
    assert not floor.complete
    assert floor.provenance.stopped == f"{number} grids"
    assert len(floor.levels) == number
    assert floor.energy == pytest.approx(floor.levels[-1].energy, rel=1e-2)
    floor.save(tmp_path / "floor.json")
    assert Floor.load(tmp_path / "floor.json") == floor


def test_the_verification_does_not_lose_them(tasks, ctrl_c_in):
    ctrl_c_in("_least_verified", 1)
    floor = energy_floor(tasks["arm"], starts=1, tolerance=0.5)
    assert floor.provenance.stopped == f"{len(floor.levels)} grids"


def test_on_the_first_two_grids_the_best_start_is_kept(tasks, ctrl_c_in, tmp_path):
    ctrl_c_in("_refined", 1)
    floor = energy_floor(tasks["arm"], starts=1)
    assert floor.provenance.stopped == "1 of 1 starts"
    assert len(floor.levels) == 2
    assert floor.levels[1].energy < floor.levels[0].energy
    floor.save(tmp_path / "floor.json")
    assert Floor.load(tmp_path / "floor.json") == floor


def test_before_a_start_is_solved_there_is_nothing_to_keep(tasks, ctrl_c_in):
    ctrl_c_in("_paths", 1)
    with pytest.raises(KeyboardInterrupt):
        energy_floor(tasks["arm"], starts=1)
