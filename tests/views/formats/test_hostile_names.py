"""Names of a stranger's file come out of every format as they went in, and nothing else does."""

import csv
import json
import re
import subprocess
from html.parser import HTMLParser
from io import StringIO
from xml.etree import ElementTree

import pandas as pd
import pytest
import yaml
from c_library import COMPILER, STRICT, needs_compiler
from hostile import INJECTED, LABEL, NAMES, Hostile
from matplotlib.figure import Figure
from rich.console import Console
from scipy.io import loadmat
from st_interpreter import Block, needs_matiec, run_by_matiec

import quietarm as qa
from quietarm.models.robot.urdf.read_urdf import read_urdf
from quietarm.ocp.escapes import (
    c_comment,
    csv_table,
    markdown,
    one_line,
    printable,
    script_json,
    st_comment,
)
from quietarm.views import export_plan
from quietarm.views.explore.by_hand import MoveByHand
from quietarm.views.explore.live_page import LivePage
from quietarm.views.page.trade_off import trade_off
from quietarm.views.report import Report, show, show_facts
from quietarm.views.report.plan_rows import plan_rows
from quietarm.views.report.saving import save_figure
from quietarm.views.report.terminal import print_lines

MAIN = """
#include "move.h"
#include <stdio.h>
int main(void)
{
    int i;
    const char *letter;
    for (i = 0; i < MOVE_JOINTS; i++) {
        for (letter = move_joints[i]; *letter; letter++)
            printf("%02x", (unsigned char)*letter);
        puts("");
    }
    return 0;
}
"""
"""Prints the names letter by letter: each would be a line by itself, or none."""


@pytest.fixture(scope="module")
def plan():
    """A motion whose joints have all the names, and whose plant has the label."""
    return qa.evaluate_coefficients(qa.PointToPoint(Hostile(), 1.0, 1.0), [])


@pytest.fixture
def report():
    """Results whose texts are the names."""
    names = [name for name in NAMES if len(name) < 100]  # of 3000 letters no page has room
    tables = {"names": pd.DataFrame({"name": names, INJECTED: range(len(names))})}
    return Report("report.md", {"label": LABEL, "names": names}, tables, {"a.png": Figure})


class Page(HTMLParser):
    """The texts of a page, by the elements that they stand in, and all of its elements."""

    def __init__(self, page):
        super().__init__()
        self.elements = []
        self.texts = []
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        self.texts.append((tag, ""))

    def handle_data(self, data):
        if self.texts:
            tag, text = self.texts[-1]
            self.texts[-1] = tag, text + data

    def of(self, element):
        """The texts of an element's kind."""
        return [text for tag, text in self.texts if tag == element]


@needs_compiler
def test_c_holds_the_names_and_runs_nothing_else(plan, tmp_path):
    export_plan(plan, tmp_path / "move.c")
    (tmp_path / "main.c").write_text(MAIN)
    strict = [flag for flag in STRICT if flag not in ("-shared", "-fPIC")]
    for trigraphs in ([], ["-trigraphs"]):
        line = [COMPILER, *strict, *trigraphs, "-o", "run", "move.c", "main.c", "-lm"]
        subprocess.run(line, check=True, cwd=tmp_path)
        printed = subprocess.run([tmp_path / "run"], capture_output=True, text=True, check=True)
        found = [bytes.fromhex(row).decode() for row in printed.stdout.splitlines()]
        # the string of a language that ends its strings by it has no NUL
        assert found == [name.partition("\0")[0] for name in NAMES]
    source = (tmp_path / "move.c").read_text()
    assert "injected" not in re.sub(r'/\*.*?\*/|"(?:\\.|[^"\\])*"', "", source, flags=re.S)
    assert source.isascii() or not set("\u202e\n") & set(source.splitlines()[0])


