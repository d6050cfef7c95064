"""The kinds of objective beside the energies of quietarm: in stages, and by a motor's map."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Any

import casadi as ca
import numpy as np

import quietarm as qa
from quietarm.metaheuristics import MoveFunction
from quietarm.models import Plant


@dataclass(frozen=True)
class Stages(qa.Energy):
    """Power from a supply that rises in stages: a smooth staircase, flat at every whole stage."""

    name = "stages"
    stage: float = 0.1

    def smooth(self, torque: Any, speed: Any) -> Any:
        """The power [W] with ripple: no slope where it is a whole number of stages."""
        x = ca.sqrt((torque * speed / self.stage) ** 2 + 1e-6)
        return self.stage * (x - ca.sin(2 * pi * x) / (2 * pi))


@dataclass(frozen=True)
class MotorMap(qa.Energy):
    """Power of a motor whose efficiency is a table of cells: it jumps at their edges.

    Braking gives nothing back. The edges are shares of a torque and of a speed.
    """

    name = "motor-map"
    torque_scale: float = 1.0
    speed_scale: float = 1.0

    def smooth(self, torque: Any, speed: Any) -> Any:
        """The power that the motor takes [W]; its slope is that within a cell."""
        torque_share = ca.fabs(torque) / self.torque_scale
        speed_share = ca.fabs(speed) / self.speed_scale
        efficiency = 0.45
        for edge, step in ((0.1, 0.15), (0.3, 0.15), (0.6, -0.05)):
            efficiency = efficiency + step * (torque_share > edge)
        for edge, step in ((0.25, 0.08), (0.5, 0.06), (0.8, -0.04)):
            efficiency = efficiency + step * (speed_share > edge)
        power = torque * speed
        return (power > 0) * power / efficiency


def energy_of(kind: str, plant: Plant, target: float, duration: float) -> qa.Energy:
    """The energy of a kind, scaled to what the plain cycloid of a move takes.

    A stage is half the plain cycloid's mean power; the map's edges are shares of its peaks.
    """
    if kind in ("absolute", "integer", "shaper"):
        return qa.AbsolutePower()
    if kind == "copper":
        return qa.CopperLoss(0.12)
    task = qa.PointToPoint(plant, target, duration)
    function = MoveFunction(
        task, qa.CycloidPolynomial(6), bound=1.0, objectives=("residual", "energy", "peak_torque")
    )
    ((_, energy, torque),) = function(np.zeros((1, 6)))[0]
    if kind == "stages":
        return Stages(_three_digits(energy / duration / 2))
    if kind == "motor-map":
        return MotorMap(_three_digits(torque), _three_digits(2 * abs(target) / duration))
    raise ValueError(
        f"no energy is called {kind!r}; give absolute, copper, stages, motor-map, integer or shaper"
    )


def _three_digits(value: float) -> float:
    return float(f"{value:.3g}")
