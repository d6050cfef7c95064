"""RK4 by hand: a scalar loop for numba, and the whole population in every operation of NumPy."""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray
from parts.population.equations import (
    Numbers,
    Values,
    peak_after,
    peak_after_compiled,
    plant_at_arrays,
    plant_at_compiled,
)


@numba.njit
def absolute_integral(start: float, middle: float, end: float) -> float:
    """Integral over [0, 1] of the absolute value of the quadratic through three points."""
    c0, c1, c2 = start, 4 * middle - 3 * start - end, 2 * (start + end) - 4 * middle
    whole = c0 + c1 / 2 + c2 / 3
    if (start >= 0 and middle >= 0 and end >= 0) or (start <= 0 and middle <= 0 and end <= 0):
        return abs(whole)  # without a look for a pair of zeros between the points
    half = -(c1 + math.copysign(math.sqrt(max(c1 * c1 - 4 * c0 * c2, 0.0)), c1)) / 2
    r = min(max(half / c2, 0.0), 1.0) if c2 != 0 else 0.0
    s = min(max(c0 / half, 0.0), 1.0) if half != 0 else 0.0
    r, s = min(r, s), max(r, s)
    to_r = r * (c0 + r * (c1 / 2 + r * c2 / 3))
    to_s = s * (c0 + s * (c1 / 2 + s * c2 / 3))
    return abs(to_r) + abs(to_s - to_r) + abs(whole - to_s)


def absolute_integral_arrays(start: Any, middle: Any, end: Any) -> Any:
    """As `absolute_integral`; the zeros are sought only in the steps that need them."""
    whole = np.abs(start + 4 * middle + end) / 6
    changes = (start * middle < 0) | (middle * end < 0)
    start, middle, end = start[changes], middle[changes], end[changes]
    c0, c1, c2 = start, 4 * middle - 3 * start - end, 2 * (start + end) - 4 * middle
    half = -(c1 + np.copysign(np.sqrt(np.maximum(c1 * c1 - 4 * c0 * c2, 0)), c1)) / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        zeros = np.clip(np.nan_to_num([half / c2, c0 / half]), 0, 1)
    r, s = np.sort(zeros, axis=0)
    to_r, to_s = (z * (c0 + z * (c1 / 2 + z * c2 / 3)) for z in (r, s))
    rest = c0 + c1 / 2 + c2 / 3 - to_s
    whole[changes] = np.abs(to_r) + np.abs(to_s - to_r) + np.abs(rest)
    return whole


@numba.njit
def march_compiled(
    x: Numbers, grid: NDArray[np.float64], trapezoid: bool, population: NDArray[np.float64]
) -> Values:
    """RK4 in scalars, the way one writes it for numba."""
    table = np.empty((len(population), 3))
    for candidate in range(len(population)):
        a = population[candidate]
        W = dW = energy = 0.0
        g, K, D, drive, coupling, speed = plant_at_compiled(x, a, grid[0])
        ddW = g
        power = (drive + coupling * ddW) * speed
        for k in range(len(grid) - 1):
            h = (grid[k + 1] - grid[k]) * x.duration
            g, K, D, drive_m, coupling_m, speed_m = plant_at_compiled(
                x, a, (grid[k] + grid[k + 1]) / 2
            )
            rate2 = dW + h / 2 * ddW
            slope2 = g - K * (W + h / 2 * dW) - D * rate2
            rate3 = dW + h / 2 * slope2
            slope3 = g - K * (W + h / 2 * rate2) - D * rate3
            g_m, K_m, D_m = g, K, D
            g, K, D, drive, coupling, speed = plant_at_compiled(x, a, grid[k + 1])
            rate4 = dW + h * slope3
            slope4 = g - K * (W + h * rate3) - D * rate4
            W_next = W + h / 6 * (dW + 2 * rate2 + 2 * rate3 + rate4)
            dW_next = dW + h / 6 * (ddW + 2 * slope2 + 2 * slope3 + slope4)
            ddW_next = g - K * W_next - D * dW_next
            W_m = (W + W_next) / 2 + h / 8 * (dW - dW_next)  # Hermite's cubics
            dW_m = (dW + dW_next) / 2 + h / 8 * (ddW - ddW_next)
            power_m = (drive_m + coupling_m * (g_m - K_m * W_m - D_m * dW_m)) * speed_m
            power_next = (drive + coupling * ddW_next) * speed
            if trapezoid:
                energy += h / 4 * (abs(power) + 2 * abs(power_m) + abs(power_next))
            else:
                energy += h * absolute_integral(power, power_m, power_next)
            W, dW, ddW, power = W_next, dW_next, ddW_next, power_next
        table[candidate, 0] = peak_after_compiled(x, W, dW)
        table[candidate, 1] = energy
        table[candidate, 2] = W
    return table


def march_arrays(
    x: Numbers, grid: NDArray[np.float64], at_once: bool, population: NDArray[np.float64]
) -> Values:
    """RK4 of the whole population."""
    times = np.empty(2 * len(grid) - 1)
    times[::2], times[1::2] = grid, (grid[:-1] + grid[1:]) / 2
    a = np.ascontiguousarray(population.T)
    if at_once:
        plant: Any = list(zip(*plant_at_arrays(x, a[:, None, :], times[:, None]), strict=True))
    else:
        plant = [plant_at_arrays(x, a, fraction) for fraction in times]
    W = dW = np.zeros(len(population))
    ddW = plant[0][0]
    powers = [ddW * 0.0]  # the joint is at rest
    lengths = np.diff(grid) * x.duration
    for k, h in enumerate(lengths):
        g_m, K_m, D_m, drive_m, coupling_m, speed_m = plant[2 * k + 1]
        g, K, D, drive, coupling, speed = plant[2 * k + 2]
        rate2 = dW + h / 2 * ddW
        slope2 = g_m - K_m * (W + h / 2 * dW) - D_m * rate2
        rate3 = dW + h / 2 * slope2
        slope3 = g_m - K_m * (W + h / 2 * rate2) - D_m * rate3
        rate4 = dW + h * slope3
        slope4 = g - K * (W + h * rate3) - D * rate4
        W_next = W + h / 6 * (dW + 2 * (rate2 + rate3) + rate4)
        dW_next = dW + h / 6 * (ddW + 2 * (slope2 + slope3) + slope4)
        ddW_next = g - K * W_next - D * dW_next
        W_m = (W + W_next) / 2 + h / 8 * (dW - dW_next)
        dW_m = (dW + dW_next) / 2 + h / 8 * (ddW - ddW_next)
        powers.append((drive_m + coupling_m * (g_m - K_m * W_m - D_m * dW_m)) * speed_m)
        powers.append((drive + coupling * ddW_next) * speed)
        W, dW, ddW = W_next, dW_next, ddW_next
    power = np.array(powers)
    energy = lengths @ absolute_integral_arrays(power[:-1:2], power[1::2], power[2::2])
    return np.column_stack([peak_after(x, W, dW), energy, W])
