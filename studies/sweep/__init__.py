"""Grids of moves: a certified plan a cell, in a Zarr store that a killed run goes on with."""
