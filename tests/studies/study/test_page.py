"""The page of the headline study."""

import html.parser
import re
import shutil
import subprocess
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import pytest
from matplotlib.figure import Figure
from quietarm.studies.report.page import page as page_of
from quietarm.studies.study.overview import draw_study_gaps
from quietarm.studies.study.page import page_file, study_document
from quietarm.studies.study.work import Study
from small_study import CASES, QUICK


def study_page(study):
    return page_of(study_document(study))


@pytest.fixture(scope="module")
def text(small):
    return study_page(small)


@pytest.fixture(scope="module")
def root(text):
    return ElementTree.fromstring(text)  # well-formed, or this raises


def test_the_overview_is_drawn_on_the_axes_that_are_given_or_on_new_ones(small):
    given = Figure().subplots()
    assert draw_study_gaps(small, given) is given
    assert [label.get_text() for label in given.get_yticklabels()] == [
        "single-link\n0 to 30 deg in 0.8 s", "arm-on-flexible-link\n0 to 90 deg in 0.8 s"
    ]  # fmt: skip
    assert draw_study_gaps(small).figure is not given.figure


# The page


def test_the_page_loads_and_runs_nothing(text, root):
    assert not re.search(r"<(script|link|iframe|object|embed|video|audio)\b", text)
    assert not re.search(r"@import|url\(|\son\w+=", text)
    for element in root.iter():
        for name in ("src", "href", "srcset", "action"):
            value = element.get(name, "#")
            assert value.startswith(("#", "data:image/svg+xml;base64,")), value[:60]
    assert "http:" not in text
    assert "https:" not in text


def test_every_version_that_computed_a_front_is_named(small, no_pictures):
    found = small.cases[0]
    group = found.comparison.groups[0]
    other = replace(group.runs[0].front, versions={"casadi": "0.1"})
    groups = (
        replace(group, runs=(replace(group.runs[0], front=other), *group.runs[1:])),
        *found.comparison.groups[1:],
    )
    case = replace(found, comparison=replace(found.comparison, groups=groups))
    assert "casadi 0.1 and " in study_page(replace(small, cases=(case,)))


def test_every_picture_has_words_and_every_link_its_place(root):
    images = list(root.iter("img"))
    assert len(images) == 1 + 3 * len(CASES)
    assert all(len(image.get("alt", "")) > 20 for image in images)
    marks = [element.get("id") for element in root.iter() if element.get("id")]
    assert len(marks) == len(set(marks))
    links = [link.get("href").removeprefix("#") for link in root.iter("a")]
    assert len(links) == 2
    assert set(links) <= set(marks)


def test_findings_stand_before_pictures_and_tables(root):
    order = [element.get("class") or element.tag for element in root.find("body")]
    assert order[:3] == ["h1", "findings", "overview"]
    for section in [s for s in root.iter("section") if s.find(".//img") is not None]:
        parts = [element.get("class") or element.tag for element in section]
        assert parts[:3] == ["h2", "findings", "pictures"]


def test_html_of_every_tag_is_closed(text):
    """As a browser's parser sees it, not only as XML."""
    void, open_tags = {"meta", "img", "br"}, []

    class Reader(html.parser.HTMLParser):
        def handle_starttag(self, tag, attributes):
            open_tags.append(tag)

        def handle_startendtag(self, tag, attributes):
            assert tag in void

        def handle_endtag(self, tag):
            assert open_tags.pop() == tag

    Reader().feed(text)
    assert open_tags == []


@pytest.mark.usefixtures("no_pictures")
def test_one_task_needs_no_overview(small):
    (case, _) = small.cases
    alone = ElementTree.fromstring(study_page(Study(QUICK, (case,), 1.0)))
    assert [element.tag for element in alone.find("body")][:2] == ["h1", "section"]


CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
def test_the_page_fits_a_desktop_and_a_phone(text, tmp_path):
    measure = (
        "<script>addEventListener('load', () => { const d = document.documentElement;"
        "document.body.dataset.seen = [innerWidth, d.scrollWidth,"
        "[...document.images].every(i => i.naturalWidth > 0)].join(' '); });</script></body>"
    )
    # in frames, since a headless window is no narrower than 500 pixels
    (tmp_path / "page.html").write_text(text.replace("</body>", measure))
    frames = "".join(
        f"<iframe src='page.html' width='{width}' height='900' "
        "onload='this.title = this.contentDocument.body.dataset.seen'></iframe>"
        for width in (1280, 390)
    )
    (tmp_path / "frames.html").write_text(f"<!DOCTYPE html><title>frames</title>{frames}")
    ran = subprocess.run(
        [CHROMIUM, "--headless=new", "--no-sandbox", "--disable-gpu", "--dump-dom",
         "--allow-file-access-from-files", "--virtual-time-budget=5000",
         f"--user-data-dir={tmp_path / 'profile'}", (tmp_path / "frames.html").as_uri()],
        capture_output=True, text=True, timeout=90, check=True,
    )  # fmt: skip
    seen = [title.split() for title in re.findall(r'title="(.*?)"', ran.stdout)]
    assert [int(inner) for inner, _, _ in seen] == [1280, 390]
    assert all(int(scroll) <= int(inner) and loaded == "true" for inner, scroll, loaded in seen)


def test_a_page_that_cannot_be_drawn_is_not_half_written(small, tmp_path, monkeypatch):
    def fail(*given):
        raise RuntimeError("drawing failed")

    monkeypatch.setattr("quietarm.studies.study.page.study_document", fail)
    path, write = page_file(small, tmp_path / "study.html")
    with pytest.raises(RuntimeError, match="drawing failed"):
        write(path)
    assert list(tmp_path.iterdir()) == []
