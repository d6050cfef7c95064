"""A robot whose joints are held while it rings down: its springs, its damping and its load."""
