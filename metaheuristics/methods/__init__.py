"""What a method is: one that is known by name, one of the gradient, one of the user's own.

It may import `algorithms`, `problems` and `evaluation`, and knows nothing of runs and jobs.
"""
