"""A user's own models.py is named as what is in the way."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from lines import MOVE, run

import quietarm.studies.cli


@pytest.mark.parametrize("package", ["ocp", "studies"])
@pytest.mark.parametrize("shadow", ["models.py", "models/__init__.py"])
def test_a_users_own_models_is_named_as_what_is_in_the_way(folder, package, shadow):
    (folder / shadow).parent.mkdir(exist_ok=True)
    (folder / shadow).write_text("class Car: ...\n")
    (folder / "script.py").write_text(f"import {package}\n")
    ran = subprocess.run([sys.executable, "script.py"], capture_output=True, text=True, timeout=60)
    assert ran.returncode == 1
    last = ran.stderr.splitlines()[-1]
    assert last.startswith(f"ImportError: {folder / shadow} takes the place of quietarm's package")
    assert "'models'" in last
    assert "rename that file, or move it away" in last


def test_a_users_own_models_that_is_loaded_already_is_named_too(folder):
    (folder / "models.py").write_text("class Car: ...\n")
    (folder / "script.py").write_text("from quietarm import models\nimport ocp\n")
    ran = subprocess.run([sys.executable, "script.py"], capture_output=True, text=True, timeout=60)
    assert ran.returncode == 1
    assert ran.stderr.splitlines()[-1].startswith(f"ImportError: {folder / 'models.py'} takes")


def test_the_command_does_not_mind_a_users_own_models(folder):
    (folder / "models.py").write_text("raise RuntimeError('not this one')\n")
    ran = run("--version")
    assert (ran.returncode, ran.stderr) == (0, "")


def with_on_path(folder, line):
    """Run the command with a folder of the user's on PYTHONPATH."""
    path = os.pathsep.join([str(folder), *filter(None, [os.environ.get("PYTHONPATH")])])
    return subprocess.run(
        [sys.executable, "-P", "-m", "quietarm", *line.split(), "--quiet"],
        capture_output=True, text=True, timeout=60, env={**os.environ, "PYTHONPATH": path},
    )  # fmt: skip


@pytest.mark.parametrize("content", ["print(1 / 0)\n", "x = 1\n", "x = \n"])
def test_a_file_with_the_name_of_a_module_of_pythons_is_told_in_one_line(folder, content):
    (folder / "random.py").write_text(content)
    (folder / "test.py").write_text("")  # another such name, which nothing loads
    ran = with_on_path(folder, "problems")
    assert ran.returncode == 1
    assert ran.stderr == (
        f"quietarm: {folder / 'random.py'} takes the place of the package 'random'; rename that "
        "file, or take its folder out of PYTHONPATH\n"
    )


@pytest.mark.parametrize(
    ("package", "line"),
    [
        ("numpy", f"evaluate {MOVE} --coefficients=0"),  # while the command is loaded
        ("models", f"evaluate {MOVE} --coefficients=0"),
        ("matplotlib", f"evaluate {MOVE} --coefficients=0 --output o.json --figure o.png"),
    ],
)
def test_a_file_on_the_path_with_the_name_of_a_package_is_told_in_one_line(folder, package, line):
    shadow = folder / f"{package}.py"
    shadow.write_text("x = 1\n")
    ran = with_on_path(folder, line)
    assert ran.returncode in (1, 2)
    assert ran.stderr == (
        f"quietarm: {shadow} takes the place of the package '{package}'; rename that file, or take "
        "its folder out of PYTHONPATH\n"
    )
    assert (folder / "o.json").exists() == ("o.json" in line)  # what was found is kept


# Without site, which imports what it likes before the command can say anything.
@pytest.mark.parametrize("shadow", ["enum.py", "enum/__init__.py"])
def test_what_the_first_import_would_need_is_told_too(folder, shadow):
    (folder / shadow).parent.mkdir(exist_ok=True)
    (folder / shadow).write_text("x = 1\n")
    script = Path(quietarm.studies.cli.__file__).with_name("quietarm")
    path = os.pathsep.join([str(folder), *filter(None, sys.path)])
    ran = subprocess.run(
        [sys.executable, "-S", "-P", script, "problems"],
        capture_output=True, text=True, timeout=60, env={**os.environ, "PYTHONPATH": path},
    )  # fmt: skip
    assert ran.stderr == (
        f"quietarm: {folder / shadow} takes the place of the package 'enum'; rename that file, or "
        "take its folder out of PYTHONPATH\n"
    )
