"""What is shown and written: documents of blocks, on a terminal, as Markdown, as a page.

May import `display` and nothing else of `studies`.
"""
