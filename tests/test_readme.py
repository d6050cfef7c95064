"""README and docs: the commands, figures and files that they name."""

import re
import shlex

import pytest
from pages import COMMANDS, PAGES, README, ROOT, TWO_COMMANDS

import quietarm as qa
from quietarm.ocp import evaluate_coefficients, plan_move
from quietarm.studies.cli import quietarm
from quietarm.studies.reproduce.paper import SINGLE_LINK_SIXTH


def test_there_are_commands_for_a_move_of_your_own():
    named = {words[1] for words in [*COMMANDS, *map(shlex.split, TWO_COMMANDS[0].split(" && "))]}
    assert named >= set(quietarm.commands)


WITHOUT_JERK_LIMIT = {
    "ur5_bar.yaml": ("robots", "The limits are in MoveIt's format, jerk included"),
    "--profile free": ("gallery", "its acceleration jumps"),
    "--from": ("sweeps", "keeps the limits of its sweep"),
}
"""What a command without a limit of the jerk says in place of it, and the page with the reason."""


def test_plans_of_the_pages_have_a_limit_of_the_jerk_or_a_reason():
    typed = [
        line
        for text in PAGES.values()
        for block in re.findall(r"^```\w+\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)
        for line in block.splitlines()
        if re.search(r"quietarm plan |--duration fastest", line)
    ]
    assert len(typed) > 40
    without = [line for line in typed if "--jerk-limit" not in line]
    assert [line for line in without if not any(word in line for word in WITHOUT_JERK_LIMIT)] == []
    for word, (page, reason) in WITHOUT_JERK_LIMIT.items():
        assert any(word in line for line in without)
        assert reason in " ".join(PAGES[page].split())


# What it says


def test_files_that_a_page_names_are_there():
    for page, text in PAGES.items():
        folder = ROOT if page == "README" else ROOT / "docs"
        linked = re.findall(r"!?\[[^]]*\]\(([^)#]+)\)", text)
        quoted = re.findall(r"`([\w.-]+/[\w./-]+\.\w+)`", text)
        named = [folder / name for name in linked if "://" not in name]
        named += [ROOT / name for name in quoted]
        assert [path for path in named if not path.exists()] == [], page


def _rows(table):
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in table if row[:1] == "|"]


def test_the_table_is_that_of_a_reproduction():
    columns = {
        "plain cycloid": "cycloid", "ZV shaper": "zv",
        "gradient, at rest": "gradient, within the bounds", "at rest, no bounds": "gradient",
    }  # fmt: skip
    measured = {}  # by move and system
    parts = PAGES["systems"].split("\n## ")[1:]
    for part in parts:
        names, _, *rows = _rows(part.splitlines())
        move = part.split("\n", 1)[0].split(", ", 1)[1]
        measured[move] = {row[0]: row[names.index("energy [J]")] for row in rows}
    paper = (ROOT / "docs/paper.md").read_text()
    (table,) = [block for block in paper.split("\n\n") if block.startswith("| energy [J] |")]
    names, _, *rows = _rows(table.splitlines())
    assert [row[0].split(", ", 1)[1] for row in rows] == list(measured)
    own = ("paper, printed", "its search, here", "gradient, same residual")
    for row, systems in zip(rows, measured.values(), strict=True):
        shown = {name: cell for name, cell in zip(names, row, strict=True) if name not in own}
        for name, cell in list(shown.items())[1:]:
            assert float(cell) == pytest.approx(float(systems[columns[name]]), abs=6e-5)
    heads, _, *searched = _rows(PAGES["inputs"].splitlines())
    places = [
        next(i for i, head in enumerate(heads) if head.startswith(words))
        for words in ("paper, printed", "six terms, searched", "six terms, by gradient")
    ]
    assert [row[0] for row in rows] == [row[0] for row in searched]
    for row, found in zip(rows, searched, strict=True):
        here = [float(row[names.index(name)]) for name in own]
        assert here == [float(found[place].split()[0]) for place in places]


def test_the_picture_says_what_is_computed():
    # The picture's text: the plain cycloid leaves so much, the plan needs such a share.
    (alt,) = re.findall(r"!\[([^]]*)\]\(images/move\.gif\)", PAGES["pictures"])
    task = SINGLE_LINK_SIXTH.task
    cycloid, plan = evaluate_coefficients(task, []), plan_move(task)
    assert re.search(r"ringing by (\d+) mm", alt).group(1) == f"{cycloid.residual * 1e3:.0f}"
    assert "a quarter of the energy" in alt
    assert plan.energy / cycloid.energy == pytest.approx(0.25, abs=0.02)
    assert plan.residual < 1e-8


def _readme_table(heading):
    (table,) = [block for block in README.split("\n\n") if block.startswith(heading)]
    return _rows(table.splitlines())[2:]


def test_when_the_tool_may_act_is_what_the_page_of_the_drive_has():
    _, gantry, picker, *_ = re.split(r"^(?:Gantry|Picker), [\d.]+ m:$", PAGES["drive"], flags=re.M)
    motions = {"plan of 0.906 s": "robust plan, 5 %, shorter", "ZVD over ruckig": "ZVD over ruckig"}
    motions["plan of 0.290 s"] = motions["plan of 0.906 s"]
    for name, acts, energy in _readme_table("| | may act after [s] |"):
        machine, motion = name.split(", ")
        part = {"gantry": gantry, "picker": picker}[machine].split("\n\n")[1]
        cells = next(row for row in _rows(part.splitlines()) if row[0] == motions[motion])
        assert f"{float(cells[1]):.3f}" in motion or motion.startswith("ZVD")
        latest = max(map(float, cells[2:5]))  # at 0, 2 and 5 %
        assert float(acts) == pytest.approx(latest, abs=0.006)
        assert float(energy) == pytest.approx(float(cells[-1]), rel=5e-3)


@pytest.mark.slow
def test_what_an_error_of_the_frequency_leaves_is_what_is_computed():
    link = qa.SingleLinkManipulator()
    limits = {"acceleration_limit": 40.0, "jerk_limit": 2000.0}
    task = link.task(qa.deg(30), 0.8, **limits)
    within = link.task(qa.deg(30), 0.8, band=5e-3, **limits)
    motions = [
        evaluate_coefficients(task, []).candidate,
        qa.JudgedMotion.of_profile(task, qa.shaped_cycloid(task, "zv"), []),
        plan_move(task).candidate,
        plan_move(within).candidate,
    ]
    rows = _readme_table("| | leaves [mm] |")
    for (_, left, energy), motion in zip(rows, motions, strict=True):
        certain = motion.on(motion.task.certain)
        worst = max(certain.perturbed({"frequency": error}).residual for error in (-0.05, 0.05))
        assert float(left) == pytest.approx(1e3 * worst, rel=0.03)
        assert float(energy) == pytest.approx(motion.energy, rel=2e-3)
