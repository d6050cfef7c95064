"""The dataset of a sweep, laid out first and then written chunk by chunk, as Zarr for xarray."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp import FileFormatError, SolveSettings, SolveStatus
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import versions
from quietarm.ocp.saved import plain
from quietarm.studies.sweep.grid import Grid

if TYPE_CHECKING:
    import zarr

Array = NDArray[np.float64]
STATUS = "status"
STATES = ("not computed", *(status.value for status in SolveStatus))
"""What `status` says, by its number."""
FIGURES = {
    "energy": "J", "residual": "m", "peak_torque": "N m", "peak_speed": "rad/s",
    "peak_acceleration": "rad/s^2", "peak_deflection": "m", "iterations": "1",
}  # fmt: skip
"""Variables of one number a cell, with their units."""


def asked(grid: Grid, profile: JointProfile, settings: SolveSettings) -> dict[str, Any]:
    """What makes two sweeps the same."""
    return {
        "task": plain(grid.task), "profile": plain(profile), "settings": plain(settings),
        "axes": {axis.name: list(axis.values) for axis in grid.axes},
    }  # fmt: skip


class Store:
    """The Zarr store of a sweep.

    Parameters
    ----------
    path : Path
        Its folder; made where there is none.
    grid, profile, settings
        What is swept.

    Raises
    ------
    FileFormatError
        When the folder is something else, or the dataset of another sweep; says what differs.
    """

    def __init__(
        self, path: Path, grid: Grid, profile: JointProfile, settings: SolveSettings
    ) -> None:
        self.path, self.grid = path, grid
        wanted = asked(grid, profile, settings)
        if not path.exists():
            self._lay_out(wanted, profile)
        group = opened(path)
        _check_same(path, json.loads(str(group.attrs["asked"])), wanted)
        self._arrays: Any = {name: group[name] for name in (*FIGURES, "coefficients", STATUS)}

    def _lay_out(self, wanted: Mapping[str, Any], profile: JointProfile) -> None:
        """Make it whole or not at all, also where two begin at once."""
        import zarr

        with tempfile.TemporaryDirectory(dir=self.path.parent, prefix=".sweep-") as folder:
            place = Path(folder) / "store"
            attributes = {"format": "quietarm-sweep", "versions": versions()}
            group = zarr.create_group(place, attributes={**attributes, "asked": json.dumps(wanted)})
            dims = [axis.name for axis in self.grid.axes]

            def make(name: str, unit: str, size: int, kind: str, empty: float, **more: Any) -> None:
                shape, chunks = self.grid.shape, self.grid.chunk
                own = {"units": unit, **more}
                group.create_array(
                    name, shape=(*shape, size) if size else shape, dtype=kind, fill_value=empty,
                    chunks=(*chunks, size) if size else chunks, attributes=own,
                    dimension_names=[*dims, "coefficient"] if size else dims,
                )  # fmt: skip

            for axis in self.grid.axes:
                group.create_array(
                    axis.name, data=np.array(axis.values), dimension_names=[axis.name],
                    attributes={"units": axis.unit},
                )  # fmt: skip
            for name, unit in FIGURES.items():
                make(name, unit, 0, "float64", np.nan)
            make("coefficients", "1", profile.size, "float64", np.nan)
            meanings = " ".join(state.replace(" ", "_") for state in STATES)
            make(
                STATUS, "1", 0, "int8", 0, flag_values=[*range(len(STATES))], flag_meanings=meanings
            )
            with suppress(OSError):  # another process was first
                os.rename(place, self.path)

    def missing(self, part: tuple[int, int]) -> list[int]:
        """The chunks of a part, i of n, that are not computed."""
        number, of = part
        status = self._arrays[STATUS][...]
        return [
            k for k, chunk in enumerate(self.grid.chunks)
            if k % of == number - 1 and (status[chunk] == 0).any()
        ]  # fmt: skip

    def keep(self, number: int, found: Mapping[str, Array]) -> None:
        """Write a chunk; its status last, so that a killed run computes it again."""
        chunk = self.grid.chunks[number]
        shape = tuple(cut.stop - cut.start for cut in chunk)
        for name in (*FIGURES, "coefficients", STATUS):
            values = found[name]
            self._arrays[name][chunk] = values.reshape(*shape, *values.shape[1:])

    def read(self, name: str) -> Array:
        """All of a variable."""
        return np.asarray(self._arrays[name][...])


def opened(path: Path) -> zarr.Group:
    """The Zarr group of a sweep; FileFormatError where it is none."""
    import zarr

    try:
        group = zarr.open_group(path, mode="r+")
        known = group.attrs.get("format") == "quietarm-sweep"
    except Exception as error:  # whatever zarr makes of another folder
        raise FileFormatError(
            f"{path} is no dataset of a sweep ({type(error).__name__}); give another name"
        ) from None
    if not known:
        raise FileFormatError(f"{path} is no dataset of a sweep; give another name")
    return group


def _check_same(path: Path, there: Mapping[str, Any], wanted: Mapping[str, Any]) -> None:
    wanted = json.loads(json.dumps(wanted))
    for entry in wanted:
        mine, its = wanted[entry], there.get(entry)
        if mine != its:
            names = [n for n in {**mine, **(its or {})} if mine.get(n) != (its or {}).get(n)]
            raise FileFormatError(
                f"{path} is of another sweep: {entry} differ in {', '.join(names)}; give the line "
                "of that sweep, or another name"
            )
