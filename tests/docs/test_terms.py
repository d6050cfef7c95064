"""The glossary's terms: pages, help and docstrings do not say its things by other words."""

import json
import re
from collections.abc import Iterable, Iterator

from pages import DOCS, PAGES, ROOT

WITH_SYMBOLS = ("physics", "paper", "glossary")
"""Pages that have the paper's symbols, or list the words themselves."""
PACKAGES = ("models", "ocp", "metaheuristics", "machine", "views", "studies")
CODE = re.compile(r"```.*?```|`[^`\n]*`|\]\([^)]*\)|<!--.*?-->|\$[^$\n]*\$", re.DOTALL)
"""What of a page is no prose: code, addresses of links, comments, formulas."""
KEPT_HEADINGS = ("reproduce",)
"""Folders whose texts are headings of files that other programs read."""
OTHER_THINGS = ("black box",)
"""What has a word of the list, and is another thing."""


def unused_words(glossary: str) -> dict[str, str]:
    """The terms to use, by the words that are not used for them."""
    listed = glossary.split("## One word for one thing")[1]
    return {
        word.strip(): term
        for term, words in re.findall(r"^- \*\*(.+?)\*\*[^:\n]*: not (.+)$", listed, re.MULTILINE)
        for word in words.split(", ")
    }


def prose(text: str) -> Iterator[tuple[int, str]]:
    """Lines of a page with their numbers, without code."""
    blank = CODE.sub(lambda found: "\n" * found[0].count("\n"), text)
    yield from enumerate(blank.splitlines(), start=1)


def lines_of_pages() -> Iterator[tuple[str, str]]:
    course = {"notebooks/README.md": (ROOT / "notebooks" / "README.md").read_text()}
    pages = {name if name == "README" else f"docs/{name}.md": text for name, text in PAGES.items()
             if name not in WITH_SYMBOLS}  # fmt: skip
    for page, text in {**pages, **course}.items():
        yield from ((f"{page}:{number}", line) for number, line in prose(text))
    for path in sorted(ROOT.glob("notebooks/*.ipynb")):
        cells = json.loads(path.read_text())["cells"]
        for place, cell in enumerate(cells, start=1):
            if cell["cell_type"] == "markdown":
                for number, line in prose("".join(cell["source"])):
                    yield f"{path.name}, cell {place}, line {number}", line


def lines_of_packages(words: Iterable[str]) -> Iterator[tuple[str, str]]:
    """First lines of docstrings, and of what is printed each text in quotes."""
    for path in sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py")):
        text = path.read_text()
        low = text.lower()
        if not any(word in low for word in words):
            continue
        is_shown = path.relative_to(ROOT).parts[0] in ("views", "studies")
        for number, line in enumerate(text.splitlines(), start=1):
            place = f"{path.relative_to(ROOT)}:{number}"
            if '"""' in line:
                yield place, re.sub(r"`[^`]*`", "", line.partition('"""')[2])
            elif is_shown and '"' in line and path.parent.name not in KEPT_HEADINGS:
                yield from ((place, text) for text in re.findall(r'"([^"]*)"', line) if " " in text)


def test_nothing_is_said_by_a_word_that_the_glossary_does_not_use():
    terms = unused_words(DOCS["glossary"])
    assert terms["box"] == "bounds"
    word = re.compile(rf"(?<![\w-])({'|'.join(map(re.escape, terms))})(?![\w-])", re.IGNORECASE)
    said = []
    for place, line in [*lines_of_pages(), *lines_of_packages([word.lower() for word in terms])]:
        for thing in OTHER_THINGS:
            line = line.replace(thing, "")
        for found in word.findall(line):
            term = next(term for name, term in terms.items() if name.lower() == found.lower())
            said.append(f"{place}: {found!r}; write {term}")
    assert not said, "\n".join(said)


def test_a_word_that_is_not_used_is_found_with_the_term_to_use():
    terms = unused_words("## One word for one thing\n\n- **bounds** of all: not box, boxes\n")
    assert terms == {"box": "bounds", "boxes": "bounds"}
    assert [line for _, line in prose("a `box`\n```\nbox\n```\nthe [box](box.md)")] == [
        "a ", "", "", "", "the [box",
    ]  # fmt: skip
