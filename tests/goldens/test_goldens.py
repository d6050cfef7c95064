"""What quietarm answers to some fifty lines, kept as text: a difference shows what a change did.

    python tests/goldens/test_goldens.py   writes the answers anew

Words are compared as they stand and numbers to 1e-6, since the last digits depend on processor and
libraries; of a metaheuristic's answer only the words are, whose numbers a single digit can turn.
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
EFFORT = re.compile(r"(?<=^time ) *[\d.]+ s|(?<= in )[\d.]+ s\b|\d+(?= iterations)", re.MULTILINE)
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
SEARCHED = re.compile(r"nsga2|vepso|polish|n1\.json")


def answer(line):
    """What a line prints and with which status it ends."""
    from quietarm.studies.cli import main

    out, err, status = io.StringIO(), io.StringIO(), 0
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            main(shlex.split(line))
        except SystemExit as end:
            status = end.code or 0
    said = [one for one in err.getvalue().splitlines() if one.startswith("quietarm: ")]
    text = "\n".join(one.rstrip() for one in [*out.getvalue().splitlines(), *said])
    return f"$ quietarm {line}\n{EFFORT.sub('...', text)}\nstatus {status}\n"


@contextlib.contextmanager
def standing_in(folder):
    """A folder to stand in, a page of 100 columns, and no colours."""
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


def numbers_and_words(text):
    """The numbers of a text, and the text without them."""
    return [float(one) for one in NUMBER.findall(text)], " ".join(NUMBER.sub("#", text).split())


@pytest.mark.parametrize("line", LINES)
def test_the_answer_is_as_it_was(answers, line):
    numbers, words = numbers_and_words(kept()[line])
    now, words_now = numbers_and_words(answers[line])
    assert words_now == words
    if not SEARCHED.search(line):
        both = zip(numbers, now, strict=True)
        assert [(a, b) for a, b in both if not math.isclose(a, b, rel_tol=1e-6, abs_tol=2e-8)] == []


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made, standing_in(made):
        ANSWERS.write_text("".join(answer(line) for line in LINES))
