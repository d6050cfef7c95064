"""Moves in the forms that controllers and other programs read."""
