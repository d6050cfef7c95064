"""Bad input: one line that names the value and the remedy, status 2, before any solve."""

import pytest
from lines import EVERY_FILE, MOVE, PLAN, TWO_TERMS

BAD = [  # the line, the value that is named, the remedy
    ("plan singel-link --target 1 --duration 1", "singel-link", "did you mean 'single-link'?"),
    ("plan Single_Link --target 1 --duration 1", "Single_Link", "did you mean 'single-link'?"),
    (
        "plan arm-on-flexibel-link --target 1 --duration 1",
        "arm-on-flexibel-link",
        "did you mean 'arm-on-flexible-link'?",
    ),
    ("plan arm --target 1 --duration 1", "'arm'", "did you mean 'arm-on-flexible-link'?"),
    ("plan qqq --target 1 --duration 1", "'qqq'", "your own by its --plant-file"),
    (f"evaluate singel-link --target 1 --duration 1 {TWO_TERMS}", "singel-link", "single-link"),
    ("plan single-link --target 30degrees --duration 1", "30degrees", "30deg, pi/6"),
    ("plan single-link --target pi/0 --duration 1", "pi/0", "30deg, pi/6"),
    ("plan single-link --start up --target 1 --duration 1", "'up'", "30deg, pi/6"),
    ("plan single-link --target '' --duration 1", "''", "30deg, pi/6"),
    ("plan single-link --target nan --duration 1", "nan", "give a finite number"),
    ("plan single-link --target inf --duration 1", "inf", "give a finite number"),
    ("plan single-link --start=-inf --target 1 --duration 1", "-inf", "give a finite number"),
    ("plan single-link --target 0 --duration 1", "target equals start (0 rad)", "change one"),
    ("plan single-link --start 90deg --target pi/2 --duration 1", "1.5708 rad", "change one"),
    ("plan single-link --target 1 --duration 0", "duration is 0 s", "give a positive number"),
    ("plan single-link --target 1 --duration -1", "duration is -1 s", "give a positive number"),
    ("plan single-link --target 1 --duration nan", "duration is nan", "give a finite number"),
    ("plan single-link --target 1 --duration inf", "duration is inf", "give a finite number"),
    ("plan single-link --target 1 --duration 1h", "'1h'", "seconds (0.8) or 800ms"),
    *[
        (f"{PLAN} --{name}-limit {value}", f"{name} limit is {shown}", remedy)
        for name in ("torque", "speed", "acceleration", "deflection")
        for value, shown, remedy in (
            ("0", "0 ", "give a positive number"),
            ("-0.5", "-0.5 ", "give a positive number"),
            ("nan", "nan", "give a finite number"),
            ("inf", "inf", "give a finite number"),
        )
    ],
    (f"{PLAN} --torque-limit strong", "strong", "--torque-limit"),
    (f"{PLAN} --deflection-limit 1inch", "1inch", "metres (0.001) or 1mm"),
    (f"{PLAN} --residual-window 0", "residual window is 0 s", "give a positive number"),
    (f"{PLAN} --residual-window nan", "residual window is nan", "give a finite number"),
    (f"{PLAN} --residual-limit -1mm", "residual limit is -0.001 m", "give 0 (at rest) or more"),
    (f"{PLAN} --residual-limit nan", "residual limit is nan", "give a finite number"),
    (f"{PLAN} --residual-limit small", "small", "metres (0.001) or 1mm"),
    (f"{PLAN} --robust frequency=", "'frequency='", "give a name and its share, as frequency=10%"),
    (f"{PLAN} --robust 10%", "'10%'", "give a name and its share, as frequency=10%"),
    (f"{PLAN} --robust frequency=much", "'much'", "give 10% or 0.1"),
    (f"{PLAN} --robust frequenzy=10%", "'frequenzy'", "did you mean 'frequency'?"),
    (f"{PLAN} --robust mass=10%", "'mass'", "it has: frequency, damping, alpha1"),
    (f"{PLAN} --robust frequency=120%", "an error of 120 %", "makes the frequency negative; give"),
    (f"{PLAN} --robust omega=-5%", "range of omega is -0.05", "give a positive number"),
    (f"{PLAN} --robust omega=nan", "range of omega is nan", "give a finite number"),
    (f"{PLAN} --robust omega=5% --robust omega=5%", "omega is given twice", "give it once"),
    (f"{PLAN} --robust omega=5% --residual-limit 0", "residual limit is 0", "leave it out"),
    (f"front {MOVE} --method epsilon --robust omega=", "'omega='", "as frequency=10%"),
    (f"{PLAN} --terms -1", "terms is -1", "to 32"),
    (f"{PLAN} --terms 33", "terms is 33", "to 32: beyond that double precision"),
    (f"{PLAN} --terms 1.5", "1.5", "--terms"),
    (f"{PLAN} --terms six", "six", "--terms"),
    (f"{PLAN} --bound 0", "bound on the coefficients is 0", "give a positive number"),
    (f"{PLAN} --bound -0.2", "bound on the coefficients is -0.2", "give a positive number"),
    (f"{PLAN} --bound nan", "bound on the coefficients is nan", "give a finite number"),
    (f"{PLAN} --starts 0", "starts is 0", "from 1 up"),
    (f"{PLAN} --seed -1", "seed is -1", "from 0 up"),
    (f"{PLAN} --method pso", "'pso'", "'vepso'"),
    (f"{PLAN} --method vepso --bound 0", "bound on the coefficients is 0", "give a positive"),
    (f"{PLAN} --method vepso", "bound", "0.2"),  # the paper's, eq (12)
    (f"evaluate {MOVE} --coefficients=0.1,nan", "coefficient 2 is 'nan'", "give finite numbers"),
    (f"evaluate {MOVE} --coefficients=inf", "coefficient 1 is 'inf'", "give finite numbers"),
    (f"evaluate {MOVE} --coefficients=0.1,,2", "coefficient 2 is ''", "separated by commas"),
    (f"evaluate {MOVE} --coefficients=a", "coefficient 1 is 'a'", "separated by commas"),
    (f"evaluate {MOVE} --coefficients=" + ",".join("0" * 33), "got 33 coefficients", "0 to 32"),
]  # fmt: skip


