"""Least squares of a plant's parameters on recordings, and how sure they are.

What is unknown of every recording, its state at the start, offsets and the scale of its sensors, is
linear in the signals and eliminated by projection (Golub and Pereyra, SIAM J. Numer. Anal. 10,
1973, with the derivatives of Kaufman, BIT 15, 1975).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from quietarm.studies.identify.recording import Recording
from quietarm.studies.identify.response import Joint, Response

Array = NDArray[np.float64]
_ROUNDS, _ITERATIONS = 6, 30
"""Of weights, and of steps with the same weights."""
_SETTLED, _SAME_WEIGHTS = 1e-6, 2e-2
_LONGEST = 0.2
"""Step of a parameter, relative to its value at the start."""
_HUBER = 2.5
"""Residuals beyond so many deviations count by their size alone (Huber's)."""
_BLOCKS = 8
"""Of a piece, for the intervals."""
_DEPENDENT = 1e-3
"""Parameters cannot be told apart where others explain all but this share of what one does."""


@dataclass(frozen=True)
class Piece:
    """A recording or a part of one, with its joint's motion."""

    recording: Recording
    joint: Joint
    weights: Array

    @classmethod
    def of(cls, recording: Recording, joint: Joint) -> Piece:
        """All samples count alike."""
        return cls(recording, joint, np.ones(measured(recording).shape))


@dataclass(frozen=True)
class Left:
    """What parameters leave of a piece.

    Attributes
    ----------
    fitted : array, shape (rows, signals)
        The nearest signals of the plant.
    residual : array, likewise
        Measured less fitted, weighted.
    slopes : array, shape (parameters, rows, signals)
        Derivatives of the residual.
    """

    fitted: Array
    residual: Array
    slopes: Array


def measured(recording: Recording) -> Array:
    """Its signals side by side."""
    return np.hstack(list(recording.signals.values()))


def left(response: Response, piece: Piece, p: Array, scaled: bool) -> Left:
    """What parameters leave of a piece; where `scaled`, the scale of its sensors is unknown."""
    columns, slopes = response.over(piece.recording, piece.joint, p)
    y, w = measured(piece.recording), piece.weights
    scaled = scaled and bool(columns[:, :, 0].any())
    known = columns[:, :, 0] * (not scaled)
    unknown = [*np.moveaxis(columns[:, :, 0 if scaled else 1 :], 2, 0)]
    among = len(unknown)
    of_signal = np.eye(y.shape[1])
    unknown += [np.broadcast_to(row, y.shape) for row in of_signal]
    if columns[:, :, 0].any():  # how far from the axis an accelerometer is
        turning = piece.joint.at(piece.recording.time)[2][:, None]
        unknown += [turning * row for row in of_signal[response.kinds == "acceleration"]]
    basis, solved = _projector(np.stack([(one * w).ravel() for one in unknown], axis=1))
    target = ((y - known) * w).ravel()
    share = solved(target)[:among]
    residual = target - basis @ (basis.T @ target)
    change: Array = np.tensordot(slopes[..., 0 if scaled else 1 :], share, axes=(3, 0))
    change = change + slopes[..., 0] * (not scaled)
    D = (change * w).reshape(len(p), -1).T
    D = basis @ (basis.T @ D) - D
    residual = residual.reshape(y.shape)
    return Left(y - residual / w, residual, D.T.reshape(-1, *y.shape))


def _projector(A: Array) -> tuple[Array, Callable[[Array], Array]]:
    """An orthonormal basis of the columns, and a function that solves for their shares."""
    scale = np.linalg.norm(A, axis=0)
    scale[scale == 0] = 1.0
    U, s, Vt = np.linalg.svd(A / scale, full_matrices=False)
    rank = np.count_nonzero(s > 1e-9 * s[0])
    U, s, Vt = U[:, :rank], s[:rank], Vt[:rank]
    return U, lambda b: (Vt.T @ ((U.T @ b) / s)) / scale


def reweighed(piece: Piece, part: Left) -> Piece:
    """Weights by the deviation of every signal, less for what lies far off."""
    plain = part.residual / piece.weights
    spread = np.sqrt((plain**2).mean(axis=0))
    robust = 1.4826 * np.median(np.abs(plain), axis=0)  # of the normal distribution
    deviation = np.clip(robust, 0.1 * spread, spread) + 1e-300
    far = np.maximum(np.abs(plain) / (_HUBER * deviation), 1.0)
    return replace(piece, weights=1 / (deviation * np.sqrt(far)))


@dataclass(frozen=True)
class Fit:
    """Parameters of least squares.

    Attributes
    ----------
    p : array
        The parameters.
    parts : list of Left
        What they leave of every piece.
    pieces : list of Piece
        With the weights at the end.
    """

    p: Array
    parts: list[Left]
    pieces: list[Piece]

    @property
    def slopes(self) -> Array:
        """Derivatives of all residuals, a row a parameter."""
        return np.hstack([one.slopes.reshape(len(self.p), -1) for one in self.parts])

    @property
    def residual(self) -> Array:
        """All residuals."""
        return np.concatenate([one.residual.ravel() for one in self.parts])

    @property
    def cost(self) -> float:
        """Sum of squares."""
        return float(self.residual @ self.residual)

    def half_widths(self, level: float) -> Array:
        """Half of the interval of every parameter that covers the truth at a level.

        By the residuals as white noise, or by what blocks of them pull in common, whichever is
        wider: a block is a stretch of time with an eighth of what a piece tells of the parameter,
        and the blocks' pulls are as good as independent (Bester, Conley and Hansen, J. Econometrics
        165, 2011, with Student's t of as many blocks).
        """
        from scipy.stats import t  # not at the top: it takes long to load

        J, r = self.slopes.T, self.residual
        white = float(r @ r) / max(len(r) - len(self.p), 1)
        ends = np.cumsum([one.residual.size for one in self.parts])[:-1]
        quantile, found = (1 + level) / 2, list[float]()
        for k in range(len(self.p)):
            others = np.delete(J, k, axis=1)
            share, *_ = np.linalg.lstsq(others, J[:, k], rcond=None)
            own = J[:, k] - others @ share
            told = float(own @ own)
            pulls = np.concatenate(
                [
                    _block_sums(own_part**2, own_part * r_part)
                    for own_part, r_part in zip(np.split(own, ends), np.split(r, ends), strict=True)
                ]
            )
            count = len(pulls)
            by_blocks = (pulls @ pulls * count / (count - 1)) ** 0.5 / told
            found.append(max(
                float(t.ppf(quantile, count - 1)) * by_blocks,
                float(t.ppf(quantile, len(r) - len(self.p))) * (white / told) ** 0.5,
            ))  # fmt: skip
        return np.array(found)


def _block_sums(information: Array, pull: Array) -> Array:
    """Sums of a pull over blocks of equal information."""
    before = np.cumsum(information) / information.sum()
    block = np.minimum((before * _BLOCKS).astype(int), _BLOCKS - 1)
    return np.bincount(block, pull, _BLOCKS).astype(float)


def fit(response: Response, pieces: Sequence[Piece], start: Array, scaled: bool) -> Fit:
    """Levenberg and Marquardt's method; weights are renewed until they stay."""

    def at(p: Array, pieces: Sequence[Piece]) -> Fit:
        return Fit(p, [left(response, one, p, scaled) for one in pieces], list(pieces))

    scale = np.where(start != 0, np.abs(start), 1e-2)
    now = at(np.array(start, float), pieces)
    for _ in range(_ROUNDS):
        now = _minimised(at, now, scale)
        pieces = [reweighed(*each) for each in zip(now.pieces, now.parts, strict=True)]
        changes = [
            np.abs(after.weights / before.weights - 1).max()
            for after, before in zip(pieces, now.pieces, strict=True)
        ]
        if max(changes) < _SAME_WEIGHTS:
            break
        now = at(now.p, pieces)
    return now


def _minimised(at: Callable[[Array, Sequence[Piece]], Fit], now: Fit, scale: Array) -> Fit:
    damping = 1e-3
    for _ in range(_ITERATIONS):
        J, r = now.slopes * scale[:, None], now.residual
        H, g = J @ J.T, J @ r
        while True:
            damped = H + damping * np.diag(np.diag(H)) + 1e-14 * np.trace(H) * np.eye(len(H))
            change = np.clip(-np.linalg.solve(damped, g), -_LONGEST, _LONGEST)
            tried = at(now.p + scale * change, now.pieces)
            if tried.cost <= now.cost:
                break
            damping *= 10
            if damping > 1e10:
                return now
        settled = np.abs(change).max() < _SETTLED
        now, damping = tried, max(damping / 10, 1e-10)
        if settled:
            break
    return now


def not_told(response: Response, pieces: Sequence[Piece], p: Array, scaled: bool) -> dict[str, str]:
    """The parameters that the pieces cannot tell, in their order, and why."""
    J = Fit(p, [left(response, one, p, scaled) for one in pieces], list(pieces)).slopes.T
    J = J * np.where(p != 0, np.abs(p), 1e-2)
    largest = np.linalg.norm(J, axis=0).max()
    kept: list[int] = []
    cannot: dict[str, str] = {}
    for k, name in enumerate(response.names):
        size = np.linalg.norm(J[:, k])
        if size <= 1e-9 * largest:
            cannot[name] = "nothing that was recorded depends on it"
            continue
        if kept:
            share, *_ = np.linalg.lstsq(J[:, kept], J[:, k], rcond=None)
            if np.linalg.norm(J[:, k] - J[:, kept] @ share) < _DEPENDENT * size:
                like = response.names[kept[int(np.abs(share).argmax())]]
                cannot[name] = f"it does what {like} does"
                continue
        kept.append(k)
    return cannot
