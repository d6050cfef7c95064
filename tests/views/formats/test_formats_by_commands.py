"""Every format that takes a plan, through every command that writes plans."""

from pathlib import Path

import pytest

from quietarm.ocp import Plan
from quietarm.views import export_plan
from quietarm.views.formats.export_format import PLAN, known_formats

FORMATS = [form for form in known_formats().values() if PLAN in form.takes and not form.pieces]
"""Films are slow: tests/views/test_film.py."""
ENDINGS = [form.endings[0] for form in FORMATS]
TEXTS = [form for form in FORMATS if form.name not in ("mat", "html")]
"""Which are the same whenever they are written: others hold the time, or the name of the answer."""


def outputs(name, forms=FORMATS):
    """--output of a file of every format."""
    return " ".join(f"--output {name}{form.endings[0]}" for form in forms)


@pytest.mark.slow
def test_evaluate_export_and_python_write_the_same_files(call, folder):
    line = "evaluate single-link --target 30deg --duration 0.3 --coefficients=0.003,-0.17"
    assert call(f"{line} --quiet --output zv.json {outputs('zv', TEXTS)}")[0] == 0
    plan = Plan.load("zv.json")
    for form in TEXTS:
        path = Path(f"zv{form.endings[0]}")
        content = path.read_text()
        assert content
        export_plan(plan, path)
        assert path.read_text() == content
        if form.to_stdout:
            code, out, err = call(f"export zv.json --output - --format {form.name}")
            assert (code, out) == (0, content)
            assert " ".join(err.split()).count("off the plan") == 1


@pytest.mark.slow
@pytest.mark.parametrize(
    "line",
    [
        "plan single-link --target 30deg --duration 0.8 --terms 4",
        "plan linear-axis --target 300mm --duration fastest --torque-limit 100 "
        "--acceleration-limit 10 --terms 4",
    ],
)
def test_plan_and_fastest_write_them(line, done, folder, quick_pictures):
    done(f"{line} --quiet --output plan.json {outputs('plan')}")
    assert {*ENDINGS} <= {path.suffix for path in folder.iterdir()}
