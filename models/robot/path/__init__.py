"""Paths of joints: polynomials of a place from 0 to 1, by waypoints, a function or a line.

It knows no equations of motion; of a robot it knows where its links stand.
"""
