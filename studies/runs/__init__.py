"""Work that takes a while: run with progress, shown, and written to files.

May import `animation`, `figures`, `comparison`, `paper`, `registry` and `display`.
"""
