"""Fronts of one task measured against each other, in figures and tables.

May import `paper`, `registry` and `display`.
"""
