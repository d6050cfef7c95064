"""A list of work: in order, announced, and what becomes of a piece that fails."""

import signal

import pytest

from ocp import SolverFailedError
from ocp.base.interrupts import note_interrupts
from studies.methods import NSGA2, VEPSO
from studies.paper.printed import ARM_HALF
from studies.runs import pieces
from studies.runs.pieces import InterruptedPiece, Piece, run_pieces, searched


def failing(done):
    raise SolverFailedError("it would not")


WORK = [
    Piece("a", "first", lambda done: 1),
    Piece("b", "second", failing),
    Piece("c", "third", lambda done: done.answers["a"] + 1),
]


def test_pieces_are_announced_in_order_and_see_what_was_done_before_them():
    begun = []
    done = run_pieces(WORK, begun.append, go_on=True)
    assert begun == ["first", "second", "third"]
    assert done.answers == {"a": 1, "c": 2}
    assert {key: str(error) for key, error in done.failures.items()} == {"b": "it would not"}


def test_a_piece_that_fails_ends_the_work_unless_it_is_to_go_on():
    begun = []
    with pytest.raises(SolverFailedError, match="it would not"):
        run_pieces(WORK, begun.append)
    assert begun == ["first", "second"]


def test_what_is_no_failure_of_the_solver_always_ends_the_work():
    def raising(done):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        run_pieces([Piece("a", "first", raising)], lambda name: None, go_on=True)


def stopping(done):
    raise KeyboardInterrupt


def in_part(done):
    raise InterruptedPiece("half of it")


def well_all_the_same(done):
    with note_interrupts():  # as work that keeps what it found
        signal.raise_signal(signal.SIGINT)
    return 2


def failing_of_it(done):
    with note_interrupts():
        signal.raise_signal(signal.SIGINT)
    raise SolverFailedError("no solution")


@pytest.mark.parametrize(
    ("work", "answers", "parts"),
    [
        (stopping, {"a": 1}, {}),
        (in_part, {"a": 1}, {"b": "half of it"}),
        (well_all_the_same, {"a": 1, "b": 2}, {}),
        (failing_of_it, {"a": 1}, {}),
    ],
)
@pytest.mark.parametrize("go_on", [True, False])
def test_ctrl_c_ends_the_work_and_keeps_what_was_done(work, answers, parts, go_on):
    begun = []
    three = [WORK[0], Piece("b", "second", work), Piece("c", "third", pytest.fail)]
    done = run_pieces(three, begun.append, go_on=go_on)
    assert begun == ["first", "second"]
    assert done.interrupted
    assert (done.answers, done.parts, done.failures) == (answers, parts, {})
    assert done.number == len(answers)


def test_without_ctrl_c_nothing_is_interrupted():
    assert not run_pieces(WORK[:1], lambda name: None).interrupted


def test_a_search_is_given_the_case_and_its_settings(monkeypatch, front_of):
    asked = {}
    fronts = [front_of([(1, 0.2)]), front_of([(1, 0.3)], seed=1)]

    def note(task, method, runs, **settings):
        asked.update(task=task, method=method, runs=runs, **settings)
        return fronts

    monkeypatch.setattr(pieces, "search_many", note)
    assert searched(ARM_HALF, NSGA2, 4, 2, seed=3) == fronts
    assert asked.pop("profile").terms == 4
    assert asked == {
        "task": ARM_HALF.task, "method": "nsga2", "runs": 2, "bound": ARM_HALF.bound, "seed": 3
    }  # fmt: skip


@pytest.mark.parametrize("left", [1, 2])
def test_a_search_that_was_interrupted_ends_the_work(monkeypatch, front_of, left):
    cut = front_of([(1, 0.2)], "vepso", complete=False)
    whole = front_of([(1, 0.2)], "vepso")
    monkeypatch.setattr(pieces, "search_many", lambda *given, **_: [whole, cut][:left])
    with pytest.raises(InterruptedPiece) as stop:
        searched(ARM_HALF, VEPSO, 4, runs=2)
    assert stop.value.part == [whole, cut][:left]
