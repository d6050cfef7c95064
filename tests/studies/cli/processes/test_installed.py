"""The installed command, as a process."""

from lines import MOVE, run
from quietarm.ocp import Front


def test_its_workers_share_the_runs(folder):
    # each worker starts by running the file of the command
    search = f"front {MOVE} --bound 0.2 --method nsga2 --population 8 --generations 2 --quiet"
    ran = run(f"{search} --runs 2 --workers 2 --output f.json")
    assert (ran.returncode, ran.stderr) == (0, "")
    assert all(Front.load(f"f-seed{seed}.json").complete for seed in range(2))
