"""What the tests of a bench run: a problem, two others, and methods."""

NAME = "single-link-30deg-0.8s-2-terms"
OTHERS = ["arm-on-flexible-link-90deg-0.8s-2-terms", "single-link-30deg-0.8s-4-terms"]
METHODS = ["nsga2", "random", "nsga2+polish"]
SMALL = {"population": 20}
