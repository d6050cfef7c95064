"""Contents of slides; in a browser none is nearly blank, and nothing is cut."""

import base64
import struct

import offline
import pytest
import wall
from nbformat.v4 import new_code_cell, new_markdown_cell, new_output
from notebook_files import PATHS, read
from slides import OUTPUT_LINES, PROGRAM_LINES, WITHOUT_ITS_WORDS, as_slides, split_text

LEAST_USED = 1 / 3
"""Of a slide's height; less is nearly blank."""
SMALLEST = 0.6
"""By which a slide is made smaller at most, so that its program can be read."""


def printed(*lines):
    return new_output("stream", name="stdout", text="\n".join(lines))


def drawn(height):
    """A picture of a height: its head is all that is read."""
    head = b"\x89PNG\r\n\x1a\n" + b"\x00\x00\x00\rIHDR" + struct.pack(">II", 640, height)
    return new_output("display_data", {"image/png": base64.b64encode(head).decode()})


def contents(cells):
    """Return what is on every slide, without what the speaker says."""
    slides = []
    for cell in as_slides(cells):
        place = cell.metadata["slideshow"]["slide_type"] if "slideshow" in cell.metadata else "-"
        if place in ("slide", "subslide"):
            slides.append([])
        if place != "notes":
            slides[-1].append(cell)
    return slides


def text_of(slide):
    return "\n".join(
        cell.source or "".join(output.get("text", "a picture") for output in cell.outputs)
        for cell in slide
    )


def test_slides_keep_questions_and_equations_and_leave_sentences_to_the_speaker():
    blocks = "Look.", "$$x = 1$$", "It is one. **Is it?** Guess.", "- a list"
    shown, said = split_text("\n\n".join(blocks))
    assert shown.split("\n\n") == ["$$x = 1$$", "**Is it?**", "- a list"]
    assert said.split("\n\n") == ["Look.", "It is one. **Is it?** Guess."]


def test_a_slide_with_room_has_the_sentences_and_a_full_one_has_not():
    question = new_markdown_cell("## A question\n\nThink of a spring.\n\n**How stiff is it?**")
    short = contents([question, new_code_cell("k = 3", outputs=[printed("3")])])
    full = contents([question, new_code_cell("k = 3", outputs=[drawn(500)])])
    assert "Think of a spring." in text_of(short[0])
    assert "Think of a spring." not in text_of(full[0])
    assert "**How stiff is it?**" in text_of(full[0])


def test_what_does_not_fit_goes_on_below_its_question():
    question = new_markdown_cell("## Two pictures\n\n**Which is higher?**")
    pictures = new_code_cell("draw()", outputs=[drawn(600), drawn(500)])
    pictures.metadata["tags"] = ["hide-input"]
    first, second = contents([question, pictures])
    assert text_of(first) == "## Two pictures\n\n**Which is higher?**\na picture"
    assert text_of(second) == "**Which is higher?**\na picture"


def test_the_sentence_before_a_list_is_on_its_slide():
    lead = "It moves thrice:"
    shown, said = split_text(f"An arm bends. {lead}\n\n1. along a path;\n2. planned.")
    assert shown == f"{lead}\n\n1. along a path;\n2. planned."
    assert said == f"An arm bends. {lead}"


def test_a_program_stays_with_what_it_prints():
    equation = new_markdown_cell("## A sum\n\nAdd.\n\n$$x = 1 \\tag{a}$$\n\n**How large is it?**")
    lines = [f"x += {number}" for number in range(18)]
    program = new_code_cell("\n".join(lines), outputs=[printed(*map(str, range(5)))])
    first, second = contents([equation, program])
    assert text_of(first) == equation.source
    assert text_of(second).startswith("**How large is it?**\nx += 0\n")
    assert text_of(second).endswith("\n4")


def test_a_short_output_stays_with_a_program_that_fills_the_slide():
    question = new_markdown_cell("## Many lines\n\n**How many?**")
    program = new_code_cell("\n".join(["x = 1"] * 30), outputs=[printed("30 lines")])
    (slide,) = contents([question, program])
    assert text_of(slide).endswith("30 lines")


