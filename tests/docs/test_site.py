"""The site: links to the glossary, the search without a server, code that breaks nowhere."""

import html
import importlib.util
import re
import shutil
import sys
from pathlib import Path
from types import SimpleNamespace
from urllib.parse import urlsplit
from urllib.request import url2pathname

import nbformat
import pytest
from notebook_files import NOTEBOOKS, narrow_name
from pages import DOCS, ROOT

import quietarm as qa

nodes = pytest.importorskip("docutils.nodes")
pytest.importorskip("sphinx")
Image = pytest.importorskip("PIL.Image")
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
names = extension("page_names")
pictures = extension("readable_pictures")
snippets = extension("search_snippets")
reference = extension("reference_texts")
stacked = extension("stacked_tables")
words = extension("whole_words")


# Links to the glossary


@pytest.fixture
def app():
    """Return what the extension asks of Sphinx."""
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


# Names of pages


@pytest.fixture
def titled(app):
    """Pages with a title, one with a section."""
    titles = {"docs/moves": nodes.title("", "Plan a move"), "docs/index": nodes.title("", "Home")}
    entry = nodes.reference("", "How long after arrival", anchorname="#how-long")
    tocs = {"docs/moves": page_of(entry), "docs/index": page_of()}
    app.env = SimpleNamespace(titles=titles, tocs=tocs)
    app.config = SimpleNamespace(root_doc="docs/index")
    return app


@pytest.mark.parametrize(
    ("words", "address", "title"),
    [
        ("docs/moves.md", "docs/moves.html", "Plan a move"),
        ("docs/moves.md", "docs/moves.html#how-long", "How long after arrival"),
        ("docs/moves.md#how-long", "docs/moves.html#how-long", "How long after arrival"),
        ("docs/moves.md", "docs/moves.html#other", "Plan a move"),
        ("docs/none.md", "docs/none.html", "docs/none.md"),
        ("the page docs/moves.md", "docs/moves.html", "the page docs/moves.md"),
    ],
)
def test_a_link_names_a_page_by_its_title(titled, words, address, title):
    page = page_of(nodes.reference("", words, refuri=address))
    names.name_pages(titled, page, "README")
    assert links(page) == [(title, address)]


def test_a_link_names_a_page_beside_its_own(titled):
    page = page_of(nodes.reference("", "moves.md", refuri="moves.html"))
    names.name_pages(titled, page, "docs/start")
    assert links(page) == [("Plan a move", "moves.html")]


@pytest.mark.parametrize(
    ("page", "neighbours", "following"),
    [
        ("README", {"prev": "a page"}, {"link": "index.html", "title": "Home"}),
        ("docs/start", {"prev": "a page", "next": "another"}, "another"),
        ("search", {}, None),
    ],
)
def test_the_last_page_names_the_first_one(titled, page, neighbours, following):
    names.end_where_it_begins(titled, page, "", neighbours, None)
    assert neighbours.get("next") == following


# Pictures


def picture_at(folder, name, width, **settings):
    """A picture of this width in a folder."""
    path = folder / name
    Image.new("RGB", (width, 100)).save(path, **settings)
    return path


def test_a_picture_is_as_wide_as_its_letters_need(tmp_path):
    # 7 points are 9 pixels at 9 * 72 / 7 = 92.6 pixels an inch
    ten_inches = picture_at(tmp_path, "a.png", 1500, dpi=(150, 150))
    assert pictures.least_width(ten_inches) == pytest.approx(10 * 92.6, rel=0.01)
    of_a_screen = picture_at(tmp_path, "b.png", 960)
    assert pictures.least_width(of_a_screen) == pytest.approx(10 * 92.6, rel=0.01)
    assert pictures.least_width(picture_at(tmp_path, "c.gif", 800)) == 0


def framed(body, picture):
    variant = pictures.narrow_variant(picture, picture.parent / "narrow")
    return pictures._IMAGE.sub(lambda tag: pictures.framed(tag, picture, variant), body)


def test_a_picture_opens_in_full_from_a_frame_that_scrolls(tmp_path):
    picture = picture_at(tmp_path, "a.png", 960, dpi=(96, 96))
    image = '<img alt="words" src="_images/a.png" />'
    assert framed(f"<p>{image}</p>", picture) == (
        '<p><span class="frame"><a class="picture" href="_images/a.png">'
        '<img alt="words" src="_images/a.png" style="--least: 930px"></a></span></p>'
    )
    linked = f'<a class="reference" href="page.html">{image}</a>'  # leads where it led
    assert framed(linked, picture).count("<a ") == 1


