"""`python -m quietarm` is `quietarm`."""

from quietarm.studies.cli import main

main()
