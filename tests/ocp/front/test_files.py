"""The files of fronts: what comes back, and what is refused."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_fronts import front, points
from quietarm.models import ArmOnFlexibleLink
from quietarm.ocp import (
    CycloidPolynomial,
    FileFormatError,
    Front,
    Generation,
    PointToPoint,
    non_dominated,
    plan_move,
)
from quietarm.ocp.answers.documents import plain

# -- files --

figures = st.floats(min_value=-0.0, allow_infinity=False)  # residuals and energies


@given(
    st.lists(st.tuples(figures, figures), max_size=6),
    st.integers(0, 2**63),
    st.floats(0, 1),
    st.booleans(),
)
def test_a_front_comes_back_as_it_was(tmp_path_factory, figures, seed, share, complete):
    path = tmp_path_factory.mktemp("front") / "front.json"
    one = front(
        non_dominated(points(*figures)),
        seed=seed,
        complete=complete,
        history=(Generation(20, share),),
    )
    one.save(path)
    loaded = Front.load(path)
    assert loaded == one
    assert loaded.seconds == one.seconds
    assert json.dumps(plain(loaded)) == json.dumps(plain(one))  # -0.0, too


# -- files that are refused --


def refused(path, match):
    """Refused in one line that names the file, which stays as it was."""
    before = path.read_bytes() if path.is_file() else None
    with pytest.raises(FileFormatError, match=match) as caught:
        Front.load(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert before == (path.read_bytes() if path.is_file() else None)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "front.json"


def test_a_plan_is_not_a_front(path):
    task = PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8)
    plan_move(task, CycloidPolynomial(2), starts=1).save(path)
    refused(path, "quietarm-plan")
