"""Methods with the same number of evaluations against the exact front of each problem.

Runs are files in a folder; whatever is measured, tested and drawn is worked out from these files
alone. May import every room but `cli`, `reproduction` and `study`.
"""
