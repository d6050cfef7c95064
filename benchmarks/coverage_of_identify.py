"""Test how far identify can be trusted, on made-up recordings whose truth is known.

    python benchmarks/coverage_of_identify.py [--runs 300] [--planted 60] [--clean 60] [--seed 0]

Intervals: how often that of the next swing holds the next swing's frequency and damping. Warnings:
of recordings with a planted defect how many are warned of or right, and of clean ones how many are
warned of. Times: processor seconds of one call. Machines have 1 to 60 Hz and 0.003 to 0.1; sensors
have noise, a resolution, an offset; recorders start early and run on; hubs are held, or move and
then stand, seen by an encoder that flickers.
"""

import argparse
import time

import numpy as np
from scipy.signal import StateSpace, lsim

import quietarm as qa

TURN = 2 * np.pi


def decay(t, hertz, damping, amplitude=1.0, start=0.0, phase=0.0):
    """A free swing from its start on."""
    w, s = TURN * hertz, np.maximum(t - start, 0.0)
    return (
        (t >= start)
        * amplitude
        * np.exp(-damping * w * s)
        * np.cos(w * np.sqrt(1 - damping**2) * s + phase)
    )


def machine(rng):
    """Frequency [Hz] and damping ratio."""
    return float(np.exp(rng.uniform(0, np.log(60)))), float(
        np.exp(rng.uniform(np.log(0.003), np.log(0.1)))
    )


def sampled(rng, hertz, periods):
    """Times of a recording of so many periods."""
    return np.arange(0, periods / hertz, 1 / (hertz * rng.uniform(20, 150)))


def sensed(rng, tip):
    """Return what a sensor makes of a tip: noise, an offset, a resolution."""
    noise = np.exp(rng.uniform(np.log(0.003), np.log(0.05))) * np.abs(tip).max()
    seen = tip + noise * rng.standard_normal(len(tip)) + rng.uniform(-1, 1) * np.abs(tip).max()
    step = rng.choice([0.0, 0.01, 0.03]) * np.abs(tip).max()
    return np.round(seen / step) * step if step else seen


def pushed(rng, hertz, damping, name="push", shape=decay):
    """A held hub, pushed one to three times; rest before and after."""
    lasts = min(max(6.0, 2.5 / (TURN * damping)), 40.0)  # periods to a twelfth, about
    count = int(rng.integers(1, 4))
    t = sampled(rng, hertz, count * lasts + rng.uniform(0, 1.5 * lasts) + 2)
    tip, begin = np.zeros(len(t)), rng.uniform(0, 2) / hertz
    for k in range(count):
        start = begin + k * lasts / hertz
        tip = np.where(
            t >= start,
            shape(t, hertz, damping, rng.uniform(0.5, 1), start, rng.uniform(-1, 1)),
            tip,
        )
    return qa.Recording(t, tip=sensed(rng, 10 * tip), name=name)


def moved(rng, hertz, damping, name="move", late=0.0, stiffness=None, count=4096):
    """A hub that moves in a cycloid and stands, or is held by a soft controller; an encoder."""
    w, lasts = TURN * hertz, min(max(10.0, 2.5 / (TURN * damping)), 40.0)
    t = sampled(rng, hertz, lasts + 3)
    span, duration = rng.uniform(0.3, 1.5), rng.uniform(0.6, 2.5) / hertz
    x = np.clip((t - 0.5 / hertz) / duration, 0, 1)
    goal = span * (x - np.sin(TURN * x) / TURN)
    coupling = 0.4  # hub and mode; the tip in units of the hub's
    if stiffness is None:
        theta = goal
        ddtheta = span * TURN / duration**2 * np.sin(TURN * x) * ((x > 0) & (x < 1))
        mode = StateSpace(
            [[0, 1], [-(w**2), -2 * damping * w]], [[0], [-1]], np.eye(2), np.zeros((2, 1))
        )
        q = lsim(mode, ddtheta, t)[1][:, 0]
    else:
        k, c = (stiffness * w) ** 2, 2 * 0.4 * stiffness * w
        M = np.array([[1, coupling], [1, 1]])
        K, D = np.diag([k, w**2]), np.diag([c, 2 * damping * w])
        A = np.block(
            [[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, K), -np.linalg.solve(M, D)]]
        )
        B = np.concatenate([[0, 0], np.linalg.solve(M, [k, 0])])[:, None]
        x = lsim(StateSpace(A, B, np.eye(4), np.zeros((4, 1))), goal, t)[1]
        theta, q = x[:, 0], x[:, 1]
    seen = np.interp(t - late, t, theta)
    counts = TURN / count
    angle = np.round((seen + 0.2 * counts * rng.standard_normal(len(t))) / counts) * counts
    return qa.Recording(t, angle, sensed(rng, q), name=name)


