"""Time per candidate of the population objective, against what one would write by hand.

    pip install ".[benchmark]"
    python benchmarks/population.py [--rounds 40] [--seed 0]

The arm on a flexible link, 0 to pi/2 in 0.8 s, six terms, 200 candidates with random coefficients
in the paper's box (|a_n| <= 0.5), one core; F1 over 1 s after arrival, F2 = integral |tau theta'|:

- quietarm: `PopulationObjective`, as it comes;
- numba: a scalar loop over candidates and steps of RK4, compiled, without fastmath;
- NumPy: RK4 with the whole population in every operation, the joint's motion computed time by time,
  or for all times at once before the march;
- solve_ivp: DOP853 with rtol 1e-8 (atol 1e-10), one candidate at a time, with the equations in
  NumPy as one usually writes them, or in the standard library's floats; "F1 too" integrates the
  second after arrival as well, as eq (11) reads, instead of taking its peak in closed form.

All compute the same: eqs (1)-(7), (13), (14). The hand-written marches get the best that is known
of them: the joint's motion once for each distinct time, the plant reduced to W'' = g - K W - D W'
there, the peak after arrival in closed form, quietarm's graded steps beside even ones. Their F2 is
the integral of the absolute value of the quadratic through the power at a step's start, middle and
end, split at its zeros; "trapezoid" is the plain rule over the same three. solve_ivp's F2 is the
trapezoid rule over samples.

Equal error: each takes the fewest steps (solve_ivp: samples) of a list with which nine in ten
candidates are within 1e-4 of F2 (relative) and 1e-6 m of W at arrival; ratios are to quietarm with
these. Its default steps, in a second row, serve all of the paper's conditions. The reference is
quietarm's rollout with 1500 steps; solve_ivp is independent of it.

Methods take turns in every round and are called twice in a row: the first call pays for the caches
that the others left ("cold", its median), the second is what the other columns are of. Printed are
the least and the median CPU time per candidate (CPU time, since the machine may be shared), and the
median of the ratios to quietarm within a round. Then, in wall time: two threads, what a second task
costs, what 10,000 candidates add to the memory.
"""

from __future__ import annotations

import argparse
import math
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import pi
from typing import Any, NamedTuple

import numba
import numpy as np
from common import console, forget_compiled, machine, timed
from numpy.typing import NDArray
from rich.table import Table
from scipy.integrate import solve_ivp

from metaheuristics import PopulationObjective
from metaheuristics.objective.population import _compiled
from models import ArmOnFlexibleLink, JointMotion
from ocp import CycloidPolynomial, PointToPoint, rollout
from ocp.simulation.collocation import mesh, modal_system
from ocp.simulation.residual import residual_samples

PLANT, PROFILE = ArmOnFlexibleLink(), CycloidPolynomial(6)
TASK = PointToPoint(PLANT, target=pi / 2, duration=0.8)
SECOND_TASK = PointToPoint(PLANT, start=-pi / 2, target=pi / 4, duration=1.0)
BOX, CANDIDATES, MANY = 0.5, 200, 10_000
FEW, TUNING = 5, 40  # candidates of solve_ivp: to time, to choose its samples
ENERGY_ERROR, ARRIVAL_ERROR, SHARE, REFERENCE_STEPS = 1e-4, 1e-6, 0.9, 1500
FEWER_STEPS = range(14, 60, 2)
STEPS = (20, 24, 28, 32, 36, 40, 44, 48, 52, 56, 60, 64, 70, 76, 82, 90, 100, 110, 120, 135, 150,
         170, 190, 210, 240, 270, 300, 350, 400)  # fmt: skip
SAMPLES = (200, 300, 400, 600, 800, 1000, 1500, 2000, 4000)

Values = NDArray[np.float64]
"""A row a candidate: F1 [m], F2 [J], W at arrival [m]."""


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
                "DOP853", np.linspace(0.0, x.window, residual_samples(TASK)),
                rtol=1e-8, atol=1e-10,
            )  # fmt: skip
            peak = abs(x.phi) * np.abs(after.y[0]).max()
        table[candidate] = peak, energy, W[-1]
    return table


def even(steps: int) -> NDArray[np.float64]:
    return np.linspace(0.0, 1.0, steps + 1)


def graded(steps: int) -> NDArray[np.float64]:
    begin, _ = mesh(np.arange(steps + 1.0), steps)
    return np.array(begin).ravel()


