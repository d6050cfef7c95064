"""Lines that are refused: one line on standard error, with the remedy, and nothing written."""

import math
import re
import shutil
from pathlib import Path

import pytest
from lines import MOVE

from quietarm.models import ArmOnFlexibleLink
from quietarm.ocp import CycloidPolynomial, PointToPoint, epsilon_front, evaluate_coefficients

TABLE = Path(__file__).with_name("messages.txt").read_text().splitlines()
FILES = Path(__file__).with_name("refused")
LINES = [line.split(" => ") for line in TABLE if not line.startswith("#")]


@pytest.fixture(scope="module")
def answers(task, plan, tmp_path_factory):
    """A folder with the files of two plans and a front, plan.json, arm.json and front.json."""
    arm = evaluate_coefficients(PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8), [])
    front = epsilon_front(task, CycloidPolynomial(2), bound=0.3, points=3, starts=1)
    folder = tmp_path_factory.mktemp("answers")
    for name, answer in {"plan": plan, "arm": arm, "front": front}.items():
        answer.save(folder / f"{name}.json")
    return folder


@pytest.mark.parametrize(("line", "words"), LINES)
def test_it_is_refused_in_one_line_with_the_remedy(refused, answers, line, words):
    shutil.copytree(FILES, ".", dirs_exist_ok=True)
    shutil.copytree(answers, ".", dirs_exist_ok=True)
    said = refused(line.replace("MOVE", MOVE))
    assert re.search(".*".join(map(re.escape, words.split(" ... "))), said)
