"""One candidate after the other by solve_ivp, with the equations as one usually writes them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray
from parts.population.equations import (
    TASK,
    Numbers,
    Values,
    peak_after,
    plant_at_arrays,
    plant_at_scalars,
)
from scipy.integrate import solve_ivp

from quietarm.ocp import FreeVibration


def rates_in_floats(x: Numbers, a: Sequence[float]) -> Callable[..., Any]:
    def rates(t: float, y: NDArray[np.float64]) -> tuple[float, float]:
        g, K, D, *_ = plant_at_scalars(x, a, t / x.duration)
        return y[1], g - K * y[0] - D * y[1]

    return rates


def rates_in_numpy(x: Numbers, a: Sequence[float]) -> Callable[..., Any]:
    U = np.polyadd([0.5, 0.5], np.polymul([-1.0, 0.0, 1.0], a[::-1]))  # of T
    dU = np.polyder(U) * 2 / x.duration
    ddU = np.polyder(dU) * 2 / x.duration

    def rates(t: float, y: NDArray[np.float64]) -> NDArray[np.float64]:
        T = 2 * t / x.duration - 1
        u, du, ddu = np.polyval(U, T), np.polyval(dU, T), np.polyval(ddU, T)
        sine, cosine = np.sin(pi * u), np.cos(pi * u)
        angle = x.start + x.span * (u - np.sin(2 * pi * u) / (2 * pi))
        speed = 2 * x.span * sine**2 * du
        acceleration = 2 * x.span * sine * (2 * pi * cosine * du**2 + sine * ddu)
        W, dW = y
        force = (
            2 * x.zeta * x.omega * dW
            + x.omega**2 * W
            + (x.alpha2 + x.alpha3 * np.cos(angle)) * acceleration
            + (x.alpha4 * dW * speed - x.alpha3 * speed**2) * np.sin(angle)
        )
        return np.array([dW, -force / (1 + x.alpha1 * np.cos(angle))])

    return rates


def at_arrival(rates: Callable[..., Any], duration: float, t: float, y: NDArray[np.float64]) -> Any:
    """The rates with the joint where it arrives, whatever the time."""
    return rates(duration, y)


def integrate(
    x: Numbers,
    samples: int,
    equations: Callable[..., Any],
    through: bool,
    population: NDArray[np.float64],
) -> Values:
    """solve_ivp, one candidate after the other; energy from so many samples of the power.

    F1 is in closed form, or, `through`, the largest of the samples over the second after arrival,
    by integrating on with the joint at rest.
    """
    table = np.empty((len(population), 3))
    times = np.linspace(0.0, x.duration, samples + 1)
    fastest = float(FreeVibration(TASK.plant, TASK.target).fastest)
    for candidate, row in enumerate(population):
        a = row.tolist()
        rates = equations(x, a)
        solution = solve_ivp(
            rates, (0.0, x.duration), [0.0, 0.0], "DOP853", times, rtol=1e-8, atol=1e-10
        )
        W, dW = solution.y
        g, K, D, drive, coupling, speed = plant_at_arrays(x, a, times / x.duration)
        power = (drive + coupling * (g - K * W - D * dW)) * speed
        energy = np.trapezoid(np.abs(power), times)
        peak = peak_after(x, W[-1], dW[-1])
        if through:
            after = solve_ivp(
                partial(at_arrival, rates, x.duration), (0.0, x.window), solution.y[:, -1],
                "DOP853", np.linspace(0.0, x.window, math.ceil(50 * x.window * fastest) + 1),
                rtol=1e-8, atol=1e-10,
            )  # fmt: skip
            peak = abs(x.phi) * np.abs(after.y[0]).max()
        table[candidate] = peak, energy, W[-1]
    return table
