"""A search of exactly so many evaluations, with a record of what it had found on the way.

Alone or together with the gradient, whose work counts against the same budget. May import `runs`
and the rooms below.
"""
