"""Fits of one part of a recording: its model, where fits start, and what is doubted of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from math import tau
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.fits.columns import BasisColumns, Driven, Forced, FreeDecay
from quietarm.machine.identify.fits.diagnosis import doubt_of, saturated
from quietarm.machine.identify.fits.fitting import Fit, fit
from quietarm.machine.identify.fits.response import response_of
from quietarm.machine.identify.fits.swing_model import SwingModel
from quietarm.machine.identify.identified import Part, bounds_of, is_frequency, is_modal, values_of
from quietarm.machine.recordings.fitted_spline import smooth
from quietarm.machine.recordings.recording import Recording, noise_of
from quietarm.models import Plant
from quietarm.models.joint_motion import ROTARY

Array = NDArray[np.float64]
SAMPLES = 64
"""A period of the fastest mode; more are averaged."""
FEW_SAMPLES = 16
"""The same where starts are compared."""


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
        self.plant = plant
        self.names = list(names)
        self.recording = recording
        self.frequency = frequency
        kinds = [kind for kind, values in recording.signals.items() for _ in values.T]
        self.response = response_of(plant, tuple(names), tuple(kinds))
        self.of_plant = values_of(plant, names)
        self.are_rates = np.array([is_frequency(plant, name) for name in names])
        are_modal = np.array([is_modal(plant, name) for name in names])
        self.are_dampings = are_modal & ~self.are_rates
        self._scaled = "torque" not in kinds and bool(are_modal.all())
        self._modes = self.response.eigenvalues(self.of_plant)[0].imag
        self._splines = dict[tuple[float, float], Any]()

    @property
    def frequencies(self) -> Array:
        """Frequencies of the plant's modes as they are given, with the joint at rest [Hz]."""
        return np.asarray(self._modes, float) / tau

    def of(self, names: Sequence[str]) -> PartFitter:
        """The fits of the same recording with other parameters sought."""
        return PartFitter(self.plant, names, self.recording, self.frequency)

    def part(self, rows: slice, hub: str = "") -> Part:
        """Some rows as a part that is not fitted yet."""
        time = self.recording.time[rows]
        return Part(self.recording.name, float(time[0]), float(time[-1]), hub=hub)

    def rows(self, part: Part) -> slice:
        """The rows of a part."""
        return self.recording.rows(part.begin, part.end)

    def piece(self, part: Part) -> Recording:
        """The samples of a part."""
        return self.recording.part(self.rows(part))

    @property
    def fastest(self) -> float:
        """Frequency of the fastest mode, where the slowest is that of the swing [Hz]."""
        return self.frequency * float(self._modes[-1] / self._modes[0])

    def thinned(self, piece: Recording, samples: float = SAMPLES) -> Recording:
        """A piece with so many samples a period of the fastest mode."""
        return piece.averaged(1 / max(samples * self.fastest * piece.step, 1e-9))

    def model(self, part: Part, thin: bool = True, samples: float = SAMPLES) -> SwingModel:
        """The model of a part: without saturated samples, with drift or hub, as the part says.

        Where it is thinned it has so many samples a period of the fastest mode.
        """
        whole = self.piece(part)
        piece = self.thinned(whole, samples) if thin and not part.saturated else whole
        columns: BasisColumns = FreeDecay(self.response, piece)
        if part.hub:
            columns = self._with_joint(part, whole, piece)
        cosines = 0
        if part.drifts:
            cosines = int(0.5 * self.frequency * np.ptp(piece.time))  # to a quarter of the swing's
        model = SwingModel(piece, columns, cosines, self._scaled)
        if part.saturated:
            model.counts = ~saturated(piece.values)
            if part.values:  # by the fit: near the limit the noise is cut as well
                model.counts = ~saturated(piece.values, model.fitted(part.vector))
        return model

    def _with_joint(self, part: Part, whole: Recording, piece: Recording) -> BasisColumns:
        """The columns of a piece whose joint moves as all samples of the part say."""
        ends = (part.begin, part.end)
        if ends not in self._splines:
            self._splines[ends] = smooth(self.thinned(whole))
        spline = self._splines[ends]
        fastest = tau * self.fastest
        if self._scaled and self.response.is_linear:
            return Forced(self.response, piece.time, spline, fastest)
        return Driven(self.response, piece.time, spline, fastest, self._scaled)

    def starts(self, frequencies: Array) -> list[Array]:
        """Frequencies and dampings from which fits may start, whichever mode swings."""
        dampings = (0.002, 0.01, 0.03, 0.08, 0.2, 0.4)
        starts = list[Array]()
        for mode, frequency, damping in product(self._modes, frequencies, dampings):
            with_damping = np.where(self.are_dampings, damping, self.of_plant)
            factors = np.where(self.are_rates, tau * frequency / mode, 1.0)
            starts.append(with_damping * factors)
        return starts

    def frequency_of(self, p: Array) -> float:
        """Frequency of the slowest mode [Hz] by some parameters."""
        return float(self.response.eigenvalues(p)[0][0].imag) / tau

    def damping_of(self, part: Part) -> float:
        """The largest damping ratio of a part; 0 where none is sought."""
        return max(part.vector[self.are_dampings], default=0.0)

    def fit_model(self, model: SwingModel, part: Part, start: Array) -> Fit:
        """A fit of some model of a part."""
        lower, upper = bounds_of(self.plant, self.names, start, part.end - part.begin)
        return fit(model, start, lower, upper, self.frequency)

    def fit(self, part: Part, start: Array) -> tuple[Part, Fit]:
        """A fit of a part as it says, and the part with what that says."""
        best = self.fit_model(self.model(part), part, start)
        time = best.model.time[best.model.counts]
        first_period = time <= time[0] + 1 / self.frequency
        noise = self._noise(part, best)
        facts: dict[str, Any] = {
            "values": dict(zip(self.names, best.p.tolist())),
            "deviations": dict(zip(self.names, best.deviations.tolist())),
            "amplitude": float(np.abs(best.swinging[first_period]).max()),
            "misfit": best.misfit,
            "noise": noise,
            "cause": "",
            "warning": "",
        }
        doubts = self._at_bound(part, best, start) or self._doubt(part, best, time, noise)
        return replace(part, **facts | doubts), best

    def _noise(self, part: Part, best: Fit) -> float:
        """The recording's own noise as a share of the swing, of the signal that has most."""
        piece = self.piece(part)
        size = np.maximum(np.sqrt((best.swinging**2).mean(axis=0)), 1e-300)
        thinned = (len(piece.time) / len(best.model.time)) ** 0.5
        return float((noise_of(piece.values) / thinned / size).max())

    def _at_bound(self, part: Part, best: Fit, start: Array) -> dict[str, str]:
        """Warn of a parameter that ends at the bound of its search; empty where none does."""
        lower, upper = bounds_of(self.plant, self.names, start, part.end - part.begin)
        width = np.where(upper < np.inf, upper - lower, 1.0)
        room = np.minimum(best.p - lower, upper - best.p) / width
        at_bound = np.flatnonzero(room < 1e-6)
        if not len(at_bound):
            return {}
        warning = (
            f"{self.names[int(at_bound[-1])]} ends at the bound of its search: the model does not "
            "fit; begin after the release, by --part, or hold the joint"
        )
        return {"cause": "bound", "warning": warning}

    def _doubt(self, part: Part, best: Fit, time: Array, noise: float) -> dict[str, str]:
        """Say why a fit of a part is doubted; empty where it is not."""
        if best.delay and part.hub == "moves" and best.misfit > 2 * noise:
            side = "late" if best.delay > 0 else "early"
            warning = (
                f"the misfit is {best.misfit:.1%} of the swing, less if the angle were not "
                f"{1e3 * abs(best.delay):.3g} ms {side}: record both by one clock"
            )
            return {"cause": "delay", "warning": warning}
        # beyond both the hub's share in the frequency is not identifiable
        inflated = best.inflation > 20
        unsure = best.deviations > 1e-3 * np.abs(best.p)
        if (inflated & unsure)[self.are_rates].any():
            warning = (
                "the hub swings in proportion to the tip, so that its share in the frequency is "
                "not identifiable: hold it, by a brake or a stiffer controller"
            )
            return {"cause": "hub", "warning": warning}
        doubts = doubt_of(time, best.residual, best.swinging, self.frequency, noise)
        damping = float(best.p[self.are_dampings].max(initial=0.0))
        more_than_a_beam = 0.12
        if not doubts and self.plant.joint == ROTARY and damping > more_than_a_beam:
            unknown = self.recording.angle is None
            remedy = ", or name its angle by --angle" if unknown else ""
            warning = (
                f"a damping ratio of {damping:.2g} is more than a beam on a held joint has: a "
                "controller that gives way damps like that, and shifts the frequency; hold the "
                f"joint{remedy}"
            )
            return {"cause": "hub", "warning": warning}
        return doubts