def test_a_later_sentence_is_shown_where_there_is_room():
    question = new_markdown_cell("## A question\n\n**Is it 1?**")
    answer = new_markdown_cell("It is, as the sum shows.")
    short = contents([question, new_code_cell("1", outputs=[printed("1")]), answer])
    full = contents([question, new_code_cell("1", outputs=[drawn(500)]), answer])
    assert "as the sum shows" in text_of(short[0])
    assert "as the sum shows" not in text_of(full[0])


def test_a_page_to_drag_is_alone_below_its_question_without_its_words():
    question = new_markdown_cell("## A front\n\nDrag it.\n\n**What changes?**")
    frame = new_output("display_data", {"text/html": '<iframe height="900" src="front.html">'})
    _, slide = contents([question, new_code_cell("show()", outputs=[frame])])
    title, page = slide
    assert title.source == "**What changes?**"
    assert f'height="{900 - WITHOUT_ITS_WORDS}"' in page.outputs[0].data["text/html"]


def test_a_picture_is_not_made_small_by_its_program():
    question = new_markdown_cell("## A curve\n\n**How high is it?**")
    program = new_code_cell("\n".join(["x = 1"] * 20), outputs=[printed("1"), drawn(340)])
    first, second = contents([question, program])
    assert text_of(first).endswith("\n1")
    assert text_of(second) == "**How high is it?**\na picture"


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_slides_have_the_exercises_and_not_what_finds_their_checks(path):
    slides = [text_of(slide) for slide in contents(read(path).cells)]
    assert not any("import checks_of" in slide for slide in slides)
    (exercises,) = [slide for slide in slides if slide.startswith("## Exercises")]
    assert exercises.count("<details>") == 3


def test_no_line_of_a_long_program_or_of_a_long_output_is_lost():
    definitions = [
        "\n".join([f"def f{number}():", *(f"    x = {line}" for line in range(20))])
        for number in range(4)
    ]
    source = "\n\n\n".join(definitions)
    lines = [f"iteration {number}" for number in range(100)]
    program = new_code_cell(source, outputs=[printed(*lines)])
    slides = contents([new_markdown_cell("## A log"), program])
    programs = [cell.source for slide in slides for cell in slide[1:] if cell.source]
    outputs = [cell.outputs[0].text for slide in slides for cell in slide[1:] if not cell.source]
    assert "\n\n\n".join(programs) == source
    assert "\n".join(outputs) == "\n".join(lines)
    assert max(part.count("\n") for part in programs) < PROGRAM_LINES
    assert max(part.count("\n") for part in outputs) < OUTPUT_LINES


def test_a_short_question_follows_on_the_slide_before_when_one_goes_on():
    cells = [
        new_markdown_cell("## First\n\n**Is it 1?**"),
        new_code_cell("1", outputs=[printed("1")]),
        new_markdown_cell("It is. **Is it 2?**"),
        new_code_cell("2", outputs=[printed("2")]),
        new_markdown_cell("## Second\n\n**Is it 3?**"),
    ]
    first, second = contents(cells)
    assert [cell.metadata["slideshow"]["slide_type"] for cell in first[3:]] == ["fragment"] * 3
    assert text_of(second).startswith("## Second")


@pytest.fixture(scope="module")
def chromium():
    api = pytest.importorskip("playwright.sync_api")
    if wall.CHROMIUM is None:
        pytest.skip("there is no Chromium here")
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=wall.CHROMIUM)
        yield browser
        browser.close()


# One with long programs and a log of 70 lines, and one with pictures and a film.
@pytest.mark.slow
@pytest.mark.parametrize("path", [PATHS[0], PATHS[4]], ids=lambda path: path.stem)
def test_every_slide_is_filled_and_nothing_is_cut(path, chromium, tmp_path):
    file = tmp_path / "slides.html"
    page, _ = offline.Slides(exclude_output_prompt=True, **offline.WALL).from_filename(str(path))
    file.write_text(page, encoding="utf-8")
    slides = wall.measured(chromium, file)
    assert len(slides) >= 8
    assert [slide for slide in slides if slide.used < LEAST_USED] == []
    assert [slide for slide in slides if slide.cut or slide.beyond > 1] == []
    assert [slide for slide in slides if slide.zoom < SMALLEST] == []
