"""How often the intervals of identify cover the truth, on made-up recordings of a flexible beam.

    python benchmarks/coverage_of_identify.py [--runs 200]

Each machine swings 8 s at 200 Hz after a fast move: its hub follows the move late and goes on
moving a little, its angle comes from an encoder of 4096 counts, its tip from a sensor of 1 mm
with 5 % of noise. Every second machine is recorded three times.
"""

import argparse
import time

import numpy as np
from quietarm.models import JointMotion
from scipy.integrate import solve_ivp

import quietarm as qa

COUNT, QUANTUM, NOISE, RATE = 2 * np.pi / 4096, 1e-3, 0.05, 200


def hub(t, rng):
    """Angle, speed, acceleration of a move and of what the drive adds to it."""
    span, begin, duration = rng.uniform(0.5, 1.5), 0.3, rng.uniform(0.25, 0.5)
    size, rate, phase = rng.uniform(1e-3, 4e-3), 2 * np.pi * rng.uniform(2, 6), rng.uniform(0, 6)
    x = np.clip((t - begin) / duration, 0, 1)
    move = [
        span * x**3 * (10 - 15 * x + 6 * x**2),
        span * 30 * x**2 * (1 - x) ** 2 / duration,
        span * 60 * x * (1 - x) * (1 - 2 * x) / duration**2,
    ]
    swing = [np.cos(rate * t + phase + k * np.pi / 2) * rate**k for k in range(3)]
    return [a + size * b for a, b in zip(move, swing, strict=True)]


def recorded(plant, seed):
    """A recording of the plant, and nothing else is known of it."""
    t = np.arange(0, 8, 1 / RATE)

    def motion(at):
        return hub(at, np.random.default_rng(seed))

    def rates(at, state):
        joint = JointMotion(*map(float, motion(np.array(at))))
        (ddW,) = plant.modal_accelerations(joint, [state[0]], [state[1]])
        return [state[1], float(ddW)]

    swing = solve_ivp(rates, (0, 8), [0, 0], "DOP853", t, rtol=1e-9, atol=1e-12, max_step=0.02).y[0]
    noise = np.random.default_rng([seed, 1]).standard_normal(len(t))
    tip = swing + NOISE * np.abs(swing).max() * noise
    angle = motion(t)[0]
    return qa.Recording(
        t, np.round(angle / COUNT) * COUNT, np.round(tip / QUANTUM) * QUANTUM, name=str(seed)
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=200)
    runs = parser.parse_args().runs
    covered, widths, seconds = {}, {}, []
    for run in range(runs):
        rng = np.random.default_rng([run, 7])
        truth = qa.FlexibleBeam(
            omega=2 * np.pi * rng.uniform(1.5, 6), zeta=rng.uniform(0.005, 0.03)
        )
        recordings = [recorded(truth, 10 * run + k) for k in range(1 + 2 * (run % 2))]
        begin = time.perf_counter()
        found = qa.identify(recordings, qa.FlexibleBeam())
        seconds.append(time.perf_counter() - begin)
        for one in found.told:
            right = one.low <= getattr(truth, one.parameter) <= one.high
            covered.setdefault(one.parameter, []).append(right)
            widths.setdefault(one.parameter, []).append(one.error)
    for name, hits in covered.items():
        print(
            f"{name:6} told in {len(hits)} of {runs}, covered in {100 * np.mean(hits):.1f} %, "
            f"interval +-{100 * np.median(widths[name]):.2g} % at the median"
        )
    print(f"{np.median(seconds):.2f} s at the median, {max(seconds):.2f} s at most")


if __name__ == "__main__":
    main()