def test_a_picture_with_a_variant_for_phones_shows_that(tmp_path):
    picture = picture_at(tmp_path, "a.png", 960)
    picture_at(tmp_path, "a-narrow.png", 300)
    body = framed('<img alt="words" src="../_images/a.png"/>', picture)
    assert '<source media="(max-width: 34em)" srcset="../_images/a-narrow.png">' in body
    assert "frame" not in body
    assert body.startswith('<a class="picture" href="../_images/a.png"><picture>')


def test_a_picture_of_a_notebook_has_its_variant_by_its_content(tmp_path):
    picture = picture_at(tmp_path, "a.png", 960)
    folder = tmp_path / "narrow"
    folder.mkdir()
    name = narrow_name(NOTEBOOKS / "03_shaping_a_move.ipynb", picture.read_bytes())
    picture_at(folder, name, 300)
    body = framed('<img alt="words" src="../_images/a.png"/>', picture)
    assert f'srcset="../_images/{name}"' in body
    other = picture_at(tmp_path, "b.png", 900)
    assert pictures.narrow_variant(other, folder) is None


def test_a_picture_without_words_says_what_it_is(tmp_path):
    picture = picture_at(tmp_path, "a.png", 960)
    body = framed('<img alt="a.png" src="a.png" />', picture)
    assert 'alt="picture that the cell above draws"' in body
    assert body.count("alt=") == 1


# Words and lines


def test_words_of_commands_stay_whole():
    page = (
        '<div class="highlight-console notranslate"><div class="highlight"><pre><span></span>'
        "plan single-link --output a.png\n</pre></div></div><p>single-link</p>"
        '<div class="highlight-python"><pre>a-b</pre></div>'
    )
    assert words.keep_whole(page) == page.replace(
        "plan single-link --output", 'plan <span class="word">single-link</span> '
        '<span class="word">--output</span>'
    )  # fmt: skip


def test_a_long_list_in_a_command_breaks_behind_its_commas():
    kinds = ["zvd", "ruckig", "zv-ruckig", "zvd-ruckig", "ei-ruckig", "toppra-and-more"]
    page = (
        f'<div class="highlight-console"><pre>compare --baselines {",".join(kinds)}\n</pre></div>'
    )
    shown = words.keep_whole(page)
    parts = "<wbr>".join(f'<span class="word">{kind},</span>' for kind in kinds[:-1])
    assert f'{parts}<wbr><span class="word">{kinds[-1]}</span>' in shown


def test_a_long_word_of_code_may_break():
    short = '<code><span class="pre">--acceleration-limit</span></code>'
    long = f'<code><span class="pre">{"a" * 40}</span></code>'
    assert words.keep_whole(short) == short
    assert words.keep_whole(long) == long.replace("pre", "pre long")


def test_a_signature_breaks_before_its_arguments():
    paren = '<span class="sig-paren">(</span>'
    assert words.keep_whole(f"<dt>Arm{paren}alpha1=1)</dt>") == f"<dt>Arm{paren}<wbr>alpha1=1)</dt>"


def whole_words_of(body):
    return re.findall(r'<span class="word">(.*?)</span>', words.keep_whole(body), re.DOTALL)


@pytest.mark.parametrize(
    ("text", "whole"),
    [
        ("by MOEA/D-DE, or NSGA-II (MO-CMA-ES).", ["MOEA/D-DE", "NSGA-II", "MO-CMA-ES"]),
        ("from -pi/2 to pi/4", ["-pi/2", "pi/4"]),
        (
            "in 0.46 s, 1.2 % and 40 rad/s^2, 0.15 N m",
            ["0.46 s", "1.2 %", "40 rad/s^2", "0.15 N m"],
        ),
        ("a point-to-point move, and so on - or not", []),
        ("a wide 3 of them", []),
        ("as --coefficients=-0.0019, or --path", ["--coefficients=-0.0019", "--path"]),
        ("a hub of 2.383e-2 kg m^2", ["2.383e-2 kg m^2"]),
    ],
)
def test_names_and_numbers_with_units_stay_whole(text, whole):
    assert whole_words_of(f"<p>{text}</p>") == whole
    assert whole_words_of(f"<p><code>{text}</code></p>") == []


