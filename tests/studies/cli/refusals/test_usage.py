"""What click refuses is told with the value and the remedy, alike in all commands."""

import pytest
from lines import MOVE
from quietarm.studies.cli.application import COMMANDS


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("pln", "unknown command 'pln'; did you mean 'plan'? (known: plan, evaluate, "),
        ("-", "unknown command '-'; quietarm --help lists all"),
        ("''", "unknown command '' (known: plan, "),
        ("--bogus", "quietarm has no option '--bogus'; quietarm --help lists all"),
        (f"plan {MOVE} more", "'more' is more than quietarm plan takes; leave it out"),
        (f"plan {MOVE} --durtion 3", "quietarm plan has no option '--durtion'; did you mean "
         "'--duration'? quietarm plan --help lists all"),
        ("plan single-link --duration 1", "--target is missing; give it, as --target ANGLE"),
        ("plan single-link --target", "--target has no value; give one behind it"),
        (f"plan {MOVE} --quiet=3", "--quiet takes no value; give it alone"),
        (f"evaluate {MOVE}", "--coefficients is missing; give it, as --coefficients NUMBERS"),
        (f"front {MOVE}", "--method is missing; give it, as --method epsilon or weighted or "),
        ("polish", "FRONT is missing; give it, as quietarm polish [OPTIONS] FRONT"),
        ("problems bogus", "quietarm: PROBLEM: unknown problem 'bogus' (known: "),
        (f"plan {MOVE} --starts two", "quietarm: --starts: 'two' is no whole number; give one"),
    ],
)  # fmt: skip
def test_bad_usage_is_told_with_the_remedy(refused, line, told):
    assert told in refused(line)


@pytest.mark.parametrize("command", COMMANDS)
def test_an_option_that_is_none_is_told_alike_in_all_commands(refused, command):
    told = refused(f"{command} -Z")
    assert f"quietarm {command} has no option '-Z'; " in told
    assert f"quietarm {command} --help lists all" in told
