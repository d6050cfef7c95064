"""Time per candidate of the population objective against what one would write by hand.

    pip install ".[benchmark]"
    python benchmarks/population.py [--rounds 15] [--seed 0]

The arm on a flexible link, 0 to pi/2 in 0.8 s, six terms, 200 candidates with random coefficients
in the paper's box (|a_n| <= 0.5), one core; F1 over 1 s after arrival, F2 = integral |tau theta'|:

- quietarm: `PopulationObjective`, as it comes;
- numba: a scalar loop over candidates and steps of RK4, compiled, without fastmath;
- NumPy: RK4 with the whole population in every operation, the joint's motion computed time by time,
  or for all times at once before the march;
- solve_ivp: DOP853 with rtol 1e-8, one candidate at a time, scalar right-hand side in Python, the
  energy by the trapezoid rule over samples.

All compute the same: eqs (1)-(7), (13), (14). The hand-written ones get the best that is known of
them: the joint's motion once for each distinct time, the plant reduced to W'' = g - D W' - K W
there, the peak after arrival in closed form, even steps or quietarm's graded ones, whichever need
fewer. F2 is the integral of the absolute value of the quadratic through the power at a step's
start, middle and end, split at its zeros; "trapezoid" is the plain rule over the same three.

Equal error: each takes the fewest steps of a list with which nine in ten candidates are within 1e-4
of F2 (relative) and 1e-6 m of W at arrival; the reference is quietarm's rollout with 1500 steps.
solve_ivp takes the fewest samples, likewise. quietarm's own steps are its default.

Methods take turns in every round. Printed are the least and the median time per candidate, and the
median of the ratios to quietarm within a round. Then: what 10,000 candidates add to the memory, two
threads, and what a second task (another start, target and duration) costs.
"""

from __future__ import annotations

import argparse
import math
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import pi
from statistics import median
from typing import Any, NamedTuple

import numba
import numpy as np
from common import console, forget_compiled, machine, timed
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from scipy.integrate import solve_ivp

from metaheuristics import population as quietarm
from metaheuristics.population import PopulationObjective
from models import ArmOnFlexibleLink, JointMotion
from ocp import CycloidPolynomial, PointToPoint, rollout
from ocp.collocation import mesh, modal_system

PLANT, PROFILE = ArmOnFlexibleLink(), CycloidPolynomial(6)
TASK = PointToPoint(PLANT, target=pi / 2, duration=0.8)
SECOND_TASK = PointToPoint(PLANT, start=-pi / 2, target=pi / 4, duration=1.0)
BOX, CANDIDATES, MANY, FEW = 0.5, 200, 10_000, 5
ENERGY_ERROR, ARRIVAL_ERROR, SHARE, REFERENCE_STEPS = 1e-4, 1e-6, 0.9, 1500
STEPS = (20, 24, 28, 32, 36, 40, 44, 48, 52, 56, 60, 64, 70, 76, 82, 90, 100, 110, 120, 135, 150,
         170, 190, 210, 240, 270, 300, 350, 400)  # fmt: skip
SAMPLES = (200, 400, 600, 800, 1000, 1500, 2000, 4000)


class Numbers(NamedTuple):
    """The plant's and the task's numbers, in a form that numba takes."""

    alpha1: float
    alpha2: float
    alpha3: float
    alpha4: float
    zeta: float
    omega: float
    beta1: float
    beta2: float
    beta3: float
    c: float
    phi: float
    start: float
    span: float
    duration: float
    window: float
    stiffness_after: float
    damping_after: float


def numbers(task: PointToPoint) -> Numbers:
    after = modal_system(task.plant, JointMotion(task.target, 0.0, 0.0))
    return Numbers(
        **task.plant.parameters,
        start=task.start,
        span=task.span,
        duration=task.duration,
        window=task.residual_window,
        stiffness_after=float(after.K[0][0]),
        damping_after=float(after.D[0][0]),
    )


