"""Least energies without quietarm: equations typed afresh, RK4, SciPy's SLSQP.

    python benchmarks/optimum_by_scipy.py [--starts 3] [--seed 3] [--only arm]

For the paper's conditions and the third plant's move: least F2 over six coefficients with
W = W' = 0 at arrival, in a box (the paper's for its own) and without one, from zeros and from
random starts. `docs/physics.md` quotes what it prints.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from math import pi

import numpy as np
from scipy.optimize import minimize

Array = np.ndarray
POLYNOMIAL = np.polynomial.Polynomial
TERMS = 6
SCALES = 10.0, 100.0, 10.0  # of F2, W and W', to numbers around one


def joint(a: Array, start: float, target: float, duration: float, t: Array) -> list[Array]:
    """theta, theta', theta'' by eqs (1), (2), (3) mended, (6), (7); a candidate a row."""
    T, rate, span = -1 + 2 * t / duration, 2 / duration, target - start
    terms = [POLYNOMIAL([1, 0, -1]) * POLYNOMIAL([0] * n + [1]) for n in range(a.shape[1])]
    U = a @ [term(T) for term in terms] + t / duration
    dU = a @ [term.deriv(1)(T) for term in terms] * rate + 1 / duration
    ddU = a @ [term.deriv(2)(T) for term in terms] * rate**2
    sine, cosine = np.sin(pi * U), np.cos(pi * U)
    return [
        start + span * (U - np.sin(2 * pi * U) / (2 * pi)),
        2 * span * sine**2 * dU,
        2 * span * sine * (2 * pi * cosine * dU**2 + sine * ddU),
    ]


def single_link(q: Array, dq: Array, ddq: Array, W: Array, dW: Array) -> tuple[Array, Array]:
    """W'' and torque by eqs (8) to (10)."""
    ddW = -2 * 9.636e-3 * 10.43 * dW - 10.43**2 * W - 2.555e-1 * ddq - 2.614e-1 * dq**2 * W
    return ddW, 2.383e-2 * ddq + 9.261e-2 * ddW + 3.091e-2 * dq


def arm(q: Array, dq: Array, ddq: Array, W: Array, dW: Array) -> tuple[Array, Array]:
    """W'' and torque by eqs (13) to (15)."""
    push = (-9.949e-3 + 5.256e-2 * np.cos(q)) * ddq
    turn = (7.634e-2 * dW * dq - 5.256e-2 * dq**2) * np.sin(q)
    force = 2 * 1.5e-3 * 7.32 * dW + 7.32**2 * W + push + turn
    ddW = -force / (1 - 1.055e-1 * np.cos(q))
    return ddW, 5.366e-3 * ddq + 1.965e-2 * dq + (-4.944e-3 + 2.399e-2 * np.cos(q)) * ddW


def two_links(q: Array, dq: Array, ddq: Array, W: Array, dW: Array) -> tuple[Array, Array]:
    """W'', a link a row, and torque of the third plant of docs/physics.md."""
    omega = np.array([[12.68], [10.71]]) * 0.993
    zeta = np.array([[15.49e-3 * 1.214], [14.27e-3 * 1.071]])
    a = np.array([[0.2266 * 0.984], [0.2570 * 1.003]])
    b = np.array([[2.004e-3 * 1.020], [5.822e-3 * 1.006]])
    ddW = -2 * zeta * omega * dW - omega**2 * W - a * ddq - b * dq**2 * W
    links = 6.652e-2 * 1.018 * ddW[0] + 5.237e-2 * 1.052 * ddW[1]
    return ddW, 2.996e-2 * 1.016 * ddq + links + 4.202e-2 * 1.131 * dq


CONDITIONS = {  # Tables 3 and 6: equations, start, target, duration, box of eq (12) or (17)
    "single link, 0 to pi/6, 0.8 s": (single_link, 0.0, pi / 6, 0.8, 0.2),
    "single link, 0 to pi/2, 1.0 s": (single_link, 0.0, pi / 2, 1.0, 0.2),
    "single link, 0 to pi/2, 1.1 s": (single_link, 0.0, pi / 2, 1.1, 0.2),
    "arm, 0 to pi/2, 0.8 s": (arm, 0.0, pi / 2, 0.8, 0.5),
    "arm, -pi/2 to pi/4, 1.0 s": (arm, -pi / 2, pi / 4, 1.0, 0.5),
    "arm, -pi/2 to pi/2, 1.2 s": (arm, -pi / 2, pi / 2, 1.2, 0.5),
    "two links, 0 to pi/2, 0.9 s": (two_links, 0.0, pi / 2, 0.9, 0.5),  # the box is ours
}


