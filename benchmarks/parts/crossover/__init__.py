"""The experiment of `crossover.py`: problems, plan, packed runs, measures, statistics, page."""
