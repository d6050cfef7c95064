"""The page of the headline study."""

import re
import xml.etree.ElementTree as ElementTree

import pytest
from quietarm.studies.document.files import page as page_of
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


def test_every_picture_has_words_and_every_link_its_place(root):
    images = list(root.iter("img"))
    assert len(images) == 1 + 3 * len(CASES)
    assert all(len(image.get("alt", "")) > 20 for image in images)
    marks = [element.get("id") for element in root.iter() if element.get("id")]
    assert len(marks) == len(set(marks))
    links = [link.get("href").removeprefix("#") for link in root.iter("a")]
    assert len(links) == 2
    assert set(links) <= set(marks)
