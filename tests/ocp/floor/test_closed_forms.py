"""The floor against closed forms."""

import math

import pytest

import quietarm as qa


def rigid(c=0.03):
    """A joint beside a mode that nothing excites: tau = alpha1 theta'' + c theta'."""
    return qa.SingleLinkManipulator(alpha1=0.02, alpha2=0.0, beta1=0.0, c=c)


def _friction_floor(inertia, c, span, duration):
    """Least integral of |tau theta'| for tau = I theta'' + c theta', no limits.

    While the power is positive the energy is the gain of I v^2/2 plus the integral of c v^2, which
    for a given way is least at a constant speed v. While the torque is zero the joint coasts, its
    speed falling as exp(-c t/I), for nothing. So: a jolt to v, v held until t1, coasting down to
    x v, and a jolt to rest. With A = E/v^2 and D = span/v,

        A = I (1 + x^2)/2 + c t1,   D = t1 + (I/c) (1 - x),   x = exp(-c (T - t1)/I),

    and E = A (span/D)^2 is stationary where c (1 + x^2) D = 2 A (1 - x), that is
    c t1 (x^2 + 2 x - 1) = 0: the joint coasts until its speed is sqrt(2) - 1 of what it was.
    """
    x = math.sqrt(2) - 1
    t1 = duration + inertia / c * math.log(x)
    assert t1 > 0  # else it coasts from the start
    A = inertia * (1 + x * x) / 2 + c * t1
    return A * (span / (t1 + inertia / c * (1 - x))) ** 2


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("smooth", [False, True])
def test_a_rigid_joint_with_friction_has_its_closed_form(smooth):
    plant = rigid()
    expected = _friction_floor(plant.alpha1, plant.c, 1.5, 0.8)
    floor = qa.energy_floor(qa.PointToPoint(plant, 1.5, 0.8), smooth=smooth, starts=1)
    assert floor.energy == pytest.approx(expected, rel=2e-3)
    assert floor.energy > expected * (1 - 1e-4)  # no motion is cheaper
    # A jolt takes up to 4e-5 of the move at any level.
    assert abs(floor.energy - expected) < 2 * floor.discretisation_error + 1e-4 * expected


def test_a_rigid_joint_with_limited_acceleration_has_its_closed_form():
    # Without friction every motion costs I v^2 with v its top speed (up, and braked down again);
    # the least top speed is the trapezium's: span = v T - v^2/A.
    limit, span, duration = 15.0, 1.5, 0.8
    v = (limit * duration - math.sqrt((limit * duration) ** 2 - 4 * limit * span)) / 2
    task = qa.PointToPoint(rigid(c=0.0), span, duration, acceleration_limit=limit)
    floor = qa.energy_floor(task, starts=1)
    assert floor.energy == pytest.approx(task.plant.alpha1 * v**2, rel=1e-3)
    assert floor.motion.peak_speed == pytest.approx(v, rel=2e-3)
    assert floor.motion.peak_acceleration <= limit * (1 + 1e-9)


@pytest.mark.slow
def test_the_floor_of_an_uncertain_task_is_that_of_the_nominal_plant():
    # a robust plan has no residual limit to go by: nothing bends this plant
    uncertain = qa.PointToPoint(rigid(), 1.0, 1.0, uncertainty=qa.Uncertainty({"alpha1": 0.1}))
    floors = [
        qa.energy_floor(task, starts=1, energy_tolerance=0.5)
        for task in (qa.PointToPoint(rigid(), 1.0, 1.0), uncertain)
    ]
    assert floors[1].energy == pytest.approx(floors[0].energy, rel=1e-3)
