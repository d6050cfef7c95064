"""A user's own file that takes the place of one of quietarm's packages is named."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from quietarm.ocp.base.shadowing import refuse_shadow

ROOT = Path(__file__).parents[3]


def test_the_packages_own_modules_are_not_refused():
    refuse_shadow("models")
    refuse_shadow("ocp")


def _import_beside(file):
    """Import ocp in a script beside a file of the user's."""
    file.parent.mkdir(exist_ok=True)
    file.write_text("x = 1\n")
    script = file.parents[file.parent.name == "models"] / "script.py"
    script.write_text("from quietarm import ocp\n")  # the script's own folder comes first on the path
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run(
        [sys.executable, script], capture_output=True, text=True, check=False, env=environment
    )


@pytest.mark.parametrize("shadow", ["models.py", "models/__init__.py"])
def test_a_users_models_beside_the_script_are_named(tmp_path, shadow):
    run = _import_beside(tmp_path / shadow)
    assert run.returncode != 0
    last = run.stderr.strip().splitlines()[-1]
    assert last.startswith("ImportError: ")
    assert str(tmp_path / shadow) in last
    assert "rename" in last


def test_a_users_folder_without_an_init_does_not_come_before_the_package(tmp_path):
    run = _import_beside(tmp_path / "models" / "mine.py")
    assert (run.returncode, run.stderr) == (0, "")
