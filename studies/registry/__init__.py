"""What a user chooses by name: `methods` that find a front, and joint `profiles`.

May import no other room of `studies`.
"""
