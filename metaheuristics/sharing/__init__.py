"""Pieces of work: one after another in this process, or shared by the workers of dask.

`running` runs them; `cluster` and `worker` are the two ends of dask, which is loaded only where
workers are asked for. May import `ocp` and the rooms below.
"""
