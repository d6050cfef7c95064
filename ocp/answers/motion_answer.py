"""What plans and floors have in common: each is one motion and its figures."""

from __future__ import annotations

from typing import Any

from quietarm.ocp.answers.provenance import Provenance
from quietarm.ocp.answers.saved import Saved
from quietarm.ocp.simulation.objective import Motion


class MotionAnswer(Saved):
    """An answer that is one motion. A subclass is a dataclass with the two entries below."""

    motion: Motion
    provenance: Provenance[Any]

    @property
    def energy(self) -> float:
        """F2: driving energy [J], by the independent integrator."""
        return self.motion.energy

    @property
    def residual(self) -> float:
        """F1: largest absolute tip displacement after arrival [m], by the same."""
        return self.motion.residual

    @property
    def complete(self) -> bool:
        """Whether the solver ran to its end; False where Ctrl-C stopped it."""
        return self.provenance.stopped is None