def test_every_hyphenated_word_of_a_cell_stays_whole():
    cells = "<td>single-link, a b</td><td>0.99 to 1.5</td><td>18 of 18</td><th>torque [N m]</th>"
    whole = ["single-link,", "0.99 to 1.5", "18 of 18", "[N m]"]
    assert whole_words_of(f"<table><tr>{cells}</tr></table>") == whole


def room_of(content):
    cell = words.keep_whole(f"<table><tr><td>{content}</td></tr></table>")
    return float(re.search(r"--room: ([\d.]+)ch", cell)[1])


def test_a_cell_has_room_for_its_words():
    assert room_of("0.0445") < room_of("gradient, 50 points") < 18
    assert room_of("some words " * 6) < 18  # four lines of twenty letters
    assert 30 < room_of("some words " * 14) < 35
    assert room_of("some words " * 100) < 41


def test_a_command_that_a_cell_prints_breaks_between_its_words():
    command = "$ quietarm plan --plant-file table.py --set stiffness=6 --target 180deg"
    assert whole_words_of(printed_by_cell(command)) == ["--plant-file", "--set", "--target"]


def printed_by_cell(*lines):
    """A page with what a cell prints."""
    printed = "\n".join(lines)
    return (
        '<div class="cell_output docutils container">\n'
        '<div class="output stream highlight-myst-ansi notranslate"><div class="highlight">'
        f"<pre><span></span>{printed}\n</pre></div>\n</div>\n</div>"
    )


def test_sentences_of_a_cell_go_on_and_columns_stay():
    sentence = "found no motion of 6 terms with residual at most 0 m; try another limit"
    row = "plain cycloid    F1 = 77.1146 mm   F2 = 91.15 mJ   net work = 40.88 mJ"
    of_file = "time_s,angle_rad,speed_rad_s,acceleration_rad_s2,tip_m,torque_Nm,power_W"
    page = words.keep_whole(printed_by_cell(sentence, "", row, "", of_file))
    assert page.count('class="sentence"') == 1
    assert f'<span class="sentence"><span></span>{sentence}</span>\n\n{row}' in page


def test_rows_of_a_table_scroll_together():
    # the second row has no two spaces, and the third goes on below its column
    rows = (
        "from (0.25, -0.3): [ 0.008 -0.157] with  19.15 mJ, bent by  14.4 mm",
        "from (1.1, 0.9): [1.038 1.032] with 663.94 mJ, bent by 245.6 mm",
        "                   more steps or another seed may improve it a little",
    )
    page = printed_by_cell(*rows)
    assert words.keep_whole(page) == page


def test_a_sentence_that_a_program_broke_is_one_again():
    first = "plant 'belt-table': torque fails at line 7 of a cell (a symbol is no number);"
    second = "write def torque(self, joint, W, dW, ddW) that returns one expression"
    page = words.keep_whole(printed_by_cell("PlainSine:", f"    {first}", f"    {second}"))
    assert page.count('class="sentence"') == 1
    assert "</span>PlainSine:\n" in page
    assert "(a symbol is no number); write def" in page


def test_rows_of_a_file_stay_rows():
    header = "time_s,angle_rad,speed_rad_s,acceleration_rad_s2,jerk_rad_s3,tip_m,torque_Nm,power_W"
    row = "0.01,0.0005,0.12,10.3,-21.5,-0.00012,0.153,0.0181,0.01,0.0005,0.12,10.3,-21.5,-0.0"
    page = printed_by_cell(header, row, row)
    assert words.keep_whole(page) == page


def test_code_behind_a_picture_stays_as_it_is():
    # the lines are long, have words, and are indented alike
    line = "settings = {'limits': 3, 'and': 4, 'words': 5}  # as long as a line of a program may be"
    picture = '<div class="cell_output docutils container">\n<img src="one.png"></div>'
    code = f'<div class="cell_input"><div class="highlight"><pre>{line}\n{line}\n</pre></div></div>'
    assert words.keep_whole(picture + code) == picture + code


def test_a_signature_breaks_behind_its_package():
    name = '<span class="sig-name descname">comparison_figure</span>'
    dt = f'<dt class="sig"><span class="sig-prename">quietarm.views.pictures.</span>{name}</dt>'
    assert words.keep_whole(dt) == dt.replace(name, f"<wbr>{name}")


