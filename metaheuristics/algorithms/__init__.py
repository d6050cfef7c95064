"""The searches themselves: VEPSO, NSGA-II, and what is asked of an algorithm of the user's own.

It may import `objective` and `ocp`, and knows nothing of runs and checkpoints.
"""
