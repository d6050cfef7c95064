"""Moves one after another, and the waits between them."""

import math
from itertools import pairwise

import numpy as np
import pytest

import quietarm as qa

LINK = qa.SingleLinkManipulator()
PERIOD = 2 * math.pi / LINK.omega
SIX = qa.CycloidPolynomial(6)


@pytest.fixture(scope="module")
def earlier():
    """The plain cycloid, which leaves 77 mm."""
    return qa.evaluate_coefficients(qa.PointToPoint(LINK, math.pi / 6, 0.8), [])


@pytest.fixture(scope="module")
def back():
    return qa.PointToPoint(LINK, 0.0, 0.8, start=math.pi / 6, acceleration_limit=40.0)


def test_a_chosen_wait_is_no_worse_than_any_on_a_grid(earlier, back):
    chosen = qa.plan_after(earlier, back)
    assert 0 <= chosen.wait <= PERIOD * (1 + 1e-12)
    assert chosen.plan.task.initial == earlier.state_after(chosen.wait)
    others = [qa.plan_after(earlier, back, float(w)).plan for w in np.linspace(0, PERIOD, 13)]
    assert chosen.plan.energy <= min(one.energy for one in others) * (1 + 1e-4)
    assert chosen.plan.energy < 0.4 * qa.plan_move(back).energy  # the swing is used


def test_a_period_of_an_undamped_link_changes_nothing():
    undamped = qa.SingleLinkManipulator(zeta=0.0)
    earlier = qa.evaluate_coefficients(qa.PointToPoint(undamped, 0.5, 0.8), [])
    at_once, later = (earlier.next_move(0.0, 0.8, wait) for wait in (0.0, PERIOD))
    assert [*later.initial.W] == pytest.approx(at_once.initial.W, abs=1e-10)
    plans = [qa.plan_move(task, SIX, starts=1) for task in (at_once, later)]
    assert plans[1].energy == pytest.approx(plans[0].energy, rel=1e-7)
    assert plans[1].coefficients == pytest.approx(plans[0].coefficients, abs=1e-4)


def test_a_sequence_begins_each_move_with_what_the_last_one_left(tmp_path):
    tasks = [
        qa.PointToPoint(LINK, 0.5, 0.8),
        qa.PointToPoint(LINK, -0.2, 0.9, start=0.5),
        qa.PointToPoint(LINK, 0.6, 0.8, start=-0.2),
    ]
    found = qa.plan_sequence(tasks, [0.1, (0.0, PERIOD)], qa.CycloidPolynomial(2), starts=1,
                             residual_limit=0.02)  # fmt: skip
    assert [one.plan.task.target for one in found] == [0.5, -0.2, 0.6]
    assert found[1].wait == 0.1
    for last, following in pairwise(found):
        assert following.plan.task.initial == last.plan.state_after(following.wait)
    found[2].plan.save(tmp_path / "third.json")
    assert qa.Plan.load(tmp_path / "third.json") == found[2].plan


def test_ctrl_c_keeps_the_moves_until_then(back, monkeypatch):
    def interrupted(*given, **settings):
        raise KeyboardInterrupt

    there = qa.PointToPoint(LINK, back.start, 0.8, acceleration_limit=40.0)
    monkeypatch.setattr("quietarm.ocp.plan.sequence.plan_moves", interrupted)
    found = qa.plan_sequence([there, back], profile=qa.CycloidPolynomial(2), residual_limit=0.02)
    assert [one.plan.task.target for one in found] == [back.start]
