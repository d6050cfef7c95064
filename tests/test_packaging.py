"""The shipped package: versions, type information, pinned requirements, nothing of one machine."""

import lzma
import subprocess
import sys
import tomllib
from importlib import import_module, metadata
from itertools import chain
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

import quietarm
from quietarm import __version__

ROOT = Path(__file__).parent.parent
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
PACKAGES = ["quietarm", "models", "ocp", "metaheuristics", "machine", "views", "studies"]
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


def test_what_is_installed_stands_under_one_name():
    tops = {path.parts[0] for path in metadata.files("quietarm")}
    ours = {top for top in tops if top != ".." and not top.endswith((".dist-info", ".pth"))}
    assert ours <= {"quietarm"}  # nothing where a checkout is installed to be edited
    wheel = PYPROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]
    assert wheel["only-include"] == PACKAGES
    assert {path.name for path in ROOT.iterdir() if (path / "__init__.py").is_file()} == set(
        PACKAGES
    )
    for package in PACKAGES[1:]:
        assert wheel["sources"][package] == f"quietarm/{package}"
        assert (
            Path(import_module(f"quietarm.{package}").__file__).parent / "__init__.py"
        ).is_file()


@pytest.mark.slow
def test_a_script_works_beside_files_of_the_packages_names(tmp_path):
    for name in PACKAGES[1:]:
        (tmp_path / f"{name}.py").write_text(f"mine = {name!r}\n")
    script = tmp_path / "script.py"
    script.write_text(
        "import models, ocp, studies\n"
        "import quietarm as qa\n"
        "task = qa.PointToPoint(qa.SingleLinkManipulator(), 0.5, 0.8)\n"
        "print(models.mine, ocp.mine, studies.mine, qa.plan_move(task).status.name)\n"
    )
    ran = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=120)
    assert (ran.stdout, ran.stderr) == ("models ocp studies OPTIMAL\n", "")


def test_quietarm_has_few_names_and_each_is_one_of_a_package():
    packages = ["models", "ocp", "metaheuristics", "machine", "views", "studies"]
    assert len({*dir(quietarm)} - {*packages}) <= 53
    rooms = [
        "views.pictures",
        "machine.identify",
        "machine.learn",
        "studies.compare",
        "studies.bench",
    ]
    homes = [*packages, *rooms, "studies.sweep"]
    public = [vars_of(f"quietarm.{home}") for home in homes]
    for name in {*dir(quietarm)} - {*packages}:
        value = getattr(quietarm, name)
        assert any(names.get(name) is value for names in public), name
    with pytest.raises(AttributeError, match="plan_mve"):
        quietarm.plan_mve  # noqa: B018


def vars_of(module_name: str) -> dict[str, object]:
    """The public names of a module, and what they are."""
    module = import_module(module_name)
    return {name: getattr(module, name) for name in dir(module)}


@pytest.mark.slow
def test_an_editor_finds_and_completes_names(tmp_path):
    """From a project of its own, by what is installed."""
    jedi = pytest.importorskip("jedi")
    environment = jedi.InterpreterEnvironment()
    project = jedi.Project(tmp_path)

    def script(source):
        return jedi.Script(source, environment=environment, project=project)

    source = "import quietarm as qa\nqa.plan_mo"
    completions = script(source).complete()
    assert "plan_move" in [completion.name for completion in completions]
    source = "import quietarm as qa\nqa.plan_move"
    (definition,) = script(source).goto(follow_imports=True, follow_builtin_imports=True)
    assert definition.full_name == "quietarm.ocp.planning.plan_move.plan_move"
    source = "from quietarm.ocp.limits import Lim"
    completions = script(source).complete()
    assert "Limit" in [completion.name for completion in completions]


def test_the_command_is_a_script_and_a_module():
    assert PYPROJECT["project"]["scripts"] == {"quietarm": "quietarm.__main__:main"}
    ran = subprocess.run(
        [sys.executable, "-m", "quietarm", "--version"], capture_output=True, text=True, timeout=60
    )
    assert ran.stdout == f"quietarm, version {__version__}\n"


def test_every_requirement_has_a_lower_bound_and_a_pin_that_meets_it():
    pinned = {canonicalize_name(pin.split("==")[0]): pin.split("==")[1] for pin in PINS}
    assert len(pinned) == len(PINS)
    for requirement in map(Requirement, chain.from_iterable(REQUIREMENTS.values())):
        if requirement.name != "quietarm":  # else another extra of its own
            assert [bound.operator for bound in requirement.specifier] == [">="]
            assert pinned[canonicalize_name(requirement.name)] in requirement.specifier


def test_the_recipe_for_conda_asks_for_what_the_wheel_asks_for():
    yaml = pytest.importorskip("yaml")
    recipe = yaml.safe_load((ROOT / "conda" / "recipe.yaml").read_text())
    asked = [Requirement(row.replace(" ", "")) for row in recipe["requirements"]["run"][1:]]
    of_the_wheel = [Requirement(row) for row in PYPROJECT["project"]["dependencies"]]
    renamed = {"matplotlib": "matplotlib-base"}  # without a toolkit of windows
    assert {(row.name, str(row.specifier)) for row in asked} == {
        (renamed.get(row.name, row.name), str(row.specifier)) for row in of_the_wheel
    }


@pytest.mark.parametrize(
    "name",
    [".github/workflows/publish.yml", ".github/workflows/site.yml", "conda/recipe.yaml"],
)
def test_a_file_that_was_never_run_says_so_in_its_first_line(name):
    assert (ROOT / name).read_text().startswith("# Not run so far")


# Put together here, so that this file is not the one that is found.
MACHINE = ["/" + name + "/" for name in ("root", "home", "work", "Users", "tmp", "private")]
MACHINE += ["C:" + "\\", "file:" + "//"]
UNSAFE = ["pickle." + "load", "cPickle", "joblib." + "load", "allow_pickle" + "=True"]


@pytest.mark.slow
def test_no_file_holds_a_path_of_one_machine_or_loads_a_pickle(files):
    assert len(files) > 50  # the listing is there
    for path in {*files} - {Path(__file__)}:
        if path.suffix in (".png", ".gif"):  # compressed, three bytes may be any
            continue
        content = path.read_bytes()
        if path.suffix == ".xz":
            content = lzma.decompress(content)
        # a test may make a file that must be refused
        words = MACHINE if path.is_relative_to(ROOT / "tests") else [*MACHINE, *UNSAFE]
        assert [word for word in words if word.encode() in content] == [], path
