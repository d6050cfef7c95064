"""Files that ask for more than a machine has, never end, are damaged, or speak to the terminal."""

import io
import os
import zipfile

import numpy as np
import pytest
from lines import MOVE
from scipy.io import savemat

from quietarm.machine.tables.table import read_table
from quietarm.ocp import CycloidPolynomial, epsilon_front

DEEP = 100_000
ROWS = "\n".join(f"{k},{k}" for k in range(9))
TEXTS = {
    "numbered.csv": "a_999999999,a_2\n1,2\n",
    "wide.csv": "\n".join([",".join(["1"] * 30_000)] * 40),
    "spaced.csv": "\n".join([" ".join(["1"] * 30_000)] * 40),
    "many.csv": "1,2\n" * 2_100_000,
    "deep.json": "[" * DEEP + "]" * DEEP,
    "deeper.json": '{"format": "quietarm-plan", "x": ' + '{"a":' * DEEP + "1" + "}" * (DEEP + 1),
    "long.csv": f"{ROWS}\n{'1' * 20_000_000}\n",
    "nan.json": '{"format": "quietarm-plan", "version": 4, "motion": {"energy": NaN}}',
    "infinite.json": '{"format": "quietarm-front", "points": [{"residual": -Infinity}]}',
    "name.csv": "n" * DEEP + f",tip\n{ROWS}\n",
    "colour.csv": f"\x1b[31mred\x1b]0;title\x07\x9b2J\u202e,tip\n{ROWS}\n",
    "huge.py": "#" * 1_000_001,
}


def bomb():
    """Compressed zeros, 120 MB in 120 kB."""
    content, header = io.BytesIO(), io.BytesIO()
    facts = {"descr": "<f8", "fortran_order": False, "shape": (15_000_000,)}
    np.lib.format.write_array_header_1_0(header, facts)
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("x.npy", header.getvalue() + bytes(120_000_000))
    return content.getvalue()


def liar():
    """An array of a hundred bytes that says that it has 8 TB."""
    content = io.BytesIO()
    facts = {"descr": "<f8", "fortran_order": False, "shape": (10**12,)}
    np.lib.format.write_array_header_1_0(content, facts)
    return content.getvalue() + bytes(100)


def matlab(**variables):
    content = io.BytesIO()
    savemat(content, variables, do_compression=True)
    return content.getvalue()


@pytest.fixture
def files(folder):
    """All of them, in the folder of the test."""
    for name, text in TEXTS.items():
        (folder / name).write_text(text, encoding="utf-8")
    contents = {"bomb.npz": bomb(), "liar.npy": liar(), "bomb.mat": matlab(t=np.zeros(13_000_000))}
    for name, content in contents.items():
        (folder / name).write_bytes(content)
    for name in ("huge.json", "huge.csv"):
        os.truncate(os.open(folder / name, os.O_CREAT | os.O_WRONLY), 10**11)
    np.save(folder / "wide.npy", np.ones((3, 30_000)))
    return folder


@pytest.fixture
def endless(folder):
    """Pipes, links to a device, and links that lead round."""
    for ending in ("json", "csv", "npz", "mat", "py"):
        os.mkfifo(folder / f"pipe.{ending}")
        os.symlink("/dev/zero", folder / f"zero.{ending}")
        os.symlink(f"loop.{ending}", folder / f"loop.{ending}")


TABLE = f"evaluate {MOVE} --coefficients"
RECORDING = "identify FILE flexible-beam --tip none"


@pytest.mark.slow
def test_what_asks_for_too_much_is_refused_with_the_bound(call, files):
    for line, words in {
        f"{TABLE} numbered.csv": "there is no column for coefficient 1; give all",
        f"{TABLE} wide.csv": "it has 30000 columns; give at most 1000",
        f"{TABLE} spaced.csv": "it has 30000 columns; give at most 1000",
        f"{TABLE} wide.npy": "it has 30000 columns; give at most 10000",
        f"{TABLE} many.csv": "it has 2100000 rows; give at most 2000000",
        f"{TABLE} bomb.npz": "its arrays take 120 MB; give at most 100 MB",
        f"{TABLE} bomb.mat": "its variables take more than 100 MB",
        f"{TABLE} liar.npy": "it is no whole .npy file of numbers",
        f"{TABLE} huge.csv": "huge.csv has 100000 MB; give at most 100 MB",
        "identify bomb.npz flexible-beam --tip x": "its arrays take 120 MB; give at most 100 MB",
        f"{TABLE} long.csv": "line 10 has 20000000 letters; give at most 200000 in a line",
        "compare nan.json": "nan.json is not a valid plan: energy is NaN, which is no number",
        "export nan.json --output a.csv": "is not a valid plan: energy is NaN, which is no number",
        "compare infinite.json": "is not a valid front: residual is -Infinity, which is no num",
        "compare huge.json": "huge.json has 100000 MB; give at most 100 MB",
        "compare deep.json": "it is not whole, valid JSON in UTF-8",
        "compare deeper.json": "it is not whole, valid JSON in UTF-8",
        "explore deeper.json": "it is not whole, valid JSON in UTF-8",
        "plan deep.json --target 1 --duration 1": "it is not whole, valid JSON in UTF-8",
        "export deep.json --output a.csv": "it is not whole, valid JSON in UTF-8",
        "plan --plant-file huge.py": "has over 1000000 bytes; is it another file?",
    }.items():
        status, out, err = call(line)
        assert (status, out, err.count("\n")) == (2, "", 1), line
        assert words in err


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("name", ["pipe", "zero", "loop"])
def test_what_never_ends_is_not_read(call, endless, name):
    words = "cannot be read: too many levels" if name == "loop" else "no ordinary file; save it"
    for line in (
        f"{TABLE} {name}.csv", f"{TABLE} {name}.npz", f"{TABLE} {name}.mat",
        f"identify {name}.csv flexible-beam --tip tip", f"evaluate single-link --path {name}.csv",
        f"compare {name}.json", f"compare --reference {name}.json {name}.json",
        f"explore {name}.json", f"export {name}.json --output a.csv", f"front --polish {name}.json",
        f"plan {name}.json --target 1 --duration 1",
    ):  # fmt: skip
        status, out, err = call(line)
        assert (status, out, err.count("\n")) == (2, "", 1), line
        assert words in err or "given twice" in err
    status, _, err = call(f"plan --plant-file {name}.py --target 1 --duration 1")
    assert (status, err.count("\n")) == (2, 1)
    assert name in err


