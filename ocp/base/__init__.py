"""What everything else stands on: checks, errors, files, Ctrl-C, processes, how a solve ended.

Knows nothing of moves. May import no other room.
"""