def test_long_words_of_code_break_behind_an_option_or_a_folder():
    code = '<code class="literal">{}</code>'
    option = code.format('<span class="pre">--coefficients="0.003347,-0.1697"</span>')
    assert words.keep_whole(option) == code.format(
        '<span class="pre">--coefficients=</span><wbr>'
        '<span class="pre long">"0.003347,-0.1697"</span>'
    )
    path = "tests/ocp/simulation/test_third_opinion.py"
    broken = words.keep_whole(code.format(f'<span class="pre">{path}</span>'))
    assert broken.count("<wbr>") == 3
    assert "simulation/<wbr>test_third_opinion.py</span>" in broken
    short = code.format('<span class="pre">--output</span>')
    assert words.keep_whole(short) == short


@pytest.mark.parametrize("typed", [".venv/bin/quietarm sweep a.yaml", "git clone ADDRESS"])
def test_commands_that_no_test_runs_break_as_those_that_one_does(typed):
    block = (
        '<div class="highlight-{} notranslate"><div class="highlight"><pre><span></span>{}</pre>'
    )
    assert words.keep_whole(block.format("text", typed)) == block.format("sh", typed)
    printed = block.format("text", "move   single-link, 0 to 30 deg in 0.8 s")
    assert words.keep_whole(printed) == printed


# The reference


def test_a_plant_of_the_reference_has_its_parameters_with_units_and_sources():
    lines = reference.parameters_of(qa.FlexibleBeam)
    assert lines[:3] == ["", "Parameters", "----------"]
    meanings = dict(zip(lines[3::2], lines[4::2]))
    assert "[m]; " in meanings["length : float"]
    assert meanings["mode_count : int"].strip().startswith("How many")
    assert "[" not in meanings["zeta : float"]  # it has no unit
    assert len(meanings) == len(qa.FlexibleBeam.parameter_fields())
    assert reference.parameters_of(qa.Plan) == []


def test_the_reference_shows_values_of_short_constants_and_links_pages():
    def function(task, objectives=("residual", "energy"), table=()):
        """Its signature is what autodoc makes of the source."""

    function.__globals__["SHORT_NAMES"] = ("residual", "energy")
    function.__globals__["LONG_TABLE"] = tuple(range(100))
    source = "(task, objectives=SHORT_NAMES, table=LONG_TABLE, errors=<factory>)"
    shown, _ = reference.shorten_signature(None, "function", "", function, {}, source, None)
    assert shown == "(task, objectives=('residual', 'energy'), table=LONG_TABLE, errors=...)"
    environment = SimpleNamespace(found_docs={"docs/physics"})
    lines = ["Unit: m, see docs/physics.md and tests/README.md."]
    reference.before_napoleon(None, "attribute", "", None, {}, lines)
    assert ":" not in lines[0]  # napoleon takes no unit for a type
    reference.after_napoleon(SimpleNamespace(env=environment), "attribute", "", None, {}, lines)
    assert lines == ["Unit: m, see :doc:`/docs/physics` and tests/README.md."]


# Tables of words


def table_of(*rows, right=""):
    """A table as Sphinx writes it; the first row has its headings."""
    lines = [
        "".join(f"<{tag}{right}><p>{words}</p></{tag}>" for words in row)
        for tag, row in zip(["th", *["td"] * len(rows)], rows)
    ]
    body = "".join(f"<tr>{line}</tr>" for line in lines)
    return f'<table class="docutils align-default">{body}</table>'


CHOICE = ("You have", "You want", 'Take "&amp;" go')


def test_a_table_of_words_has_the_heading_of_every_cell_beside_it():
    row = ("a recording of the machine", "a model, by <b>its swing</b>", "identify")
    shown = stacked.stack_tables(table_of(CHOICE, row, ("a robot of six joints", "", "plan")))
    assert shown.startswith('<table class="stacked docutils align-default">')
    labels = re.findall(r'<td data-label="(.*?)"><p>(.*?)</p>', shown)
    assert labels[:3] == [
        ("You have", "a recording of the machine"),
        ("You want", "a model, by <b>its swing</b>"),
        ("Take &quot;&amp;&quot; go", "identify"),
    ]
    assert [label for label, _ in labels[3:]] == ["You have", "Take &quot;&amp;&quot; go"]
    assert "<td><p></p></td>" in shown  # an empty cell says nothing


