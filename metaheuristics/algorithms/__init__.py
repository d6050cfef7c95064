"""The searches themselves: VEPSO, NSGA-II, and what is mended of pymoo's.

It may import `evaluation`, `problems` and `ocp`, and knows nothing of names, runs and checkpoints.
"""
