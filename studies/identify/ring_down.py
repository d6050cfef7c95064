"""Each ring-down of a recording fitted alone, and whether the model is right for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import tau

import numpy as np
from numpy.typing import NDArray
from quietarm.models import Plant
from quietarm.studies.identify.answer import Part
from quietarm.studies.identify.diagnosis import cause_of, exceeds, saturated
from quietarm.studies.identify.parameters import bounds_of, is_frequency, values_of
from quietarm.studies.identify.parts import LEAST_PERIODS, moves, ring_downs, standing
from quietarm.studies.identify.recording import LEAST_ROWS, Recording, noise_of
from quietarm.studies.identify.swing import Eigenvalues, Swing, Window, cost_of, fit_swing

Array = NDArray[np.float64]
_HELPS = 0.9
"""The hub is part of the model where what is left falls below this share by it."""
_MET = 0.05
"""Share of a whole recording that its joint's motion may leave, to be better than ring-downs."""
_HUB = 0.03
"""Share of a swing that the hub's own swing may feed: the frequency is off by half of it."""
_FACTORS = np.geomspace(0.5, 2, 40)
"""Of a frequency, from the best of which whole recordings are fitted."""
_SLOW = 0.25
"""Of the swing's frequency: slower motions are taken for drift."""
_FAR = 4.0
"""A quarter of a period belongs to a swing where it leaves less than so many times the usual."""
_DAMPINGS = (0.002, 0.01, 0.03, 0.08, 0.2, 0.4)


