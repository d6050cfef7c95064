"""The site: links to the glossary, the search without a server, code that breaks nowhere."""

import importlib.util
import shutil
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from pages import DOCS, ROOT

nodes = pytest.importorskip("docutils.nodes")
pytest.importorskip("sphinx")
DOCS_FOLDER = ROOT / "docs"
SITE = ROOT / "build" / "site"
CHROMIUM = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
in_chromium = pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium here")
built = pytest.mark.skipif(
    not (SITE / "index.html").exists(), reason="the site is not built; .ci/run builds it"
)


def extension(name):
    """A module beside docs/conf.py."""
    place = DOCS_FOLDER / "_extensions" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(name, place)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


glossary = extension("glossary_links")
snippets = extension("search_snippets")


# Links to the glossary


@pytest.fixture
def app():
    """What the extension asks of Sphinx."""
    builder = SimpleNamespace(get_relative_uri=lambda page, other: f"{Path(other).name}.html")
    return SimpleNamespace(srcdir=ROOT, builder=builder)


def page_of(*elements):
    """A page of these elements, as docutils has it."""
    page = nodes.section()
    page += elements
    return page


def links(page):
    return [(link.astext(), link["refuri"]) for link in page.findall(nodes.reference)]


def test_every_row_of_the_glossary_has_an_anchor_of_its_own():
    rows = glossary.rows_of_terms(DOCS_FOLDER / "glossary.md")
    in_tables = [
        line
        for line in DOCS["glossary"].splitlines()
        if line.startswith("| ") and not line.startswith("| term |")
    ]
    assert len(rows) == len(in_tables) > 40
    anchors = [glossary.anchor_of(terms) for terms in rows]
    assert len(set(anchors)) == len(rows)
    assert ("residual vibration", "residual") in rows
    assert "term-residual-vibration" in anchors


def test_terms_are_links_where_they_first_stand(app):
    page = page_of(
        nodes.title("", "The plain cycloid"),  # no heading,
        nodes.literal_block("", "plain cycloid"),  # no code,
        nodes.paragraph("", "", nodes.literal("", "residual")),
        nodes.paragraph("", "Plain cycloids leave residual vibration; the residual is F1."),
        nodes.paragraph("", "The plain cycloid again, and a front of non-dominated motions."),
    )
    glossary.link_terms(app, page, "docs/start")
    assert links(page) == [
        ("Plain cycloids", "glossary.html#term-plain-cycloid"),
        ("residual vibration", "glossary.html#term-residual-vibration"),
        ("front", "glossary.html#term-front"),
    ]
    assert page.astext().count("plain cycloid again, and a front of non-dominated motions.") == 1


def test_the_glossary_itself_and_generated_lists_have_no_such_links(app):
    for name in ("docs/reference/ocp", "docs/commands", "CHANGELOG"):
        page = page_of(nodes.paragraph("", "the plain cycloid"))
        glossary.link_terms(app, page, name)
        assert links(page) == []


# Commands


def test_words_of_commands_stay_whole():
    page = (
        '<div class="highlight-console notranslate"><div class="highlight"><pre><span></span>'
        "plan single-link --output a.png\n</pre></div></div><p>single-link</p>"
        '<div class="highlight-python"><pre>a-b</pre></div>'
    )
    assert extension("whole_words").keep_whole(page) == page.replace(
        "plan single-link --output", 'plan <span class="word">single-link</span> '
        '<span class="word">--output</span>'
    )  # fmt: skip


# The search


def test_the_text_of_a_page_is_kept_by_sections():
    body = (
        '<section id="a"><h1>A<a class="headerlink" href="#a">link</a></h1><p>first  words</p>'
        '<section id="b"><h2>B</h2><pre>code &amp; <span>more</span></pre></section>'
        "<script>hidden</script><p>last</p></section>"
    )
    assert snippets.sections_of(body) == {"a": "A first words last", "b": "B code & more"}


@pytest.fixture(scope="module")
def chromium():
    api = pytest.importorskip("playwright.sync_api")
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM)
        yield browser
        browser.close()


@pytest.fixture
def page(chromium):
    """A page that is opened as a file: no script fails, and nothing is asked of a server."""
    page = chromium.new_page(viewport={"width": 1400, "height": 900})
    wrong = []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("console", lambda said: wrong.append(said.text) if said.type == "error" else None)
    page.on("request", lambda asked: wrong.append(asked.url))
    yield page
    assert [words for words in wrong if not words.startswith("file:")] == []
    page.close()


RESULTS = """<!doctype html><html><body><div id="search-results"></div>
<script>const PAGE_TEXTS = {"docs/start": {"start": "nothing here",
  "swing": "After a fast move the tip of an arm keeps <b>vibrating</b> for long."}};</script>
<script src="search_snippets.js"></script>
<script>document.getElementById("search-results").innerHTML =
  '<ul class="search"><li><a href="docs/start.html">Start</a></li>'
  + '<li><a href="docs/start.html#swing">Swing</a></li></ul>';</script></body></html>"""


