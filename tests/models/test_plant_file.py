"""Plants of a file: imported when it is named, the same in every process, refused in one line."""

import copy
import hashlib
import pickle
import subprocess
import sys
from multiprocessing.reduction import ForkingPickler

import pytest
from quietarm.models import SingleLinkManipulator, file_of_plant, known_plants, load_plant_file

pytestmark = pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")


def test_a_files_plants_are_known_from_then_on(crane_file):
    assert "crane" not in known_plants()
    plants = load_plant_file(crane_file)
    assert list(plants) == ["crane"]
    assert known_plants()["crane"] is plants["crane"]
    crane = plants["crane"](omega=2.0)
    crane.validate()
    assert crane.parameters == {"omega": 2.0, "coupling": 0.4, "inertia": 2.0}


def test_a_files_path_and_digest_are_kept(crane_file):
    file = file_of_plant(load_plant_file(crane_file)["crane"])
    assert file.path == str(crane_file)
    assert file.digest == hashlib.sha256(crane_file.read_bytes()).hexdigest()


def test_quietarms_own_plants_are_of_no_file():
    assert file_of_plant(SingleLinkManipulator) is None


def test_the_same_content_gives_the_same_class(crane_file, tmp_path):
    other = tmp_path / "other.py"
    other.write_bytes(crane_file.read_bytes())
    assert load_plant_file(crane_file)["crane"] is load_plant_file(other)["crane"]


def test_changed_content_gives_another_class(crane_file):
    before = load_plant_file(crane_file)["crane"]
    crane_file.write_text(crane_file.read_text().replace("0.4", "0.5"))
    after = load_plant_file(crane_file)["crane"]
    assert (before().coupling, after().coupling) == (0.4, 0.5)
    assert known_plants()["crane"] is after


def test_its_plants_are_copied_and_go_to_other_processes(crane_file):
    crane = load_plant_file(crane_file)["crane"](omega=2.0)
    assert copy.copy(crane) == crane
    assert pickle.loads(pickle.dumps(crane)) == crane
    assert ForkingPickler.loads(ForkingPickler.dumps(crane)) == crane


def test_another_process_needs_no_file(crane_file, tmp_path):
    # As a worker that starts anew: it has imported nothing, and the file may have been changed.
    crane = load_plant_file(crane_file)["crane"](omega=2.0)
    (tmp_path / "crane.pickle").write_bytes(pickle.dumps(crane))
    crane_file.write_text("raise RuntimeError('not again')")
    code = (
        "import pickle, sys; crane = pickle.load(open(sys.argv[1], 'rb')); "
        "crane.validate(); print(type(crane).__name__, crane.omega)"
    )
    ran = subprocess.run(
        [sys.executable, "-c", code, tmp_path / "crane.pickle"],
        capture_output=True, text=True, timeout=300,
    )  # fmt: skip
    assert (ran.returncode, ran.stdout, ran.stderr) == (0, "Crane 2.0\n", "")


def _refused(path):
    before = known_plants()
    with pytest.raises(ValueError, match="plant file ") as told:
        load_plant_file(path)
    assert "\n" not in str(told.value)
    assert known_plants() == before
    return str(told.value)


def test_a_broken_plant_in_it_is_found_when_it_is_checked(crane_file):
    text = crane_file.read_text().replace(
        "return self.inertia", "joint.acceleration + self.inertia"
    )
    crane_file.write_text(text)
    crane = load_plant_file(crane_file)["crane"]()
    with pytest.raises(ValueError, match="'crane': torque returns NoneType"):
        crane.validate()


OWN = "from quietarm.models import Plant, SingleLinkManipulator\n"


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("x = 1\n", "defines no plant; write a class in it"),
        (OWN, "defines no plant; write a class in it"),
        ("def x(:\n", ", line 1: SyntaxError: invalid syntax"),
        ("\n\nx = 1 / 0\n", ", line 3: ZeroDivisionError: division by zero"),
        (
            "import a_module_that_is_not\n",
            ", line 1: ModuleNotFoundError: No module named 'a_module_that_is_not'; a plant is one",
        ),
        (OWN + "class S(SingleLinkManipulator): pass\n", "write name: ClassVar[str]"),
        (OWN + "class S(Plant):\n    name, modes = 's', 1\n", "write modal_accelerations and "),
        (
            OWN + "class S(SingleLinkManipulator):\n    name = 'single-link'\n",
            ", line 2: plant name 'single-link' is that of quietarm's own",
        ),
    ],
)
def test_a_file_that_gives_no_plant_is_refused_with_the_line(tmp_path, content, told):
    path = tmp_path / "crane.py"
    path.write_text(content)
    assert told in _refused(path)


def test_a_file_that_is_none_is_refused(tmp_path):
    assert "no such file" in _refused(tmp_path / "none.py")
    (tmp_path / "folder.py").mkdir()
    assert "is a directory" in _refused(tmp_path / "folder.py")


def test_a_data_file_is_not_run(tmp_path):
    path = tmp_path / "plan.json"
    path.write_text("raise RuntimeError('run')")
    assert "is not called .py" in _refused(path)


def test_ctrl_c_while_it_is_imported_is_not_swallowed(crane_file):
    crane_file.write_text(f"{crane_file.read_text()}\nraise KeyboardInterrupt\n")
    before = dict(known_plants())
    with pytest.raises(KeyboardInterrupt):
        load_plant_file(crane_file)
    assert known_plants() == before
