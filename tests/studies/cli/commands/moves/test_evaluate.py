"""`quietarm evaluate`: coefficients, recorded paths, and tables that another program wrote."""

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
from quietarm.ocp import CycloidPolynomial, Front, Plan, PointToPoint

TASK = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8)


def test_coefficients_and_an_angle_below_zero_need_no_equals_sign(call):
    line = "evaluate arm-on-flexible-link --start -pi/2 --target pi/2 --duration 1.2"
    assert call(f"{line} --coefficients -0.1,-0.4 --output e.json")[0] == 0
    saved = Plan.load("e.json")
    assert saved.task.start == pytest.approx(-math.pi / 2, rel=1e-15)
    assert saved.coefficients == (-0.1, -0.4)


def test_a_broken_limit_is_shown_with_what_is_reached(call):
    line = f"evaluate {MOVE} --coefficients=0 --torque-limit 0.01 --deflection-limit 100mm"
    _, out, _ = call(f"{line} --output plan.json")
    peak = Plan.load("plan.json").motion.peak_torque
    shown = re.search(r"limits +(.*\S)", out).group(1)
    assert shown == f"torque 0.01 N m (broken: {peak:.4g} N m), deflection 0.1 m"


# A recorded path


def test_the_path_of_a_plan_has_the_plans_figures(done, plan):
    table = plan.sampled(np.arange(161) * 5e-3)
    rows = np.column_stack([1e3 * table.time, np.degrees(table.joint[:, 0])])
    np.savetxt("path.csv", rows, delimiter=",", header="time_ms,angle_deg", comments="")
    out = done("evaluate single-link --path path.csv --error frequency=5%")
    assert "0 to 30 deg in 0.8 s" in out
    energy = float(re.search(r"energy +([0-9.]+) J", out)[1])
    assert energy == pytest.approx(plan.energy, rel=1e-4)
    assert "161 points, 5 ms apart" in out
    assert len(re.findall(r"mm with frequency [-+]5 %", out)) == 2


@pytest.mark.parametrize(("column", "target"), [("position_mm", "9.5"), ("position", "9500")])
def test_a_path_of_a_linear_axis_is_in_metres(done, folder, column, target):
    rows = [f"{k / 10},{x}" for k, x in enumerate([0, 1, 3, 6, 8, 9, 9.5])]
    (folder / "path.csv").write_text("\n".join([f"time_s,{column}", *rows]))
    out = done("evaluate linear-axis --path path.csv")
    assert f"linear-axis, 0 to {target} mm in 0.6 s" in out
    assert "m/s^2 from point to point" in out


def _cycloid(clock, name="path.csv"):
    """The cycloid from 0 to 30 deg in 0.8 s, a row a millisecond."""
    share = np.arange(801) / 800
    angle = math.pi / 6 * (share - np.sin(math.tau * share) / math.tau)
    rows = "".join(f"{t:.0f},{q:.9f}\n" for t, q in zip(clock, angle))
    with open(name, "w") as file:
        file.write(f"time_us,angle_rad\n{rows}")


def test_the_clock_of_a_path_that_wraps_is_unwrapped(done, folder):
    _cycloid((np.arange(801) * 1000 + 2**32 - 400_000) % 2**32)
    out = done("evaluate single-link --path path.csv")
    assert "0 to 30 deg in 0.8 s" in out
    assert "0.09115 J" in out  # as of the cycloid itself
    assert "77.1 mm" in out
    assert "path.csv: its clock, a counter of 32 bits, wraps after row 400" in out


def test_a_path_with_a_hole_or_of_two_recordings_is_refused(refused, folder):
    _cycloid(np.sort((np.arange(801) * 1000 + 2**32 - 400_000) % 2**32))
    said = refused("evaluate single-link --path path.csv")
    assert "path.csv: a hole of 4294 s after row 401, among steps of 0.001 s" in said
    _cycloid(np.append(np.arange(400), np.arange(401)) * 1000)
    said = refused("evaluate single-link --path path.csv")
    assert "two recordings, the second from row 401" in said


def test_columns_of_a_path_that_are_not_used_are_named(done, folder):
    rows = "".join(f"{k / 10},{x},5,a\n" for k, x in enumerate([0, 1, 3, 6, 8, 9, 9.5]))
    (folder / "path.csv").write_text(f"time_s,angle_deg,current,note\n{rows}")
    assert "not used: columns current, note" in done("evaluate single-link --path path.csv")


# A table of results

(REFERENCE,) = problem_of("single-link-30deg-0.8s-2-terms").fronts()
POINTS = REFERENCE.points[3::6]
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
    coefficients = [point.coefficients for point in front.points]
    # pandas before 3.1 may read another last digit
    assert coefficients == [pytest.approx(row, rel=1e-14) for row in X.tolist()]
    # the reference front's figures are by CVODES as well
    assert front.residuals == pytest.approx(CLAIMS[:, 0], rel=1e-5, abs=1e-9)
    assert front.energies == pytest.approx(CLAIMS[:, 1], rel=1e-8)


def evaluate(run, name, more=""):
    return run(f"evaluate {MOVE} --coefficients {name} --output f.json --quiet {more}")


