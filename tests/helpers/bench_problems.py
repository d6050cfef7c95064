"""Parts of a bench for its tests: a problem, two others, and methods."""

import numpy as np

NAME = "single-link-30deg-0.8s-2-terms"
OTHERS = ["arm-on-flexible-link-90deg-0.8s-2-terms", "single-link-30deg-0.8s-4-terms"]
METHODS = ["nsga2", "random", "nsga2+polish"]
SMALL = {"population": 20}


def called(function, seed, budget):
    """A method that is a function: random candidates. It stands here, where workers find it."""
    random = np.random.default_rng(seed)
    while True:
        function(random.uniform(function.lower, function.upper, (25, 2)))
