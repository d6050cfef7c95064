"""The paper recomputed: its tables, its claims, and the floor, beside what it prints.

May import every room but `cli`, `contest` and `study`.
"""
