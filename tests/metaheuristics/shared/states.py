"""States of searches: one to keep, and whether two are the same."""

import numpy as np

HEADER = {"method": "nsga2", "seed": 3, "settings": {"bound": 0.5, "population": None}}


def state():
    generator = np.random.default_rng(7)
    generator.random(5)
    return {
        "algorithm": {
            "iteration": 12,
            "population": {
                "X": generator.random((4, 3)),
                "F": np.array([[np.inf, -np.inf], [np.nan, -0.0], [5e-324, 1.8e308]]),
                "rank": np.array([0, 1, 0]),
                "kept": np.array([True, False]),
                "none": np.empty((0, 2)),
                "scalar": np.array(2.5),
            },
            "random_state": generator.bit_generator.state,
        },
        "history": np.arange(3),
        "failed": 2,
        "seconds": 1.5,
        "text": "Grüße",
        "nothing": None,
        "empty": {},
    }


def same(a, b):
    """Whether two states are equal to the last bit, NaN included."""
    if isinstance(a, dict):
        return isinstance(b, dict) and a.keys() == b.keys() and all(same(a[k], b[k]) for k in a)
    if isinstance(a, np.ndarray):
        alike = isinstance(b, np.ndarray) and (a.dtype, a.shape) == (b.dtype, b.shape)
        return alike and a.tobytes() == b.tobytes()
    return type(a) is type(b) and a == b
