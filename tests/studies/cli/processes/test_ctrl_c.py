"""Ctrl-C in a reproduction, which keeps the fronts that it has."""

from quietarm.ocp import Front
from quietarm.studies.reproduce.paper import ARM_HALF


def test_ctrl_c_ends_a_reproduction_and_keeps_its_fronts(at_a_terminal, ctrl_c, folder):
    process = at_a_terminal("reproduce --workers 1 --output results")
    while not process.stderr.readline().startswith("[1/"):
        assert process.poll() is None
    out, err = ctrl_c(process)
    assert (process.returncode, out) == (1, "")
    assert err.splitlines()[-1] == "quietarm: interrupted; what was written until then is kept"
    first = min((folder / "results" / "fronts").iterdir(), key=lambda path: path.stat().st_mtime)
    assert Front.load(first).task == ARM_HALF.task
