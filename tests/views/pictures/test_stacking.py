"""A figure stacked for a phone: its panels below each other, with what they said together."""

from itertools import pairwise

import numpy as np
import pytest

import quietarm as qa
from quietarm.views.pictures.axes import NARROW, head, in_lines, legend_below, letter, new_figure
from quietarm.views.pictures.stacking import MOST_PANELS

SENTENCE = "This plan takes 0.0237 J and arrives at rest; the plain cycloid leaves 77 mm"


def wide(rows=2, columns=2, **settings):
    """A figure of several panels with a head and a legend."""
    figure = new_figure(4.0 * columns, 3.0 * rows)
    panels = figure.subplots(rows, columns, squeeze=False, **settings)
    for number, ax in enumerate(panels.flat):
        ax.plot([0, 1], [number, number], label="plan" if number == 0 else "_")
        ax.set_title(f"panel {number}", loc="left", fontsize=10)
    for ax in panels[-1]:
        ax.set_xlabel("time [s]")
    letter(list(panels.flat)[:9])
    head(figure, SENTENCE, "single-link, 0 to 30 deg in 0.8 s")
    legend_below(figure, list(panels.flat), 3, 9)
    return figure


def boxes(figure):
    figure.draw_without_rendering()
    return [ax.get_position() for ax in figure.axes]


def test_panels_stand_below_each_other_in_reading_order():
    stacked = qa.pictures.stack(wide())
    assert stacked.get_figwidth() == NARROW
    places = boxes(stacked)
    assert len(places) == 4
    for upper, lower in pairwise(places):
        assert lower.y1 < upper.y0
        assert lower.x0 == pytest.approx(upper.x0)
    titles = [ax.get_title(loc="left") for ax in stacked.axes]
    assert titles == [f"({name}) panel {number}" for number, name in enumerate("abcd")]


def test_the_figure_stays_as_it_is():
    figure = wide()
    before = boxes(figure)
    size = figure.get_size_inches()
    qa.pictures.stack(figure)
    np.testing.assert_array_equal(figure.get_size_inches(), size)
    np.testing.assert_allclose([box.extents for box in boxes(figure)],
                               [box.extents for box in before], atol=0.01)  # fmt: skip
    assert [legend.get_texts()[0].get_text() for legend in figure.legends] == ["plan"]


@pytest.mark.slow
def test_words_keep_their_size_and_fit():
    stacked = qa.pictures.stack(wide())
    stacked.draw_without_rendering()
    drawn = stacked.get_tightbbox()  # [inch]
    assert drawn.x0 >= -0.02
    assert drawn.x1 <= NARROW + 0.02
    title = stacked.get_suptitle()
    assert " ".join(title.split()) == f"{SENTENCE} single-link, 0 to 30 deg in 0.8 s"
    assert title.count("\n") >= 2
    (legend,) = stacked.legends
    assert [text.get_text() for text in legend.get_texts()] == ["plan"]
    assert legend.get_texts()[0].get_fontsize() == 9


def test_what_panels_say_together_each_says_alone():
    stacked = qa.pictures.stack(wide(sharex=True))
    stacked.draw_without_rendering()
    for ax in stacked.axes:
        assert ax.get_xlabel() == "time [s]"
        assert any(label.get_visible() and label.get_text() for label in ax.get_xticklabels())
    alone = qa.pictures.stack(wide())  # these share nothing
    assert [ax.get_xlabel() for ax in alone.axes] == ["", "", "time [s]", "time [s]"]


def test_a_legend_in_place_of_a_panel_comes_last():
    figure = new_figure(8.0, 6.0)
    panels = figure.subplots(2, 2)
    spare = panels[0, 1]
    (line,) = panels[0, 0].plot([0, 1])
    spare.axis("off")
    spare.legend([line], ["best without parametrisation, at rest, of all of them"], fontsize=10)
    stacked = qa.pictures.stack(figure)
    places = boxes(stacked)
    of_legend = places[stacked.axes.index(next(ax for ax in stacked.axes if not ax.axison))]
    assert of_legend.y0 == min(place.y0 for place in places)
    assert of_legend.height < 0.3 * max(place.height for place in places)


