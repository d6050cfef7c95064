"""Methods: those known by name, those by the gradient, and the user's own.

It may import `algorithms`, `problems` and `evaluation`, and knows nothing of runs and jobs.
"""
