"""The parts of recompute.py.

`runs` reads the files, `areas` and `gaps` measure a front, `significance` and `comparing` hold
methods against each other on many problems. Each of the other files has a group of figures, but
`published`, which compares them with what is printed. `experiment` has what they share.
"""
