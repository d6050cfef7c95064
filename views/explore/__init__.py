"""The page to drag, alive: a move that is changed by hand, and the server that answers the page."""
