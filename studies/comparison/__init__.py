"""Fronts of one task measured against each other, in tables and pictures.

May import `paper`, `methods` and `display`.
"""
