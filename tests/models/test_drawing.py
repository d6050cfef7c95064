"""Drawings of structures: the mode shape, tips where the equations have them, refusals."""

import numpy as np
import pytest

import quietarm as qa
from quietarm.models.beam_modes import beam_modes, mode_shape
from quietarm.models.drawing import TIP_SLOPE

pytestmark = pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")


def tips_of(bodies):
    return [body.points[-1] for body in bodies if body.tip]


def test_the_mode_shape_is_that_of_a_clamped_free_beam():
    # Blevins, table 8-1: cosh kx - cos kx - 0.7341 (sinh kx - sin kx), 2 at the tip, k = 1.8751.
    k, sigma, at = 1.8751040687, 0.7340955138, np.linspace(0, 1, 11)
    shape = np.cosh(k * at) - np.cos(k * at) - sigma * (np.sinh(k * at) - np.sin(k * at))
    (first,), *_ = beam_modes(1, 0.0, 0.0)
    assert [mode_shape(first, x)[0] for x in at] == pytest.approx(shape / 2, abs=1e-9)
    slope = k * (np.sinh(k) + np.sin(k) - sigma * (np.cosh(k) - np.cos(k))) / 2
    assert pytest.approx(slope, abs=1e-8) == TIP_SLOPE


def test_the_tip_of_the_single_link_moves_as_its_kinetic_energy_has_it():
    angle, w = 0.4, 0.05
    (tip,) = tips_of(qa.SingleLinkManipulator().structure(angle, [w]))
    radial, across = [np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]
    assert tip @ radial == pytest.approx(0.475)  # the plate's length, section 3.1
    assert tip @ across == pytest.approx(w)


def test_the_tips_of_the_two_links_go_the_same_way_round():
    first, second = tips_of(qa.DualLinkManipulator().structure(0.0, [0.1, 0.2]))
    assert first == pytest.approx([0.5, 0.1])
    assert second == pytest.approx([-0.5, -0.2])


def test_a_plant_without_a_drawing_is_a_straight_link_for_each_tip():
    class Two(qa.SingleLinkManipulator):
        structure = qa.Plant.structure

    first, second, joint = Two().structure(0.0, [0.1, -0.2])
    assert first.points == pytest.approx(np.array([[0, 0], [1, 0.1]]))
    assert second.points == pytest.approx(np.array([[0, 0], [1, -0.2]]))
    assert joint.points == pytest.approx(np.zeros((1, 2)))
    assert [(body.rigid, body.tip) for body in (first, second, joint)] == [
        (True, True), (True, True), (True, False)
    ]  # fmt: skip


def test_the_arms_link_is_clamped_at_the_origin_and_bears_a_rigid_arm():
    clamp, link, arm, motor = qa.ArmOnFlexibleLink().structure(0.7, [0.02])
    assert [body.rigid for body in (clamp, link, arm, motor)] == [True, False, True, True]
    assert clamp.points.mean(axis=0) == pytest.approx([0, 0])  # as far up as down
    assert clamp.points[:, 0] == pytest.approx([0, 0])
    assert np.ptp(clamp.points[:, 1]) < np.linalg.norm(np.diff(arm.points, axis=0))
    assert link.points[0] == pytest.approx([0, 0])
    assert motor.points.tolist() == [link.points[-1].tolist()]


def test_the_arm_turns_as_the_signs_of_its_equations_say():
    # The coupling of eq (13), (alpha2 + alpha3 cos theta) theta'' with alpha3 > 0 and alpha2 < 0:
    # at 0 rad a growing joint angle moves the arm towards positive w; the arm's own turning, which
    # alpha2 and beta2 hold, is theta' less the slope's rate.
    plant = qa.ArmOnFlexibleLink()

    def arm(angle, w):
        _, link, arm, _ = plant.structure(angle, [w])
        assert link.tip
        assert arm.points[0] == pytest.approx(link.points[-1])
        return np.diff(arm.points, axis=0)[0]

    (tip,) = tips_of(plant.structure(1.0, [0.03]))
    assert tip == pytest.approx([0.55, 0.03])
    assert arm(1e-6, 0.0)[1] > 0
    assert arm(np.pi / 2, 0.0) == pytest.approx([0, 0.21])
    slope = np.arctan(TIP_SLOPE * 0.03 / 0.55)
    assert arm(slope, 0.03) == pytest.approx(arm(0.0, 0.0))


@pytest.mark.parametrize("plant", [qa.SingleLinkManipulator(), qa.DualLinkManipulator()])
def test_the_hub_is_a_rigid_disc_on_the_axis_and_the_links_bend(plant):
    *links, hub = plant.structure(0.4, [0.05] * plant.tips)
    assert (hub.rigid, hub.tip, hub.points.tolist()) == (True, False, [[0.0, 0.0]])
    assert [(link.rigid, link.tip) for link in links] == [(False, True)] * plant.tips


def test_a_deflection_is_small_up_to_a_tenth_of_the_length():
    # of 0.475 and 0.55 m, sections 3.1 and 3.2: beyond it a warning says that equations are linear
    assert qa.SingleLinkManipulator.small_deflection == pytest.approx(0.0475)
    assert qa.ArmOnFlexibleLink.small_deflection == pytest.approx(0.055)
