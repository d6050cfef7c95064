"""`python -m quietarm` is the command."""

from quietarm.studies.cli import main

if __name__ == "__main__":  # not in the workers of a search
    main()
