"""Small moves count as at rest at less than others, wherever words say it."""

from dataclasses import replace

import pytest

import quietarm as qa
from quietarm.ocp.rest import REST, rest_of
from quietarm.views.page.page_moves import Choice
from quietarm.views.page.page_words import swing_words
from quietarm.views.report.captions import caption_of_motions
from quietarm.views.report.words import residual_words


@pytest.fixture(scope="module")
def cycloid():
    """A plain cycloid over two microradians, which swings by as large a share as any."""
    task = qa.PointToPoint(qa.SingleLinkManipulator(), 2e-6, 0.8)
    return qa.evaluate_coefficients(task, [])


def test_what_a_small_move_leaves_is_no_rest_although_it_is_below_a_micrometre(cycloid):
    task = cycloid.task
    assert rest_of(task) == pytest.approx(2e-3 * REST)  # of 2e-6 rad, where 1e-3 rad have all
    assert rest_of(task) < cycloid.residual < REST
    front = qa.Front(task, cycloid.profile, (), cycloid.record, reference=(1.0, 1.0))
    words = [
        caption_of_motions({"plan": cycloid}),
        residual_words(cycloid.residual, task),
        swing_words(Choice(cycloid, cycloid.residual, cycloid.energy)),
        cycloid._repr_html_(),
        replace(
            front, points=(qa.ocp.FrontPoint((), cycloid.residual, cycloid.energy),)
        )._repr_html_(),
    ]
    shown = f"{cycloid.residual:.3g}"
    assert not any("rest" in text.replace("arrest", "") for text in words[:3])
    assert shown in words[3]
    assert "at rest" not in words[3]
    assert shown in words[4]


def test_its_verification_holds_it_to_what_counts_as_rest_there(cycloid):
    assert cycloid.verification.agrees
    off = replace(cycloid.verification, residual_difference=3 * rest_of(cycloid.task))
    assert not off.agrees
