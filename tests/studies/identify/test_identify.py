"""Parameters from made-up recordings, whose truth is known, and from those of a real link."""

import math
from functools import partial

import numpy as np
import pytest
from quietarm.models import JointMotion
from scipy.integrate import solve_ivp

import quietarm as qa

LINK = qa.SingleLinkManipulator(
    alpha1=0.03, alpha2=0.1, c=0.05, omega=12.0, zeta=0.02, beta1=0.3, phi=2.0
)
TIME = np.arange(0, 4, 0.004)


def hub(t):
    """A quintic move of 1 rad in 0.5 s."""
    x = np.clip((t - 0.2) / 0.5, 0, 1)
    return [
        x**3 * (10 - 15 * x + 6 * x**2),
        30 * x**2 * (1 - x) ** 2 / 0.5,
        60 * x * (1 - x) * (1 - 2 * x) / 0.25,
    ]


def joint_at(t):
    return JointMotion(*map(float, hub(t)))


@pytest.fixture(scope="module")
def moved():
    """Tip and torque of the link after a move, by scipy."""

    def rates(t, state):
        (ddW,) = LINK.modal_accelerations(joint_at(t), state[:1], state[1:])
        return [state[1], ddW]

    run = solve_ivp(rates, (0, 4), [0, 0], "DOP853", TIME, rtol=1e-10, atol=1e-13, max_step=0.02)
    torque = [
        float(LINK.torque(joint_at(t), x[:1], x[1:], rates(t, x)[1:]))
        for t, x in zip(TIME, run.y.T, strict=True)
    ]
    return LINK.phi * run.y[0], np.array(torque)


def noisy(values, share, seed=0):
    noise = np.random.default_rng(seed).standard_normal(len(values))
    return values + share * np.abs(values).max() * noise


def rung(frequency=3.2, zeta=0.01, seconds=6.0, rate=200, seed=0):
    """A push of the tip, with the joint held: 20 mm, in steps of 1 mm, 5 % of noise."""
    t, omega = np.arange(0, seconds, 1 / rate), 2 * math.pi * frequency
    swing = np.exp(-zeta * omega * t) * np.cos(omega * math.sqrt(1 - zeta**2) * t + seed)
    return qa.Recording(t, tip=np.round(noisy(0.02 * swing, 0.05, seed), 3), name=f"push {seed}")


def ends_of(found):
    return {one.parameter: (one.low, one.high) for one in found.told}


def test_a_push_tells_frequency_and_damping():
    found = qa.identify([rung()], qa.FlexibleBeam())
    ends = ends_of(found)
    assert ends["omega"][0] < 2 * math.pi * 3.2 < ends["omega"][1]
    assert ends["zeta"][0] < 0.01 < ends["zeta"][1]
    assert found.told[0].error < 0.005
    assert found.plant.omega == found.told[0].value
    assert found.plant.length == qa.FlexibleBeam().length  # what is not sought stays
    assert 0.02 < found.parts[0].misfit < 0.5
    assert found.untold == {}


def test_ring_downs_are_found_between_pushes():
    pushes = [rung(seconds=4.0, seed=seed).tip for seed in (0, 2)]
    quiet = np.zeros(200)
    tip = np.concatenate([quiet, pushes[0], pushes[1]])
    found = qa.identify([qa.Recording(np.arange(len(tip)) / 200, tip=tip)], qa.FlexibleBeam())
    begins = [part.begin for part in found.parts]
    assert begins == pytest.approx([1.3, 5.3], abs=0.4)  # within two periods
    assert all(part.held_back < 2 * part.misfit + 0.05 for part in found.parts)


def test_the_push_of_the_joint_shows_while_it_moves(moved):
    tip, _ = moved
    assumed = qa.SingleLinkManipulator(phi=2.0)
    recording = qa.Recording(TIME, hub(TIME)[0], noisy(tip, 0.01))
    found = qa.identify([recording], assumed, ["omega", "zeta", "beta1", "phi", "alpha1"])
    low, high = ends_of(found)["beta1"]
    assert low < 0.3 < high
    assert found.untold == {
        "phi": "it does what beta1 does",
        "alpha1": "nothing that was recorded depends on it",
    }


def test_a_torque_tells_inertia_and_friction_too(moved):
    _, torque = moved
    assumed = qa.SingleLinkManipulator(beta1=0.3)
    found = qa.identify([qa.Recording(TIME, hub(TIME)[0], torque=noisy(torque, 0.01))], assumed)
    ends = ends_of(found)
    for name in ("omega", "zeta", "alpha1", "alpha2", "c"):
        assert ends[name][0] < getattr(LINK, name) < ends[name][1]
    assert set(found.errors) == {"omega", "zeta"}  # no others move the tip


def test_pushes_of_different_machines_have_an_interval_that_has_them_all():
    frequencies = (3.1, 3.2, 3.3, 3.25)
    each = [rung(one, seed=seed) for seed, one in enumerate(frequencies)]
    found = qa.identify(each, qa.FlexibleBeam(), ["omega"])
    (one,) = found.told
    assert one.by == "spread"
    assert one.low < 2 * math.pi * np.mean(frequencies) < one.high
    assert one.error > 0.02


def test_intervals_cover_the_truth():
    # benchmarks/coverage_of_identify.py has 200 with a moving hub; binomial: 16 of 20 or fewer
    # has a chance of 1 in 60 for 95 %
    hits = 0
    for seed in range(20):
        found = qa.identify([rung(2 + seed / 10, seconds=3.0, seed=seed)], qa.FlexibleBeam())
        low, high = ends_of(found)["omega"]
        hits += low < 2 * math.pi * (2 + seed / 10) < high
    assert hits >= 17


def test_a_machine_is_saved_and_planned_for_robustly(tmp_path):
    found = qa.identify([rung()], qa.FlexibleBeam())
    found.save(tmp_path / "arm.json")
    assert qa.Identified.load(tmp_path / "arm.json") == found
    task = qa.PointToPoint(found.plant, 0.5, 1.0, uncertainty=qa.Uncertainty(found.errors))
    assert task.ranges == {one.parameter: one.error for one in found.told}


T = np.linspace(0, 2, 400)
RING = np.cos(20 * T)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (partial(qa.Recording, T, 300 * T, RING), "an angle of 600 rad; is it in degrees"),
        (partial(qa.Recording, T[::-1], tip=RING), "does not increase from row 1"),
        (partial(qa.Recording, T, tip=np.where(T > 1, np.nan, RING)), "tip in row 201 is no"),
        (partial(qa.Recording, T), "has no tip, acceleration or torque"),
    ],
)
def test_what_cannot_be_a_recording_is_refused(make, said):
    with pytest.raises(ValueError, match=said):
        make()
