"""Checkpoints: what goes in comes out, bit for bit."""

import struct

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from quietarm.metaheuristics.runs.checkpoint import load_checkpoint, save_checkpoint
from states import HEADER, same, state


def test_what_goes_in_comes_out_bit_for_bit(path):
    save_checkpoint(path, HEADER, state())
    header, found = load_checkpoint(path)
    assert header == HEADER
    assert same(found, state())


def test_the_generator_goes_on_with_the_same_numbers(path):
    # PCG64 keeps two integers of 128 bits.
    generator = np.random.default_rng(2**100)
    generator.random(7)
    kept = generator.bit_generator.state
    assert kept["state"]["state"] > 2**64
    save_checkpoint(path, {}, {"random_state": kept})
    other = np.random.default_rng()
    other.bit_generator.state = load_checkpoint(path)[1]["random_state"]
    assert np.array_equal(other.random(100), generator.random(100))


@pytest.mark.parametrize("value", [2**127 + 1, 2**128 - 1, -(2**127), 0])
def test_integers_of_128_bits(path, value):
    save_checkpoint(path, {}, {"state": value})
    assert load_checkpoint(path)[1] == {"state": value}


@pytest.mark.parametrize("value", [0.1, -0.0, 5e-324, 1.7976931348623157e308, float("inf")])
def test_floats_outside_arrays(path, value):
    save_checkpoint(path, {}, {"value": value})
    found = load_checkpoint(path)[1]["value"]
    assert struct.pack("<d", found) == struct.pack("<d", value)


def test_the_same_name_at_two_depths(path):
    given_state = {"X": np.zeros(2), "inner": {"X": np.ones(3), "more": {"X": np.arange(4)}}}
    save_checkpoint(path, {}, given_state)
    assert same(load_checkpoint(path)[1], given_state)


@pytest.mark.parametrize("name", ["header", "state", "file", "allow_pickle", "format"])
def test_any_name_may_be_that_of_an_array(path, name):
    save_checkpoint(path, HEADER, {name: np.arange(3)})
    header, found = load_checkpoint(path)
    assert header == HEADER
    assert same(found, {name: np.arange(3)})


def test_fortran_order_keeps_its_values(path):
    X = np.asfortranarray(np.arange(6.0).reshape(2, 3))
    save_checkpoint(path, {}, {"X": X, "view": X[:, ::2]})
    found = load_checkpoint(path)[1]
    assert np.array_equal(found["X"], X)
    assert np.array_equal(found["view"], X[:, ::2])


names = st.text("abcXYZ_", min_size=1, max_size=5)
leaves = st.one_of(
    st.integers(-(2**128), 2**128),
    st.floats(allow_nan=False),
    st.text(max_size=8),
    st.none(),
    st.booleans(),
    st.lists(st.integers(), max_size=3),
    arrays(np.float64, array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=3)),
    arrays(np.int64, array_shapes(max_side=3)),
)
states = st.dictionaries(
    names, st.recursive(leaves, lambda inner: st.dictionaries(names, inner, max_size=3)), max_size=4
)


@given(given_state=states)
@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_nested_state_comes_back(path, given_state):
    save_checkpoint(path, HEADER, given_state)
    header, found = load_checkpoint(path)
    assert header == HEADER
    assert same(found, given_state)


def test_nothing_is_pickled(path):
    with pytest.raises(ValueError, match=r"[Oo]bject"):
        save_checkpoint(path, {}, {"X": np.array([{"a": 1}, None], dtype=object)})
    assert not path.exists()


def test_a_file_that_was_there_is_kept_when_the_new_one_cannot_be_made(path, good):
    with pytest.raises(ValueError, match=r"[Oo]bject"):
        save_checkpoint(path, {}, {"X": np.array([None])})
    assert path.read_bytes() == good
    assert [entry.name for entry in path.parent.iterdir()] == [path.name]


def test_a_newer_state_replaces_the_file_whole(path, good):
    save_checkpoint(path, {"method": "vepso"}, {"iteration": 1})
    assert load_checkpoint(path) == ({"method": "vepso"}, {"iteration": 1})
    assert [entry.name for entry in path.parent.iterdir()] == [path.name]


def test_loading_leaves_the_file_as_it_was_and_may_be_repeated(path, good):
    path.chmod(0o400)
    first, second = load_checkpoint(path), load_checkpoint(path)
    assert same(first[1], second[1])
    assert path.read_bytes() == good


@pytest.mark.parametrize("name", ["missing/checkpoint", "."])
def test_a_place_that_cannot_be_written_is_named(tmp_path, name):
    with pytest.raises(ValueError, match="folder") as caught:
        save_checkpoint(tmp_path / name, {}, {})
    assert "\n" not in str(caught.value)
