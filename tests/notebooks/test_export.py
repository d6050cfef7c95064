"""Every notebook becomes a page and slides that need no network, with the solutions folded."""

import re
import subprocess
import sys

import offline
import pytest
from notebook_files import NOTEBOOKS, PATHS, code_cells, pictures, read

pytestmark = pytest.mark.slow

OFFLINE = NOTEBOOKS / "offline.py"
FROM_ELSEWHERE = re.compile(r"<(?:script|link|img)[^>]*(?:src|href)=\"https?:[^\"]+\"")


def check_whole(page, path):
    """Its solutions are folded, its pictures drawn, equations set and nothing is fetched."""
    assert page.count("<summary>Solution</summary>") == 3
    assert page.count('src="data:image/png') == len(pictures(read(path)))
    body = page[page.index("<body") :]
    assert "```" not in body  # a fence inside the fold is code, not three quotation marks
    assert not FROM_ELSEWHERE.findall(page)
    assert ("<math" in body) == any("$" in cell.source for cell in read(path).cells)
    assert "\\tag" not in body
    assert 'alt="No description' not in body


def test_one_becomes_a_page_whose_pictures_have_their_code_folded(tmp_path):
    path = PATHS[0]
    words = [sys.executable, OFFLINE, path, "--output", tmp_path / "new"]
    said = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    page = tmp_path / "new" / f"{path.stem}.html"
    assert said == f"wrote {page}\n"
    check_whole(page.read_text(), path)
    drawn = [c for c in code_cells(read(path)) if "hide-input" in c.metadata.get("tags", [])]
    assert page.read_text().count("celltag_hide-input") == len(drawn) + 2  # and twice in its style


def test_a_notebook_that_is_not_there_is_told_in_a_line():
    said = subprocess.run([sys.executable, OFFLINE, "99.ipynb"], capture_output=True, text=True)
    assert (said.returncode, said.stderr) == (1, "99.ipynb: no such notebook\n")


@pytest.fixture(scope="module")
def slides_of():
    return offline.Slides().from_filename  # it reads the templates of slides once


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_it_becomes_slides_that_show_the_program(path, slides_of):
    slides, _ = slides_of(path)
    check_whole(slides, path)
    assert "Reveal.initialize" in slides
    assert "%matplotlib" not in slides
    assert slides.count('aside class="notes"') >= 4
    assert slides.count("cm-editor") >= 4
