"""Many methods or moves in one command: study, contest, the paper recomputed.

May import every room of `studies` but those of the other commands.
"""
