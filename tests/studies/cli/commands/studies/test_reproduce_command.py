"""`quietarm reproduce`, with the one reproduction of these tests in place of another."""

import pytest
import quietarm.studies.cli.commands.evaluate
import quietarm.studies.cli.commands.plan
import quietarm.studies.reading.saved
import quietarm.studies.reproduction.recompute
import quietarm.studies.study.work
from quietarm.studies.paper import ROWS
from quietarm.studies.reproduction.recompute import pieces_of_paper


@pytest.fixture
def reproduced(reproduction, monkeypatch):
    """Let the command find the paper recomputed already."""

    def at_once(begin, *rest):
        begin("the only solve")
        return reproduction

    monkeypatch.setattr(quietarm.studies.reproduction.recompute, "recompute_paper", at_once)


def test_reproduce_prints_every_printed_and_recomputed_energy(call, reproduced, reproduction):
    code, out, err = call("reproduce")
    assert (code, err) == (0, f"[1/{len(pieces_of_paper(seeds=1))}] the only solve\n")
    for number in (2, 3, 5, 6):
        assert f"Table {number}: " in out
    for row in ROWS:
        assert f" {row.energy:.4g} " in out
    for result in reproduction.rows:
        assert f" {result.in_box.energy:.4g} " in out
        assert f" {result.free.energy:.4g} " in out
    for claim in ("Two terms suffice", "More terms", "above six", "beats refs [23] and [24]"):
        assert claim in out
