"""Numbers of films that are needed before a film is drawn."""

FRAMES = 25.0
"""Frames in a second."""
WIDTHS = 200, 2000
"""Least and largest width of a film [pixels]."""