@pytest.mark.slow
@in_chromium
def test_a_result_has_the_words_around_what_was_found_without_a_server(page, tmp_path):
    script = DOCS_FOLDER / "_static" / "search_snippets.js"
    (tmp_path / script.name).write_bytes(script.read_bytes())
    (tmp_path / "search.html").write_text(RESULTS)
    page.goto(f"{(tmp_path / 'search.html').as_uri()}?q=vibration+tips")
    page.wait_for_selector("p.context")
    for words in page.locator("p.context").all_inner_texts():
        assert "the tip of an arm keeps <b>vibrating</b> for long." in words  # as text
    assert page.locator("mark").all_inner_texts() == ["tip", "vibrating"] * 2


CODE = """<!doctype html><html><head><meta name="viewport" content="width=device-width">
<link rel="stylesheet" href="site.css"></head><body>
<div class="highlight-console"><div class="highlight"><pre>{line}</pre></div></div>
<p>{words}</p></body></html>"""


@pytest.mark.slow
@in_chromium
def test_a_command_breaks_nowhere_and_scrolls_on_a_phone(page, tmp_path):
    sheet = DOCS_FOLDER / "_static" / "site.css"
    (tmp_path / sheet.name).write_bytes(sheet.read_bytes())
    line = "quietarm plan single-link --target 30deg --duration 0.8 --output a.json --output a.png"
    literal = "".join(f'<span class="pre">{word}</span> ' for word in line.split())
    words = f'With <code class="literal">{literal}</code> ' * 5
    written = extension("whole_words").keep_whole(CODE.format(line=line, words=words))
    (tmp_path / "code.html").write_text(written)
    page.set_viewport_size({"width": 390, "height": 844})
    page.goto((tmp_path / "code.html").as_uri())
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    wide, visible, lines = page.evaluate(
        "(pre => [pre.scrollWidth, pre.clientWidth, pre.clientHeight"
        " / parseFloat(getComputedStyle(pre).fontSize)])(document.querySelector('pre'))"
    )
    assert wide > visible
    assert lines < 2.5  # one line and a scroll bar
    # no word of a command stands on two lines, in a sentence or in a block, which goes on below
    for width in (390, 800, 1400):
        page.set_viewport_size({"width": width, "height": 844})
        pieces = page.evaluate(
            "[...document.querySelectorAll('.pre, .word')].map(e => e.getClientRects().length)"
        )
        assert set(pieces) == {1}
    page.set_viewport_size({"width": 740, "height": 844})
    wide, visible = page.evaluate(
        "(pre => [pre.scrollWidth, pre.clientWidth])(document.querySelector('pre'))"
    )
    assert wide == visible


# The site as .ci/run builds it


def pages_of_site():
    """The pages of the site, without lists and without the pages to drag that stand in frames."""
    made_by_sphinx = {"index.html", "genindex.html", "search.html", "py-modindex.html"}
    return [
        path
        for path in sorted(SITE.rglob("*.html"))
        if "_static" not in path.parts
        and not (path.parent == SITE and path.name in made_by_sphinx)
        and "<article" in path.read_text()
    ]


CUT = """() => {
    const shown = "article :is(pre, .cell_output, table, img)";
    const scrolling = "table.docutils, .cell_output, .highlight pre, .equation";
    const edge = document.documentElement.clientWidth + 1;
    const cut = [...document.querySelectorAll(shown)].filter(element => {
        const hidden = getComputedStyle(element).overflowX === "hidden";
        const wide = element.scrollWidth > element.clientWidth + 1;
        const beyond = element.getBoundingClientRect().right > edge;
        return (wide && hidden) || (beyond && !element.closest(scrolling));
    });
    return cut.map(element => element.tagName + " " + element.textContent.slice(0, 60));
}"""
"""What is cut, or stands beyond the screen and does not scroll."""


@pytest.mark.slow
@in_chromium
@built
def test_every_page_names_the_next_one_fits_the_screen_and_has_headings(page):
    last = set()
    for width in (1400, 390):
        page.set_viewport_size({"width": width, "height": 900})
        for path in pages_of_site():
            name = path.relative_to(SITE).as_posix()
            page.goto(path.as_uri())
            assert page.evaluate("document.documentElement.scrollWidth") <= width, name
            assert page.evaluate(CUT) == [], name
            if not page.locator(".related-pages .next-page .title").count():
                last.add(name)
            article = page.evaluate("document.querySelector('article').scrollHeight")
            if width == 1400 and article > 2 * 900:
                headings = "article :is(h2, h3, dt) > a.headerlink"
                assert page.locator(headings).count() >= 2, name
    assert last == {"README.html"}  # with which the table of contents ends


@pytest.mark.slow
@in_chromium
@built
@pytest.mark.parametrize("query", ["vibration", "insensitivity", "torque limit", "hypervolume"])
def test_the_search_of_the_site_finds_text_with_its_words(page, query):
    page.goto(f"{(SITE / 'search.html').as_uri()}?q={query.replace(' ', '+')}")
    page.wait_for_selector("ul.search li p.context")
    page.wait_for_function(
        "document.querySelector('.search-summary').innerText.includes('finished')"
    )
    results = page.locator("ul.search > li").count()
    assert results > 3
    assert page.locator("ul.search > li > p.context").count() == results
    assert page.locator("ul.search mark").count() >= results / 2
