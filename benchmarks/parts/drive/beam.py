"""A beam on a carriage by finite elements, reduced to its slowest modes with the carriage held."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial
from scipy.linalg import eigh

HERMITE = (
    Polynomial([1, 0, -3, 2]),
    Polynomial([0, 1, -2, 1]),
    Polynomial([0, 0, 3, -2]),
    Polynomial([0, 0, -1, 1]),
)
"""Displacements of an element by its ends' displacement and slope, over its length from 0 to 1."""


@dataclass(frozen=True)
class Lump:
    """A rigid body that is fixed to the beam: its place as a share of the length, and its inertia.

    Parameters
    ----------
    place
        Share of the beam's length, from its foot.
    mass
        Mass [kg].
    inertia
        Moment of inertia about its own centre [kg m^2].
    """

    place: float
    mass: float
    inertia: float = 0.0


@dataclass(frozen=True)
class Beam:
    """An upright Euler-Bernoulli beam that its carriage moves sideways; its last lump is the tool.

    Parameters
    ----------
    length
        Length [m].
    stiffness
        Bending stiffness E I [N m^2].
    line_mass
        Mass per length [kg/m].
    lumps
        Rigid bodies on the beam; the last one is the tool, at the beam's end.
    elements
        Number of finite elements; lumps stand on the nearest node.
    """

    length: float
    stiffness: float
    line_mass: float
    lumps: tuple[Lump, ...]
    elements: int = 20

    def matrices(self) -> tuple[np.ndarray, np.ndarray]:
        """Mass and stiffness matrix of displacement and slope of every node, the foot's first."""
        size = self.length / self.elements
        slopes = np.array([1.0, size, 1.0, size])
        nodes = 2 * (self.elements + 1)
        mass = np.zeros((nodes, nodes))
        stiffness = np.zeros((nodes, nodes))
        by_scale = np.outer(slopes, slopes)
        m = self.line_mass * size * by_scale * _products(HERMITE)
        k = self.stiffness / size**3 * by_scale * _products([p.deriv(2) for p in HERMITE])
        for first in range(0, nodes - 2, 2):
            of_element = slice(first, first + 4)
            mass[of_element, of_element] += m
            stiffness[of_element, of_element] += k
        for lump in self.lumps:
            node = 2 * round(lump.place * self.elements)
            mass[node, node] += lump.mass
            mass[node + 1, node + 1] += lump.inertia
        return mass, stiffness

    def modes(self, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Frequencies [rad/s] and shapes with the foot held, of unit modal mass; all nodes."""
        mass, stiffness = self.matrices()
        squares, free = eigh(stiffness[2:, 2:], mass[2:, 2:], subset_by_index=[0, count - 1])
        shapes = np.vstack([np.zeros((2, count)), free])
        return np.sqrt(squares), shapes

    def reduced(self, count: int, damping: tuple[float, ...]) -> tuple[np.ndarray, ...]:
        """Mass, damping and stiffness by the carriage's place and `count` modes, and the tool.

        The tool's displacement in space is the last array times these coordinates.
        """
        mass, _ = self.matrices()
        omega, shapes = self.modes(count)
        together = np.zeros(len(mass))
        together[::2] = 1.0
        basis = np.column_stack([together, shapes])
        rates = 2 * np.array(damping[:count]) * omega
        return (
            basis.T @ mass @ basis,
            np.diag([0.0, *rates]),
            np.diag([0.0, *omega**2]),
            basis[-2],
        )


def tuned(first: float, beam: Beam) -> Beam:
    """The beam with the bending stiffness that gives it this first frequency [Hz]."""
    (omega,), _ = beam.modes(1)
    factor = (2 * np.pi * first / omega) ** 2
    return Beam(
        beam.length, beam.stiffness * factor, beam.line_mass, beam.lumps, beam.elements
    )  # fmt: skip


def _products(shapes) -> np.ndarray:
    """Integrals from 0 to 1 of the products of each pair of polynomials."""
    return np.array([[(a * b).integ()(1.0) for b in shapes] for a in shapes])