@pytest.mark.slow
def test_a_table_with_right_figures_becomes_a_front(done):
    rows = np.column_stack([X, CLAIMS])[::-1].tolist()
    written("swarm.csv", table(["a_1", "a_2", "residual_m", "energy_J"], rows))
    more = "--bound 0.2 --terms 2 --output f.csv --output f.svg"
    out = evaluate(done, "swarm.csv", more)
    front = Front.load("f.json")
    assert_same(front)
    assert (front.record.method, front.record.evaluations) == ("swarm", len(X))
    assert (front.record.settings, front.record.bound) == ({"imported": "swarm.csv"}, 0.2)
    lines = out.splitlines()
    assert f"the file's residual is right for all {len(X)} motions" in lines
    assert f"the file's energy is right for all {len(X)} motions" in lines
    assert lines[-3:] == ["wrote f.json", "wrote f.csv", "wrote f.svg"]
    evaluate(done, "f.csv")  # what it wrote is a table as well
    assert_same(Front.load("f.json"))


def test_wrong_figures_are_told_and_do_not_enter_the_front(done):
    claims = CLAIMS.copy()
    claims[1, 1] *= 1.1
    rows = np.column_stack([claims * [1000, 1], X]).tolist()
    written("f.csv", table(["residual", "energy", "x1", "x2"], rows, ";"))
    out = evaluate(done, "f.csv", "--evaluations 500")
    assert_same(Front.load("f.json"))
    assert Front.load("f.json").record.evaluations == 500
    assert f"the file's energy is wrong for 1 of {len(X)} motions" in out
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
NUMBERED = np.column_stack([np.arange(len(X)), X]).tolist()
FILES = {
    "no-names.txt": ("\n".join(" ".join(map(repr, row)) for row in X.tolist()), "neither"),
    "comments.txt": ("# found\n% by\n\n" + table(["A1", "A 2", "f2"], np.column_stack(
        [X, CLAIMS[:, 1]]).tolist(), "\t"), "energy is right"),
    "commas.csv": (table(["a_1", "a_2"], X.tolist(), ";").replace(".", ","), "neither"),
    "others.csv": (table(["run", "a_1", "a_2"], NUMBERED), "ignored: run"),
    "pandas.csv": (table(["", "a_1", "a_2"], NUMBERED), "ignored: a column without a name"),
    "pandas-numbers.csv": (table(["", "0", "1"], NUMBERED), "ignored: a column without a name"),
    "mm.csv": (table(["a_1", "a_2", "residual_mm"], np.column_stack(
        [X, CLAIMS[:, 0] * 1e3]).tolist()), "residual is right"),
    "matrix.npy": (numpy_file(X), "neither"),
    "named.npy": (numpy_file(STRUCTURED), "energy is right"),
    "named.npz": (numpy_file(None, np.savez, X=X, F=CLAIMS), "energy is right"),
    "found.mat": (matlab(X=X, energy=CLAIMS[:, 1:]), "energy is right"),
    "alone.mat": (matlab(best=X, note=3.0), "ignored: note"),
    "several.npz": (numpy_file(None, np.savez, a=X[:, ::-1], X=X, x1=X[:, 0]), "ignored: a, x1"),
    "set.mat": (matlab(x1=X[:, :1], pareto_set=X, pareto_front=CLAIMS), "energy is right"),
}  # fmt: skip


@pytest.mark.slow_after(4)
@pytest.mark.parametrize("name", FILES)
def test_tables_of_many_kinds(done, name):
    content, words = FILES[name]
    written(name, content)
    out = evaluate(done, name)
    assert_same(Front.load("f.json"))
    assert words in out


MOTIONS = np.array([[0.0, 1.0], [0.1, 0.2]])
COUNTING = {
    "headed.csv": table(["a_1", "a_2"], MOTIONS.tolist()),
    "plain.csv": "0,1\n0.1,0.2\n",
    "array.npy": numpy_file(MOTIONS),
    "counted.csv": table(["", "0", "1"], [[5, 0.0, 1.0], [7, 0.1, 0.2]]),
}


@pytest.mark.parametrize("name", COUNTING)
def test_a_first_motion_that_counts_is_a_motion(done, name):
    written(name, COUNTING[name])
    evaluate(done, name)
    assert Front.load("f.json").record.evaluations == len(MOTIONS)


@pytest.mark.parametrize("shape", [(0,), (0, 2), (1, 0)])
def test_an_empty_array_holds_no_coefficients(refused, shape):
    written("x.npy", numpy_file(np.empty(shape)))
    said = evaluate(refused, "x.npy")
    assert "x.npy holds no coefficients; give a row for each motion" in said


def test_a_table_without_a_motion_that_keeps_the_limits(call):
    written("f.csv", table(["a_1", "a_2"], X.tolist()))
    code, out, err = evaluate(call, "f.csv", "--torque-limit 0.001")
    assert (code, out) == (1, "")
    (least,) = re.findall(
        r"keeps the limits best is (\S+) N m, above its limit of 0.001 N m; widen that limit", err
    )
    peaks = [rollout(TASK, CycloidPolynomial(2), x).motion.peak_torque for x in X]
    assert float(least) == pytest.approx(min(peaks), rel=1e-2)
    written("f.csv", "1e300,1\n")
    code, _, err = evaluate(call, "f.csv")
    assert (code, "their figures overflow" in err) == (1, True)


@pytest.mark.slow
def test_a_fronts_own_table_is_right_within_the_window_that_it_states(done):
    line = "single-link --target 30deg --duration 0.8"
    done(f"front {line} --points 6 --residual-window 1.0 --output front.csv --quiet")
    out = done(f"evaluate {line} --coefficients front.csv")
    assert "the file's residual is right for all" in out
    assert "the file's energy is right for all" in out
    assert "within 1 s" in out