@dataclass(frozen=True)
class Method:
    """A row of the tables.

    `errors` are of every candidate: of F2 (relative), W at arrival [m], F1 (relative). `target` is
    the least ratio to quietarm that is asked for, where there is one.
    """

    title: str
    steps: str
    errors: tuple[NDArray[np.float64], ...]
    call: Callable[[], object]
    candidates: int = CANDIDATES
    target: float | None = None


def errors_of(values: Values, reference: Values) -> tuple[NDArray[np.float64], ...]:
    difference = np.abs(values - reference)
    relative = difference / np.abs(reference)
    return relative[:, 1], difference[:, 2], relative[:, 0]


def accurate(errors: tuple[NDArray[np.float64], ...]) -> bool:
    energy, arrival, _ = errors
    return bool(
        np.quantile(energy, SHARE) <= ENERGY_ERROR and np.quantile(arrival, SHARE) <= ARRIVAL_ERROR
    )


def by_rollout(population: NDArray[np.float64], steps: int) -> Values:
    """The rollout, with the peak after arrival in closed form."""
    x, rows = numbers(TASK), []
    for a in population:
        result = rollout(TASK, PROFILE, a, steps)
        rows.append([peak_after(x, *result.arrival), result.motion.energy, result.arrival[0]])
    return np.array(rows)


def tuned(
    title: str,
    choices: Sequence[tuple[str, Callable[[NDArray[np.float64]], Values]]],
    population: NDArray[np.float64],
    reference: Values,
    timed_on: int = CANDIDATES,
    target: float | None = None,
) -> Method:
    """The first of the choices that is accurate enough."""
    for name, march in choices:
        errors = errors_of(march(population), reference)
        if accurate(errors):
            call = partial(march, population[:timed_on])
            return Method(title, name, errors, call, timed_on, target)
    raise RuntimeError(f"{title}: {choices[-1][0]} are not accurate enough")


def ours(
    title: str, steps: int | None, population: NDArray[np.float64], reference: Values
) -> Method:
    """The population objective with its default or another number of steps."""
    objective = PopulationObjective(TASK, PROFILE, steps=steps)
    values = objective(population)
    arrival = by_rollout(population, objective.steps)[:, 2]
    figures = np.column_stack([values.residual, values.energy, arrival])
    call = partial(objective, population)
    return Method(title, f"{objective.steps} graded", errors_of(figures, reference), call)


def methods(population: NDArray[np.float64]) -> list[Method]:
    """First quietarm, then the others, with steps that make them as accurate as asked."""
    x, reference = numbers(TASK), by_rollout(population, REFERENCE_STEPS)
    fewer = (ours("quietarm, PopulationObjective", n, population, reference) for n in FEWER_STEPS)
    rows = [
        next(method for method in fewer if accurate(method.errors)),
        ours("quietarm, default steps", None, population, reference),
    ]
    for title, march, option, spacing, target in (
        ("numba loop", march_compiled, False, even, 1.0),
        ("numba loop, graded", march_compiled, False, graded, 1.0),
        ("numba loop, trapezoid", march_compiled, True, even, None),
        ("NumPy, time by time", march_arrays, False, even, 5.0),
        ("NumPy, time by time, graded", march_arrays, False, graded, 5.0),
        ("NumPy, all at once, graded", march_arrays, True, graded, None),
    ):
        choices = [
            (f"{steps} {spacing.__name__}", partial(march, x, spacing(steps), option))
            for steps in STEPS
        ]
        rows.append(tuned(title, choices, population, reference, target=target))
    for title, equations, through, target in (
        ("solve_ivp, in NumPy, F1 too", rates_in_numpy, True, 3000.0),
        ("solve_ivp, in NumPy", rates_in_numpy, False, 3000.0),
        ("solve_ivp, in floats, F1 too", rates_in_floats, True, None),
        ("solve_ivp, in floats", rates_in_floats, False, None),
    ):
        choices = [
            (f"{samples} samples", partial(integrate, x, samples, equations, through))
            for samples in SAMPLES
        ]
        rows.append(tuned(title, choices, population[:TUNING], reference[:TUNING], FEW, target))
    return rows


def times_of(rows: Sequence[Method], rounds: int) -> NDArray[np.float64]:
    """CPU time per candidate [us]: rounds, methods, first and second call."""
    times = np.empty((rounds, len(rows), 2))
    for turn in range(rounds):
        for column, method in enumerate(rows):
            for call in range(2):
                began = time.process_time()
                method.call()
                seconds = time.process_time() - began
                times[turn, column, call] = 1e6 * seconds / method.candidates
    return times


