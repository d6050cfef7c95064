"""Plants of a file: imported when it is named, the same in every process, refused in one line."""

import pickle

import pytest

from quietarm.models import known_plants, load_plant_file

pytestmark = pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")


def test_changed_content_gives_another_class(crane_file):
    before = load_plant_file(crane_file)["crane"]
    crane_file.write_text(crane_file.read_text().replace("0.4", "0.5"))
    after = load_plant_file(crane_file)["crane"]
    assert (before().radius, after().radius) == (0.4, 0.5)
    assert known_plants()["crane"] is after


def test_a_plant_that_was_renamed_is_not_among_those_of_the_new_content(crane_file):
    load_plant_file(crane_file)
    crane_file.write_text(crane_file.read_text().replace('"crane"', '"derrick"'))
    assert list(load_plant_file(crane_file)) == ["derrick"]


def test_a_file_without_a_plant_may_define_something_else(tmp_path):
    path = tmp_path / "energies.py"
    path.write_text("import quietarm as qa\nclass Half(qa.AbsolutePower):\n    absolute = 0.5\n")
    assert load_plant_file(path) == {}


def test_its_plants_go_to_other_processes(crane_file):
    crane = load_plant_file(crane_file)["crane"](omega=2.0)
    assert pickle.loads(pickle.dumps(crane)) == crane


OWN = "from quietarm.models import Plant, SingleLinkManipulator\nclass S(Plant): "


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("crane.py", OWN.partition("class")[0], "no plant"),
        ("crane.py", "\n\nx = 1 / 0\n", ", line 3: ZeroDivisionError"),
        ("crane.py", "\nx = (\n", ", line 2: SyntaxError"),
        (
            "crane.py",
            "import sys\nsys.exit(3)\n",
            ", line 2: it calls sys.exit(3), which would end",
        ),
        ("crane.py", "raise SystemExit", ", line 1: it calls sys.exit(), which would end"),
        ("crane.py", OWN + "name, modes = 's', 1", "with a name, modes, modal_acc"),
        (
            "crane.py",
            OWN + "name, modes = 's', 1\nclass Other(SingleLinkManipulator): pass",
            "with a name, modes, modal_acc",
        ),
        ("crane.py", OWN + "name = 'single-link'", "quietarm's own; give S another"),
        ("plan.json", "raise RuntimeError('run')", "is not called .py"),
    ],
)
def test_a_file_that_gives_no_plant_is_refused_with_the_line(tmp_path, name, content, told):
    path, before = tmp_path / name, known_plants()
    path.write_text(content)
    with pytest.raises(ValueError, match="plant file ") as error:
        load_plant_file(path)
    assert told in str(error.value)
    assert known_plants() == before


def test_a_plant_file_may_import_what_stands_beside_it(tmp_path, crane_file):
    (tmp_path / "lengths_of_a_crane.py").write_text("PENDULUM = 1.5\n")
    path = tmp_path / "own.py"
    path.write_text("from lengths_of_a_crane import PENDULUM\n" + crane_file.read_text())
    assert list(load_plant_file(path)) == ["crane"]
