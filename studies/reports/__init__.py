"""One answer on the screen and in files: a plan, a floor, a front, a comparison, robustness.

May import `figures`, `comparison`, `reading`, `sweep`, `paper`, `document` and `display`.
"""
