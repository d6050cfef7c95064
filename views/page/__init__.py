"""The page on which a move is seen and dragged: by itself in one file, or alive with a server.

`trade_off` makes the file: `page_moves` says what is on it, `page_words` what is said of it, and
`samples` makes its numbers small. `live_page` answers what `server` is asked by the same page with
sliders, for a move that is changed `by_hand`. The scripts and styles beside them are put into both.
"""
