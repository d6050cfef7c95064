"""What the terminal shows and how files are written: words, tables, progress, saving.

May import no other room of `studies`.
"""
