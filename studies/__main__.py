"""`python -m studies` is `quietarm`."""

from studies.cli import main

main()
