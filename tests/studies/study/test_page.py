"""The page of the headline study."""

import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import pytest
from quietarm.studies.report.page import page as page_of
from quietarm.studies.study.page import study_document
from small_study import CASES


def study_page(study):
    return page_of(study_document(study))


@pytest.fixture(scope="module")
def text(small):
    return study_page(small)


@pytest.fixture(scope="module")
def root(text):
    return ElementTree.fromstring(text)  # well-formed, or this raises


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
    (run, *others), *_ = (group.runs for group in found.comparison.groups)
    other = replace(run, front=replace(run.front, versions={"casadi": "0.1"}))
    first = replace(found.comparison.groups[0], runs=(other, *others))
    groups = (first, *found.comparison.groups[1:])
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
