"""The pictures of the pages: each is its command's, and none is older than what it shows."""

import importlib.util
import re
import sys

import pytest
from pages import ROOT

PLACE = ROOT / "docs" / "make_pictures.py"


def load():
    """The script that makes them, which is no package."""
    spec = importlib.util.spec_from_file_location("make_pictures", PLACE)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


maker = load()
REMEDY = "run python docs/make_pictures.py {}"


def test_every_picture_of_a_page_says_what_it_shows_and_nothing_else_does():
    files = {path.name for path in maker.IMAGES.iterdir()} - {maker.SHOWN.name}
    pictures = {name for name in files if not name.endswith("-narrow.png")}
    assert set(maker.names()) == pictures == set(maker.recorded())
    for_phones = {maker.narrow_name(name) for name, shown in maker.recorded().items()
                  if "narrow" in shown}  # fmt: skip
    assert files - pictures == for_phones


def test_pictures_of_several_panels_have_a_variant_for_phones():
    without = {name for name, shown in maker.recorded().items() if "narrow" not in shown}
    assert without == {
        "arm.gif",
        "dragged.gif",
        "film.gif",
        "move.gif",
    }  # films are drawn for a phone


@pytest.mark.parametrize("name", maker.names())
def test_a_picture_is_that_of_the_command_on_its_page(name):
    shown = maker.recorded()[name]
    content = (maker.IMAGES / name).read_bytes()
    assert shown["file"] == maker.digest(content), REMEDY.format(name)
    if "narrow" in shown:
        narrow = (maker.IMAGES / maker.narrow_name(name)).read_bytes()
        assert shown["narrow"] == maker.digest(narrow), REMEDY.format(name)
    if name not in maker.MAKERS and not maker.python_of(name):
        assert shown["command"] == maker.command_of(name).line, REMEDY.format(name)


def test_the_gallery_has_a_dozen_pictures_each_below_its_one_command():
    page = (ROOT / "docs" / "gallery.md").read_text()
    pair = r"```console\n\.venv/bin/(quietarm [^\n]+)\n```\n\n!\[[^]]+\]\(images/([\w.-]+)\)"
    pairs = re.findall(pair, page)
    assert len(pairs) == page.count("![") == page.count("```console") == 12
    for line, name in pairs:
        assert maker.command_of(name).line == line


def chromium():
    return any(map(maker.shutil.which, ("chromium", "chromium-browser", "google-chrome")))


@pytest.mark.slow
@pytest.mark.parametrize("name", maker.names())
def test_no_picture_is_older_than_what_it_shows(name):
    if name in ("dragged.gif", "explore.png"):
        pytest.importorskip("playwright.sync_api")
        if not chromium():
            pytest.skip("there is no Chromium here")
    now = maker.make(name, quick=True).shown
    assert maker.differences(maker.recorded()[name], now, maker.has_values(name)) == [], (
        REMEDY.format(name)
    )


def test_a_picture_is_older_where_words_looks_or_values_are_others():
    line = ["plan", "#0072b2", "-", "None", [0.0, 1.0], [0.0, 0.5]]
    before = {"words": ["energy # J"], "lines": [line], "areas": [[0.5, 0.25]]}
    assert maker.differences(before, before, with_values=True) == []
    near = {**before, "lines": [[*line[:5], [0.0, 0.501]]]}  # another machine
    assert maker.differences(before, near, with_values=True) == []
    far = {**before, "lines": [[*line[:5], [0.0, 0.6]]]}
    assert maker.differences(before, far, with_values=True) == ["other values of plan"]
    assert maker.differences(before, far, with_values=False) == []
    green = {**before, "lines": [["plan", "#009e73", *line[2:]]]}
    assert maker.differences(before, green, with_values=False) == ["lines with other looks"]
    words = {**before, "words": ["power [W]"]}
    assert maker.differences(before, words, with_values=True) == [
        "no longer: energy # J",
        "new: power [W]",
    ]
    other = {**before, "areas": [[0.5, 0.3]]}
    assert maker.differences(before, other, with_values=True) == ["other values of an area"]
