"""One answer on the screen and as a picture: a plan, a floor, a front.

May import `comparison`, `paper`, `methods` and `display`.
"""
