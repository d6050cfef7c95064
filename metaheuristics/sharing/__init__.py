"""Pieces of work: one after another in this process, or shared by workers.

`running` runs them. The workers are `processes` of this machine, or those of a `scheduler` of dask,
which is loaded only for these. May import `ocp` and the rooms below.
"""
