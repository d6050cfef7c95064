"""The headline study: every method, what it finds in words, and its page."""

import html.parser
import re
import shutil
import signal
import subprocess
import types
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import pytest
from matplotlib.figure import Figure

import metaheuristics.ensemble as ensemble
import studies.study.pieces as study_pieces
import studies.study.work as study_module
from ocp import Front, InfeasibleTaskError, PointToPoint, SolverFailedError
from studies.comparison.measures import compare_fronts
from studies.paper.case import Case
from studies.paper.printed import ARM_HALF, CONDITIONS, SINGLE_LINK_SIXTH
from studies.study.files import _file_name, front_files, page_file
from studies.study.findings import case_findings, findings, percent, percents
from studies.study.overview import draw_study_gaps
from studies.study.page import method_lines, study_page
from studies.study.pieces import StudySettings
from studies.study.work import Study, amount_of_work, run_study

QUICK = StudySettings(terms=2, points=6, runs=2, population=24, generations=8)
CASES = (Case(SINGLE_LINK_SIXTH.task), Case(ARM_HALF.task))
METHODS = ["epsilon", "weighted", "nsga2", "nsga2", "nsga2, polished", "vepso", "vepso",
           "vepso, polished"]  # fmt: skip
FLOOR = 0.0165


@pytest.fixture(scope="module", autouse=True)
def _floor_at_once():
    """The floor has tests of its own."""
    with pytest.MonkeyPatch.context() as patch:
        found = types.SimpleNamespace(energy=FLOOR, complete=True)
        patch.setattr(study_pieces, "energy_floor", lambda task: found)
        yield


@pytest.fixture(scope="module")
def begun():
    return []


@pytest.fixture(scope="module")
def small(_floor_at_once, begun):
    """Two tasks, with searches cut short."""
    return run_study(CASES, QUICK, begun.append)


@pytest.fixture(scope="module")
def text(small):
    return study_page(small)


@pytest.fixture(scope="module")
def root(text):
    return ElementTree.fromstring(text)  # well-formed, or this raises


# What is run


def test_every_method_runs_on_every_task(small, begun):
    assert [found.case.task for found in small.cases] == [case.task for case in CASES]
    for found in small.cases:
        assert [run.front.method for run in found.comparison.runs] == METHODS
        assert found.failures == ()
        assert {run.front.settings["bound"] for run in found.comparison.runs} == {found.case.bound}
    assert len(begun) == amount_of_work(CASES, QUICK) == 18
    assert begun[0] == "single-link, 0 to 30 deg in 0.8 s: epsilon"


def test_polish_never_makes_worse_what_it_starts_from(small):
    for found in small.cases:
        for method in ("nsga2", "vepso"):
            first = next(r for r in found.comparison.runs if r.front.method == method)
            polished = found.comparison.group(
                {"nsga2": "NSGA-II polished", "vepso": "VEPSO polished"}[method]
            )
            gained = polished.runs[0].hypervolume_found - first.hypervolume_found
            assert gained > -1e-5  # the two integrators differ by that much
            assert len(found.polishes[method].gains) == len(first.front.points)


def test_the_papers_six_conditions_are_the_default():
    assert len(CONDITIONS) == 6
    assert {case.bound for case in CONDITIONS} == {0.2, 0.5}  # eqs (12) and (17)


def test_a_plant_of_ones_own_needs_a_bound(two_links):
    task = PointToPoint(two_links, 1.5, 0.9)
    with pytest.raises(ValueError, match="give a bound on the coefficients"):
        Case(task)
    assert Case(task, 0.3).bound == 0.3
    with pytest.raises(ValueError, match="bound on the coefficients is -1"):
        Case(task, -1)


