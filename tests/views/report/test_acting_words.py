"""The first line of a front with a band: which motion acts first, or why none on arrival."""

from dataclasses import replace

import pytest

from quietarm.ocp import PointToPoint, evaluate_coefficients
from quietarm.views.report.acting_words import band_lines_of_front


@pytest.fixture
def front_of_cycloid(task, front_of):
    """A front of the plain cycloid alone, for a band; and when it may act."""

    def make(band):
        of_band = PointToPoint(task.plant, task.target, task.duration, band=band)
        cycloid = evaluate_coefficients(of_band, [])
        front = front_of([(1e3 * cycloid.residual, cycloid.energy)], task=of_band)
        point = replace(front.points[0], coefficients=(0.0, 0.0))
        return replace(front, points=(point,)), cycloid.acts_after

    return make


def test_a_front_that_acts_late_only_says_so_and_names_the_way_out(front_of_cycloid):
    front, after = front_of_cycloid(5e-3)  # the plain cycloid leaves 77 mm
    assert after > front.task.duration
    (line,) = band_lines_of_front(front)
    assert line.startswith("no motion of this front stays within 5 mm from arrival on for")
    assert f"the first may act after {after:.3g} s" in line
    assert "quietarm plan --band" in line


def test_a_front_that_keeps_its_band_without_the_margin_says_both(front_of_cycloid):
    front, after = front_of_cycloid(0.1)  # it leaves at most 90 mm
    (line,) = band_lines_of_front(front)
    assert line.startswith(f"may act after {after:.3g} s: within 100 mm")
    assert "no motion of this front leaves less than 33.3 mm, the band over its margin" in line
