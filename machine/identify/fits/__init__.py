"""Least squares of a plant's parameters to a recording or a part of it."""