def time_table(rows: Sequence[Method], times: NDArray[np.float64]) -> Table:
    table = Table(title=f"CPU time per candidate in us, {CANDIDATES} candidates")
    table.add_column("method")
    for name in ("steps", "cold", "least", "median", "/ quietarm", "target"):
        table.add_column(name, justify="right")
    for column, method in enumerate(rows):
        cold, warm = times[:, column].T
        ratio = float(np.median(warm / times[:, 0, 1]))
        verdict = ""
        if method.target is not None:
            verdict = f"{method.target:g} {'met' if ratio >= method.target else 'missed'}"
        table.add_row(
            method.title,
            method.steps,
            *(f"{value:,.2f}" for value in (np.median(cold), warm.min(), np.median(warm))),
            f"{ratio:,.2f}",
            verdict,
        )
    return table


def error_table(rows: Sequence[Method]) -> Table:
    table = Table(title=f"errors: {SHARE:.0%} quantile, root mean square, largest")
    table.add_column("method")
    for quantity in ("F2, relative", "W at arrival, m", "F1, relative"):
        table.add_column(quantity, justify="right")
    for method in rows:
        cells = [
            f"{np.quantile(e, SHARE):.0e} {np.sqrt(np.mean(e**2)):.0e} {e.max():.0e}"
            for e in method.errors
        ]
        table.add_row(method.title, *cells)
    return table


def threads_table(rng: np.random.Generator, rounds: int) -> Table:
    table = Table(title="two threads, wall time, least")
    for name in ("candidates", "one thread", "two threads", "one / two"):
        table.add_column(name, justify="right")
    objectives = [PopulationObjective(TASK, PROFILE, threads=threads) for threads in (1, 2)]
    for count in (CANDIDATES, 10 * CANDIDATES, MANY):
        population = rng.uniform(-BOX, BOX, (count, PROFILE.size))
        times = [
            [timed(partial(objective, population))[0] for objective in objectives]
            for _ in range(rounds)
        ]
        one, two = (1e6 * min(column) / count for column in zip(*times, strict=True))
        table.add_row(f"{count:,}", f"{one:.2f} us", f"{two:.2f} us", f"{one / two:.2f}")
    return table


def tasks_table(population: NDArray[np.float64]) -> Table:
    """Objective and first population of a task, when nothing is built and when a like one is."""

    def values(task: PointToPoint) -> float:
        return timed(lambda: PopulationObjective(task, PROFILE)(population))[0]

    forget_compiled()
    _compiled.cache_clear()
    first, second = values(TASK), values(SECOND_TASK)
    table = Table(title=f"objective and {CANDIDATES} candidates, wall time")
    for name in ("first task", "second task", "first / second", "functions built"):
        table.add_column(name, justify="right")
    built = str(_compiled.cache_info().misses)
    table.add_row(f"{1e3 * first:.0f} ms", f"{1e3 * second:.1f} ms", f"{first / second:.0f}", built)
    return table


MEMORY = f"""
import math, numpy as np
from metaheuristics import PopulationObjective
from models import ArmOnFlexibleLink
from ocp import CycloidPolynomial, PointToPoint

def peak():  # ru_maxrss would start from the parent's peak
    return next(int(line.split()[1]) for line in open("/proc/self/status") if "VmHWM" in line)

population = np.random.default_rng(0).uniform(-{BOX}, {BOX}, ({MANY}, {PROFILE.size}))
before = peak()
PopulationObjective(
    PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8), CycloidPolynomial({PROFILE.size})
)(population)
print((peak() - before) / 1024)
"""


def memory_growth() -> float:
    """Growth of the peak memory by objective and population [MiB], in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-c", MEMORY], check=True, capture_output=True, text=True
    )
    return float(done.stdout)


def main() -> None:
    parser = argparse.ArgumentParser(description="The population objective against other ways.")
    parser.add_argument("--rounds", type=int, default=40, help="40 by default")
    parser.add_argument("--seed", type=int, default=0, help="of the candidates; 0 by default")
    arguments = parser.parse_args()
    rng = np.random.default_rng(arguments.seed)
    population = rng.uniform(-BOX, BOX, (CANDIDATES, PROFILE.size))
    screen = console()
    screen.print(machine("numpy", "numba", "scipy"))
    rows = methods(population)
    screen.print(time_table(rows, times_of(rows, arguments.rounds)))
    screen.print(error_table(rows))
    screen.print(threads_table(rng, arguments.rounds))
    screen.print(tasks_table(population))
    growth = memory_growth()
    screen.print(f"{MANY:,} candidates: peak memory grows by {growth:.0f} MiB, build included")


if __name__ == "__main__":
    main()
