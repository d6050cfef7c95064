"""A profile's subclass without a name of its own is not taken for its parent."""

import math
from dataclasses import dataclass, replace

import pytest
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, Plan, PointToPoint, evaluate_coefficients
from quietarm.ocp.profiles.joint_profile import known_profiles


@dataclass(frozen=True)
class Unnamed(CycloidPolynomial):
    """As its parent, but for its name: none."""


def test_the_parent_keeps_its_name():
    assert known_profiles()[CycloidPolynomial.name] is CycloidPolynomial


def test_its_plans_are_not_saved_as_the_parents(tmp_path):
    task = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8)
    plan = evaluate_coefficients(task, [0.01, -0.1])
    path = tmp_path / "plan.json"
    with pytest.raises(ValueError, match="Unnamed has no name of its own"):
        replace(plan, profile=Unnamed(2)).save(path)
    assert not path.exists()
    plan.save(path)
    assert Plan.load(path) == plan
