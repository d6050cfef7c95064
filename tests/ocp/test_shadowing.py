"""A user's own file that takes the place of one of quietarm's packages is named."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from ocp.shadowing import refuse_shadow

ROOT = Path(__file__).parents[2]


def test_the_packages_own_modules_are_not_refused():
    refuse_shadow("models")
    refuse_shadow("ocp")


@pytest.mark.parametrize("shadow", ["models.py", "models/__init__.py", "models/mine.py"])
def test_a_users_models_beside_the_script_are_named(tmp_path, shadow):
    file = tmp_path / shadow
    file.parent.mkdir(exist_ok=True)
    file.write_text("x = 1\n")
    script = tmp_path / "script.py"
    script.write_text("import ocp\n")  # the script's own folder comes first on the path
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    run = subprocess.run(
        [sys.executable, script], capture_output=True, text=True, check=False, env=environment
    )
    if shadow == "models/mine.py":
        # A folder without __init__.py does not come before a package further on.
        assert run.returncode == 0, run.stderr
        return
    assert run.returncode != 0
    last = run.stderr.strip().splitlines()[-1]
    assert last.startswith("ImportError: ")
    assert str(file) in last
    assert "rename" in last
