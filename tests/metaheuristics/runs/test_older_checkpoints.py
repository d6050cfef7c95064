"""Checkpoints of older versions: the search that they are of still goes on."""

import math
import shutil
from pathlib import Path

import pytest

from metaheuristics import search
from metaheuristics.runs import keeping
from metaheuristics.runs.checkpoint import load_checkpoint
from models import SingleLinkManipulator
from ocp import CycloidPolynomial, PointToPoint
from ocp.answers.encoding import typed

FOLDER = Path(__file__).parents[2] / "older_files"  # its README says how they were written
LINK = PointToPoint(
    SingleLinkManipulator(omega=20.0), math.pi / 6, 0.8, start=-0.1, deflection_limit=0.5
)


def _search(method, **options):
    asked = {"profile": CycloidPolynomial(2), "bound": 0.2, "population": 8, "generations": 6}
    return search(LINK, method, **asked, seed=2, **options)


@pytest.mark.parametrize("method", ["nsga2", "vepso"])
def test_a_search_goes_on_from_a_checkpoint_of_version_1(monkeypatch, tmp_path, method):
    path = tmp_path / "checkpoint"
    shutil.copy(FOLDER / f"{method}.checkpoint", path)
    header, state = load_checkpoint(path)
    # written with other versions of casadi, NumPy and pymoo, perhaps: here they count as the same
    monkeypatch.setattr(keeping, "search_versions", lambda: header["versions"])
    seen = []
    front = _search(method, resume=path, checkpoint=path, report=seen.append)
    assert front.complete
    assert [progress.generation for progress in seen] == [4, 5, 6]
    assert [entry.evaluations for entry in front.history[:3]] == state["evaluations"].tolist()
    assert [entry.hypervolume for entry in front.history[:3]] == state["hypervolume"].tolist()
    again = load_checkpoint(path)[0]  # written in the shape of today
    assert typed(again, keeping.Header) == typed(header, keeping.Header)


@pytest.mark.parametrize("method", ["nsga2", "vepso"])
def test_it_is_of_that_search_alone(tmp_path, method):
    path = FOLDER / f"{method}.checkpoint"
    with pytest.raises(ValueError, match=r"of another search: its duration is 0\.8, not 0\.9"):
        search(PointToPoint(LINK.plant, LINK.target, 0.9, LINK.start, deflection_limit=0.5),
               method, profile=CycloidPolynomial(2), bound=0.2, population=8, generations=6,
               seed=2, resume=path)  # fmt: skip
