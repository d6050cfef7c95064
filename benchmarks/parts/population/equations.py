"""The move that is measured, and its equations as one writes them by hand: eqs (1)-(7), (13).

The plant is reduced to W'' = g - K W - D W', and the peak after arrival is in closed form.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from math import pi
from typing import Any, NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from quietarm.models import ArmOnFlexibleLink, JointMotion
from quietarm.ocp import CycloidPolynomial, PointToPoint
from quietarm.ocp.simulation.collocation import modal_system

PLANT, PROFILE = ArmOnFlexibleLink(), CycloidPolynomial(6)
TASK = PointToPoint(PLANT, target=pi / 2, duration=0.8, residual_window=1.0)

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
