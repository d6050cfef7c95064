"""How anything is shown: tables, progress, pictures and pages, whatever they hold.

May import no other room of `studies`.
"""
