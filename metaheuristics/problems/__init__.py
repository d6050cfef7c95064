"""Moves as problems for any optimiser, and a catalogue of named ones with their reference fronts.

It may import `evaluation` and `ocp`, and knows nothing of algorithms and runs.
"""
