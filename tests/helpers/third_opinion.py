"""The equations typed afresh, simulated by SciPy's DOP853; the paper's printed coefficients."""

import itertools
import math

import numpy as np
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

# Tables 1 and 4 of the paper.
SINGLE_LINK = {
    "cycloid": [],
    "2": [3.347e-3, -1.697e-1],
    "4": [-1.690e-3, -1.367e-1, -1.951e-2, -1.971e-1],
    "6": [-1.889e-3, -1.427e-1, -4.247e-2, -1.187e-1, 4.800e-2, -1.890e-1],
}


ARM = {
    "cycloid": [],
    "2": [-1.023e-1, -4.365e-1],
    "4": [-9.583e-2, -3.350e-1, 2.090e-1, -2.854e-1],
    "6 as printed": [-9.346e-2, -3.488e-1, 1.989e-1, -1.515e-1, -2.993e-1, -2.377e-1],
    "6 mended": [-9.346e-2, -3.488e-1, 1.989e-1, -1.515e-1, -2.993e-2, -2.377e-1],
}


COEFFICIENTS = {"single link": SINGLE_LINK, "arm": ARM}
pi = math.pi


def _joint(a, start, target, duration):
    """Eqs (1)-(3) (mended), (6), (7), with numpy's polynomials, as a function of time."""
    in_T = np.polynomial.Polynomial([1, 0, -1]) * np.polynomial.Polynomial(a or [0.0])
    coefficients = [in_T.deriv(order).coef for order in range(3)]
    rate, span = 2 / duration, target - start

    def at(t):
        T = -1 + rate * t
        of_T = [np.polynomial.polynomial.polyval(T, c, tensor=False) for c in coefficients]
        U = t / duration + of_T[0]
        dU = 1 / duration + rate * of_T[1]
        ddU = rate**2 * of_T[2]
        return (
            span * (U - np.sin(2 * pi * U) / (2 * pi)) + start,
            2 * span * np.sin(pi * U) ** 2 * dU,
            2 * span * np.sin(pi * U) * (2 * pi * np.cos(pi * U) * dU**2 + np.sin(pi * U) * ddU),
        )

    return at


def _single_link(q, dq, ddq, W, dW):
    """W'' and torque by eqs (8)-(10)."""
    acceleration = (
        -2 * 9.636e-3 * 10.43 * dW
        - 10.43**2 * W
        - 2.555e-1 * ddq
        - 2.614e-1 * dq**2 * W
    )  # fmt: skip
    return acceleration, 2.383e-2 * ddq + 9.261e-2 * acceleration[0] + 3.091e-2 * dq


def _arm(q, dq, ddq, W, dW):
    """W'' and torque by eqs (13)-(15)."""
    push = (-9.949e-3 + 5.256e-2 * np.cos(q)) * ddq
    turn = (7.634e-2 * dW * dq - 5.256e-2 * dq**2) * np.sin(q)
    acceleration = -(2 * 1.5e-3 * 7.32 * dW + 7.32**2 * W + push + turn) / (
        1 - 1.055e-1 * np.cos(q)
    )
    coupling = -4.944e-3 + 2.399e-2 * np.cos(q)
    return acceleration, 5.366e-3 * ddq + 1.965e-2 * dq + coupling * acceleration[0]


TWO_LINKS = [
    (12.68 * 0.993, 15.49e-3 * 1.214, 0.2266 * 0.984, 2.004e-3 * 1.020),
    (10.71 * 0.993, 14.27e-3 * 1.071, 0.2570 * 1.003, 5.822e-3 * 1.006),
]
"""Frequency, damping ratio, a and b of either mode."""


def two_links(q, dq, ddq, W, dW):
    """W'' and torque of docs/physics.md's third plant."""
    acceleration = []
    for i, (omega, zeta, a, b) in enumerate(TWO_LINKS):
        spring = 2 * zeta * omega * dW[i] + omega**2 * W[i]
        acceleration.append(-spring - a * ddq - b * dq**2 * W[i])
    inertia = 2.996e-2 * 1.016 * ddq + 6.652e-2 * 1.018 * acceleration[0]
    return acceleration, inertia + 5.237e-2 * 1.052 * acceleration[1] + 4.202e-2 * 1.131 * dq


EQUATIONS = {"single link": _single_link, "arm": _arm, "two links": two_links}
PHI = {"single link": 2.28, "arm": 0.508, "two links": 2.7244}  # docs/physics.md


def followed(plant, joint, corners, **settings):
    """A plant's equations by DOP853, restarted at the corners of a joint's motion.

    Gives modes, rates, net work and energy at the end, and the runs between the corners.
    """
    n, z, runs = plant.modes, np.zeros(2 * plant.modes + 2), []

    def rates(t, z):
        at, W, dW = joint(t), z[:n], z[n : 2 * n]
        ddW = [float(one) for one in plant.modal_accelerations(at, W, dW)]
        power = float(plant.torque(at, W, dW, ddW)) * at.speed
        return [*dW, *ddW, power, abs(power)]

    for begin, end in itertools.pairwise(corners):
        if end - begin > 1e-12:
            settings = {"rtol": 1e-11, "atol": 1e-13, "max_step": (end - begin) / 40, **settings}
            runs.append(solve_ivp(rates, (begin, end), z, "DOP853", **settings))
            z = runs[-1].y[:, -1]
    return z, runs


class ThirdOpinion:
    """Modes, torque, F1 and F2 of a move by SciPy."""

    def __init__(self, name, a, start, target, duration, initial=None):
        self.equations, self.phi, self.modes = EQUATIONS[name], PHI[name], 1 + (name == "two links")
        self.duration = duration
        self.joint = _joint(a, start, target, duration)
        initial = np.zeros(2 * self.modes) if initial is None else np.array(initial)
        self.during = self._solve(self.joint, 0.0, duration, initial)
        arrival, rest = self.during.y[:, -1], lambda t: (target, 0.0, 0.0)
        self.after = self._solve(rest, duration, duration + 1, arrival)

    def _solve(self, joint, begin, end, state):
        def rates(t, x):
            W, dW = x[: self.modes], x[self.modes :]
            return [*dW, *self.equations(*joint(t), W, dW)[0]]

        return solve_ivp(
            rates, (begin, end), state, "DOP853", rtol=1e-13, atol=1e-15, dense_output=True
        )

    def torque(self, joint, x):
        """Return the torque at joint's angle, speed and acceleration and states, at any times."""
        return self.equations(*joint, x[: self.modes], x[self.modes :])[1]

    def power(self, t):
        joint = self.joint(t)
        torque = self.torque(joint, self.during.sol(t))
        return np.reshape(torque * joint[1], np.shape(t))[()]

    @property
    def energy(self):
        """Adaptive quadrature between the zeros of the power: a grid's, then sharpened."""
        grid = np.linspace(0.0, self.duration, 4001)
        power = self.power(grid)
        change = np.flatnonzero(power[:-1] * power[1:] < 0)
        zeros = [brentq(self.power, grid[k], grid[k + 1], xtol=1e-14) for k in change]
        edges = [0.0, *zeros, self.duration]
        pieces = [
            quad(self.power, begin, end, limit=200, epsabs=1e-14, epsrel=1e-11)[0]
            for begin, end in itertools.pairwise(edges)
        ]
        return sum(map(abs, pieces))

    @property
    def residual(self):
        W = self.after.sol(np.linspace(self.duration, self.duration + 1, 8001))[: self.modes]
        return self.phi * np.abs(W).max()
