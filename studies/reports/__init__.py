"""One answer on the screen and in files: a plan, a floor, a front, a comparison, robustness.

May import `figures`, `comparison`, `paper`, `registry` and `display`, and nothing else of `runs`.
"""
