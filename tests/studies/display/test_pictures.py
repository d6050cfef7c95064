"""Pictures that the user's own settings of matplotlib spoil are told in a line."""

import pytest
from matplotlib.figure import Figure
from quietarm.studies.display.pictures import save_figure


@pytest.mark.parametrize("name", [r"$\frac{$", "one $ and $x_{$", "кран 🏗"])
def test_names_are_drawn_as_they_are_written(tmp_path, name):
    figure = Figure()
    figure.subplots().set_title(name)
    save_figure(figure, tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
