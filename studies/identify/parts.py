"""Each ring-down of a recording fitted alone, or all of it by its joint's motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise, product
from math import tau
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.models import Plant
from quietarm.models.joint_motion import ROTARY
from quietarm.studies.identify.amplitudes import spread_of
from quietarm.studies.identify.diagnosis import doubt, doubt_of, exceeds, saturated
from quietarm.studies.identify.fitting import Fit, Model, fit
from quietarm.studies.identify.joint_spline import smooth
from quietarm.studies.identify.machine import Part, bounds_of, is_frequency, is_modal, values_of
from quietarm.studies.identify.recording import LEAST_ROWS, Recording, noise_of
from quietarm.studies.identify.response import Driven, Forced, FreeDecay, response_of
from quietarm.studies.identify.ring_downs import LEAST_PERIODS, find_ring_downs, moves
from quietarm.studies.identify.well_damped import find_well_damped
from quietarm.studies.identify.words import say

Array = NDArray[np.float64]
_PER_PERIOD = 64
"""Samples a period of the fastest mode; more are averaged."""
_ROUGHLY = 16
"""The same where starts are compared."""
_HELPS = 0.9
"""The hub is part of the model where what is left falls below this share by it."""
_MET = 0.05
"""Share of a whole recording that its joint's motion may leave, to be better than ring-downs."""
_HUB = 0.015
"""Of a frequency, that a hub which swings with the tip may shift it."""
_FACTORS = np.geomspace(0.5, 2, 15)
"""Of a frequency, from the best of which whole recordings are fitted."""
_MORE = 2.0
"""Times the noise that is left, from which on a delay of the angle matters."""
_SLOW = 0.25
"""Of the swing's frequency: slower motions are taken for drift."""
_FAR = 4.0
"""A quarter of a period belongs to a swing where it leaves less than so many times the usual."""
_INFLATED, _UNSURE = 20.0, 1e-3
"""Factor on a frequency's deviation, and that deviation as a share: beyond both the hub's share in
the frequency is not identifiable."""
_MUCH_DAMPING = 0.12
"""More than a held beam has, that turns; a controller that gives way damps like that."""
_DAMPINGS = (0.002, 0.01, 0.03, 0.08, 0.2, 0.4)
_SAME_SWING = 1.25
"""Times what is left of parts by themselves, that one swing may leave of them."""
_ALONG = 0.003
"""Misfit beside the noise, from which on pieces of a swing are fitted alone."""
_PIECE, _PIECES = 3.0, 12
"""Periods of such a piece, at least, and how many there are, at most."""
_SMALL = 1 / 8
"""Of the largest amplitude, below which friction alone is seen."""
_LOST = 0.3
"""Noise of a piece as a share of its swing, from which on the piece tells nothing."""
_MUCH = 0.1
"""Misfit beside the noise that a swing may have to be called met."""
_WELL = 0.06
"""Damping, from which on a swing is over too soon for an envelope to show it."""
_POOR = 0.2
"""Misfit, from which on a swing may be one that is damped well."""
_STARTS = 2
"""Of whole recordings."""


