"""Answers come back from their files equal; what is no answer ends in one line that says why."""

import json
import subprocess
import sys
from dataclasses import replace

import pytest
from saved_files import edit, renew_checksum

import quietarm as qa
from quietarm.ocp import CycloidGaussians, CycloidNetwork, FileFormatError


@pytest.fixture(scope="module")
def plan(tasks):
    """A plan with a limit."""
    return qa.evaluate_coefficients(replace(tasks["single link"], torque_limit=0.5), [0.01, -0.1])


@pytest.fixture
def saved(plan, tmp_path):
    """Its file."""
    plan.save(tmp_path / "some.json")
    return tmp_path / "some.json"


def refusal(path):
    with pytest.raises(FileFormatError) as error:
        qa.Plan.load(path)
    message = str(error.value)
    assert message.startswith(f"{path} ")
    return message


def test_an_answer_comes_back_equal(plan, saved, tasks, tmp_path):
    assert qa.Plan.load(saved) == plan
    task = replace(tasks["arm"], uncertainty=qa.Uncertainty({"beta1": 0.02}))
    robust = qa.evaluate_coefficients(task, [0.01, -0.1])
    robust.save(tmp_path / "robust.json")
    assert qa.Plan.load(tmp_path / "robust.json") == robust
    guess = qa.plan_move(tasks["arm"], qa.CycloidPolynomial(2), guess=[0.01, 0.02], starts=1)
    guess.save(tmp_path / "guess.json")
    assert qa.Plan.load(tmp_path / "guess.json").record.settings["guess"] == "0.01, 0.02"


def test_limits_by_direction_and_speed_come_back_and_older_files_load(plan, saved, tasks, tmp_path):
    task = replace(tasks["arm"], acceleration_limit=(-30, 40), torque_speed=[(1.5, 0), (0.8, 20)])
    limited = qa.evaluate_coefficients(task, [0.01, -0.1])
    limited.save(tmp_path / "limited.json")
    assert qa.Plan.load(tmp_path / "limited.json") == limited
    document = json.loads(saved.read_text())
    del document["task"]["torque_speed"]  # as of an entry that is newer than the file
    renew_checksum(document)
    saved.write_text(json.dumps(document))
    assert qa.Plan.load(saved) == plan


@pytest.mark.parametrize(
    "spoil",
    [
        pytest.param(lambda text: text[: len(text) // 2], id="truncated"),
        pytest.param(lambda text: text.replace("0.01", "NaN"), id="no number"),
    ],
)
def test_what_is_not_whole_json_is_refused(saved, spoil):
    saved.write_text(spoil(saved.read_text()))
    assert "not whole, valid JSON" in refusal(saved)


@pytest.mark.parametrize(
    ("place", "value", "word"),
    [
        ("format", "quietarm-front", "quietarm-front"),
        ("version", qa.Plan.version + 1, str(qa.Plan.version + 1)),
        ("stated/energy", "much", "stated.energy"),
        ("task/duration", -1.0, "duration is -1 s"),
        ("task/plant/name", "crane", "crane"),
        ("profile/terms", 99, "terms is 99"),
        ("task/energy", {"name": "cupper"}, "energy 'cupper' is not known here"),
        ("task/torque_sped", [[1.0, 0.0], [0.5, 2.0]], "torque_sped"),
    ],
)
def test_a_wrong_entry_is_named(saved, place, value, word):
    edit(saved, place, value)
    assert word in refusal(saved)


@pytest.mark.slow_after(1)
@pytest.mark.parametrize(
    "profile",
    [qa.JointSpline((0.2, 0.4, 0.6, 0.8)), CycloidGaussians(2), CycloidNetwork(2)],
    ids=lambda profile: profile.name,
)
def test_a_plan_of_any_profile_loads_in_a_process_of_its_own(profile, tmp_path):
    # quietarm's own profiles are loaded with the first of their names that is asked for
    task = qa.PointToPoint(qa.SingleLinkManipulator(), 0.5, 0.8)
    plan = qa.evaluate_coefficients(task, profile.plain, profile=profile)
    plan.save(tmp_path / "plan.json")
    program = f"import quietarm as qa; print(qa.Plan.load({str(tmp_path / 'plan.json')!r}).energy)"
    printed = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert float(printed.stdout) == plan.energy