def plant_along(sin: Any, cos: Any) -> Callable[..., tuple[Any, ...]]:
    """The plant along the profile, for scalars (Python, numba) or arrays: the functions differ."""

    def plant_at(x: Numbers, a: Any, fraction: Any) -> tuple[Any, ...]:
        """g, K, D of W'' = g - K W - D W'; tau = drive + coupling * W''; the joint's speed."""
        T = 2 * fraction - 1
        p = dp = ddp = 0.0 * T
        for n in range(len(a) - 1, -1, -1):
            ddp = ddp * T + 2 * dp
            dp = dp * T + p
            p = p * T + a[n]
        bump, rate = 1 - T * T, 2 / x.duration
        U = fraction + bump * p
        dU = 1 / x.duration + rate * (bump * dp - 2 * T * p)
        ddU = rate * rate * (bump * ddp - 4 * T * dp - 2 * p)
        sine, cosine = sin(pi * U), cos(pi * U)
        angle = x.start + x.span * (U - sine * cosine / pi)
        speed = 2 * x.span * sine * sine * dU
        acceleration = 2 * x.span * sine * (2 * pi * cosine * dU * dU + sine * ddU)
        sine, cosine = sin(angle), cos(angle)
        inertia = 1 / (1 + x.alpha1 * cosine)
        return (
            -inertia * (x.alpha2 + x.alpha3 * cosine) * acceleration
            + inertia * x.alpha3 * speed * speed * sine,
            inertia * x.omega * x.omega,
            inertia * (2 * x.zeta * x.omega + x.alpha4 * speed * sine),
            x.beta1 * acceleration + x.c * speed,
            x.beta2 + x.beta3 * cosine,
            speed,
        )

    return plant_at


plant_at_arrays = plant_along(np.sin, np.cos)
plant_at_scalars = plant_along(math.sin, math.cos)
plant_at_compiled = numba.njit(plant_along(math.sin, math.cos))


def peak_after(x: Numbers, W: Any, dW: Any) -> Any:
    """F1: at arrival, at the first extremum after it, or at the window's end if that is sooner."""
    decay = x.damping_after / 2
    frequency = np.sqrt(x.stiffness_after - decay * decay)
    B = (dW + decay * W) / frequency
    first = np.arctan2(dW, frequency * W + decay * B) % pi / frequency
    t = np.minimum(first, x.window)
    turned = W * np.cos(frequency * t) + B * np.sin(frequency * t)
    return abs(x.phi) * np.maximum(np.abs(W), np.exp(-decay * t) * np.abs(turned))


peak_after_compiled = numba.njit(peak_after)


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
    x: Numbers, population: NDArray[np.float64], grid: NDArray[np.float64], trapezoid: bool
) -> NDArray[np.float64]:
    """F1, F2 and W at arrival of every candidate (columns)."""
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
    x: Numbers, population: NDArray[np.float64], grid: NDArray[np.float64], at_once: bool
) -> NDArray[np.float64]:
    """As `march_compiled`, in NumPy."""
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


def integrate(x: Numbers, population: NDArray[np.float64], samples: int) -> NDArray[np.float64]:
    """As `march_compiled`, by solve_ivp, with so many samples of the power."""
    table = np.empty((len(population), 3))
    times = np.linspace(0.0, x.duration, samples + 1)
    for candidate, row in enumerate(population):
        a = row.tolist()

        def rates(t: float, y: NDArray[np.float64], a: list[float] = a) -> tuple[float, float]:
            g, K, D, *_ = plant_at_scalars(x, a, t / x.duration)
            return y[1], g - K * y[0] - D * y[1]

        solution = solve_ivp(
            rates, (0.0, x.duration), [0.0, 0.0], "DOP853", times, rtol=1e-8, atol=1e-10
        )
        W, dW = solution.y
        g, K, D, drive, coupling, speed = plant_at_arrays(x, a, times / x.duration)
        power = (drive + coupling * (g - K * W - D * dW)) * speed
        energy = np.trapezoid(np.abs(power), times)
        table[candidate] = peak_after(x, W[-1], dW[-1]), energy, W[-1]
    return table


def even(steps: int) -> NDArray[np.float64]:
    return np.linspace(0.0, 1.0, steps + 1)


def graded(steps: int) -> NDArray[np.float64]:
    begin, _ = mesh(np.arange(steps + 1.0), steps)
    return np.array(begin).ravel()


