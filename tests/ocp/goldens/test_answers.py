"""Answers are those of commit 9b4f93f8; `questions.py` says what is asked and how closely held."""

import importlib.util
import json
import sys
from pathlib import Path

import pytest

_SPEC = importlib.util.spec_from_file_location(
    "golden_questions", Path(__file__).with_name("questions.py")
)
assert _SPEC is not None
assert _SPEC.loader is not None
golden_questions = importlib.util.module_from_spec(_SPEC)
sys.modules[_SPEC.name] = golden_questions  # dataclasses look there
_SPEC.loader.exec_module(golden_questions)
KNOWN = json.loads(golden_questions.ANSWERS.read_text())


@pytest.mark.parametrize("name", golden_questions.QUESTIONS)
def test_answer_is_the_one_known(name):
    question = golden_questions.QUESTIONS[name]
    found, known = question.ask(), KNOWN[name]
    assert found.keys() == known.keys()
    for number, expected in known.items():
        relative, absolute = question.tolerance(number)
        assert found[number] == pytest.approx(expected, rel=relative, abs=absolute), number


def test_no_answer_is_left_without_its_question():
    assert KNOWN.keys() == golden_questions.QUESTIONS.keys()
