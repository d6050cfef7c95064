"""A page on which a point is dragged along a front, and its motion is seen at once.

`moves` says what is on it, `samples` makes its numbers small, `page` writes it; the scripts and
styles beside them are put into the one file.
"""