@pytest.mark.slow
def test_a_name_of_a_file_is_cut_and_gives_the_terminal_no_orders(call, files):
    _, _, err = call("identify name.csv flexible-beam --tip top")
    assert "nnn ... nnn" in err
    assert len(err) < 500
    _, _, err = call("identify colour.csv flexible-beam --tip top")
    assert err.isascii()
    assert err.rstrip("\n").isprintable()
    assert "?[31mred" in err


@pytest.mark.slow
def test_the_name_of_a_method_gives_the_terminal_no_orders(call, folder, task):
    front = epsilon_front(task, CycloidPolynomial(2), bound=0.3, points=3, starts=1)
    front.restated(method="\x1b[31mred\x9b2J").save("front.json")
    status, out, _ = call("compare front.json --no-free-motion")
    assert status == 0
    assert "?[31mred" in out
    assert not {"\x1b", "\x9b"} & set(out)
    with pytest.raises(ValueError, match="a name of 100000 letters; give at most 300"):
        front.restated(method="n" * 100_000)


def test_a_profile_of_many_coefficients_says_that_it_takes_minutes(call):
    line = f"sweep {MOVE} --profile network --terms 30 --output a.zarr --starts 1"
    assert call(line)[0] == 2  # sweep has no starts
    _, _, err = call(f"plan {MOVE} --profile network --terms 30 --bound -1")
    assert err.startswith("91 coefficients: a plan takes minutes; with fewer --terms seconds\n")


@pytest.mark.parametrize(
    ("line", "solves"),
    [
        ("plan --profile network --terms 30 --starts 10000", 10_000),
        ("plan --profile gaussians --terms 32 --starts 9999", 9999),
        ("front --points 10000 --starts 10000", 100_000_000),
        ("front --profile spline --terms 32 --points 10000", 40_000),
        ("front --profile network --terms 20 --points 500", 2000),
    ],
)
def test_endless_solves_are_refused_with_their_number(call, line, solves):
    command, _, rest = line.partition(" ")
    status, out, err = call(f"{command} {MOVE} {rest}")
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert f"{solves} solves take some " in err
    assert " hours on a core; give fewer, or --yes" in err


SOUND = matlab(t=np.arange(50) / 50.0, tip=np.sin(np.arange(50.0)), s={"a": [1.0, 2.0]}, name="x")
DAMAGED = 40
"""Files, of each of which some bytes are others."""


@pytest.mark.slow
def test_a_damaged_file_of_matlab_is_refused_whatever_scipy_makes_of_it(folder):
    plain = io.BytesIO()
    savemat(plain, {"t": np.arange(50) / 50.0, "s": {"a": [1.0, 2.0], "b": [{"c": 1}] * 2}})
    random, path, refusals = np.random.default_rng(0), folder / "damaged.mat", list[str]()
    for k in range(DAMAGED):
        content = bytearray(SOUND if k % 2 else plain.getvalue())
        for place in random.integers(128, len(content), 5):
            content[place] = random.integers(256)
        path.write_bytes(content)
        try:
            read_table(path)
        except ValueError as error:
            refusals.append(str(error))
    assert len(refusals) > DAMAGED / 2
    assert all("damaged.mat: it" in refusal for refusal in refusals)


def test_a_reader_that_dies_is_no_end_of_the_command(folder, monkeypatch):
    (folder / "dead.mat").write_bytes(SOUND)
    dying = folder / "dying.py"
    dying.write_text("import os; os.abort()")
    monkeypatch.setattr("quietarm.machine.tables.matlab._PROCESS", dying)
    with pytest.raises(ValueError, match=r"dead.mat: it is no whole .mat file .* status -6"):
        read_table(folder / "dead.mat")
    dying.write_text("import time; time.sleep(60)")
    monkeypatch.setattr("quietarm.machine.tables.matlab.LONGEST_READ", 0.1)
    with pytest.raises(ValueError, match=r"reading it takes more than 0.1 s"):
        read_table(folder / "dead.mat")


def test_a_sound_file_of_matlab_has_its_variables(folder):
    (folder / "sound.mat").write_bytes(SOUND)
    columns = {column.name: column.values for column in read_table(folder / "sound.mat").columns}
    assert [*columns] == ["t", "tip", "s.a"]
    assert columns["tip"] == pytest.approx(np.sin(np.arange(50.0)), abs=1e-15)
    assert columns["s.a"].tolist() == [1.0, 2.0]
