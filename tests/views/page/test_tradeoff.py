"""The page to drag along a front: its numbers are the files', and no name breaks it."""

import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest

from quietarm.models import ArmOnFlexibleLink
from quietarm.ocp import (
    FrontPoint,
    PointToPoint,
    Uncertainty,
    epsilon_front,
    evaluate_coefficients,
)
from quietarm.studies.reproduce.paper import paper_points
from quietarm.views import animate, export_plan, trade_off
from quietarm.views.page import trade_off as page_room
from quietarm.views.page.samples import needed_samples, packed, shapes_of, unpacked


@pytest.fixture(scope="module")
def front(task):
    """The gradient's front of the README's move, with the paper's six terms."""
    return epsilon_front(task, bound=0.2, points=5)


@pytest.fixture(scope="module")
def shown(front):
    """Return what the page has of a front."""
    (move,) = trade_off(front).moves
    return move


def data_of(html):
    """The numbers that are in a page, as a browser reads them."""
    (text,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', html)
    return json.loads(text)["moves"]


def test_every_point_of_a_file_is_on_the_page_with_its_figures(done, folder, front):
    front.save("front.json")
    out = done("export front.json --output front.html --quiet")
    text = (folder / "front.html").read_text()
    assert out == f"wrote front.html\n5 motions, {len(text.encode()) / 1e3:.0f} kB\n"
    (move,) = data_of(text)
    stated = json.loads((folder / "front.json").read_text())["points"]
    assert [(p["residual"], p["energy"]) for p in move["points"]] == [
        (p["residual"], p["energy"]) for p in stated
    ]
    for point, exact in zip(move["points"][1:], front.points[1:], strict=True):
        motion = evaluate_coefficients(front.task, exact.coefficients).motion
        figures = 1e3 * exact.residual, exact.energy, motion.peak_torque
        cells = [float(cell) for cell in point["cells"]]
        assert cells[:3] == pytest.approx(figures, rel=1e-3)  # four digits
        assert cells[4] == pytest.approx(1e3 * motion.peak_deflection, rel=1e-3)
    assert move["points"][0]["cells"][0] == "at rest"
    # docs/start.md: the plain cycloid leaves 77 mm
    assert move["cycloid"]["cells"][0].startswith("77.")


def test_a_point_says_what_it_trades(shown):
    first, second, *_ = shown["points"]
    # README: at rest within the box 0.0445 J, the plain cycloid 0.0911 J and 77 mm
    assert re.fullmatch(
        r"The tip arrives at rest and takes 0\.044\d J, 51 % less energy than the plain cycloid, "
        r"which leaves it swinging by up to 77\.1 mm\. One millimetre of residual vibration would "
        r"save about 0\.\d+ mJ\.",
        first["sentence"],
    )
    share = 1 - second["energy"] / first["energy"]
    residual = f"{1e3 * second['residual']:#.3g} mm"
    assert second["sentence"].startswith(
        f"{residual} of residual vibration saves {100 * share:.0f} % of the energy: "
        f"{second['energy']:#.3g} J, where arriving at rest takes {first['energy']:#.3g} J."
    )


def test_curves_and_structure_are_those_of_the_motions(front, shown):
    times = np.array(shown["times"])
    assert times[shown["arrival"]] == shown["duration"] == 0.8
    torques, tips = (unpacked(shown["panels"][name]["values"]) for name in ("torque", "deflection"))
    structure = shown["structure"]
    scores = unpacked(structure["scores"])
    at = np.linspace(0.01, shown["end"] - 0.01, 37)
    for number, point in enumerate(front.points):
        exact = evaluate_coefficients(front.task, point.coefficients).sampled(at)
        torque, tip = (np.interp(at, times, rows[number, 0]) for rows in (torques, tips))
        # half a per cent of the peak of all is what straight lines may miss
        assert torque == pytest.approx(exact.torque, abs=0.006 * np.abs(torques).max())
        assert tip == pytest.approx(1e3 * exact.tips[:, 0], abs=0.006 * np.abs(tips).max())
        score = np.array([np.interp(at, times, row) for row in scores[number]])
        drawn = structure["mean"] + score.T @ structure["shapes"]
        for place, angle, displacement in zip(drawn, exact.joint[:, 0], exact.tips[:, 0]):
            bodies = front.task.plant.structure(float(angle), [float(displacement)])
            expected = np.vstack([body.points for body in bodies])
            # a pixel of a picture of 600 is 0.8 mm; the last point is the tip, once more
            assert place[: 2 * 25].reshape(-1, 2) == pytest.approx(expected[:25], abs=0.8e-3)
            assert place[-2:] == pytest.approx(expected[24], abs=0.8e-3)


def test_a_rigid_link_that_turns_has_two_shapes_and_one_that_bends_four():
    angle, bend = np.meshgrid(np.linspace(0, 1, 9), np.linspace(-0.1, 0.1, 7))
    along = np.column_stack([np.cos(angle.ravel()), np.sin(angle.ravel())])
    across = bend.ravel()[:, None] * np.column_stack([-along[:, 1], along[:, 0]])
    assert len(shapes_of(np.hstack([0.5 * along, along]), 1e-9).shapes) == 2
    found = shapes_of(np.hstack([0.5 * along + 0.3 * across, along + across]), 1e-9)
    assert len(found.shapes) == 4
    assert found.mean + found.scores @ found.shapes == pytest.approx(
        np.hstack([0.5 * along + 0.3 * across, along + across]), abs=1e-9
    )


def test_samples_are_where_a_curve_bends_and_lose_little_in_sixteen_bits():
    times = np.linspace(0.0, 2.0, 2001)
    row = np.where(times < 1.0, np.sin(30 * times), 0.0)
    places = needed_samples(times, row[None, :], np.array([1000]), 0.01)
    assert np.abs(np.interp(times, times[places], row[places]) - row).max() <= 0.01
    assert 1000 in places
    # 4.8 periods of 2 pi / sqrt(8 * 0.01) = 22 pieces each at least, and hardly one beyond them
    assert 100 <= len(places) <= 240
    assert (places > 1001).sum() == 1
    rows = np.array([[row, 1e-3 * row]])
    assert unpacked(packed(rows)) == pytest.approx(rows, abs=1 / 32767)
    assert unpacked(packed(rows))[0, 1] == pytest.approx(1e-3 * row, abs=1e-3 / 32767)


def test_names_end_no_script_and_stand_as_they_are(front, folder, done):
    name = "</script><script>alert</script>"
    stranger = replace(front, record=replace(front.record, method=name))
    page = trade_off({name: front, "x & y": stranger})
    assert page.html().count("</script>") == 2  # of the numbers and of the program
    (move,) = data_of(page.html())
    assert move["label"] == name
    assert move["beside"][0]["label"] == f"search ({name})"
    # two files of one name are called by their paths
    for place in ("<", "other"):
        (folder / place).mkdir()
        front.save(folder / place / "script>.json")
    done("export '</script>.json' 'other/script>.json' --output front.html --quiet")
    (move,) = data_of((folder / "front.html").read_text())
    assert move["label"] == "</script>.json"


@pytest.mark.slow
def test_of_ten_thousand_points_there_are_sixty_with_both_ends(front):
    residuals, energies = np.linspace(0.0, 0.04, 10_000), np.linspace(0.045, 0.018, 10_000)
    coefficients = front.points[1].coefficients
    points = [FrontPoint(coefficients, r, e) for r, e in zip(residuals, energies)]
    page = trade_off(replace(front, points=tuple(points)))
    (move,) = page.moves
    assert len(move["points"]) == 60
    assert (move["points"][0]["residual"], move["points"][-1]["residual"]) == (0.0, 0.04)
    steps = np.diff([point["residual"] for point in move["points"]])
    assert steps == pytest.approx(0.04 / 59, rel=0.02)
    assert move["note"] == "60 of the front's 10000 points. "
    assert len(page.html().encode()) < 1_500_000


def test_a_front_without_points_or_motions_is_refused(refused_here, front):
    empty = replace(front, points=())
    with pytest.raises(ValueError, match="mine: the front has no point; search longer or widen"):
        trade_off({"mine": empty})
    front.save("front.json")
    content = json.loads(refused_here.read("front.json"))
    for point in content["points"]:
        del point["coefficients"]
    refused_here.write("front.json", json.dumps(content))
    assert "coefficients" in refused_here("export front.json --output front.html")


@pytest.fixture
def refused_here(call, folder):
    """Run a line that is refused in one line, and writes nothing; read and write files."""

    class Refused:
        read = staticmethod(lambda name: (folder / name).read_text())
        write = staticmethod(lambda name, text: (folder / name).write_text(text))

        def __call__(self, line):
            before = sorted(folder.iterdir())
            code, out, err = call(line)
            assert (code != 0, out, err.count("\n")) == (True, "", 1)
            assert sorted(folder.iterdir()) == before
            return err

    return Refused()


@pytest.mark.slow
def test_fronts_of_a_move_lie_beside_each_other_and_other_moves_are_chosen(front, poor, plan):
    arm = evaluate_coefficients(PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8), [])
    limited = replace(plan, task=replace(plan.task, torque_limit=5.0))
    weak = replace(front, task=replace(front.task, torque_limit=5.0))
    answers = {"c": limited, "a": front, "b": poor, "weak": weak, "d": arm}
    link, weaker, other = trade_off(answers, known_points=paper_points).moves
    assert (weaker["label"], len(weaker["points"])) == ("weak", len(front.points))
    assert [(place["label"], place["kind"]) for place in link["beside"]] == [
        ("search (NSGA-II)", "search"), ("c", "plan"), ("the paper's best (6 terms)", "known"),
    ]  # fmt: skip
    assert link["beside"][0]["points"] == tuple((p.residual, p.energy) for p in poor.points)
    # docs/results: the paper's six coefficients take 0.0514 J and leave 0.36 mm
    assert link["beside"][2]["points"][0] == pytest.approx((0.36e-3, 0.0514), rel=0.01)
    assert (other["label"], len(other["points"]), other["joined"]) == ("d", 1, False)
    assert other["points"][0]["sentence"].startswith("The tip swings by up to ")


