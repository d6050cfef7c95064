"""The figures that quietarm prints for some lines: a difference shows what a change did.

    python tests/goldens/test_goldens.py   writes the answers anew

Numbers are compared to 1e-6, since the last digits depend on processor and libraries. The words
are there to be read: no test depends on them.
"""

import contextlib
import io
import math
import os
import re
import shlex
import tempfile
from pathlib import Path

import pytest

HERE = Path(__file__).parent
LINES = [one for one in (HERE / "lines.txt").read_text().splitlines() if one and one[0] != "#"]
ANSWERS = HERE / "answers.txt"
EFFORT = re.compile(
    r"(?<=^time ) *[\d.]+ s|(?<= in )[\d.]+ s\b|\d+(?= iterations)|(?<=by CVODES).*", re.MULTILINE
)
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def answer(line):
    """What a line prints, without the effort that it took."""
    from quietarm.studies.cli import main

    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.suppress(SystemExit):
        main([*shlex.split(line), "--quiet"])
    text = "\n".join(one.rstrip() for one in out.getvalue().splitlines())
    return f"$ quietarm {line}\n{EFFORT.sub(' ...', text)}\n"


@contextlib.contextmanager
def standing_in(folder):
    """A folder to stand in, a wide page, and no colours."""
    before, known = Path.cwd(), dict(os.environ)
    os.chdir(folder)
    os.environ.update(COLUMNS="100", NO_COLOR="1")
    try:
        yield
    finally:
        os.chdir(before)
        os.environ.clear()
        os.environ.update(known)


def kept():
    """The answers of the file, by line."""
    blocks = re.split(r"^(?=\$ quietarm )", ANSWERS.read_text(), flags=re.MULTILINE)[1:]
    return {block.splitlines()[0].removeprefix("$ quietarm "): block for block in blocks}


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    with standing_in(tmp_path_factory.mktemp("goldens")):
        return {line: answer(line) for line in LINES}


@pytest.mark.parametrize("line", LINES)
def test_the_figures_are_as_they_were(answers, line):
    before, now = (
        [float(one) for one in NUMBER.findall(of)] for of in (kept()[line], answers[line])
    )
    assert len(now) == len(before) > 5
    same = [
        math.isclose(a, b, rel_tol=1e-6, abs_tol=2e-8) for a, b in zip(before, now, strict=True)
    ]
    assert all(same), answers[line]


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made, standing_in(made):
        ANSWERS.write_text("".join(answer(line) for line in LINES))
