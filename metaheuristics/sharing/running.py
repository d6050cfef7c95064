"""A list of work, run piece by piece here or shared by workers."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from quietarm.metaheuristics.sharing.pieces import (
    INTERRUPTED,
    Done,
    InterruptedPiece,
    Listener,
    Piece,
    Say,
)
from quietarm.metaheuristics.sharing.workers import HERE, Workers
from quietarm.ocp import QuietarmError
from quietarm.ocp.interrupts import hear_interrupts


def run_pieces(
    pieces: Sequence[Piece],
    listener: Listener | None = None,
    *,
    workers: Workers = HERE,
    note: type[QuietarmError] | tuple[()] = (),
) -> Done:
    """Run pieces of work until Ctrl-C."""
    listener = Listener() if listener is None else listener
    if workers.here or workers.local(len(pieces)) == 1:
        return _one_after_another(pieces, listener, note)
    # Not at the top: dask is an extra, and takes longer to load than all of quietarm.
    from quietarm.metaheuristics.sharing.sharing import share

    return share(pieces, listener, workers, note)


def _one_after_another(
    pieces: Sequence[Piece], listener: Listener, note: type[QuietarmError] | tuple[()]
) -> Done:
    done = Done()
    with hear_interrupts() as came:
        for piece in pieces:
            try:
                listener.begin(piece.name)
                say = Say(partial(listener.report, piece.key))
                answer = piece.work(done.of(piece.after), say)
                done.answers[piece.key] = answer
                listener.ended(piece.key, answer)
            except QuietarmError as error:
                if not isinstance(error, note) and not came:
                    raise
                if not came:  # else it may have failed of that
                    done.failures[piece.key] = error
            except KeyboardInterrupt as stop:
                done.stopped = INTERRUPTED
                if isinstance(stop, InterruptedPiece):
                    done.parts[piece.key] = stop.part
            if came:  # a piece that ended well in spite of Ctrl-C raises nothing
                done.stopped = INTERRUPTED
            if done.stopped:
                break
    return done
