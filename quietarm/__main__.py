"""`python -m quietarm` is the command."""

from quietarm.studies.cli import main

main()