def varied(rng, hertz, spread):
    return hertz * (1 + spread * rng.standard_normal())


def a_machine(seed):
    """Recordings of a machine, and the frequency and damping of its next swing."""
    rng = np.random.default_rng([seed, 1])
    hertz, damping = machine(rng)
    make = moved if seed % 3 == 2 else pushed
    if seed % 3 == 0:
        return [pushed(rng, hertz, damping)], hertz, damping
    spread = rng.choice([0.0, 0.003, 0.03])
    files = int(rng.integers(2, 7))
    each = [
        make(rng, varied(rng, hertz, spread), damping, f"{make.__name__} {k}") for k in range(files)
    ]
    if make is pushed and spread:  # pushes of one file are swings of one machine, a file a day
        each = [
            pushed(
                np.random.default_rng([seed, k]), varied(rng, hertz, spread), damping, f"push {k}"
            )
            for k in range(files)
        ]
    return each, varied(rng, hertz, spread), damping


def two_modes(rng, hertz, damping):
    ratio, share = rng.uniform(2.2, 7), rng.uniform(0.1, 0.5)

    def both(t, hertz, damping, amplitude, start, phase):
        first = decay(t, hertz, damping, amplitude, start, phase)
        return first + decay(t, ratio * hertz, damping, share * amplitude, start, 0.3)

    return pushed(rng, hertz, damping, shape=both)


def saturates(rng, hertz, damping):
    one = pushed(rng, hertz, damping)
    middle, most = np.median(one.tip), np.abs(one.tip - np.median(one.tip)).max()
    limit = rng.uniform(0.4, 0.8) * most
    return qa.Recording(one.time, tip=np.clip(one.tip, middle - limit, middle + limit), name="push")


def drifts(rng, hertz, damping):
    one = pushed(rng, hertz, damping)
    share, size = one.time / one.time[-1], np.ptp(one.tip)
    slow = (
        rng.choice([0, 1]) * np.sin(TURN * rng.uniform(0.5, 2) * share) + rng.uniform(-3, 3) * share
    )
    return qa.Recording(one.time, tip=one.tip + size * slow, name="push")


def wrong_unit(rng, hertz, damping):
    if rng.uniform() < 0.5:  # milliseconds, read as seconds
        one = pushed(rng, hertz, damping)
        return qa.Recording(1e3 * one.time, tip=one.tip, name="push")
    one = moved(rng, hertz, damping)  # degrees, read as radians
    return qa.Recording(one.time, np.degrees(one.angle) % 99, one.tip, name="move")


DEFECTS = {
    "two modes": two_modes,
    "saturation": saturates,
    "drift": drifts,
    "controller": lambda rng, f, z: moved(rng, f, z, stiffness=rng.uniform(0.5, 2.5)),
    "late angle": lambda rng, f, z: moved(rng, f, z, late=rng.uniform(0.02, 0.2) / f),
    "wrong unit": wrong_unit,
}


def identify(recordings):
    """The answer or None where it is refused, and its processor time [s]."""
    begin = time.process_time()
    try:
        found = qa.identify(recordings, qa.FlexibleBeam())
    except ValueError as error:
        return str(error), time.process_time() - begin
    return found, time.process_time() - begin


def warned(found):
    return isinstance(found, str) or bool(
        found.warnings or found.left_out or any(p.warning for p in found.parts)
    )


def why(found):
    if isinstance(found, str):
        return found
    return [*found.warnings, found.left_out, *(part.warning for part in found.parts)]


