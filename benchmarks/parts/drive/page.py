"""The tables of docs/drive.md, from the runs in the csv."""
from pathlib import Path
ROOT = Path(__file__).parents[3]
RESULTS = ROOT / "benchmarks" / "results" / "real_drive.csv"
def write():
    pass
