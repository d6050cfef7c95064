"""Every notebook becomes a page and slides that need no network, with the solutions folded."""

import importlib.util
import re
import subprocess
import sys

import pytest
from notebook_files import NOTEBOOKS, PATHS, code_cells, pictures, read

OFFLINE = NOTEBOOKS / "offline.py"
FROM_ELSEWHERE = re.compile(r"<(?:script|link|img)[^>]*(?:src|href)=\"https?:[^\"]+\"")

each_notebook = pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)


def check_whole(page, path):
    """Its solutions are folded, its pictures drawn and its fences read."""
    assert page.count("<summary>Solution</summary>") == page.count("</details>") == 3
    assert page.count('src="data:image/png') == len(pictures(read(path)))
    # A fence inside the fold is code, not three quotation marks.
    body = page[page.index("<body") :]
    assert "```" not in body
    assert not FROM_ELSEWHERE.findall(page)
    # equations are typeset; a price in dollars is none
    assert ("<math" in body) == any("$" in cell.source for cell in read(path).cells)
    assert "\\tag" not in body
    assert 'alt="No description' not in body


def test_one_becomes_a_page(tmp_path):
    path = PATHS[0]
    words = [sys.executable, OFFLINE, path, "--output", tmp_path / "new"]
    said = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    page = tmp_path / "new" / f"{path.stem}.html"
    assert said == f"wrote {page}\n"
    check_whole(page.read_text(), path)


def test_a_notebook_that_is_not_there_is_told_in_a_line():
    said = subprocess.run([sys.executable, OFFLINE, "99.ipynb"], capture_output=True, text=True)
    assert (said.returncode, said.stderr) == (1, "99.ipynb: no such notebook\n")


@pytest.fixture(scope="module")
def slides_of():
    """It reads the templates of pages once."""
    spec = importlib.util.spec_from_file_location("offline", OFFLINE)
    offline = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(offline)
    return offline.Slides().from_filename


@each_notebook
def test_it_becomes_slides(path, slides_of):
    slides, _ = slides_of(path)
    check_whole(slides, path)
    assert "Reveal.initialize" in slides
    notebook = read(path)
    placed = [cell.metadata.get("slideshow", {}).get("slide_type", "-") for cell in notebook.cells]
    below = placed.count("subslide")
    # One section for a slide, and in it one for itself and each below it.
    assert slides.count("<section>") == 2 * placed.count("slide") + below
    assert placed.count("slide") >= 4
    hidden = [cell.source for cell in code_cells(notebook) if cell.source.startswith("%matplotlib")]
    assert len(hidden) == 1
    assert "%matplotlib" not in slides