class PartFitter:
    """Fits of the parts of one recording, that swings at a frequency.

    Parameters
    ----------
    plant : Plant
        Its equations, and the values of what is not sought.
    names : sequence of str
        The parameters that are sought.
    recording : Recording
        What was measured.
    frequency : float
        Of its swing [Hz].
    """

    def __init__(
        self, plant: Plant, names: Sequence[str], recording: Recording, frequency: float
    ) -> None:
        self.plant, self.names, self.recording = plant, list(names), recording
        self.frequency = frequency
        kinds = [kind for kind, values in recording.signals.items() for _ in values.T]
        self._response = response_of(plant, tuple(names), tuple(kinds))
        self._given = values_of(plant, names)
        self._splines = dict[tuple[float, float], Any]()
        self._rates = np.array([is_frequency(plant, name) for name in names])
        modal = np.array([is_modal(plant, name) for name in names])
        self._dampings = modal & ~self._rates
        self._scaled = "torque" not in kinds and bool(modal.all())
        self._modes = self._response.eigenvalues(self._given)[0].imag

    def of(self, names: Sequence[str]) -> PartFitter:
        """The fits of the same recording with other parameters sought."""
        return PartFitter(self.plant, names, self.recording, self.frequency)

    def model(self, part: Part, thin: bool = True, per_period: float = _PER_PERIOD) -> Model:
        """The model of a part: without saturated samples, with drift or hub, as the part says.

        Where it is thinned it has so many samples a period of the fastest mode.
        """
        piece = whole = self._piece(part)
        fastest = self.frequency * float(self._modes[-1] / self._modes[0])
        if thin and not part.saturated:
            piece = piece.averaged(1 / max(per_period * fastest * piece.step, 1e-9))
        columns = FreeDecay(self._response, piece)
        if part.hub:
            spline, speed = self._spline(part, whole, fastest), tau * fastest
            columns = Driven(self._response, piece.time, spline, speed, self._scaled)
            if self._scaled and self._response.is_linear:
                columns = Forced(self._response, piece.time, spline, speed)
        cosines = int(2 * _SLOW * self.frequency * np.ptp(piece.time)) if part.drifts else 0
        model = Model(piece, columns, cosines, self._scaled)
        if part.saturated:
            model.kept = ~saturated(piece.values)
            if part.values:  # by the fit: near the limit the noise is cut as well
                model.kept = ~saturated(piece.values, model.fitted(part.vector))
        return model

    def _spline(self, part: Part, piece: Recording, fastest: float) -> Any:
        """The joint's motion in a part, smooth."""
        ends = (part.begin, part.end)
        if ends not in self._splines:
            count = 1 / max(_PER_PERIOD * fastest * piece.step, 1e-9)
            self._splines[ends] = smooth(piece.averaged(count))
        return self._splines[ends]

    def ring_downs(self, by_hand: Sequence[tuple[float, float]] = ()) -> tuple[list[Part], str]:
        """The ring-downs of the recording, or why there are none."""
        recording, frequency = self.recording, self.frequency
        parts, why = list[Part](), say("recording.silent")
        if frequency:
            parts, why = self._periodic(by_hand)
        if all(part.misfit > _POOR for part in parts):
            parts = self._well_damped(by_hand) or parts
        if moves(recording) and not by_hand:
            parts = self._with_hub(parts, slice(None))
        elif moves(recording):
            parts = [one for part in parts for one in self._with_hub([part], self._rows(part))]
        return parts, "" if parts else why

    def _periodic(self, by_hand: Sequence[tuple[float, float]]) -> tuple[list[Part], str]:
        """Ring-downs of several periods, or why there are none."""
        recording, frequency = self.recording, self.frequency
        found = [recording.rows(*ends) for ends in by_hand]
        found = [rows for rows in found if rows.stop - rows.start >= LEAST_ROWS]
        parts, end, why = list[Part](), 0, _no_ring_down(recording, frequency)
        for rows in found if by_hand else find_ring_downs(recording, frequency):
            part = self._by_amplitude(self._ring_down(rows, end, bool(by_hand)), rows)
            end = rows.stop
            last = parts[-1] if parts and not by_hand else None
            if last and part.amplitude < last.amplitude and (whole := self._joined(last, part)):
                parts[-1] = whole
            elif part.misfit < 1 or by_hand:
                parts.append(part)
            else:
                ends = {"begin": part.begin, "end": part.end}
                why = say("recording.free", **ends, frequency=frequency)
        return parts, why

    def _well_damped(self, by_hand: Sequence[tuple[float, float]]) -> list[Part]:
        """Swings that are over after a period or two, of all of the recording or of parts of it."""
        usual, parts = self.frequency, list[Part]()
        spans = [self.recording.rows(*ends) for ends in by_hand] or [slice(None)]
        for span in spans:
            piece = self.recording.part(span)
            if moves(piece):
                continue
            swings = find_well_damped(piece)
            if by_hand and len(swings) > 1:  # a part by hand is one ring-down
                continue
            for rows, self.frequency in swings:
                ends = piece.time[[rows.start, rows.stop - 1]]
                part = self._part(self.recording.rows(*ends))
                starts = self._starts(self.frequency * _FACTORS)
                part, _ = self._met(part, min(starts, key=self.model(part).cost))
                damped = max(part.vector[self._dampings], default=0.0) > _WELL
                if damped and part.misfit < max(_POOR, 2 * part.noise):
                    parts.append(part)
        if not parts:
            self.frequency = usual
        return parts

    def whole(self, rows: slice = slice(None)) -> Part:
        """All of the recording, or some rows, by how the plant answers its joint's motion."""
        part = self._part(rows, hub="moves")
        starts = [self._given, *self._starts(self.frequency * _FACTORS)]
        roughly = self.model(part, per_period=_ROUGHLY)
        tried = [
            self._fit(roughly, part, start) for start in sorted(starts, key=roughly.cost)[:_STARTS]
        ]
        return self._met(part, min(tried, key=lambda fitted: fitted.misfit).p)[0]

    def sensitivities(self) -> Array:
        """How the whole recording would change by the given values, a column each.

        What amplitudes and trend can do instead does not count.
        """
        model = self.model(self._part(slice(None), hub="moves"))
        x = model.start(self._given)
        J = model.jacobian(x) / model.values.std(axis=0)[:, None, None]
        by_p, others = np.split(J.reshape(-1, len(x)), [model.count], axis=1)
        by_p -= others @ np.linalg.lstsq(others, by_p, rcond=None)[0]
        return by_p * np.where(self._given != 0, np.abs(self._given), 1e-2)

    def frequency_of(self, p: Array) -> float:
        """Frequency of the slowest mode [Hz] by some parameters."""
        return float(self._response.eigenvalues(p)[0][0].imag) / tau

    def _rows(self, part: Part) -> slice:
        return self.recording.rows(part.begin, part.end)

    def _piece(self, part: Part) -> Recording:
        return self.recording.part(self._rows(part))

    def _part(self, rows: slice, hub: str = "") -> Part:
        time = self.recording.time[rows]
        return Part(self.recording.name, float(time[0]), float(time[-1]), hub=hub)

    def _starts(self, frequencies: Array) -> list[Array]:
        """Frequencies and dampings from which fits may start, whichever mode swings."""
        return [
            np.where(self._dampings, damping, self._given)
            * np.where(self._rates, tau * frequency / mode, 1.0)
            for mode, frequency, damping in product(self._modes, frequencies, _DAMPINGS)
        ]

    def _ring_down(self, rows: slice, earliest: int, by_hand: bool) -> Part:
        """A ring-down fitted alone: grown to what it meets; then what helps its model is added."""
        part = self._part(rows)
        model = self.model(part, per_period=_ROUGHLY)
        near = self.frequency + np.linspace(-0.6, 0.6, 9) / float(np.ptp(model.time))
        starts = self._starts(np.maximum(near, 0.3 * self.frequency))
        part, best = self._met(part, min(starts, key=model.cost))
        for _ in range(0 if by_hand else 2):
            grown = self._grown(rows, best, earliest)
            if grown == rows:
                break
            rows = grown
            part, best = self._met(self._part(rows), best.p)
        piece = self._piece(part)
        flat = saturated(piece.values)
        if flat.any() and np.count_nonzero(~flat) > max(LEAST_ROWS, 0.1 * len(flat)):
            tried, other = self._met(replace(part, saturated=int(flat.sum()), values={}), best.p)
            tried, other = self._met(tried, other.p)
            if exceeds(piece.values, other.model.fitted(other.p), flat):
                part, best = tried, other
        if moves(piece) and not part.saturated:
            tried, other = self._met(replace(part, hub="creeps"), best.p)
            if (other.residual.std(axis=0) < _HELPS * best.residual.std(axis=0)).any():
                part, best = tried, other
        if part.cause == "drift":
            tried, _ = self._met(replace(part, drifts=True), best.p)
            part = part if tried.cause == "drift" else tried
        return part

    def _joined(self, first: Part, second: Part) -> Part | None:
        """Two parts as one ring-down, where one swing meets both: samples between them lack."""
        rows = slice(self._rows(first).start, self._rows(second).stop)
        if moves(self.recording.part(rows)):
            return None
        model = self.model(self._part(rows))
        start = min((first.vector, second.vector), key=model.cost)
        whole, best = self._met(self._part(rows), start)
        time = best.model.time
        for part in (first, second):
            alone = self.model(part)
            left = (alone.values - alone.fitted(part.vector)).std(axis=0)
            inside = (time >= part.begin) & (time <= part.end)
            if (best.residual[inside].std(axis=0) > _SAME_SWING * left).any():
                return None
        return whole

    def _by_amplitude(self, part: Part, rows: slice) -> Part:
        """A ring-down with what its parameters are along it, fitted where one value meets it.

        Pieces of it are fitted alone where all of it leaves more than noise; from the begin of the
        rows in which it was found, if a swing is there.
        """
        if part.misfit <= 1.5 * part.noise + _ALONG or part.hub or part.saturated:
            return part
        last = self._rows(part).stop
        pieces = self._pieces(slice(rows.start, last))
        if not pieces or pieces[0].begin > part.begin or pieces[0].unexplained > _MUCH:
            pieces = self._pieces(self._rows(part))
        spread = {name: ends for name in self.names if (ends := spread_of(pieces, name))}
        if not spread:
            return part
        found = part
        if part.unexplained > _MUCH:
            found = self._where_it_fits(part, pieces)
        if found.cause in ("", "amplitude", "misfit") and found.unexplained < _MUCH:
            changes = {"first": self._words(pieces[0]), "last": self._words(pieces[-1])}
            found = replace(found, **doubt("changes", misfit=part.misfit, **changes))
        return replace(found, spread=spread)

    def _pieces(self, rows: slice) -> list[Part]:
        """Pieces of some rows in order of time, each fitted alone, that stand out of noise."""
        pieces = list[Part]()
        periods = float(np.ptp(self.recording.time[rows])) * self.frequency
        count = min(int(periods / _PIECE), _PIECES)
        if count < 2:
            return []
        ends = np.linspace(rows.start, rows.stop, count + 1).astype(int)
        start = None
        for first, last in pairwise(ends):
            if last - first < LEAST_ROWS:
                return []
            piece = self._part(slice(first, last))
            if start is None:
                near = self.frequency * np.linspace(0.85, 1.15, 13)
                start = min(self._starts(near), key=self.model(piece).cost)
            piece, best = self._met(piece, start)
            if piece.noise < _LOST and piece.cause != "bound":
                pieces.append(piece)
                start = best.p
        largest = max((piece.amplitude for piece in pieces), default=0.0)
        return [piece for piece in pieces if piece.amplitude >= _SMALL * largest]

    def _where_it_fits(self, part: Part, pieces: Sequence[Part]) -> Part:
        """The longest end of a ring-down that one value of each parameter meets.

        What comes after the pieces is left out, and of these the last where it has to be.
        """
        for last in range(len(pieces), 1, -1):
            end, low, high, met = self._rows(pieces[last - 1]).stop, 1, last, None
            while low < high:  # the later it begins, the better it fits
                middle = (low + high) // 2
                rows = slice(self._rows(pieces[middle]).start, end)
                tried, _ = self._met(self._part(rows), pieces[last - 1].vector)
                if tried.unexplained <= _MUCH:
                    high, met = middle, tried
                else:
                    low = middle + 1
            if met:
                return replace(met, largest=pieces[0].amplitude)
        return part

    def _words(self, part: Part) -> str:
        """What a part is in a sentence: its frequency and damping, and at which amplitude."""
        damping = max(part.vector[self._dampings], default=0.0)
        return f"{self.frequency_of(part.vector):.4g} Hz and {damping:.2g} at {part.amplitude:.3g}"

    def _grown(self, rows: slice, best: Fit, earliest: int) -> slice:
        """The rows with those before that the same swing meets, without those it does not."""
        size = max(2, round(0.25 / (self.frequency * self.recording.step)))
        first = max(earliest, rows.start - 12 * size)
        wide = self.model(self._part(slice(first, rows.stop)), thin=False)
        left = wide.values - wide.fitted(best.p, np.arange(first, rows.stop) >= rows.start)
        count, inside = len(left) // size, (rows.stop - rows.start) // size
        blocks = (left[len(left) - count * size :] ** 2).sum(axis=1).reshape(count, size)
        power = blocks.mean(axis=1)
        usual = _FAR**2 * float(np.median(power[-inside:]))
        far = power >= max(usual, 1e-6 * float((best.swinging**2).sum(axis=1).mean()))
        begin = count - inside + min(8, inside // 3)  # at most two periods are lost
        begin = int(np.flatnonzero(far[:begin]).max(initial=-1)) + 1
        return slice(rows.stop - (count - begin) * size, rows.stop)

    def _with_hub(self, parts: list[Part], rows: slice) -> list[Part]:
        """The parts, or all of these rows where the hub swings with them and that meets it all.

        A hub that swings with the tip shifts the frequency (docs/plants.md).
        """
        if parts and not any(self._hub_swings(part) for part in parts):
            return parts
        whole = self.whole(rows)
        fails = whole.cause in ("bound", "hub")
        met = whole.misfit < max(_MET, 2 * whole.noise)
        if met and not fails and whole.cause != "delay":
            return [whole]
        held = self.frequency_of(whole.vector)

        def doubted(part: Part) -> bool:
            shifted = fails or abs(self.frequency_of(part.vector) / held - 1) > _HUB
            return shifted and not (part.warning or part.hub)

        return [replace(part, **doubt("hub.swings")) if doubted(part) else part
                for part in parts]  # fmt: skip

    def _hub_swings(self, part: Part) -> bool:
        """Whether the hub swings as the tip does in a part, by more than an encoder's noise."""
        piece = self._piece(part)
        assert piece.angle is not None
        swing = FreeDecay(self._response, piece)(part.vector)[0][0, :, :2]
        X = np.hstack([swing, np.vander(piece.time - piece.time[0], 2)])
        share, *_ = np.linalg.lstsq(X, piece.angle, rcond=None)
        noise = float(noise_of(piece.angle)[0])
        return float(np.hypot(*share[:2])) > max(8 * noise / len(piece.time) ** 0.5, noise / 2)

    def _fit(self, model: Model, part: Part, start: Array) -> Fit:
        ends = bounds_of(self.plant, self.names, start, part.end - part.begin)
        return fit(model, start, *ends, self.frequency)

    def _met(self, part: Part, start: Array) -> tuple[Part, Fit]:
        """A fit of a part as it says, and the part with what that says."""
        low, high = bounds_of(self.plant, self.names, start, part.end - part.begin)
        best = self._fit(self.model(part), part, start)
        piece, model = self._piece(part), best.model
        time = model.time[model.kept]
        size = np.maximum(np.sqrt((best.swinging**2).mean(axis=0)), 1e-300)
        thinned = (len(piece.time) / len(model.time)) ** 0.5
        noise = float((noise_of(piece.values) / thinned / size).max())
        room = np.minimum(best.p - low, high - best.p) / np.where(high < np.inf, high - low, 1.0)
        facts = {
            "values": dict(zip(self.names, best.p.tolist())),
            "deviations": dict(zip(self.names, best.deviations.tolist())),
            "amplitude": float(np.abs(best.swinging[time <= time[0] + 1 / self.frequency]).max()),
            "misfit": best.misfit, "noise": noise, "cause": "", "warning": "",
        }  # fmt: skip
        found = self._doubt(part, best, time, noise)
        if (room < 1e-6).any():
            found = doubt("bound", parameter=self.names[int(np.flatnonzero(room < 1e-6)[-1])])
        return replace(part, **facts | found), best

    def _doubt(self, part: Part, best: Fit, time: Array, noise: float) -> dict[str, str]:
        """Why a fit of a part is doubted; empty where it is not."""
        if best.delay and part.hub == "moves" and best.misfit > _MORE * noise:
            side = "late" if best.delay > 0 else "early"
            return doubt("delay", misfit=best.misfit, delay=abs(best.delay) * 1e3, side=side)
        unsure = (best.inflation > _INFLATED) & (best.deviations > _UNSURE * np.abs(best.p))
        if unsure[self._rates].any():
            return doubt("hub.hides")
        found = doubt_of(time, best.residual, best.swinging, self.frequency, noise)
        damping = float(best.p[self._dampings].max(initial=0.0))
        if not found and self.plant.joint == ROTARY and damping > _MUCH_DAMPING:
            remedy = "" if self.recording.angle is not None else ", or name its angle by --angle"
            return doubt("hub.damps", damping=damping, remedy=remedy)
        return found


def _no_ring_down(recording: Recording, frequency: float) -> str:
    lasts = float(np.ptp(recording.time)) * frequency
    few = f": it lasts {lasts:.2g} periods of {frequency:.3g} Hz" if lasts < LEAST_PERIODS else ""
    angle = "" if recording.angle is not None else ", or the joint's angle, too"
    return say("recording.short", few=few, angle=angle)
