"""A list of work: in order, announced, and what becomes of a piece that fails."""

import signal

import pytest
from quietarm.metaheuristics.sharing.pieces import InterruptedPiece, Listener, Piece
from quietarm.metaheuristics.sharing.running import run_pieces
from quietarm.ocp import QuietarmError, SolverFailedError
from quietarm.ocp.interrupts import note_interrupts


def failing(done, say):
    raise SolverFailedError("it would not")


WORK = [
    Piece("a", "first", lambda done, say: 1),
    Piece("b", "second", failing),
    Piece("c", "third", lambda done, say: done.answers["a"] + 1, after=("a",)),
]


def test_pieces_are_announced_in_order_and_see_what_was_done_before_them():
    begun = []
    done = run_pieces(WORK, Listener(begun.append), note=QuietarmError)
    assert begun == ["first", "second", "third"]
    assert done.answers == {"a": 1, "c": 2}
    assert {key: str(error) for key, error in done.failures.items()} == {"b": "it would not"}


def test_a_piece_that_fails_ends_the_work_unless_it_is_to_go_on():
    begun = []
    with pytest.raises(SolverFailedError, match="it would not"):
        run_pieces(WORK, Listener(begun.append))
    assert begun == ["first", "second"]


def stopping(done, say):
    raise KeyboardInterrupt


def in_part(done, say):
    raise InterruptedPiece("half of it")


def well_all_the_same(done, say):
    with note_interrupts():  # as work that keeps what it found
        signal.raise_signal(signal.SIGINT)
    return 2


def failing_of_it(done, say):
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
def test_ctrl_c_ends_the_work_and_keeps_what_was_done(work, answers, parts):
    begun = []
    three = [WORK[0], Piece("b", "second", work), Piece("c", "third", pytest.fail)]
    done = run_pieces(three, Listener(begun.append), note=QuietarmError)
    assert begun == ["first", "second"]
    assert done.stopped == "interrupted"
    assert (done.answers, done.parts, done.failures) == (answers, parts, {})
    assert done.number == len(answers)
