"""Work that takes a while: run with progress, shown, and written to files.

May import `reports`, `comparison`, `paper`, `methods` and `display`.
"""
