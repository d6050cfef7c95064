"""The parts of recompute.py: the files, the measures, and a file for each group of figures."""
