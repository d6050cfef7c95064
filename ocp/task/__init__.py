"""What is asked: a move of a plant, and the limits on it.

May import `base`.
"""
