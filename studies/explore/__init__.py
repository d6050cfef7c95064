"""A page in the browser on which a move is changed by hand: what it shows, and its widgets."""
