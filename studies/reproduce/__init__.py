"""The paper recomputed: its tables, figures and claims beside what it prints.

May import every room but `cli` and `bench`.
"""
