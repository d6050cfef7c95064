"""Files are claims: what one states is held against the plant before it counts."""

import json
import math
from pathlib import Path

import pytest
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, PointToPoint, epsilon_front


@pytest.fixture(scope="module")
def found():
    """A front of the plant, whose figures are its own."""
    task = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8, torque_limit=0.5)
    return epsilon_front(task, CycloidPolynomial(2), bound=0.3, points=4, starts=1)


@pytest.fixture(autouse=True)
def folder(folder, monkeypatch, found):
    monkeypatch.setenv("COLUMNS", "1000")
    found.save("f.json")
    return folder


READS = ["polish f.json --output out.json", "compare f.json f.json --no-floor --output out"]


def one_doubled(document):
    document["points"][1]["energy"] /= 1.01


def enormous(document):
    document["settings"]["bound"] = None
    for point in document["points"]:
        point["coefficients"] = [1e308, 1e308]


def beyond_the_bound(document):
    document["settings"]["bound"] = 0.01


def beyond_a_limit(document):
    document["task"]["torque_limit"] = 0.05


CLAIMS = {
    one_doubled: "point 2 of 4 states energy 0.",
    enormous: "its coefficients give no finite figure",
    beyond_the_bound: "beyond the stated bound of 0.01",
    beyond_a_limit: "breaks the torque limit of 0.05 N m",
}


@pytest.mark.parametrize("line", READS)
@pytest.mark.parametrize(("change", "words"), CLAIMS.items())
def test_a_front_that_its_plant_does_not_bear_out_is_refused(call, folder, line, change, words):
    document = json.loads(Path("f.json").read_text())
    change(document)
    Path("f.json").write_text(json.dumps(document))
    code, out, err = call(line)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert err.startswith("quietarm: f.json: ")
    assert words in err
    assert not list(folder.glob("out*"))


# Lines given to the command one after another; the statuses with which they end.
