"""Plants of a file: imported when it is named, the same in every process, refused in one line."""

import copy
import pickle
from multiprocessing.reduction import ForkingPickler

import pytest
from quietarm.models import known_plants, load_plant_file

pytestmark = pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")


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


def _refused(path):
    before = known_plants()
    with pytest.raises(ValueError, match="plant file ") as told:
        load_plant_file(path)
    assert "\n" not in str(told.value)
    assert known_plants() == before
    return str(told.value)


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
