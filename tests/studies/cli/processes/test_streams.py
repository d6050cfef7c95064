"""Standard output that is closed, full, or read only in part: files come before words."""

import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from lines import COARSELY, MOVE

EVALUATE = f"evaluate {MOVE} --coefficients=0.003347,-0.1697 --quiet"  # the paper's Table 1
FULL = Path("/dev/full")


def shell(line):
    """Run a line of a shell, in which `quietarm` is the command."""
    command = shlex.join(COARSELY)
    script = f'set -o pipefail\nquietarm() {{ {command} "$@"; }}\n{line}'
    return subprocess.run(
        ["bash", "-c", script], capture_output=True, text=True, timeout=240, check=False
    )


@pytest.fixture(scope="module")
def fronts(front_of, tmp_path_factory):
    """A front that holds what it says, found by the gradient in a moment."""
    where = tmp_path_factory.mktemp("fronts")
    ran = subprocess.run(
        [sys.executable, "-m", "quietarm", *shlex.split(f"front {MOVE} --method epsilon --quiet"),
         *shlex.split("--terms 2 --points 3 --bound 0.3 --output a.json")],
        cwd=where, capture_output=True, text=True, timeout=240, check=False,
    )  # fmt: skip
    assert (ran.returncode, ran.stderr) == (0, "")
    found = json.loads((where / "a.json").read_text())
    found["points"] = found["points"][:2]
    (where / "b.json").write_text(json.dumps(found))
    return where


# Every command writes its files, whoever reads what it prints.
SMALL = "--population 10 --generations 2 --bound 0.2"
LINES = [
    (f"plan {MOVE} --terms 2 --starts 1 --output o.json --csv o.csv", ["o.csv", "o.json"]),
    (f"{EVALUATE} --output o.json --figure o.png", ["o.json", "o.png"]),
    (f"front {MOVE} --method nsga2 {SMALL} --output o.json", ["o.json"]),
    (f"front {MOVE} --method epsilon --terms 2 --points 3 --output o.json", ["o.json"]),
    ("polish FRONTS/a.json --points 2 --output o.json --csv o.csv", ["o.csv", "o.json"]),
    ("compare FRONTS/a.json FRONTS/b.json --no-floor --output .",
     ["coverage.csv", "fronts.png", "report.md", "runs.csv"]),
    (f"floor {MOVE} --acceleration-limit 200 --starts 1 --tolerance 0.1 --output o.json",
     ["o.json"]),
]  # fmt: skip


@pytest.mark.parametrize(("line", "files"), LINES, ids=[line.split()[0] for line, _ in LINES])
def test_a_reader_that_has_gone_costs_no_file_and_is_no_error(folder, fronts, line, files):
    ran = shell(f"quietarm {line.replace('FRONTS', str(fronts))} --quiet | true")
    assert (ran.returncode, ran.stderr) == (0, "")
    assert sorted(path.name for path in folder.iterdir()) == files


def test_a_reader_that_has_gone_costs_no_page_of_a_study(folder):
    line = (
        f"study {MOVE} --acceleration-limit 200 --terms 2 --points 3 --runs 1 {SMALL} "
        "--method nsga2 --fronts fronts"
    )
    ran = shell(f"quietarm {line} --quiet | head -1")
    assert (ran.returncode, ran.stderr) == (0, "")
    assert ran.stdout.startswith("- ")
    assert sorted(path.name for path in folder.iterdir()) == ["fronts", "study.html"]
    assert len(list((folder / "fronts").iterdir())) == 4  # two by gradient, one searched, polished


def test_progress_that_nobody_reads_stops_no_work(folder):
    ran = shell(f"quietarm {EVALUATE} --output o.json 2>&1 >/dev/null | true")
    assert ran.returncode == 0
    ran = shell(f"quietarm front {MOVE} --method nsga2 {SMALL} --output f.json 2>/dev/full")
    assert ran.returncode == 0
    assert sorted(path.name for path in folder.iterdir()) == ["f.json", "o.json"]


@pytest.mark.skipif(not FULL.exists(), reason="no /dev/full here")
def test_a_full_output_costs_no_file_and_is_said(folder):
    ran = shell(f"quietarm {EVALUATE} --output o.json --csv o.csv > /dev/full")
    assert ran.returncode == 2
    words = (
        "quietarm: standard output cannot be written: no space left on device; send it elsewhere\n"
    )
    assert ran.stderr == words
    assert sorted(path.name for path in folder.iterdir()) == ["o.csv", "o.json"]


def test_one_output_that_cannot_be_written_takes_no_other_with_it(call, folder, monkeypatch):
    replace = os.replace

    def fail(source, target):
        if Path(target).name == "o.json":
            raise OSError(28, "No space left on device", str(target))
        replace(source, target)

    monkeypatch.setattr(os, "replace", fail)
    code, out, err = call(f"{EVALUATE} --output o.json --csv o.csv --figure o.png")
    assert code == 2
    assert err.startswith("quietarm: ")
    assert err.endswith("o.json cannot be written: no space left on device; choose another place\n")
    assert out.splitlines()[-2:] == ["wrote o.csv", "wrote o.png"]
    assert sorted(path.name for path in folder.iterdir()) == ["o.csv", "o.png"]


# - is standard output


def test_a_dash_is_standard_output_and_words_go_beside_it(folder):
    ran = shell(f"quietarm {EVALUATE} --output - --csv move.csv")
    assert ran.returncode == 0
    assert json.loads(ran.stdout)["coefficients"] == [0.003347, -0.1697]
    assert "energy F2" in ran.stderr
    assert ran.stderr.splitlines()[-1] == "wrote move.csv"
    assert [path.name for path in folder.iterdir()] == ["move.csv"]


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (f"{EVALUATE} --output - --csv -", "--output and --csv are both -; give two files"),
        (f"{EVALUATE} --figure -", "- is no picture"),
        (f"front {MOVE} --method vepso {SMALL} --runs 2 --output -", "--output - is for one run"),
        (f"front {MOVE} --method vepso {SMALL} --checkpoint -", "not for standard output"),
        ("reproduce --output -", "not for standard output; give ./- or another"),
        (f"{EVALUATE} --output ''", "--output: the name is empty; give one"),
        (f"{EVALUATE} --csv ''", "--csv: the name is empty; give one"),
        (f"{EVALUATE} --figure ''", "--figure: the name is empty; give one"),
        ("reproduce --output ''", "--output: the name is empty; give one"),
        ("polish ''", "the name is empty; give one"),
        ("compare '' ''", "the name is empty; give one"),
    ],
)
def test_a_name_that_names_no_file_is_refused_first(call, folder, line, words):
    code, out, err = call(line)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert words in err
    assert list(folder.iterdir()) == []


def test_a_file_may_be_called_dash(call, folder):
    assert call(f"{EVALUATE} --output ./-")[0] == 0
    assert [path.name for path in folder.iterdir()] == ["-"]


def test_a_name_of_any_bytes_is_written_and_said(folder):
    ran = shell(f"quietarm {EVALUATE} --output $'\\xff.json' | tail -1")
    assert (ran.returncode, ran.stderr) == (0, "")
    assert ran.stdout == "wrote \\udcff.json\n"