def test_structured_text_holds_the_names_in_comments_and_runs_nothing_else(plan, tmp_path):
    export_plan(plan, tmp_path / "move.st")
    text = (tmp_path / "move.st").read_text(encoding="utf-8")
    code = re.sub(r"\(\*.*?\*\)", "", text, flags=re.S)
    assert "injected" not in code
    assert code.isascii()
    outputs = Block(text)(Execute=True, TimeStep=0.1)
    assert len(outputs["Position"]) == len(NAMES)
    for number, name in enumerate(NAMES, 1):
        assert f"(* joint {number}: {st_comment(name)} [rad] *)\n" in text


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("name", ["move.cam", "move.cia402"])
def test_records_and_cams_have_the_names_in_a_heading_that_is_no_formula(plan, tmp_path, name):
    settings = {"period": 0.2} if name == "move.cia402" else {"points": 5}
    export_plan(plan, tmp_path / name, **settings)
    with open(tmp_path / name, newline="", encoding="utf-8") as file:
        lines = list(file)
    # what is no row is a comment in one line
    header = [line for line in lines if line.startswith("# ")]
    heading, *rows = csv.reader(line for line in lines if line not in header)
    assert len(header) == (4 if name == "move.cia402" else 0)
    assert not [cell for cell in heading if re.match(r"\s*[=+\-@\t\r\uff1d\uff0b]", cell)]
    ending = " 60C1h:01 position" if name == "move.cia402" else "_angle_rad"
    stems = [cell.removesuffix(ending) for cell in heading if cell.endswith(ending)]
    assert [stem.removeprefix("'") for stem in stems] == NAMES
    assert {len(row) for row in rows} == {len(heading)}


@pytest.mark.slow
@needs_matiec
def test_a_compiler_of_structured_text_finds_nothing_else(plan, tmp_path):
    export_plan(plan, tmp_path / "move.st")
    (row,) = run_by_matiec(tmp_path / "move.st", [(True, 0.1)], len(NAMES))
    assert len(row) == 3 + 3 * len(NAMES)


def test_no_title_ends_a_comment_of_structured_text():
    for title in [LABEL, *NAMES, "(*)", "*)(*", "(*(*"]:
        words = st_comment(title)
        assert not {"*)", "(*"} & {words[k : k + 2] for k in range(len(words))}
        assert words.replace(" ", "") == one_line(title).replace(" ", "")
        assert len(words.splitlines()) <= 1


def test_no_title_ends_a_comment_of_c():
    for title in [LABEL, *NAMES]:
        words = c_comment(title)
        assert not {"*/", "/*", "??"} & {words[k : k + 2] for k in range(len(words))}
        assert "\\" not in words
        assert len(words.splitlines()) <= 1


def test_tables_quote_the_names_and_no_heading_is_a_formula(plan, tmp_path):
    plan.save_csv(tmp_path / "plan.csv", 5.0)
    export_plan(plan, tmp_path / "export.csv", rate=5.0, columns="time,angle")
    for name in ("plan.csv", "export.csv"):
        with open(tmp_path / name, newline="", encoding="utf-8") as file:
            heading, *rows = csv.reader(file)
        assert {len(row) for row in rows} == {len(heading)}
        assert not [cell for cell in heading if re.match(r"\s*[=+\-@\t\r\uff1d\uff0b]", cell)]
        stems = [cell.removesuffix("_angle_rad") for cell in heading if "_angle_rad" in cell]
        assert [stem.removeprefix("'") for stem in stems] == NAMES
        assert all(float(cell) == pytest.approx(float(cell)) for row in rows for cell in row)
    both = [pd.read_csv(tmp_path / name) for name in ("plan.csv", "export.csv")]
    headings = [[head for head in table if "_angle_rad" in head] for table in both]
    assert headings[0] == headings[1]


def test_a_cell_of_a_table_is_no_formula_either():
    text = csv_table({"name": NAMES, "x": [0.1] * len(NAMES)})
    rows = list(csv.reader(StringIO(text, newline="")))
    assert [row[1] for row in rows[1:]] == ["0.1"] * len(NAMES)
    numbers = ("+1", "-1")
    assert not [
        cell for cell, _ in rows if re.match(r" *[=+\-@\t\r]", cell) and cell not in numbers
    ]


