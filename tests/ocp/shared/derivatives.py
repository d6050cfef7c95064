"""Derivatives that a program assembles by hand, against casadi's own and against differences."""
