"""Every answer begins with the answer, in a sentence, and fits into a hundred columns."""

import re

import pytest
from lines import MOVE, TWO_TERMS
from pages import ROOT

from quietarm.ocp import CycloidPolynomial, epsilon_front

GANTRY = ROOT / "docs" / "recordings" / "gantry.csv"
KNOWN = "--set mass=82.7kg --set load=15kg --set friction=50 --assume share1"
A_NUMBER = r"\d[\d.]* (J|mm|Hz|s|%)"
CUT = re.compile(r"\d…|…\d")


def checked(out, begins):
    """The first line of an answer, which is a sentence with a figure; all of it is narrow."""
    lines = out.splitlines()
    assert re.match(begins, lines[0]), lines[0]
    assert re.search(A_NUMBER, lines[0])
    assert max(len(line.rstrip()) for line in lines) <= 100
    assert not CUT.search(out)
    return lines[0]


@pytest.fixture
def files(plan, cycloid, task, folder):
    """A plan, the plain cycloid, and a front of one move."""
    plan.save("plan.json")
    cycloid.save("cycloid.json")
    epsilon_front(task, CycloidPolynomial(2), bound=0.2, points=4, starts=1).save("front.json")
    return folder


def test_a_motion_says_what_it_takes_and_leaves_beside_the_plain_cycloid(done, plan):
    # the cycloid: 0.0911 J and 77.1 mm by docs/start.md
    cycloid = "; the plain cycloid takes 0.0911 J and leaves 77.1 mm."
    first = checked(done(f"evaluate {MOVE} {TWO_TERMS} --quiet"), "This motion takes ")
    assert first == f"This motion takes 0.063 J and leaves 0.256 mm{cycloid}"
    first = checked(done(f"plan {MOVE} --terms 2 --starts 1 --quiet"), "This plan takes ")
    assert first == f"This plan takes {plan.energy:.3g} J and arrives at rest{cycloid}"
    alone = checked(done(f"evaluate {MOVE} --coefficients 0 --torque-limit 0.1 --quiet"), "This ")
    assert alone == "This motion takes 0.0911 J and leaves 77.1 mm, beyond its limit of torque."


def test_how_an_answer_was_found_is_behind_verbose_and_coefficients_are_last(done):
    line = f"plan {MOVE} --terms 2 --starts 1 --quiet"
    brief, verbose = done(line), done(f"{line} --verbose")
    assert "verified           by a second integrator (CVODES)" in brief
    assert "local optimum" not in brief
    assert brief.splitlines()[-1].startswith("coefficients")
    assert "The solver found a local optimum." in verbose
    assert re.search(r"by a second integrator \(CVODES\), within \S+ of the energy", verbose)


def test_fronts_and_what_is_compared_begin_with_who_takes_or_leaves_least(done, files):
    search = f"search {MOVE} --bound 0.2 --terms 2 --population 8 --generations 4 --quiet"
    found = done(f"{search} --output found.json")
    checked(
        found, r"From \S+ J .* to \S+ J with \S+ mm: this vibration saves \S+ % of the energy\."
    )
    fronts = done("compare front.json found.json --no-free-motion --quiet")
    checked(fronts, r"Within 1 mm, epsilon constraint takes \S+ J; NSGA-II has no such m")
    assert "hypervolume gap [%]" in fronts
    plans = done("compare plan.json cycloid.json --quiet")
    assert checked(plans, r"plan arrives at rest for \S+ J; cycloid leaves \S+ mm for \S+ J\.$")


def test_files_name_their_answer_and_a_machine_its_frequency(done, refused, files):
    assert done("export plan.json --output move.csv --quiet").startswith("wrote move.csv\n")
    out = done(f"identify {GANTRY} linear-axis --tip tool_mm {KNOWN} --quiet")
    first = checked(out, "The mach")
    assert "assumed           share1 1" in out
    assert "default" not in out
    assert first == "The machine swings at 4.484 Hz (+-0.001 %), by 1 ring-down."
    said = refused(f"identify {GANTRY} linear-axis")
    assert "its columns, by name or by number from 0, are time_s, tool_mm" in said


@pytest.mark.slow
def test_sweeps_benches_and_robust_plans_begin_with_their_answer(call, done, folder):
    out = done(f"sweep {MOVE.replace('30deg', '20deg,30deg')} --terms 2 --quiet --output m.zarr")
    checked(out, r"2 of 2 moves have a plan, of \S+ to \S+ J; all arrive at rest\.$")
    assert "cold starts  found no better plan for 1 move" in out
    assert "target [deg]" in out

    bench = "bench single-link-30deg-0.8s --methods nsga2,epsilon --runs 2 --evaluations 100"
    code, out, _ = call(f"{bench} --quiet --output bench")
    assert code == 0
    checked(out, r"epsilon constraint, SQP is best on single-link-30deg-0.8s: its hypervolume gap")
    robust = done(f"plan {MOVE} --terms 2 --starts 1 --error frequency=5% --quiet")
    checked(robust, r"This plan takes \S+ J and leaves at most \S+ mm for frequency errors up to 5")
