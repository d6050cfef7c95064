"""Files of floors."""

import json
from dataclasses import replace

import pytest
from floor_moves import ARM, SHORT
from quietarm.ocp import (
    FileFormatError,
    Floor,
)

# -- files --


def test_a_saved_floor_is_equal(coarse_of, tmp_path):
    floor = coarse_of(replace(ARM, acceleration_limit=200.0), **SHORT)
    floor.save(tmp_path / "floor.json")
    again = Floor.load(tmp_path / "floor.json")
    assert again == floor
    assert again.left == floor.left
    assert again.trajectory.torque == pytest.approx(floor.trajectory.torque, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    "damage",
    [
        lambda d: d.pop("motion"),
        lambda d: d["free"].pop("jerk"),
        lambda d: d["free"]["times"].pop(),
        lambda d: d["free"].update(times="0, 1"),
        lambda d: d["free"]["times"].__setitem__(1, "0.1"),
        lambda d: d.update(levels=d["levels"][:1]),
        lambda d: d["levels"][0].update(energy="0.1"),
        lambda d: d.update(starts=[]),
        lambda d: d["task"].update(duration=0.9),
        lambda d: d.update(status="fine"),
        lambda d: d["provenance"]["settings"].pop("smooth"),
        lambda d: d["provenance"]["settings"].pop("tolerance"),
        lambda d: d.update(format="quietarm-plan"),
        lambda d: d.update(version=99),
    ],
)
def test_a_damaged_file_is_refused(coarse_of, tmp_path, damage):
    path = tmp_path / "floor.json"
    coarse_of(ARM, **SHORT).save(path)
    document = json.loads(path.read_text())
    damage(document)
    path.write_text(json.dumps(document))
    with pytest.raises(FileFormatError, match=r"floor\.json"):
        Floor.load(path)