def ends(found, name):
    one = next((one for one in found.estimates if one.parameter == name), None)
    if one is None:
        return None
    return (one.low, one.high) if one.next_low is None else (one.next_low, one.next_high)


def right(found, hertz):
    """Return whether the frequency is in its interval, or within 0.3 % if that is narrower."""
    if isinstance(found, str) or (at := ends(found, "omega")) is None:
        return False
    low, high = (end / TURN for end in at)
    return min(low, 0.997 * (low + high) / 2) <= hertz <= max(high, 1.003 * (low + high) / 2)


def intervals(runs, seed, verbose):
    held, told, seconds, refused = {"omega": [], "zeta": []}, {"omega": 0, "zeta": 0}, [], 0
    for k in range(seed, seed + runs):
        recordings, hertz, damping = a_machine(k)
        found, spent = identify(recordings)
        seconds.append(spent)
        if isinstance(found, str):
            refused += 1
            print(f"  {k}: {found}") if verbose else None
            continue
        for name, truth in (("omega", TURN * hertz), ("zeta", damping)):
            if (at := ends(found, name)) is not None:
                told[name] += 1
                held[name].append(at[0] <= truth <= at[1])
                if verbose and not held[name][-1]:
                    print(
                        f"  {k}: {name} {truth:.5g} not in {at[0]:.5g} to {at[1]:.5g}, "
                        f"{len(found.parts)} parts, {recordings[0].name}"
                    )
    for name, hits in held.items():
        print(
            f"{name}: identifiable in {told[name]} of {runs}, the next swing's within its interval "
            f"in {100 * np.mean(hits):.1f} %"
        )
    print(
        f"refused: {refused}; {np.median(seconds):.2f} s of processor time at the median, "
        f"{max(seconds):.2f} s at most"
    )


def warnings(planted, clean, seed, verbose):
    good = {name: [0, 0] for name in DEFECTS}
    for k in range(planted):
        name = list(DEFECTS)[k % len(DEFECTS)]
        rng = np.random.default_rng([seed, k, 2])
        hertz, damping = machine(rng)
        found, _ = identify([DEFECTS[name](rng, hertz, damping)])
        fine = warned(found) or right(found, hertz)
        good[name][0] += fine
        good[name][1] += 1
        if verbose and not fine:
            print(
                f"  {k} {name}: {hertz:.5g} Hz {damping:.4g}, "
                f"{[x / TURN for x in ends(found, 'omega') or []]}"
            )
    total = [sum(x) for x in zip(*good.values(), strict=True)]
    print(
        f"defects: {total[0]} of {total[1]} warned of or right ("
        + ", ".join(f"{n} {a}/{b}" for n, (a, b) in good.items())
        + ")"
    )
    false = 0
    for k in range(clean):
        rng = np.random.default_rng([seed, k, 3])
        hertz, damping = machine(rng)
        one = (moved if k % 3 == 2 else pushed)(rng, hertz, damping)
        found, _ = identify([one])
        false += warned(found)
        if verbose and warned(found):
            print(f"  {k} {one.name}: {hertz:.5g} Hz {damping:.4g}: {why(found)}")
    print(f"clean: {false} of {clean} warned of")


def times():
    rng = np.random.default_rng(5)

    def one(rows, seconds, name="push"):
        t = np.linspace(0, seconds, rows)
        return qa.Recording(
            t, tip=decay(t, 3.2, 0.01, 20) + 0.3 * rng.standard_normal(rows), name=name
        )

    cases = {
        "10 s at 1 kHz": [one(10_000, 10)],
        "40,000 rows": [one(40_000, 40)],
        "seven of 10,000 rows": [one(10_000, 10, f"push {k}") for k in range(7)],
    }
    for name, recordings in cases.items():
        print(f"{name}: {identify(recordings)[1]:.2f} s of processor time")


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    for name, usual in {"runs": 300, "planted": 60, "clean": 60, "seed": 0}.items():
        parser.add_argument(f"--{name}", type=int, default=usual)
    parser.add_argument("--verbose", action="store_true", help="name each that is missed")
    given = parser.parse_args()
    intervals(given.runs, given.seed, given.verbose)
    warnings(given.planted, given.clean, given.seed, given.verbose)
    times()


if __name__ == "__main__":
    main()