class RingDowns:
    """Fits of free decays by a plant's eigenvalues.

    Parameters
    ----------
    plant : Plant
        Its equations.
    names : sequence of str
        Frequencies and dampings that are sought.
    """

    def __init__(self, plant: Plant, names: Sequence[str]) -> None:
        self.plant, self.names = plant, list(names)
        self._eigenvalues = Eigenvalues(plant, names)
        self._given = values_of(plant, names)
        self._rates = np.array([is_frequency(plant, name) for name in names])
        self._modes, _ = self._eigenvalues(self._given)

    def fit(
        self, recording: Recording, frequency: float, by_hand: Sequence[tuple[float, float]] = ()
    ) -> tuple[list[Part], str]:
        """The ring-downs of a recording that swings at a frequency [Hz]; or why there are none."""
        if not frequency:
            return [], "no swing stands out of the noise"
        if by_hand:
            found = [recording.rows(*ends) for ends in by_hand]
            found = [rows for rows in found if rows.stop - rows.start >= LEAST_ROWS]
        else:
            found = ring_downs(recording, frequency, standing(recording, frequency))
        parts: list[Part] = []
        end, why = 0, _no_ring_down(recording, frequency)
        for rows in found:
            part = self._part(recording, rows, frequency, end, fixed=bool(by_hand))
            end = rows.stop
            if part.misfit < 1 or by_hand:
                parts.append(part)
            else:
                why = f"{part.begin:.3g} to {part.end:.3g} s is no free decay of {frequency:.3g} Hz"
        if not by_hand and moves(recording) and "acceleration" not in recording.signals:
            parts = self._with_hub(recording, parts, frequency)
        return parts, "" if parts else why

    def again(self, part: Part, recording: Recording) -> Swing:
        """The fit of a part, as it was made."""
        piece = recording.part(recording.rows(part.begin, part.end))
        return self._fit_as(part, piece, np.array(list(part.values.values())))

    def _fit_as(self, part: Part, piece: Recording, start: Array) -> Swing:
        """A fit without saturated samples, with drift or hub, as a part says."""
        values, _ = self._eigenvalues(start)
        fastest, slowest = values[-1].imag / tau, values[0].imag / tau
        slow = _SLOW * slowest if part.drifts else 0.0
        if not part.saturated:
            return self._fit(Window.of(piece, fastest, slow, bool(part.hub)), start)
        flat = saturated(piece.values)
        # the second time by the fit: near the limit the noise is cut as well
        first = self._fit(Window.of(piece.part(~flat), trend=slow), start)
        flat = saturated(piece.values, first.at(piece.time))
        return self._fit(Window.of(piece.part(~flat), trend=slow), start)

    def _fit(self, window: Window, start: Array) -> Swing:
        ends = bounds_of(self.plant, self.names, start)
        return fit_swing(window, self._eigenvalues, start, *ends)

    def _start(self, window: Window, frequencies: Array) -> Array:
        """The best of a grid of frequencies and dampings, whichever mode swings."""
        grid: list[Array] = []
        for mode in self._modes:
            for frequency in frequencies:
                for damping in _DAMPINGS:
                    p = self._given.copy()
                    p[self._rates] *= tau * frequency / mode.imag
                    p[~self._rates] = damping
                    grid.append(p)
        return min(grid, key=lambda p: cost_of(window, self._eigenvalues, p))

    def _part(
        self, recording: Recording, rows: slice, frequency: float, before: int, fixed: bool
    ) -> Part:
        """A ring-down fitted alone: grown to what it meets; then what helps its model is added."""
        fastest = frequency * float(self._modes[-1].imag / self._modes[0].imag)
        window = Window.of(recording.part(rows), fastest)
        near = frequency + np.linspace(-0.6, 0.6, 9) / float(np.ptp(window.time))
        fit = self._fit(window, self._start(window, np.maximum(near, 0.3 * frequency)))
        for _ in range(0 if fixed else 2):
            grown = _grown(recording, rows, fit, before, frequency)
            if grown == rows:
                break
            rows, fit = grown, self._fit(Window.of(recording.part(grown), fastest), fit.p)
        piece = recording.part(rows)
        part = self._described(Part(piece.name, piece.time[0], piece.time[-1]), piece, fit)
        flat = saturated(piece.values)
        if flat.any() and np.count_nonzero(~flat) > max(LEAST_ROWS, 0.1 * len(flat)):
            tried = replace(part, saturated=int(np.count_nonzero(flat)))
            other = self._fit_as(tried, piece, fit.p)
            if exceeds(piece.values, other.at(piece.time), flat):
                part, fit = self._described(tried, piece, other), other
        if moves(piece) and "acceleration" not in recording.signals and not part.saturated:
            tried = replace(part, hub="creeps")
            other = self._fit_as(tried, piece, fit.p)
            if (other.residual.std(axis=0) < _HELPS * fit.residual.std(axis=0)).any():
                part, fit = self._described(tried, piece, other), other
        if part.cause == "drift":
            tried = replace(part, drifts=True)
            other = self._fit_as(tried, piece, fit.p)
            tried = self._described(tried, piece, other)
            part = part if tried.cause == "drift" else tried
        return part

    def _with_hub(self, recording: Recording, parts: list[Part], frequency: float) -> list[Part]:
        """The parts, or the whole recording where the hub swings with them and that meets it all.

        A mode that feels c times the hub's acceleration swings, where the hub swings by rho times
        its displacement, with |1 + c rho| times the square of the held frequency (docs/plants.md).
        """
        swinging = [(part, self._hub_swing(part, recording)) for part in parts]
        if parts and not any(abs(ratio) for _, ratio in swinging):
            return parts
        window = Window.of(recording, 2 * frequency, hub=True)
        fit = self._fit(window, self._start(window, frequency * _FACTORS))
        gains = fit.amplitudes[2 : 3 * len(self._modes) : 3, 0]
        fed = [(part, float(np.abs(gains).max() * abs(ratio))) for part, ratio in swinging]
        if parts and max(share for _, share in fed) < _HUB:
            return parts
        if fit.misfit < _MET:
            blank = Part(recording.name, recording.time[0], recording.time[-1], hub="moves")
            return [self._described(blank, recording, fit)]
        return [
            part if share < _HUB or part.warning else replace(part, cause="hub", warning=(
                f"the hub swings with the tip, by about {share:.0%} of what the tip does, so that "
                "the frequency is not that of a held hub: hold it, by a brake or a stiffer "
                "controller"
            ))
            for part, share in fed
        ]  # fmt: skip

    def _hub_swing(self, part: Part, recording: Recording) -> complex:
        """What the hub swings by in a part, over what the tip does; 0 for an encoder's noise."""
        piece = recording.part(recording.rows(part.begin, part.end))
        assert piece.angle is not None
        value = self._eigenvalues(np.array(list(part.values.values())))[0][0]
        time = piece.time - piece.time[0]
        swing = np.exp(value * time)
        X = np.stack([swing.real, swing.imag, np.ones_like(time), time], axis=1)
        share, *_ = np.linalg.lstsq(
            X, np.column_stack([piece.angle, piece.values[:, 0]]), rcond=None
        )
        hub, tip = (complex(share[0, k], -share[1, k]) for k in range(2))
        noise = float(noise_of(piece.angle)[0])
        least = max(8 * noise / len(time) ** 0.5, noise / 2)
        return hub / tip if abs(hub) > least else 0j

    def _described(self, part: Part, piece: Recording, fit: Swing) -> Part:
        """The part with what a fit of it says."""
        size = np.maximum(np.sqrt((fit.swinging**2).mean(axis=0)), 1e-300)
        thinned = (len(piece.time) / len(fit.window.time)) ** 0.5
        noise = float((noise_of(piece.values) / thinned / size).max())
        first = fit.window.time <= 1 / fit.frequency
        deviations = np.sqrt(np.diag(fit.covariance))
        cause, warning = cause_of(fit.window.time, fit.residual, fit.swinging, fit.frequency, noise)
        return replace(
            part,
            values=dict(zip(self.names, map(float, fit.p), strict=True)),
            deviations=dict(zip(self.names, map(float, deviations), strict=True)),
            amplitude=float(np.abs(fit.swinging[first]).max()),
            misfit=fit.misfit,
            noise=noise,
            cause=cause,
            warning=warning,
        )


def _no_ring_down(recording: Recording, frequency: float) -> str:
    lasts = float(np.ptp(recording.time)) * frequency
    few = f": it lasts {lasts:.2g} periods of {frequency:.3g} Hz" if lasts < LEAST_PERIODS else ""
    held = "" if recording.angle is not None else ", or the joint's angle, too"
    return f"no ring-down of two periods{few}; record longer after a push{held}"


def _grown(recording: Recording, rows: slice, fit: Swing, before: int, frequency: float) -> slice:
    """The rows with those before that the same swing meets, and without those that it does not."""
    size = max(2, round(0.25 / (frequency * recording.step)))
    earliest = max(before, rows.start - 12 * size)
    left = recording.values[earliest : rows.stop] - fit.at(recording.time[earliest : rows.stop])
    count = len(left) // size
    blocks = (left[len(left) - count * size :] ** 2).sum(axis=1).reshape(count, size).mean(axis=1)
    inside = (rows.stop - rows.start) // size
    usual = _FAR**2 * float(np.median(blocks[-inside:]))
    good = blocks < max(usual, 1e-6 * float((fit.swinging**2).sum(axis=1).mean()))
    first = count - inside + min(8, inside // 3)  # at most two periods are lost
    while first > 0 and good[first - 1]:
        first -= 1
    return slice(rows.stop - (count - first) * size, rows.stop)