def test_ros_reads_the_names(plan, tmp_path):
    export_plan(plan, tmp_path / "move.yaml", rate=2.0)
    message = yaml.safe_load((tmp_path / "move.yaml").read_text(encoding="utf-8"))
    assert message["joint_names"] == NAMES
    assert set(message) == {"joint_names", "points"}
    export_plan(plan, tmp_path / "move.moveit", rate=2.0, frame=INJECTED)
    message = yaml.safe_load((tmp_path / "move.moveit").read_text(encoding="utf-8"))
    assert message["joint_trajectory"]["joint_names"] == NAMES
    assert message["joint_trajectory"]["header"]["frame_id"] == INJECTED
    assert set(message) == {"joint_trajectory", "multi_dof_joint_trajectory"}
    single = qa.evaluate_coefficients(
        qa.PointToPoint(qa.SingleLinkManipulator(), 0.5, 0.8), [0.0, 0.0]
    )
    export_plan(single, tmp_path / "one.yaml", rate=2.0, joint=INJECTED)
    assert yaml.safe_load((tmp_path / "one.yaml").read_text())["joint_names"] == [INJECTED]


def test_matlab_reads_the_names_and_a_variable_for_every_column(plan, tmp_path):
    export_plan(plan, tmp_path / "move.mat", rate=2.0, columns="time,angle,torque")
    variables = loadmat(tmp_path / "move.mat", chars_as_strings=True)
    found = [str(cell[0]) if cell.size else "" for cell in variables["joint_names"].ravel()]
    kept = [name for name in NAMES if "\0" not in name]  # MATLAB's own mark of an end
    assert [name for name, given in zip(found, NAMES, strict=True) if given in kept] == kept
    columns = [name for name in variables if not name.startswith("__")]
    assert all(re.fullmatch(r"[A-Za-z]\w{0,62}", name, re.ASCII) for name in columns)
    facts = {"coefficients", "duration_s", "joint_names"}
    assert len(set(columns) - facts) == 1 + 2 * len(NAMES)


def test_the_page_to_drag_is_one_script_whose_data_hold_the_names(plan):
    page = Page(trade_off([plan]).html())
    scripts = [attributes for tag, attributes in page.elements if tag == "script"]
    assert scripts == [{"type": "application/json", "id": "data"}, {}]
    (move,) = json.loads(page.of("script")[0])["moves"]
    names = [name.removeprefix("joint ") for name in move["panels"]["torque"]["names"]]
    assert names == [printable(name) for name in NAMES]
    assert one_line(LABEL).split("\n")[0] in page.of("title")[0]
    assert not {"img", "b", "h1 "} & {tag for tag, _ in page.elements}


def test_the_page_alive_is_one_script_and_its_answers_are_data(plan):
    live = LivePage(MoveByHand.of_plan(plan))
    page = Page(live.html())
    scripts = [attributes for tag, attributes in page.elements if tag == "script"]
    assert scripts == [{"type": "application/json", "id": "data"}, {}]
    names = json.loads(page.of("script")[0])["moves"][0]["panels"]["angle"]["names"]
    assert names == [printable(name) for name in NAMES]
    assert not {"img", "b", "h1 "} & {tag for tag, _ in page.elements}
    lines = {
        what: script_json(live.answer(what, b"{}", lambda done, total: None))
        for what in ("motion", "rows")
    }
    assert not set("<>&\n\u202e") & set("".join(lines.values()))
    answer = json.loads(lines["motion"])
    assert answer["move"]["title"].startswith(printable(LABEL))
    # and the server knows the name again
    asked = json.dumps({"plant": answer["fields"]["shown"]["plant"]}).encode()
    assert live.answer("motion", asked, lambda done, total: None)["move"]["points"]


def test_a_notebook_shows_texts_alone(plan):
    text = plan._repr_html_()
    page = Page(text)
    assert {tag for tag, _ in page.elements} <= {"table", "tr", "td", "th", "div", "b"}
    assert not any(attributes for _, attributes in page.elements)
    assert "\u202e" not in text