@pytest.mark.slow
def test_each_scale_of_colours_stays_beside_its_panel():
    figure = new_figure(8.0, 4.0)
    for ax in figure.subplots(1, 2, sharey=True):
        figure.colorbar(ax.pcolormesh(np.arange(4.0).reshape(2, 2)), ax=[ax])
    figure.draw_without_rendering()
    upper, lower, of_upper, of_lower = boxes(qa.pictures.stack(figure))
    for panel, scale in ((upper, of_upper), (lower, of_lower)):
        assert scale.x0 > panel.x1
        assert (scale.y0 + scale.y1) / 2 == pytest.approx((panel.y0 + panel.y1) / 2, abs=0.02)


def test_what_cannot_part_stays_together():
    many = wide(1 + MOST_PANELS // 3, 3)
    assert qa.pictures.stack(many) is None
    figure = new_figure(8.0, 4.0)
    panels = figure.subplots(1, 2)
    meshes = [ax.pcolormesh(np.arange(4.0).reshape(2, 2)) for ax in panels]
    figure.colorbar(meshes[0], ax=list(panels))
    assert qa.pictures.stack(figure) is None


@pytest.mark.parametrize("width", [0.0, -1.0, float("nan")])
def test_the_width_is_positive(width):
    with pytest.raises(ValueError, match="width"):
        qa.pictures.stack(wide(), width)


def test_a_drawing_without_axes_fills_the_width_at_its_scale():
    figure = new_figure(6.4, 3.0)
    ax = figure.subplots()
    ax.plot([0, 4], [0, 1])
    ax.set(aspect="equal", xlim=(0, 4), ylim=(0, 2))
    ax.axis("off")
    ax.set_title("The belt stretches, and the table lags behind the motor", loc="left")
    stacked = qa.pictures.stack(figure)
    stacked.draw_without_rendering()
    (drawn,) = stacked.axes
    across, upwards = drawn.get_position().size * stacked.get_size_inches()
    assert across == pytest.approx(2 * upwards, rel=1e-3)  # 4 by 2
    assert across > 0.9 * NARROW
    assert "\n" in drawn.get_title(loc="left")


def test_a_title_that_was_set_as_text_is_broken_into_lines_too():
    figure = new_figure(8.0, 3.0)
    for ax in figure.subplots(1, 2):
        ax.plot([0, 1], [0, 1])
    figure.suptitle(SENTENCE, x=0.01, ha="left")
    title = qa.pictures.stack(figure).get_suptitle()
    assert title.split() == SENTENCE.split()
    assert title.count("\n") >= 1


@pytest.mark.parametrize(
    "words", ["leaves 123 mm", "off by \u00b15 %", "takes 36.7 mJ", "a torque of 0.36 N m",
              "in 0.8 s", "0.12 \u00b5J", "1.5 rad/s", "30 deg", "2.5 m/s\u00b2"],
)  # fmt: skip
def test_no_line_ends_between_a_number_and_its_unit(words):
    number = next(word for word in words.split() if word[-1].isdigit())
    together = words[words.index(number) :]
    for letters in range(len(together), len(words) + 1):
        lines = in_lines(words, letters).splitlines()
        assert any(together in line for line in lines)
        assert " ".join(lines) == words


def test_lines_stay_lines():
    assert in_lines("energy: 0.0438 J\n5 of 5 seeds", 30) == "energy: 0.0438 J\n5 of 5 seeds"


def test_a_legend_that_would_cover_its_panel_stands_below_it():
    figure = new_figure(7.5, 3.6)
    ax = figure.subplots()
    ax.plot([0, 1], [0, 1], label="one solution: a point and its shadow price")
    ax.set(xlabel="residual limit [mm]", ylabel="energy [mJ]")
    ax.legend(loc="center left")
    stacked = qa.pictures.stack(figure)
    stacked.draw_without_rendering()
    (panel,) = stacked.axes
    assert panel.get_legend().get_window_extent().y1 < panel.xaxis.label.get_window_extent().y0
    ax.legend(["plan"], loc="center left")  # a short one stays where it was
    stacked = qa.pictures.stack(figure)
    stacked.draw_without_rendering()
    (panel,) = stacked.axes
    assert panel.get_legend().get_window_extent().y0 > panel.get_window_extent().y0