def test_plans_are_chosen_among_themselves_and_their_limits_are_drawn(plan, cycloid):
    task = replace(plan.task, torque_limit=(-0.3, 0.2))
    limited = replace(plan, task=task)
    (move,) = trade_off({"limited": limited, "plain": cycloid}).moves
    assert [point["name"] for point in move["points"]] == ["limited", "plain"]
    assert move["points"][0]["sentence"].startswith(
        "limited: the tip arrives at rest and takes 0.0"
    )
    assert move["panels"]["torque"]["limits"] == [[-0.3, 0.2]]
    with pytest.raises(ValueError, match="61 plans of one move are given, of which a page shows"):
        trade_off({str(number): plan for number in range(61)})


def test_of_a_duration_with_many_digits_the_arrival_is_found(cycloid):
    duration = 0.8 + 1 / 7
    longer = evaluate_coefficients(replace(cycloid.task, duration=duration), [])
    (move,) = trade_off(longer).moves
    assert move["times"][move["arrival"]] == pytest.approx(duration, abs=1e-8)


def test_of_an_uncertain_task_it_says_whose_residual_it_is(front, task):
    uncertain = replace(task, uncertainty=Uncertainty({"frequency": 0.1}))
    plan = evaluate_coefficients(uncertain, front.points[0].coefficients)
    (move,) = trade_off(plan).moves
    assert move["points"][0]["residual"] == plan.residual > 1e-3
    scenarios = len(plan.task.scenarios)
    assert move["note"].startswith(
        f"The residual is the worst of {scenarios} plants within the errors"
    )
    assert not move["swings_about_rest"]


def test_what_does_not_fit_on_a_page_is_refused(front, plan, tmp_path, monkeypatch):
    with pytest.raises(ValueError, match=r"front\.png is no page; end its name in \.html"):
        trade_off(front).save(tmp_path / "front.png")
    with pytest.raises(ValueError, match=r"csv takes a plan, and a front is given; give .* \.html"):
        export_plan(front, tmp_path / "move.csv")
    with pytest.raises(ValueError, match=r"is no film; end its name in \.gif or \.mp4"):
        animate(plan).save(tmp_path / "move.html")
    with pytest.raises(ValueError, match="no front or plan is given; give one or more"):
        trade_off([])
    with pytest.raises(TypeError, match="answer 1"):
        trade_off([3])
    monkeypatch.setattr(page_room, "MOST_BYTES", 30_000)
    with pytest.raises(ValueError, match=r"5 motions of 1 move make a page of \d+ kB, where 30 kB"):
        trade_off(front)


def test_between_the_points_of_a_search_no_line_is_drawn(poor):
    (move,) = trade_off(poor).moves
    assert (move["joined"], move["method"]) == (False, "search (NSGA-II)")
