"""Pictures that the user's own settings of matplotlib spoil are told in a line."""

import matplotlib as mpl
import pytest
from matplotlib.figure import Figure
from quietarm.studies.display.pictures import save_figure


def test_a_picture_that_cannot_be_drawn_is_told_in_one_line(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", "")  # no LaTeX
    figure = Figure()
    with mpl.rc_context({"text.usetex": True}):
        figure.text(0.5, 0.5, "a text that no cache holds")
        with pytest.raises(ValueError, match=r"a\.png cannot be drawn \(.*\); check matplotlib's"):
            save_figure(figure, tmp_path / "a.png")
    assert list(tmp_path.iterdir()) == []


def test_a_date_that_is_none_is_told_in_one_line(tmp_path, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "today")
    with pytest.raises(ValueError, match=r"a\.pdf cannot be drawn \(.*'today'\); "):
        save_figure(Figure(), tmp_path / "a.pdf")


@pytest.mark.parametrize("name", [r"$\frac{$", "one $ and $x_{$", "кран 🏗"])
def test_names_are_drawn_as_they_are_written(tmp_path, name):
    figure = Figure()
    figure.subplots().set_title(name)
    save_figure(figure, tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