def test_a_terminal_gets_no_orders_and_as_many_lines_as_without_them(plan):
    console = Console(width=200, file=StringIO())
    facts = plan_rows(plan)
    show_facts(console, [(name, value[:80]) for name, value in facts])
    assert len(console.file.getvalue().splitlines()) == len(facts)
    console = Console(width=200, file=StringIO())
    print_lines(console, *NAMES)
    lines = console.file.getvalue().split("\n")
    assert [line.strip() for line in lines[:-1]] == [one_line(name).strip() for name in NAMES]
    assert "".join(lines).replace("\N{NO-BREAK SPACE}", " ").isprintable()


TEMPLATE = """# {{ label }}

{% for name in names %}
- x {{ name }} y
{% endfor %}

{{ tables.names | table }}

{{ label | code }}
"""


@pytest.fixture
def page(report, tmp_path, monkeypatch):
    """The report by a template of one's own."""
    template = tmp_path / "report.md"
    template.write_text(TEMPLATE)
    object.__setattr__(report, "template", template)
    object.__setattr__(report, "figures", {})
    return report


def test_reports_show_the_names_in_markdown_html_csv_and_latex(page, tmp_path):
    names = page.values["names"]
    words = [" ".join(one_line(name).split()) for name in names]
    html = Page(page.html())
    tags = {tag for tag, _ in html.elements}
    assert not tags & {"a", "img", "em", "strong", "del", "script", "b", "h2", "blockquote"}
    assert [" ".join(text.split()) for text in html.of("li")] == [f"x {name} y".replace(
        "  ", " ") for name in words]  # fmt: skip
    cells = [" ".join(text.split()) for text in html.of("td")][::2]
    assert cells == words
    assert [text.strip() for text in html.of("title")] == [one_line(LABEL)]
    assert [text.strip() for text in html.of("code")] == [one_line(LABEL)]
    for path, write in page.files(tmp_path / "out"):
        write(path)
    with open(tmp_path / "out" / "names.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    assert len(rows) == 1 + len(names)
    assert {len(row) for row in rows} == {2}
    latex = page.latex()
    assert "\\input" not in latex
    assert len([line for line in latex.splitlines() if line.endswith(r"\\")]) == 1 + len(names)
    console = Console(width=400, file=StringIO())
    show(console, page)
    text = console.file.getvalue()
    assert "[/red]" in text
    assert not {"\x1b", "\u202e", "\x9b"} & set(text)


def test_what_is_no_mark_stays_as_it_is_in_markdown():
    plain = "energy [J] within 5 mm, a_1 * 2, R&D, 3 < 4, nsga2+polish(population=20), ±5 %"
    assert markdown(plain) == plain
    assert markdown(markdown("*a*")) == r"\*a\*"


def test_a_picture_is_well_formed_and_shows_letters_not_formulas(tmp_path):
    figure = Figure()
    for k, name in enumerate(NAMES):
        figure.text(0.1, k / len(NAMES), name[:50])
    save_figure(figure, tmp_path / "names.svg")
    ElementTree.parse(tmp_path / "names.svg")
    texts = {text.get_text() for text in figure.texts}
    assert "\u202e" not in "".join(texts)
    assert "$x$" in texts


def test_a_urdf_keeps_the_names_as_they_are():
    """By entities, as XML has them; what XML cannot hold is no name of a URDF."""
    held = [name for name in NAMES if not re.search("[\x00-\x08\x0b\x0c\x0e-\x1f]", name)]
    links = "".join(f'<link name="l{k}"/>' for k in range(len(held) + 1))
    entities = ("".join(f"&#{ord(letter)};" for letter in name) for name in held)
    joints = "".join(
        f'<joint name="{name}" type="fixed"><parent link="l{k}"/><child link="l{k + 1}"/></joint>'
        for k, name in enumerate(entities)
    )
    assert [*read_urdf(f'<robot name="r">{links}{joints}</robot>').joints] == held
