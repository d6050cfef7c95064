"""The registry of methods: one value for each, found by the name that a front states."""

import math

import pytest
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, PointToPoint, polish_front
from quietarm.studies.registry.methods import (
    Kind,
    method_of,
    methods_of,
)


@pytest.mark.parametrize("method", methods_of(Kind.GRADIENT), ids=lambda method: method.name)
def test_a_gradients_front_and_its_polished_one_name_their_method(method):
    task = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8)
    front = method.sweep(task, CycloidPolynomial(2), bound=0.2, points=2, starts=1)
    assert method_of(front.record.method) == method
    assert method_of(polish_front(front).front.record.method) == method.then_polished()
