"""A contest whose runs are shared by processes of this machine."""

import multiprocessing
import re
import signal

import pytest
from quietarm.studies.contest.store import Run, Store
from small_contest import LINE, found

pytestmark = pytest.mark.usefixtures("no_pictures")


def test_it_stops_and_one_process_goes_on_to_the_same_runs(call, folder, held, monkeypatch):
    keep, kept = Store.keep, []

    def keep_and_interrupt(self, what):
        keep(self, what)
        if isinstance(what, Run):
            kept.append((what.method, what.front.seed))
            if len(kept) == 1:
                signal.raise_signal(signal.SIGINT)

    with monkeypatch.context() as patch:
        patch.setattr(Store, "keep", keep_and_interrupt)
        code, _, err = call(f"{LINE} --workers 2 --output shared")
    assert code == 1
    assert multiprocessing.active_children() == []
    said = re.fullmatch(
        r"quietarm: interrupted: (\d) of 4 pieces of work are done; give the same line again to go "
        r"on\n",
        err,
    )
    # what was on its way when Ctrl-C came is kept as well
    there = set(found(folder / "shared"))
    assert 1 <= int(said[1]) == len(there) < 4
    assert set(kept) <= there
    assert (folder / "shared/contest.html").exists()
    code, _, err = call(f"{LINE.removesuffix(' --quiet')} --output shared")
    assert code == 0
    assert (
        err.splitlines()[0]
        == f"{len(there)} of 4 runs are in shared; {4 - len(there)} are to be done"
    )
    assert found(folder / "shared") == found(held)
