"""`quietarm import`: coefficients that another program found."""

import io
import math
import re

import numpy as np
import pytest
import scipy.io
from fixed_steps import rollout
from lines import MOVE
from quietarm.metaheuristics import problem_of
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, Front, PointToPoint

IMPORT = f"{MOVE} --quiet"
TASK = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8)
(EXACT,) = problem_of("single-link-30deg-0.8s-2-terms").fronts()
POINTS = EXACT.points[3::6]
X = np.array([point.coefficients for point in POINTS])
CLAIMS = np.array([(point.residual, point.energy) for point in POINTS])


def table(columns, rows, between=","):
    lines = [between.join(columns), *(between.join(map(repr, row)) for row in rows)]
    return "\n".join(lines) + "\n"


def written(name, content):
    with open(name, "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())


def assert_same(front):
    """The front is that of `X`: the file's order does not matter, nor which figures it states."""
    assert [p.coefficients for p in front.points] == [tuple(row) for row in X.tolist()]
    # the exact front's figures are by CVODES as well
    assert front.residuals == pytest.approx(CLAIMS[:, 0], rel=1e-5, abs=1e-9)
    assert front.energies == pytest.approx(CLAIMS[:, 1], rel=1e-8)


def test_a_table_with_right_claims_is_a_front(call, folder):
    rows = np.column_stack([X, CLAIMS])[::-1].tolist()
    written("swarm.csv", table(["a_1", "a_2", "residual_m", "energy_J"], rows))
    code, out, err = call(
        f"import swarm.csv {IMPORT} --bound 0.2 --terms 2 --output f.json --csv f.csv "
        "--figure f.svg"
    )
    assert (code, err) == (0, "")
    front = Front.load("f.json")
    assert_same(front)
    assert (front.method, front.evaluations) == ("swarm", len(X))
    assert dict(front.settings) == {"imported": "swarm.csv", "bound": 0.2}
    lines = out.splitlines()
    assert lines[0].startswith(f"swarm: {len(X)} points, {len(X)} candidates in ")
    assert f"the file's residual is right for all {len(X)} motions" in lines
    assert f"the file's energy is right for all {len(X)} motions" in lines
    assert lines[-3:] == ["wrote f.json", "wrote f.csv", "wrote f.svg"]
    # and what it wrote can be imported again
    assert call(f"import f.csv {IMPORT} --output g.json")[0] == 0
    assert_same(Front.load("g.json"))


def test_wrong_claims_are_told_and_do_not_enter_the_front(call, folder):
    claims = CLAIMS.copy()
    claims[1, 1] *= 1.1
    rows = np.column_stack([claims * [1000, 1], X]).tolist()
    written("f.csv", table(["residual", "energy", "x1", "x2"], rows, ";"))
    code, out, err = call(f"import f.csv {IMPORT} --output f.json --method 'my swarm'")
    assert (code, err) == (0, "")
    assert_same(Front.load("f.json"))
    assert Front.load("f.json").method == "my swarm"
    ours, theirs = f"{CLAIMS[1, 1]:.4g}", f"{1.1 * CLAIMS[1, 1]:.4g}"
    assert (
        f"the file's energy is wrong for 1 of {len(X)} motions, most for motion 2: {theirs} J in "
        f"the file, {ours} J by its coefficients\n"
    ) in out
    assert f"the file's residual is wrong for {len(X)} of {len(X)} motions" in out
    assert "is it in mm? name the column residual_mm" in out


def matlab(**variables):
    content = io.BytesIO()
    scipy.io.savemat(content, variables)
    return content.getvalue()


def numpy_file(values, save=np.save, **arrays):
    content = io.BytesIO()
    save(content, *([] if values is None else [values]), **arrays)
    return content.getvalue()


STRUCTURED = np.array(
    [tuple(row) for row in np.column_stack([X, CLAIMS[:, 1]])],
    dtype=[("a_1", float), ("a_2", float), ("energy", float)],
)
FILES = {
    "no-names.csv": ("\n".join(" ".join(map(repr, row)) for row in X.tolist()), "neither"),
    "comments.txt": ("# found\n% by\n\n" + table(["A1", "A 2", "f2"], np.column_stack(
        [X, CLAIMS[:, 1]]).tolist(), "\t"), "energy is right"),
    "commas.csv": (table(["a_1", "a_2"], X.tolist(), ";").replace(".", ","), "neither"),
    "others.csv": (table(["run", "a_1", "a_2"], np.column_stack(
        [np.arange(len(X)), X]).tolist()), "ignored: run"),
    "pandas.csv": (table(["", "a_1", "a_2"], np.column_stack(
        [np.arange(len(X)), X]).tolist()), "ignored: a column without a name"),
    "pandas-numbers.csv": (table(["", "0", "1"], np.column_stack(
        [np.arange(len(X)), X]).tolist()), "ignored: a column without a name"),
    "pandas-no-index.csv": (table(["0", "1"], X.tolist()), "neither"),
    "mm.csv": (table(["a_1", "a_2", "residual_mm"], np.column_stack(
        [X, CLAIMS[:, 0] * 1e3]).tolist()), "residual is right"),
    "matrix.npy": (numpy_file(X), "neither"),
    "named.npy": (numpy_file(STRUCTURED), "energy is right"),
    "named.npz": (numpy_file(None, np.savez, X=X, F=CLAIMS), "energy is right"),
    "small.npz": (numpy_file(None, np.savez_compressed, found=X), "neither"),
    "found.mat": (matlab(X=X, energy=CLAIMS[:, 1:]), "energy is right"),
    "alone.mat": (matlab(best=X, note=3.0), "ignored: note"),
}  # fmt: skip


@pytest.mark.parametrize("name", FILES)
def test_files_of_many_kinds(call, folder, name):
    content, words = FILES[name]
    written(name, content)
    code, out, err = call(f"import {name} {IMPORT} --output f.json")
    assert (code, err) == (0, "")
    assert_same(Front.load("f.json"))
    assert words in out


BAD = [
    ("a_1,a_2\n0.1\n", "line 2 has 1 columns, the first 2"),
    ("a_1,a_3\n0.1,0.1\n", "there is no column for coefficient 2; give all"),
    ("time,energy\n0.1,0.1\n", "no column is a coefficient; name them a_1, a_2"),
    ("", "it is empty; give rows of numbers"),
    ("a_1,a_2\nnan,0.1\n", "motion 1: coefficient 1 is nan; give a finite number"),
    ("a_1,a_2\n0.3,0.1\n", "beyond the stated bound of 0.2; correct it, or state a wider bound"),
    ("0,0.1,0.1\n1,0.1,0.2\n", "its first column counts the rows; leave it out, in pandas by"),
]


@pytest.mark.parametrize(("content", "words"), BAD)
def test_a_file_that_does_not_fit_is_refused_in_one_line(call, folder, content, words):
    written("f.csv", content)
    code, out, err = call(f"import f.csv {IMPORT} --bound 0.2 --output f.json")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert err.startswith("quietarm: f.csv")
    assert words in err
    assert "\x1b" not in err
    assert not (folder / "f.json").exists()


def test_a_file_without_a_motion_that_can_be_used(call, folder):
    written("f.csv", table(["a_1", "a_2"], X.tolist()))
    code, out, err = call(f"import f.csv {IMPORT} --torque-limit 0.001 --output f.json")
    assert (code, out) == (1, "")
    (least,) = re.findall(r"keeps the limits best is (\S+), above 0.001; widen that limit", err)
    peaks = [rollout(TASK, CycloidPolynomial(2), x).motion.peak_torque for x in X]
    assert float(least) == pytest.approx(min(peaks), rel=1e-2)
    written("f.csv", "1e300,1\n")
    code, _, err = call(f"import f.csv {IMPORT}")
    assert code == 1
    assert "with coefficients of up to 1e+300 their figures overflow; give those of the" in err
