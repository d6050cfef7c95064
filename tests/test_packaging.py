"""What is shipped: versions, type information, pinned requirements, nothing of one machine."""

import re
import subprocess
import tomllib
from importlib import import_module, metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

from quietarm.models import __version__

ROOT = Path(__file__).parent.parent
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
PACKAGES = ["models", "ocp", "metaheuristics", "studies"]
PINS = (ROOT / "constraints.txt").read_text().splitlines()
REQUIREMENTS = {
    "runtime": PYPROJECT["project"]["dependencies"],
    **PYPROJECT["project"]["optional-dependencies"],
}


@pytest.fixture(scope="module")
def files():
    """Every file of the repository, those not yet committed among them."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        check=True,
    )
    found = [ROOT / name for name in listed.stdout.decode().split("\0") if name]
    return [path for path in found if path.is_file()]  # one that is removed but still listed


def test_one_version_everywhere():
    version_file = ROOT / PYPROJECT["tool"]["hatch"]["version"]["path"]
    (written,) = re.findall(r'^__version__ = "(.*)"$', version_file.read_text(), re.MULTILINE)
    assert PYPROJECT["project"]["dynamic"] == ["version"]
    assert written == __version__ == metadata.version("quietarm")
    assert str(Version(written)) == written


def test_the_changelog_begins_with_this_version():
    headings = re.findall(r"^## (\S+)", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert headings[0] == __version__


def test_the_wheel_holds_the_four_packages():
    assert PYPROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"] == PACKAGES
    top = {path.name for path in ROOT.iterdir() if (path / "__init__.py").is_file()}
    assert top == set(PACKAGES)


@pytest.mark.parametrize("package", PACKAGES)
def test_every_package_says_that_it_is_typed(package):
    installed = Path(import_module(package).__file__).parent
    for folder in (ROOT / package, installed):
        assert (folder / "py.typed").is_file()


def test_the_licence_is_mit_and_shipped():
    assert PYPROJECT["project"]["license"] == "MIT"
    assert (ROOT / "LICENSE").read_text().startswith("MIT License")
    assert metadata.metadata("quietarm")["License-Expression"] == "MIT"
    assert any(path.name == "LICENSE" for path in metadata.files("quietarm"))


def test_the_command_is_the_script_of_studies():
    (script,) = PYPROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]["shared-scripts"]
    (installed,) = (  # beside the one in the package
        path
        for path in metadata.files("quietarm")
        if path.name == "quietarm" and path.parent.name == "bin"
    )
    lines = (ROOT / script).read_text().splitlines()
    assert installed.locate().read_text().splitlines()[1:] == lines[1:]
    assert lines[0] == "#!python"  # pip puts its own Python there


@pytest.mark.parametrize("pin", PINS)
def test_constraints_are_a_name_and_a_version_each(pin):
    assert re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9._-]*==[0-9][A-Za-z0-9.]*", pin)


def test_nothing_is_pinned_twice():
    names = [canonicalize_name(pin.split("==")[0]) for pin in PINS]
    assert len(names) == len(set(names))


@pytest.mark.parametrize(
    ("where", "text"),
    [
        (where, text)
        for where, texts in REQUIREMENTS.items()
        for text in texts
        if Requirement(text).name != "quietarm"  # another extra of its own
    ],
)
def test_every_requirement_has_a_lower_bound_and_a_pin_that_meets_it(where, text):
    pinned = {canonicalize_name(pin.split("==")[0]): pin.split("==")[1] for pin in PINS}
    requirement = Requirement(text)
    assert [bound.operator for bound in requirement.specifier] == [">="]
    assert pinned[canonicalize_name(requirement.name)] in requirement.specifier


def test_the_runtime_requirements_are_few():
    names = {Requirement(text).name for text in REQUIREMENTS["runtime"]}
    # moocore, which pymoo brings, is imported for the hypervolume
    assert names == {
        "casadi",
        "daqp",
        "numpy",
        "matplotlib",
        "pymoo",
        "click",
        "rich",
        "moocore",
        "msgspec",
    }


def test_python_from_3_11_on():
    assert PYPROJECT["project"]["requires-python"] == ">=3.11"
    assert metadata.metadata("quietarm")["Requires-Python"] == ">=3.11"


# Put together here, so that this file is not the one that is found.
MACHINE = ["/" + name + "/" for name in ("root", "home", "work", "Users", "tmp", "private")]
MACHINE += ["C:" + "\\", "file:" + "//"]
UNSAFE = ["pickle." + "load", "cPickle", "joblib." + "load", "allow_pickle" + "=True"]


@pytest.mark.parametrize("word", [*MACHINE, *UNSAFE], ids=lambda word: word.strip("/"))
def test_no_file_holds_a_path_of_one_machine_or_loads_a_pickle(files, word):
    assert len(files) > 50  # the listing is there
    assert [
        str(path.relative_to(ROOT))
        for path in files
        if path != Path(__file__)
        # a test may make a file that must be refused
        and not (word in UNSAFE and path.is_relative_to(ROOT / "tests"))
        and word.encode() in path.read_bytes()
    ] == []


def test_this_file_holds_none_either():
    text = Path(__file__).read_text()
    assert [word for word in [*MACHINE, *UNSAFE[:1], *UNSAFE[2:]] if word in text] == []


def test_no_file_is_large(files):
    # A notebook with pictures is the largest thing that belongs here.
    assert [str(path) for path in files if path.stat().st_size > 700_000] == []