@pytest.mark.parametrize(("line", "value", "remedy"), BAD, ids=[line for line, *_ in BAD])
def test_bad_input_is_refused_with_its_value_and_a_remedy(refused, line, value, remedy):
    message = refused(f"{line} {EVERY_FILE}", status=2)
    assert value in message
    assert remedy in message


FRONT = f"front {MOVE} --method nsga2"


@pytest.mark.parametrize(
    ("line", "value", "remedy"),
    [
        (FRONT, "bound", "0.2"),  # the paper's, eq (12)
        (f"{FRONT} --bound nan", "nan", "give a finite number"),
        (f"{FRONT} --bound 0.2 --population 0", "population is 0", "give"),
        (f"{FRONT} --bound 0.2 --generations 0", "generations is 0", "give"),
        (f"{FRONT} --bound 0.2 --runs 0", "runs is 0", "from 1 up"),
        (f"{FRONT} --bound 0.2 --runs 2 --workers 0", "workers is 0", "from 1 up"),
        (f"{FRONT} --bound 0.2 --workers 0", "workers is 0", "from 1 up"),
        (f"{FRONT} --bound 0.2 --seed -1", "seed is -1", "give"),
        (f"{FRONT} --bound 0.2 --terms 0", "0 terms", "give 1 term or more"),
        (f"{FRONT} --bound 0.2 --resume nowhere", "nowhere", "cannot be read"),
        (f"front {MOVE} --method annealing --bound 0.2", "annealing", "vepso, nsga2, "),
        ("reproduce --seeds 0", "seeds is 0", "from 1 up"),
        ("reproduce --seeds 0 --output results", "seeds is 0", "from 1 up"),
    ],
)
def test_a_bad_search_is_refused_with_its_value_and_a_remedy(refused, line, value, remedy):
    message = refused(line, status=2)
    assert value in message
    assert remedy in message


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("replan", ["replan", "'plan'"]),
        ("plan", ["--target"]),
        ("plan single-link --duration 1", ["--target"]),
        ("plan single-link --target 1", ["--duration"]),
        (f"evaluate {MOVE}", ["--coefficients"]),
        (f"{PLAN} --torqe-limit 1", ["--torqe-limit", "--torque-limit"]),
        (f"{PLAN} 0.3", ["0.3"]),
        (f"{PLAN} --output", ["--output"]),
        ("reproduce --output", ["--output"]),
    ],
)
def test_a_command_that_is_not_whole_is_refused(refused, no_solve, line, words):
    message = refused(line, status=2)
    for word in words:
        assert word in message


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("plan single-link --target 1e300 --duration 1", "target is 1e+300 rad; give an angle"),
        ("plan single-link --target 1 --duration 1e-300", "duration is 1e-300 s; give 1e-06 to"),
        ("plan single-link --target 1 --duration 1e300", "duration is 1e+300 s; give 1e-06 to"),
        (f"evaluate single-link --target 1 --duration 1e300 {TWO_TERMS}", "duration is 1e+300 s"),
        (f"evaluate single-link --target 1e300 --duration 1 {TWO_TERMS}", "target is 1e+300 rad"),
    ],
)
def test_values_beyond_all_reason_are_refused(refused, no_solve, line, words):
    assert words in refused(f"{line} {EVERY_FILE}", status=2)


def test_coefficients_beyond_all_reason_fail_in_one_line(refused):
    message = refused(f"evaluate {MOVE} --coefficients=1e300 {EVERY_FILE}", status=1)
    assert "CVODES could not follow this motion" in message
    assert "largest is 1e+300" in message


@pytest.mark.parametrize("name", ["study.pdf", "study", "study.png"])
def test_a_study_is_a_page_of_html(refused, name):
    message = refused(f"study {MOVE} --output {name}")
    assert message == f"quietarm: --output: {name} is for a page of HTML; end its name in .html\n"
