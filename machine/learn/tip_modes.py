"""A plant's modes with the joint at rest, each by what it does to the tip.

A state of modal amplitudes and rates is then one complex number a mode: the displacement of the tip
that the mode moves most is its real part, now, and turns as the mode swings.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.models import JointMotion, Plant
from quietarm.ocp.simulation.collocation import modal_system
from quietarm.ocp.task import ModalState

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


class TipModes:
    """The modes of a plant at a place of its joint, the slowest first.

    Parameters
    ----------
    plant : Plant
        What moves.
    place : float
        Where its joint rests [rad, of a linear joint m].

    Attributes
    ----------
    values : array of complex, shape (modes,)
        Eigenvalues above the real axis [rad/s].
    tips : array of complex, shape (tips, modes)
        What each mode does to each tip; 1 for the tip that it moves most.

    Raises
    ------
    ValueError
        When a mode does not swing, or moves no tip.
    """

    def __init__(self, plant: Plant, place: float) -> None:
        joint = JointMotion(place, 0.0, 0.0)
        system = modal_system(plant, joint)
        K, D = (np.array(matrix, float) for matrix in (system.K, system.D))
        size = plant.modes
        zero, one = np.zeros((size, size)), np.eye(size)
        values: Any
        vectors: Any
        values, vectors = np.linalg.eig(np.block([[zero, one], [-K, -D]]).astype(complex))
        inverse = np.linalg.inv(vectors)
        order = [int(k) for k in np.argsort(values.imag) if values[k].imag > 0]
        if len(order) < size:
            raise ValueError(
                f"{plant.name} has {size - len(order)} of {size} modes that do not swing; learning "
                "needs a damping ratio below 1"
            )
        by_modes: Any = _tips_by_modes(plant, joint) @ vectors[:size, order]
        most = np.abs(by_modes).argmax(axis=0)
        scale = by_modes[most, range(size)]
        if (np.abs(scale) <= 1e-12 * np.abs(vectors[:size, order]).max(axis=0)).any():
            raise ValueError(
                f"a mode of {plant.name} moves no tip, so that no recording tells of it; leave it "
                "out of the plant"
            )
        self.values: ComplexArray = values[order]
        self.tips: ComplexArray = by_modes / scale
        self._shapes = vectors[:, order] / scale
        self._parts = 2 * inverse[order] * scale[:, None]

    @property
    def frequencies(self) -> Array:
        """Frequencies of the modes [Hz]."""
        return self.values.imag / (2 * np.pi)

    def amplitudes(self, state: Any) -> ComplexArray:
        """The complex amplitude of each mode in a state, W and then W'."""
        amplitudes: ComplexArray = self._parts @ np.asarray(state, complex)
        return amplitudes

    def state(self, amplitudes: ComplexArray) -> ModalState:
        """The state in which the modes have these complex amplitudes."""
        W, dW = np.split((self._shapes @ amplitudes).real, 2)
        return ModalState(tuple(W.tolist()), tuple(dW.tolist()))


def _tips_by_modes(plant: Plant, joint: JointMotion) -> Array:
    """Displacement of each tip by each modal amplitude (tips, modes)."""
    rest = np.array([float(tip) for tip in plant.tips_at(joint, [0.0] * plant.modes)])
    units = np.eye(plant.modes).tolist()
    return np.stack([np.array([float(t) for t in plant.tips_at(joint, u)]) - rest for u in units]).T