@pytest.mark.parametrize(
    "wrong",
    [{"points": 1}, {"runs": 0}, {"terms": 0}, {"workers": 0}, {"population": 1},
     {"generations": 0}],
)  # fmt: skip
def test_settings_out_of_range_are_refused(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        StudySettings(**wrong)


def test_a_method_that_fails_is_left_out_with_its_reason(monkeypatch, let_sweep):
    def fail(*arguments, **settings):
        raise SolverFailedError("it would not")

    let_sweep("weighted", fail)
    monkeypatch.setattr(study_pieces, "energy_floor", fail)
    (found,) = run_study(CASES[:1], QUICK).cases
    assert "weighted" not in {run.front.method for run in found.comparison.runs}
    assert found.failures == ("weighted: it would not", "floor: it would not")
    assert found.floor is None
    assert set(found.failures) <= set(case_findings(found))


def test_the_gradient_is_not_asked_twice_for_an_infeasible_task(monkeypatch, let_sweep, small):
    def infeasible(*arguments, **settings):
        raise InfeasibleTaskError("found no motion")

    found = [run.front for run in small.cases[0].comparison.runs if run.front.seed is not None]
    let_sweep("epsilon", infeasible)
    let_sweep("weighted", lambda *given, **_: pytest.fail("asked"))
    searches_that_find(monkeypatch, lambda method: [f for f in found if f.method == method])
    (case,) = run_study(CASES[:1], QUICK).cases
    assert case.failures == (
        "epsilon: found no motion",
        "weighted: not tried, as epsilon found no motion within the limits",
    )


def searches_that_find(monkeypatch, answer):
    """Let every search of a study answer so, by its method and seed."""
    monkeypatch.setattr(ensemble, "search", lambda task, method, seed, **_: answer(method)[seed])


def test_without_a_front_to_start_from_there_is_no_polish(monkeypatch):
    def fail(method):
        raise SolverFailedError("it would not")

    searches_that_find(monkeypatch, fail)
    begun = []
    (case,) = run_study(CASES[:1], QUICK, begun.append).cases
    assert case.failures == (
        "nsga2 (2 of 2 seeds): it would not",
        "nsga2, polished: not tried, as nsga2 found no front to start from",
        "vepso (2 of 2 seeds): it would not",
        "vepso, polished: not tried, as vepso found no front to start from",
    )
    assert case.polishes == {}
    assert len(begun) == amount_of_work(CASES[:1], QUICK)


def test_the_first_front_that_has_points_is_polished(monkeypatch, small):
    fronts = {run.front.method: run.front for run in small.cases[0].comparison.runs}

    def first_empty(method):
        return [replace(fronts[method], points=()), fronts[method]]

    searches_that_find(monkeypatch, first_empty)
    (case,) = run_study(CASES[:1], QUICK).cases
    assert case.failures == (
        "nsga2 (1 of 2 seeds): found no point",
        "vepso (1 of 2 seeds): found no point",
    )
    for method in ("nsga2", "vepso"):
        assert len(case.polishes[method].gains) == len(fronts[method].points)


def test_a_search_that_is_interrupted_ends_the_study_and_what_was_found_is_kept(
    monkeypatch, let_sweep, small
):
    fronts = [run.front for run in small.cases[0].comparison.runs]
    for front in fronts[:2]:
        let_sweep(front.method, lambda *given, found=front, **_: found)
    cut = replace(fronts[2], complete=False)
    searches_that_find(monkeypatch, lambda method: [cut])
    begun = []
    found = run_study(CASES, QUICK, begun.append)
    assert len(begun) == 3
    assert found.done == 2
    (case,) = found.cases
    assert [run.front for run in case.comparison.runs] == [*fronts[:2], cut]
    assert case.failures == (
        "nsga2 (1 of 2 seeds): interrupted, with what was found until then",
        "nsga2 (1 of 2 seeds): not done before the interruption",
        "nsga2, polished: not done before the interruption",
        "vepso (2 of 2 seeds): not done before the interruption",
        "vepso, polished: not done before the interruption",
        "floor: not done before the interruption",
    )
    assert "not done before the interruption" in study_page(found)


def test_ctrl_c_while_the_last_task_is_put_together_loses_nothing(monkeypatch, let_sweep, small):
    fronts = [run.front for run in small.cases[0].comparison.runs]
    for front in fronts[:2]:
        let_sweep(front.method, lambda *given, found=front, **_: found)
    searches_that_find(monkeypatch, lambda method: [f for f in fronts if f.method == method])
    compared = study_module.compare_fronts

    def interrupted(*given, **settings):
        signal.raise_signal(signal.SIGINT)
        return compared(*given, **settings)

    monkeypatch.setattr(study_module, "compare_fronts", interrupted)
    (case,) = run_study(CASES[:1], QUICK).cases
    assert len(case.comparison.runs) == len(fronts)


def test_a_study_of_which_one_front_was_found_is_a_page(small):
    (case, _) = small.cases
    alone = compare_fronts([case.comparison.runs[0].front], least=1)
    page = study_page(Study(QUICK, (replace(case, comparison=alone, polishes={}),), 1.0, done=1))
    assert "epsilon constraint" in page


def test_a_study_that_found_nothing_before_ctrl_c_is_none(let_sweep):
    def stopped(*given, **settings):
        raise KeyboardInterrupt

    let_sweep("epsilon", stopped)
    with pytest.raises(KeyboardInterrupt):
        run_study(CASES[:1], QUICK)


# What it says


def test_shares_in_words():
    assert percent(0.1234) == "12 %"
    assert percent(0.0012) == "0.12 %"
    assert percent(1.199) == "120 %"
    assert percent(1e-6) == "less than 0.01 %"
    assert percents([0.001, 0.02]) == "0.1 to 2 %"
    assert percents([0.02, 0.02]) == "2 %"


def test_findings_are_those_of_the_fronts(small):
    found = small.cases[0]
    words = " ".join(case_findings(found))
    fronts = {run.front.method: run.front for run in found.comparison.runs}
    best = found.comparison.best[1]
    assert f"within 1 mm is {best:.4g} J" in words
    # at least as good as what every front holds
    assert best <= min(front.cheapest(1e-3).energy for front in fronts.values()
                       if front.stillest().residual <= 1e-3)  # fmt: skip
    # docs/physics.md: the printed coefficients for N = 2 take 0.06297 J with 0.256 mm
    (claim,) = re.findall(r"N = 2, takes 0.06297 J at 0.256 mm: (\S+) % more", words)
    at_paper = min(front.cheapest(2.56e-4).energy for front in fronts.values()
                   if front.stillest().residual <= 2.56e-4)  # fmt: skip
    assert float(claim) == pytest.approx(100 * (0.06297 / at_paper - 1), abs=0.6)
    ratio = fronts["epsilon"].stillest().energy / FLOOR
    assert f"{ratio:.3g} times the floor" in words


def test_the_summary_speaks_of_every_method(small):
    words = " ".join(findings(small))
    for part in ("The front that dominates most: epsilon constraint in ", "NSGA-II takes",
                 "VEPSO takes", "Polished by the gradient", "times the floor",
                 "Median time of a front: epsilon constraint"):  # fmt: skip
        assert part in words


def test_where_no_motion_is_still_the_findings_say_how_still_the_stillest_is(small):
    found = small.cases[0]
    fronts = [replace(run.front, points=run.front.points[-1:]) for run in found.comparison.runs]
    (last,) = fronts[0].points
    assert last.residual > 5e-3  # the largest of the residuals that energies are compared at
    words = " ".join(case_findings(replace(found, comparison=compare_fronts(fronts[:4]))))
    assert "No method arrives within 1 mm: the stillest motion leaves " in words
    assert re.search(r"The stillest motion of NSGA-II leaves \d\S* mm\.", words)
    assert "not reached" not in words
    assert "No motion of 2 coefficients was found that arrives at rest" in words


@pytest.mark.parametrize(
    ("settings", "nsga2", "vepso"),
    [
        # sections 3.1 and 3.2 of the paper
        (StudySettings(), "200 and 500 generations, as in the paper",
         "100 and 200 generations, as in the paper"),
        (QUICK, "24 and 8 generations, where the paper has 200 and 500",
         "24 and 8 generations, where the paper has 100 and 200"),
        (StudySettings(generations=200), "200 and 200 generations, where the paper has 200 and 500",
         "100 and 200 generations, as in the paper"),
    ],
)  # fmt: skip
def test_the_page_says_with_which_settings_the_searches_ran(settings, nsga2, vepso):
    words = method_lines(settings)
    seeds = f"from {settings.runs} seeds"
    for label, part in (("NSGA-II", nsga2), ("VEPSO", vepso)):
        wanted = f"{label}: the paper's search, {seeds}, with a population of {part}."
        assert wanted in words


def test_epsilon_has_a_point_at_every_residual_that_energies_are_compared_at(small):
    for found in small.cases:
        front = next(r.front for r in found.comparison.runs if r.front.method == "epsilon")
        for level in found.comparison.levels:
            assert level * (1 - 3e-4) < front.cheapest(level).residual <= level


def test_the_overview_is_drawn_on_the_axes_that_are_given_or_on_new_ones(small):
    given = Figure().subplots()
    assert draw_study_gaps(small, given) is given
    assert [label.get_text() for label in given.get_yticklabels()] == [
        "single-link\n0 to 30 deg in 0.8 s", "arm-on-flexible-link\n0 to 90 deg in 0.8 s"
    ]  # fmt: skip
    assert draw_study_gaps(small).figure is not given.figure


# The page


def test_the_page_loads_and_runs_nothing(text, root):
    assert not re.search(r"<(script|link|iframe|object|embed|video|audio)\b", text)
    assert not re.search(r"@import|url\(|\son\w+=", text)
    for element in root.iter():
        for name in ("src", "href", "srcset", "action"):
            value = element.get(name, "#")
            assert value.startswith(("#", "data:image/svg+xml;base64,")), value[:60]
    assert "http:" not in text
    assert "https:" not in text


def test_every_picture_has_words_and_every_link_its_place(root):
    images = list(root.iter("img"))
    assert len(images) == 1 + 3 * len(CASES)
    assert all(len(image.get("alt", "")) > 20 for image in images)
    marks = [element.get("id") for element in root.iter() if element.get("id")]
    assert len(marks) == len(set(marks))
    links = [link.get("href").removeprefix("#") for link in root.iter("a")]
    assert links == marks == ["task-1", "task-2"]


def test_findings_stand_before_pictures_and_tables(root):
    order = [element.get("class") or element.tag for element in root.find("body")]
    assert order[:3] == ["h1", "findings", "overview"]
    for section in [s for s in root.iter("section") if s.get("id")]:
        parts = [element.get("class") or element.tag for element in section]
        assert parts[:3] == ["h2", "findings", "pictures"]


def test_html_of_every_tag_is_closed(text):
    """As a browser's parser sees it, not only as XML."""
    void, open_tags = {"meta", "img", "br"}, []

    class Reader(html.parser.HTMLParser):
        def handle_starttag(self, tag, attributes):
            open_tags.append(tag)

        def handle_startendtag(self, tag, attributes):
            assert tag in void

        def handle_endtag(self, tag):
            assert open_tags.pop() == tag

    Reader().feed(text)
    assert open_tags == []


def test_one_task_needs_no_overview(small):
    (case, _) = small.cases
    alone = ElementTree.fromstring(study_page(Study(QUICK, (case,), 1.0)))
    assert [element.tag for element in alone.find("body")][:2] == ["h1", "section"]


CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
@pytest.mark.parametrize("width", [1280, 390])
def test_the_page_fits_a_desktop_and_a_phone(text, tmp_path, width):
    measure = (
        "<script>addEventListener('load', () => { const d = document.documentElement;"
        "document.body.dataset.seen = [innerWidth, d.scrollWidth,"
        "[...document.images].every(i => i.naturalWidth > 0)].join(' '); });</script></body>"
    )
    # in a frame, since a headless window is no narrower than 500 pixels
    (tmp_path / "page.html").write_text(text.replace("</body>", measure))
    frame = (
        f"<iframe src='page.html' width='{width}' height='900' onload='document.title = "
        "this.contentDocument.body.dataset.seen'></iframe>"
    )
    (tmp_path / "frame.html").write_text(f"<!DOCTYPE html><title>none</title>{frame}")
    ran = subprocess.run(
        [CHROMIUM, "--headless=new", "--no-sandbox", "--disable-gpu", "--dump-dom",
         "--allow-file-access-from-files", "--virtual-time-budget=5000",
         f"--user-data-dir={tmp_path / 'profile'}", (tmp_path / "frame.html").as_uri()],
        capture_output=True, text=True, timeout=90, check=True,
    )  # fmt: skip
    (seen,) = re.findall(r"<title>(.*?)</title>", ran.stdout)
    inner, scroll, loaded = seen.split()
    assert int(inner) == width
    assert int(scroll) <= width
    assert loaded == "true"


# The command


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder of the test's own, and standing in it; lines are not wrapped."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "1000")
    return tmp_path


MOVE = "study single-link --target 30deg --duration 0.8"


def test_study_writes_the_page_and_the_fronts(call, folder, small, monkeypatch):
    asked = {}

    def at_once(cases, settings, begin):
        asked.update(cases=cases, settings=settings)
        return Study(settings, small.cases[:1], 1.0)

    monkeypatch.setattr(study_module, "run_study", at_once)
    code, out, err = call(
        f"{MOVE} --bound 0.3 --terms 2 --points 6 --runs 2 --population 24 --generations 8 "
        "--fronts fronts --quiet"
    )
    assert (code, err) == (0, "")
    assert asked["settings"] == QUICK
    assert [case.bound for case in asked["cases"]] == [0.3]
    for line in case_findings(small.cases[0]):
        assert f"- {line}" in out
    assert out.splitlines()[-2:] == ["wrote study.html", "wrote 8 fronts to fronts"]
    assert (folder / "study.html").read_text().startswith("<!DOCTYPE html>")
    runs = small.cases[0].comparison.runs
    saved = [Front.load(path) for path in (folder / "fronts").iterdir()]
    assert len(saved) == len(runs) == 8
    assert all(run.front in saved for run in runs)


def test_fronts_of_a_move_and_of_its_mirror_image_have_names_of_their_own(small, tmp_path):
    names = [path.name for path, _ in front_files(small, tmp_path)]
    assert len(names) == len(set(names)) == 16
    assert "arm-on-flexible-link-0-to-90-deg-in-0.8-s-nsga2-polished-seed0.json" in names
    assert _file_name("-90 to 45 deg") == "minus-90-to-45-deg"


def test_without_a_plant_it_is_the_papers_conditions(call, folder, small, monkeypatch):
    asked = {}

    def at_once(cases, settings, begin):
        asked.update(cases=cases)
        return small

    monkeypatch.setattr(study_module, "run_study", at_once)
    code, out, _ = call("study --quiet --output all.html")
    assert code == 0
    assert asked["cases"] == CONDITIONS
    assert f"- {findings(small)[0]}" in out


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("study --target 1", "--target is for a task of your own: give its plant as well"),
        ("study --torque-limit 1", "--torque-limit is for a task of your own"),
        ("study --bound 0.2", "--bound is for a task of your own"),
        ("study single-link --duration 1", "give --target with the plant"),
        ("study single-link --target 1", "give --duration with the plant"),
        (f"{MOVE} --bound 0", "bound on the coefficients is 0"),
        (f"{MOVE} --points 1", "points is 1; give a whole number from 2 up"),
        (f"{MOVE} --runs 0", "runs is 0"),
        (f"{MOVE} --population 1", "population is 1; give a whole number from 2 up"),
        (f"{MOVE} --terms 0", "terms is 0"),
        (f"{MOVE} --output nowhere/a.html", "folder nowhere does not exist"),
        ("study singel-link --target 1 --duration 1", "did you mean 'single-link'?"),
    ],
)
def test_bad_input_is_refused_in_a_line_before_any_work(call, folder, monkeypatch, line, words):
    monkeypatch.setattr(study_module, "run_study", lambda *given: pytest.fail("work was begun"))
    code, out, err = call(line)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert words in err
    assert list(folder.iterdir()) == []


def test_a_folder_for_the_fronts_that_cannot_be_made_is_refused_first(call, folder, no_place):
    code, out, err = call(f"{MOVE} --fronts fronts")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "fronts cannot be written: no such file or directory; choose another place" in err
    assert list(folder.iterdir()) == []


def test_an_interrupt_leaves_no_file(call, folder, monkeypatch):
    def interrupted(*given):
        raise KeyboardInterrupt

    monkeypatch.setattr(study_module, "run_study", interrupted)
    code, _, err = call(f"{MOVE} --quiet")
    assert (code, err.strip()) == (1, "quietarm: interrupted; nothing was written")
    assert list(folder.iterdir()) == []


def test_a_page_that_cannot_be_drawn_is_not_half_written(small, tmp_path, monkeypatch):
    def fail(*given):
        raise RuntimeError("drawing failed")

    monkeypatch.setattr("studies.study.files.study_page", fail)
    path, write = page_file(small, tmp_path / "study.html")
    with pytest.raises(RuntimeError, match="drawing failed"):
        write(path)
    assert list(tmp_path.iterdir()) == []