def simulate(equations: Callable, move: tuple[float, ...], a: Array, steps: int) -> Array:
    """F2, and W and W' at arrival, by RK4: a candidate a row; the power linear over a step."""
    duration = move[2]
    q = joint(a, *move, np.linspace(0, duration, 2 * steps + 1))
    still = np.zeros((2, len(a)) if equations is two_links else len(a))
    h, W, dW = duration / steps, still, still

    def rates(i: int, W: Array, dW: Array) -> tuple[Array, Array]:
        ddW, torque = equations(*(entry[:, i] for entry in q), W, dW)
        return ddW, torque * q[1][:, i]

    power = []
    for i in range(0, 2 * steps, 2):
        k1, at_node = rates(i, W, dW)
        power.append(at_node)
        k2 = rates(i + 1, W + h / 2 * dW, dW + h / 2 * k1)[0]
        k3 = rates(i + 1, W + h / 2 * (dW + h / 2 * k1), dW + h / 2 * k2)[0]
        k4 = rates(i + 2, W + h * (dW + h / 2 * k2), dW + h * k3)[0]
        W = W + h * dW + h**2 / 6 * (k1 + k2 + k3)
        dW = dW + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    power.append(rates(2 * steps, W, dW)[1])
    p, n = np.array(power[:-1]), np.array(power[1:])
    both = np.abs(p) + np.abs(n)
    crossed = (p**2 + n**2) / np.where(both > 0, both, 1)  # two triangles
    energy = h / 2 * np.where(p * n < 0, crossed, both).sum(axis=0)
    return np.vstack([energy, W, dW]).T


def least_energy(equations: Callable, move: tuple, box: float | None, start: Array) -> Array:
    """The coefficients where SLSQP ends."""
    modes = 2 if equations is two_links else 1
    scales = np.repeat(SCALES, [1, modes, modes])

    def values(a: Array) -> Array:
        return (simulate(equations, move, a[None], 400) * scales)[0]

    def slopes(a: Array) -> Array:
        d = 1e-6 * np.eye(TERMS)
        found = simulate(equations, move, np.vstack([a + d, a - d]), 400) * scales
        return np.ascontiguousarray((found[:TERMS] - found[TERMS:]).T) / 2e-6  # SLSQP reads rows

    at_rest = {"type": "eq", "fun": lambda a: values(a)[1:], "jac": lambda a: slopes(a)[1:]}
    return minimize(
        lambda a: values(a)[0],
        start,
        jac=lambda a: slopes(a)[0],
        method="SLSQP",
        bounds=None if box is None else [(-box, box)] * TERMS,
        constraints=at_rest,
        options={"maxiter": 300, "ftol": 1e-9},
    ).x


def main() -> None:
    """Print F2 and |W|, |W'| at arrival of each start."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--starts", type=int, default=3)
    parser.add_argument("--seed", type=int, default=3)
    parser.add_argument("--only", default="", help="part of the names of conditions")
    given = parser.parse_args()
    random = np.random.default_rng(given.seed)
    for name, (equations, *move, width) in CONDITIONS.items():
        if given.only not in name:
            continue
        for box in (width, None):
            print(f"{name}, {'no box' if box is None else f'box {box}'}")
            for k in range(given.starts):
                start = random.uniform(-width / 2, width / 2, TERMS) if k else np.zeros(TERMS)
                a = least_energy(equations, tuple(move), box, start)
                energy, *arrival = simulate(equations, tuple(move), a[None], 3200)[0]
                W, dW = np.abs(arrival).reshape(2, -1).max(axis=1)
                print(f"    F2 {energy:.5f} J, |W| {W:.0e} m, |W'| {dW:.0e} m/s")


if __name__ == "__main__":
    main()