@pytest.mark.parametrize(
    "table",
    [
        table_of(("a", "b"), ("plan", "blue and solid")),  # fits on a phone
        table_of(("move", "energy"), ("link, 0 to pi/6, in 0.8 s, at rest", "0.0911")),
        table_of(
            CHOICE, ("a recording of the machine", "a model", "b"), right=' class="text-right"'
        ),
    ],
)
def test_short_tables_and_those_of_numbers_stay_side_by_side(table):
    assert stacked.stack_tables(table) == table


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
    text = f'With <code class="literal">{literal}</code> ' * 5
    written = words.keep_whole(CODE.format(line=line, words=text))
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
    const shown = "article :is(pre, .cell_output, table, img, code)";
    const scrolling = ".table-wrapper, .frame, .text_html, .highlight pre, .equation";
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
    for width in (1400, 390):
        page.set_viewport_size({"width": width, "height": 900})
        for path in pages_of_site():
            name = path.relative_to(SITE).as_posix()
            page.goto(path.as_uri())
            assert page.evaluate("document.documentElement.scrollWidth") <= width, name
            assert page.evaluate(CUT) == [], name
            assert page.locator(".related-pages .next-page .title").count() == 1, name
            article = page.evaluate("document.querySelector('article').scrollHeight")
            if width == 1400 and article > 2 * 900:
                headings = "article :is(h2, h3, dt) > a.headerlink"
                assert page.locator(headings).count() >= 2, name


LETTERS = """() => [...document.querySelectorAll("article img")].map(image => ({
    file: image.currentSrc, width: image.getBoundingClientRect().width,
}))"""
"""Which file of each picture is shown, and how wide."""
SMALLEST = 7
"""Points of the smallest letters of a figure; tests/views/pictures holds it."""
FILM = (5.4, 10)
"""Inches of a film of two panels, and points of its letters (views/film.py)."""


def inches_and_points(file):
    """Return how wide a picture is on paper, and how high its smallest letters are."""
    if file.startswith("data:") or file.endswith(".gif"):
        return FILM
    with Image.open(Path(url2pathname(urlsplit(file).path))) as image:
        return image.width / image.info.get("dpi", (96, 96))[0], SMALLEST


@pytest.fixture
def phone(page):
    """A page that is opened on a phone."""
    page.set_viewport_size({"width": 390, "height": 844})
    return page


def codes_on(page):
    """The programs of the cells that a page of a notebook shows."""
    blocks = re.findall(r'<div class="cell_input\b.*?<pre>(.*?)</pre>', page.read_text(), re.DOTALL)
    return [html.unescape(re.sub(r"<[^>]*>", "", block)).strip() for block in blocks]


@pytest.mark.slow
@built
@pytest.mark.parametrize("path", sorted(ROOT.glob("notebooks/[0-9]*.ipynb")), ids=lambda p: p.stem)
def test_the_code_of_a_notebook_stands_on_its_page_as_it_is(path):
    cells = nbformat.read(path, as_version=4).cells
    sources = {cell.source.strip() for cell in cells if cell.cell_type == "code"}
    shown = codes_on(SITE / "notebooks" / f"{path.stem}.html")
    assert len(shown) > len(sources) / 2
    assert set(shown) <= sources


@pytest.mark.slow
@in_chromium
@built
def test_letters_of_every_picture_are_nine_pixels_high_on_a_phone(phone):
    small = []
    for path in pages_of_site():
        phone.goto(path.as_uri())
        for shown in phone.evaluate(LETTERS):
            inches, points = inches_and_points(shown["file"])
            pixels = shown["width"] / inches * points / 72
            if pixels < 8.95:
                small.append((path.name, shown["file"][-40:], round(pixels, 1)))
    assert small == []


