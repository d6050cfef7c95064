"""Every method on a task, or on all of the paper's, in one page of HTML.

May import every room but `cli`, `contest` and `reproduction`.
"""
