"""The moves between posts of `benchmarks/basins.py`, and the figures of its runs."""

import inspect
import lzma
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.integrate import solve_ivp

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT / "benchmarks"), str(ROOT / "docs" / "results")]

import basins  # noqa: E402
from parts import outside_rivals, posts  # noqa: E402
from parts.posts_gradient import is_free, least_energy  # noqa: E402
from recomputing.arms import arm_figures  # noqa: E402
from recomputing.basins import gaps_of, read  # noqa: E402


def test_gaps_are_shares_of_the_area_that_the_best_points_of_all_runs_dominate(tmp_path):
    """Two corners and the middle of a square: areas by hand, up to 1.1 of the scale."""
    rows = [
        "problem,method,candidates,seed,seconds,residuals_mm,energies_J",
        "posts-1,gradient,,0,1,0 1 2,4 3 2",
        "posts-1,slsqp,200,0,1,0 2,4 2",
        "posts-1,es,200,0,1,1,3",
    ]
    (tmp_path / "basins.csv.xz").write_bytes(lzma.compress("\n".join(rows).encode()))
    gaps, _ = gaps_of(read(tmp_path / "basins.csv.xz"))
    corners = 1.1 * 0.1 + 0.1 * 1.0
    whole = corners + 0.5 * 0.5
    assert gaps["gradient", 0]["posts-1"] == pytest.approx([0.0])
    assert gaps["slsqp", 200]["posts-1"] == pytest.approx([100 * (1 - corners / whole)])
    assert gaps["es", 200]["posts-1"] == pytest.approx([100 * (1 - 0.6**2 / whole)])


def test_first_seeds_choose_the_method_of_the_arms_and_fresh_ones_judge(tmp_path):
    """Ten problems alike, a point of each method: areas by hand."""
    best = {"gp": [1.2, 1.4], "es": [1.3, 1.1], "slsqp": [1.5, 1.5], "slsqp step=0.01": [1.6, 1]}
    rows = ["problem,method,candidates,seed,seconds,residuals_mm,energies_J"]
    for number in range(10):
        name = f"arm-{'post-' * (number > 4)}{4 + 4 * (number % 2)}-{number}"
        rows.append(f"{name},moead-de,2000,100,9,0 2,4 2")
        rows += [
            f"{name},{method},300,{seed},1,{values[seed > 1]},3"
            for method, values in best.items()
            for seed in range(3)
        ]
    (tmp_path / "arms.csv.xz").write_bytes(lzma.compress("\n".join(rows).encode()))
    figures = arm_figures(tmp_path)
    row = figures["judged"]
    assert (row["search"], row["rival"], row["seeds"]) == ("gp", "slsqp", 1)
    # in the problem's scale the best points are (0, 1), (0.5, 0.5) and (1, 0); corners at 1.1
    whole = 0.5 * 0.1 + 0.5 * 0.6 + 0.1 * 1.1
    assert row["missing"] == pytest.approx(100 * (1 - (1.1 - 0.7) * 0.6 / whole))
    assert row["control"] == pytest.approx(100 * (1 - (1.1 - 0.75) * 0.6 / whole))
    assert (row["better"], row["of"], row["equal"]) == (10, 10, 0)
    assert row["p"] == pytest.approx(2 / 2**10)  # all ten of one sign
    assert {block: test["of"] for block, test in row["blocks"].items()} == {
        "post": 5, "no post": 5, "4 coefficients": 5, "8 coefficients": 5,
    }  # fmt: skip


def test_the_rival_of_twenty_lines_has_no_more():
    _, _, body = inspect.getsource(outside_rivals.twenty_lines).partition('first."""\n')
    assert 10 < len(body.strip().splitlines()) <= 20


@pytest.mark.slow
def test_residuals_are_those_of_another_integrator():
    """The joints' paths and the links' equations are written anew here, and solved by DOP853."""
    move = posts.drawn()[3]
    candidate = 0.4 * np.random.default_rng(0).uniform(-1, 1, move.size)
    way = Polynomial([0, 0, 0, 10, -15, 6])
    hump = Polynomial([0, 4, -4]) ** 3
    middle = Polynomial([-1, 2])
    paths = [
        begin + (end - begin) * way + sum(a * hump * middle**k for k, a in enumerate(coefficients))
        for begin, end, coefficients in zip(
            move.start, move.target, candidate.reshape(2, -1), strict=True
        )
    ]
    (l1, l2), (m1, m2), load = move.lengths, move.masses, move.load
    stiffness = np.array(move.stiffness)
    rows, frequencies = move._modes()
    damping = stiffness * 2 * 0.01 / frequencies[0]

    def slope(time, state):
        share = time / move.duration
        angles = np.array([path(share) for path in paths]) - state[:2]
        rates = np.array([path.deriv()(share) / move.duration for path in paths]) - state[2:]
        inner = (m1 / 3 + m2 + load) * l1**2
        outer = (m2 / 3 + load) * l2**2
        coupled = (m2 / 2 + load) * l1 * l2
        mixed = outer + coupled * np.cos(state[1])
        first = inner + outer + 2 * coupled * np.cos(state[1])
        speed, other = state[2:]
        turned = coupled * np.sin(state[1]) * np.array([-(2 * speed + other) * other, speed**2])
        torque = stiffness * angles + damping * rates
        inertia = np.array([[first, mixed], [mixed, outer]])
        return [*state[2:], *np.linalg.solve(inertia, torque - turned)]

    begin = [*move.start, 0.0, 0.0]
    end = solve_ivp(slope, (0, move.duration), begin, "DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
    residual = np.linalg.norm(rows @ (end - [*move.target, 0.0, 0.0]))
    assert move(candidate[None])[0][0, 0] == pytest.approx(residual, rel=1e-3)


@pytest.mark.slow
def test_the_gradient_keeps_clear_of_posts_that_the_plain_move_hits():
    move = posts.drawn()[1]
    assert not is_free(move, np.zeros(move.size))
    random = np.random.default_rng(3)
    ends = [least_energy(move, random.uniform(move.lower, move.upper), 0.01)[0] for _ in range(8)]
    clear = [end for end in ends if is_free(move, end)]
    assert len({move.way(end) for end in clear}) > 1  # both sides of a post
    values, slopes = (part.full() for part in move.with_derivatives(clear[0]))
    step = 1e-6
    shifted = move.with_derivatives(clear[0] + step * np.eye(move.size)[1])[0].full()
    assert (shifted - values)[:, 0] / step == pytest.approx(slopes[:, 1], rel=1e-2, abs=1e-3)


@pytest.mark.slow
def test_a_run_is_a_row_and_is_not_run_again(tmp_path, monkeypatch, capsys):
    subject = basins.of_posts()[0]
    runs = [basins.Run(subject, method, 60, 0) for method in ("random", basins.TWENTY)]
    monkeypatch.setitem(basins.PLANS, "posts", lambda: iter(runs))
    path = tmp_path / "basins.csv.xz"
    basins.run_plan("posts", path, 0)
    content = path.read_bytes()
    assert [row["method"] for row in basins.read(path)] == ["random", basins.TWENTY]
    basins.run_plan("posts", path, 0)
    assert path.read_bytes() == content