BROKEN = r"""() => {
    const kept = /(?<!\S)-?\w+(?:[-/]\w+)*-\w+|(?<![\w.])\d[\d.]* (?:%|s|mm|J|N m|rad)(?!\w)/g;
    const broken = [];
    for (const cell of document.querySelectorAll("article :is(td, th)")) {
        const texts = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT);
        while (texts.nextNode()) {
            for (const found of texts.currentNode.data.matchAll(kept)) {
                const range = document.createRange();
                range.setStart(texts.currentNode, found.index);
                range.setEnd(texts.currentNode, found.index + found[0].length);
                const tops = [...range.getClientRects()].map(({ top }) => Math.round(top));
                if (new Set(tops).size > 1 && found[0].length <= 32) broken.push(found[0]);
            }
        }
    }
    return broken;
}"""
"""Names and numbers with units in cells that stand on two lines."""
TALL = """() => [...document.querySelectorAll("article table.docutils tr")]
    .filter(row => row.getBoundingClientRect().height > 300)
    .map(row => row.innerText.slice(0, 60))"""
"""Rows of tables of more than a dozen lines."""
UNSAID = """() => [...document.querySelectorAll("article *")].filter(element => {
    const scrolls = ["auto", "scroll"].includes(getComputedStyle(element).overflowX);
    const wide = scrolls && element.scrollWidth > element.clientWidth + 1;
    return wide && !element.parentElement.dataset.hidden?.includes("right");
}).map(element => element.tagName + " " + element.className + element.textContent.slice(0, 40))"""
"""What scrolls without a sign of it."""


@pytest.mark.slow
@in_chromium
@built
def test_tables_and_logs_can_be_read_on_a_phone(phone):
    for path in pages_of_site():
        phone.goto(path.as_uri())
        phone.wait_for_load_state("load")
        name = path.relative_to(SITE).as_posix()
        assert phone.evaluate(BROKEN) == [], name
        assert phone.evaluate(TALL) == [], name
        assert phone.evaluate(UNSAID) == [], name


@pytest.mark.slow
@in_chromium
@built
def test_the_columns_of_a_table_of_words_are_seen_on_a_phone_without_scrolling(phone):
    phone.goto((SITE / "docs" / "choose.html").as_uri())
    cells = phone.locator("article table.docutils >> nth=0").locator("td")
    assert cells.count() == 39
    for left, right in cells.evaluate_all(
        "cells => cells.map(c => [c.getBoundingClientRect().left, c.getBoundingClientRect().right])"
    ):
        assert 0 <= left < right <= 390
    assert "You want" in cells.nth(1).evaluate("cell => getComputedStyle(cell, '::before').content")
    phone.set_viewport_size({"width": 1400, "height": 900})
    row = phone.locator("article table.docutils tbody tr").first
    assert row.evaluate("row => new Set([...row.cells].map(c => c.offsetTop)).size") == 1


@pytest.mark.slow
@in_chromium
@built
def test_the_sign_of_a_scroll_says_on_which_side_more_is(phone):
    phone.goto((SITE / "docs" / "systems.html").as_uri())
    holder = phone.locator(".scrolls:has(> .table-wrapper)").first
    assert holder.get_attribute("data-hidden") == "right"
    assert holder.locator("> .more.right").is_visible()
    assert not holder.locator("> .more.left").is_visible()
    for to, hidden in ((100, "left right"), (10_000, "left"), (0, "right")):
        holder.locator("> .table-wrapper").evaluate("(table, to) => table.scrollTo(to, 0)", to)
        phone.wait_for_function(
            "([holder, hidden]) => holder.dataset.hidden === hidden",
            arg=[holder.element_handle(), hidden],
        )


@pytest.mark.slow
@in_chromium
@built
def test_a_tap_opens_the_full_picture(phone):
    phone.goto((SITE / "docs" / "gallery.html").as_uri())
    phone.locator("a.picture").first.click()
    phone.wait_for_url("**/_images/plan.png")


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


@pytest.mark.slow
@in_chromium
@built
@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("gallery", "docs/gallery.html"),
        ("glossary", "docs/glossary.html"),
        ("robots", "docs/robots.html"),
        ("fronts", "docs/fronts.html"),
        ("hypervolume", "docs/measures.html"),
        ("vibration", "notebooks/02_three_plants.html"),
    ],
)
def test_a_page_whose_heading_has_the_word_comes_before_those_that_mention_it(page, query, first):
    page.goto(f"{(SITE / 'search.html').as_uri()}?q={query}")
    page.wait_for_function(
        "document.querySelector('.search-summary').innerText.includes('finished')"
    )
    results = page.locator("ul.search > li > a").evaluate_all(
        "links => links.map(link => link.getAttribute('href').split('#')[0])"
    )
    assert results[0] == first
