"""A beam with measurable parameters, against closed forms and the paper's identified plate."""

from math import pi

import pytest

from quietarm.models import FlexibleBeam, SingleLinkManipulator
from quietarm.models.beam_modes import beam_modes
from quietarm.models.joint_motion import JointMotion
from quietarm.ocp import PointToPoint, evaluate_coefficients, plan_move


def test_wave_numbers_of_a_cantilever_are_those_of_the_tables():
    # Blevins, Formulas for Natural Frequency and Mode Shape (1979), table 8-1
    expected = [1.87510407, 4.69409113, 7.85475744, 10.99554073, 14.13716839, 17.27875953]
    assert beam_modes(6, 0.0, 0.0).wave_numbers == pytest.approx(expected, rel=1e-8)


def test_wave_numbers_with_a_tip_mass_as_heavy_as_the_beam():
    # Laura, Pombo and Susemihl, J. Sound and Vibration 37 (1974)
    assert beam_modes(2, 1.0, 0.0).wave_numbers == pytest.approx([1.2479, 4.0311], abs=1e-4)


def test_a_heavy_tip_is_a_mass_on_a_cantilevers_spring():
    # omega^2 = 3 E I / (m l^3), so that k^4 = 3 / ratio; higher modes are pinned at the tip
    first, second, *_ = beam_modes(2, 1e5, 0.0).wave_numbers
    assert first**4 == pytest.approx(3e-5, rel=1e-4)
    assert second == pytest.approx(3.92660231, rel=1e-5)  # Blevins, clamped-pinned


def test_modal_masses_and_stiffening_of_a_cantilever():
    beam = beam_modes(4, 0.0, 0.0)
    assert beam.masses == pytest.approx([0.25] * 4, rel=1e-9)  # of modes that are 1 at the tip
    # Southwell's coefficient of the first mode: 1.193 with no hub (ARC R&M 766)
    assert beam.stiffenings[0][0] / beam.masses[0] == pytest.approx(1.193, abs=1e-3)


def test_modes_are_orthogonal_to_the_rigid_turn_in_sum():
    # the pushes squared over the masses add up to the inertia of beam and tip about the axis: the
    # first six to all but 0.4 %
    ratio, radius = 0.3, 0.2
    beam = beam_modes(6, ratio, radius)
    inertia = ((1 + radius) ** 3 - radius**3) / 3 + ratio * (1 + radius) ** 2
    shares = [p**2 / m for p, m in zip(beam.pushes, beam.masses, strict=True)]
    assert inertia * (1 - 5e-3) < sum(shares) < inertia


def test_the_papers_plate_comes_out_as_it_was_identified():
    # eq (10) is identified from an experiment, the plate is as printed with brass of 8500 kg/m^3;
    # the paper's W displaces the tip by phi W
    identified, beam = SingleLinkManipulator(), FlexibleBeam()
    modes, phi = beam_modes(1, 0.036 / (0.425 * 0.475), 0.0), identified.phi
    push = 0.475 * modes.pushes[0]
    assert 0.425 * 0.475 * push * phi == pytest.approx(identified.alpha2, rel=0.1)
    assert push / modes.masses[0] / phi == pytest.approx(identified.beta1, rel=0.12)
    turned = beam.torque(JointMotion(0.0, 0.0, 1.0), [0.0], [0.0], [0.0])
    assert turned == pytest.approx(identified.alpha1, rel=0.01)


def test_section_and_material_give_the_frequency():
    # omega = k^2 sqrt(E I / (rho A l^4)); steel, 300 x 20 x 2 mm
    beam = FlexibleBeam.of_section(
        width=0.02, thickness=0.002, density=7850, youngs_modulus=2.1e11, length=0.3
    )
    expected = 1.87510407**2 * (2.1e11 * 0.002**2 / 12 / 7850) ** 0.5 / 0.3**2
    assert beam.omega == pytest.approx(expected, rel=1e-8)
    assert beam.mass_per_length == pytest.approx(0.314)


@pytest.mark.parametrize("tip_mass", [0.0, 0.05, 0.5])
def test_another_payload_swings_as_the_beam_of_the_same_stiffness(tip_mass):
    section = {"width": 0.02, "thickness": 0.002, "density": 7850, "youngs_modulus": 2.1e11}
    beam = FlexibleBeam.of_section(**section, length=0.3, tip_mass=0.1, zeta=0.02)
    expected = FlexibleBeam.of_section(**section, length=0.3, tip_mass=tip_mass, zeta=0.02)
    assert beam.carrying(tip_mass).parameters == pytest.approx(expected.parameters, rel=1e-12)


@pytest.mark.slow
def test_a_plan_needs_the_second_mode_and_hardly_the_third():
    def left(planned, judged):
        move = [PointToPoint(FlexibleBeam(mode_count=n), pi / 6, 0.8) for n in (planned, judged)]
        plan = plan_move(move[0], starts=1)
        return evaluate_coefficients(move[1], plan.coefficients).residual

    assert left(1, 2) > 5e-4
    assert left(2, 3) < 5e-6


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"omega": 0}, "omega is 0 rad/s; give more than 0"),
        ({"tip_mass": -0.1}, "tip_mass is -0.1 kg; give 0 or more"),
        ({"mode_count": 9}, "mode_count is 9; give a whole number"),
    ],
)
def test_what_no_beam_has_is_refused(wrong, words):
    with pytest.raises(ValueError, match=words):
        FlexibleBeam(**wrong)