@dataclass(frozen=True)
class Errors:
    """Of every candidate: relative in F1 and F2, and of W at arrival [m]."""

    residual: NDArray[np.float64]
    energy: NDArray[np.float64]
    arrival: NDArray[np.float64]

    @classmethod
    def between(cls, table: NDArray[np.float64], reference: NDArray[np.float64]) -> Errors:
        difference = np.abs(table - reference)
        relative = difference / np.abs(reference)
        return cls(relative[:, 0], relative[:, 1], difference[:, 2])

    @property
    def within(self) -> bool:
        return (
            np.quantile(self.energy, SHARE) <= ENERGY_ERROR
            and np.quantile(self.arrival, SHARE) <= ARRIVAL_ERROR
        )


@dataclass(frozen=True)
class Method:
    """A row: how it is called, its steps, its errors, and what to time for how many candidates."""

    title: str
    steps: str
    errors: Errors
    call: Callable[[], object]
    candidates: int = CANDIDATES


def by_rollout(population: NDArray[np.float64], steps: int) -> NDArray[np.float64]:
    """F1 in closed form, F2 and W at arrival by quietarm's rollout."""
    x, rows = numbers(TASK), []
    for a in population:
        result = rollout(TASK, PROFILE, a, steps)
        rows.append([peak_after(x, *result.arrival), result.motion.energy, result.arrival[0]])
    return np.array(rows)


def tuned(
    title: str,
    march: Callable[..., NDArray[np.float64]],
    option: bool,
    population: NDArray[np.float64],
    reference: NDArray[np.float64],
) -> Method:
    """A march with the fewest steps that are accurate enough; even ones where both serve."""
    x = numbers(TASK)
    for steps in STEPS:
        for spacing in (even, graded):
            grid = spacing(steps)
            errors = Errors.between(march(x, population, grid, option), reference)
            if errors.within:
                call = lambda grid=grid: march(x, population, grid, option)  # noqa: E731
                return Method(title, f"{steps} {spacing.__name__}", errors, call)
    raise RuntimeError(f"{title}: {STEPS[-1]} steps are not accurate enough")


def one_at_a_time(
    population: NDArray[np.float64], reference: NDArray[np.float64]
) -> tuple[Method, int]:
    """solve_ivp with the fewest samples that are accurate enough for a few candidates."""
    x, few = numbers(TASK), population[:: len(population) // 40]
    for samples in SAMPLES:
        errors = Errors.between(
            integrate(x, few, samples), reference[:: len(population) // 40]
        )
        if errors.within:
            call = lambda: integrate(x, population[:FEW], samples)  # noqa: E731
            return Method("solve_ivp, DOP853", f"{samples} samples", errors, call, FEW), samples
    raise RuntimeError(f"solve_ivp: {SAMPLES[-1]} samples are not accurate enough")


def methods(population: NDArray[np.float64]) -> list[Method]:
    reference = by_rollout(population, REFERENCE_STEPS)
    objective = PopulationObjective(TASK, PROFILE)
    table = by_rollout(population, objective.steps)
    values = objective(population)
    table[:, :2] = np.column_stack([values.residual, values.energy])
    ours = Method(
        "quietarm, PopulationObjective",
        f"{objective.steps} graded",
        Errors.between(table, reference),
        lambda: objective(population),
    )
    solver, _ = one_at_a_time(population, reference)
    return [
        ours,
        tuned("numba loop, RK4", march_compiled, False, population, reference),
        tuned("numba loop, RK4, trapezoid", march_compiled, True, population, reference),
        tuned("NumPy, RK4, time by time", march_arrays, False, population, reference),
        tuned("NumPy, RK4, all times at once", march_arrays, True, population, reference),
        solver,
    ]


if __name__ == "__main__":
    rng = np.random.default_rng(0)
    A = rng.uniform(-BOX, BOX, (CANDIDATES, 6))
    ms = methods(A)
    T = [[] for _ in ms]
    for _ in range(12):
        for i, m in enumerate(ms):
            t = time.perf_counter(); m.call(); T[i].append((time.perf_counter() - t) / m.candidates * 1e6)
    for m, t in zip(ms, T):
        e = m.errors
        print(m.title, m.steps, min(t), median(t), *(f"{np.quantile(v,.9):.1e} {v.max():.1e} {np.sqrt(np.mean(v*v)):.1e}" for v in (e.energy, e.arrival, e.residual)), median(a/b for a,b in zip(t,T[0])))
