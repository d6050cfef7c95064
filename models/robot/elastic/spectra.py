"""Natural frequencies of stiffness and mass matrices."""

from __future__ import annotations

import numpy as np

from quietarm.models.joint_motion import Array


def spectrum(stiffness: Array, masses: Array) -> tuple[Array, Array]:
    """Squares of the frequencies [1/s^2], rising, and the shapes of modes of unit modal mass.

    Columns of the second are those of K v = w^2 M v, for symmetric K and positive definite M.
    """
    root = np.linalg.cholesky(masses)
    inverse = np.linalg.inv(root)
    found = np.linalg.eigh(inverse @ stiffness @ inverse.T)
    return np.asarray(found.eigenvalues, float), np.asarray(inverse.T @ found.eigenvectors, float)
