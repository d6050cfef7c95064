"""A user's own models.py is named as what is in the way."""

import subprocess
import sys

import pytest
from lines import run


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
    (folder / "script.py").write_text("import models\nimport ocp\n")
    ran = subprocess.run([sys.executable, "script.py"], capture_output=True, text=True, timeout=60)
    assert ran.returncode == 1
    assert ran.stderr.splitlines()[-1].startswith(f"ImportError: {folder / 'models.py'} takes")


def test_the_command_does_not_mind_a_users_own_models(folder):
    (folder / "models.py").write_text("raise RuntimeError('not this one')\n")
    ran = run("--version")
    assert (ran.returncode, ran.stderr) == (0, "")
