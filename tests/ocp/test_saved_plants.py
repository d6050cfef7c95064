"""Answers about a plant of a user's file: what is recorded, and who may load them."""

import hashlib
import pickle
import sys

import pytest

import quietarm as qa
from quietarm.models import load_plant_file
from quietarm.ocp import FileFormatError


@pytest.fixture
def saved(crane_file, tmp_path):
    """A saved plan of the crane, and the plan."""
    crane = load_plant_file(crane_file)["crane"](omega=2.5)
    plan = qa.evaluate_coefficients(qa.PointToPoint(crane, 1.0, 3.0), [0.1])
    plan.save(tmp_path / "plan.json")
    return tmp_path / "plan.json", plan


def _refused(path):
    with pytest.raises(FileFormatError) as told:
        qa.Plan.load(path)
    return str(told.value)


BESIDE = """

@dataclass(frozen=True)
class Half(qa.Energy):
    name: ClassVar[str] = "half-of-a-test"
    share: float = 0.5

    def smooth(self, torque, speed):
        return 0.5 * torque * speed


class Straight(qa.TermProfile):
    name: ClassVar[str] = "straight-of-a-test"

    def angle(self, coefficients, fraction):
        return fraction
"""


def test_profiles_and_energies_beside_the_plant_go_to_other_processes(crane_file):
    crane_file.write_text(crane_file.read_text() + BESIDE)
    module = sys.modules[load_plant_file(crane_file)["crane"].__module__]
    for value in (module.Half(0.25), module.Straight(3)):
        assert pickle.loads(pickle.dumps(value)) == value


def test_it_loads_where_the_file_was_given(saved, crane_file, tmp_path):
    path, plan = saved
    assert qa.Plan.load(path) == plan
    (tmp_path / "moved.py").write_bytes(crane_file.read_bytes())
    load_plant_file(tmp_path / "moved.py")
    assert qa.Plan.load(path) == plan


def test_nothing_is_run_that_the_user_did_not_name(saved, crane_file):
    del qa.Plant._known["crane"]  # as in another process
    told = _refused(saved[0])
    assert f"{crane_file.name}' with SHA-256" in told


def test_a_changed_file_is_refused_with_both_digests(saved, crane_file):
    before = hashlib.sha256(crane_file.read_bytes()).hexdigest()
    crane_file.write_text(crane_file.read_text() + "# changed\n")
    after = hashlib.sha256(crane_file.read_bytes()).hexdigest()
    load_plant_file(crane_file)
    told = _refused(saved[0])
    assert before[:12] in told
    assert after[:12] in told
