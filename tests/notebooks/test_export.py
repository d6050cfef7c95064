"""nbconvert makes pages and slides of every notebook as it stands, with the solutions folded."""

import pytest
from nbconvert import HTMLExporter, SlidesExporter
from notebook_files import PATHS, code_cells, pictures, read

each_notebook = pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)


def check_whole(page, path):
    """Its solutions are folded, its pictures drawn and its fences read."""
    assert page.count("<summary>Solution</summary>") == page.count("</details>") == 3
    assert page.count('src="data:image/png') == len(pictures(read(path)))
    # A fence inside the fold is code, not three quotation marks.
    body = page[page.index("<body") :]
    assert "```" not in body


def test_one_becomes_a_page():
    page, _ = HTMLExporter().from_filename(PATHS[0])
    check_whole(page, PATHS[0])


@pytest.fixture(scope="module")
def slides_of():
    """nbconvert makes slides with the templates of pages; it reads them once."""
    return SlidesExporter().from_filename


@each_notebook
def test_it_becomes_slides(path, slides_of):
    slides, _ = slides_of(path)
    check_whole(slides, path)
    notebook = read(path)
    placed = [cell.metadata.get("slideshow", {}).get("slide_type", "-") for cell in notebook.cells]
    below = placed.count("subslide")
    # One section for a slide, and in it one for itself and each below it.
    assert slides.count("<section>") == 2 * placed.count("slide") + below
    assert placed.count("slide") >= 4
    hidden = [cell.source for cell in code_cells(notebook) if cell.source.startswith("%matplotlib")]
    assert len(hidden) == 1
    assert "%matplotlib" not in slides
