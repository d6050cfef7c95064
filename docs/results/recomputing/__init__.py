"""The parts of recompute.py: the files, what is measured by, and a file for each group of figures."""
