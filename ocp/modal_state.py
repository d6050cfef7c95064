"""The modes at one time: how far the structure is bent, and how fast that changes."""

from __future__ import annotations

from dataclasses import dataclass

from quietarm.ocp.checks import finite


@dataclass(frozen=True)
class ModalState:
    """Modal amplitudes and their rates at one time.

    Parameters
    ----------
    W : sequence of float
        Amplitudes [m], one for each mode of the plant; a tip is displaced as the plant's
        `tip_displacements` say, by phi W on the single link.
    dW : sequence of float
        Their rates W' [m/s].

    Raises
    ------
    ValueError
        When a number is not finite, or there are not as many rates as amplitudes.
    """

    W: tuple[float, ...]
    dW: tuple[float, ...]

    def __post_init__(self) -> None:
        for name, unit in (("W", "m"), ("dW", "m/s")):
            given = enumerate(getattr(self, name), start=1)
            checked = tuple(finite(f"{name} of mode {i}", value, unit) for i, value in given)
            object.__setattr__(self, name, checked)
        if len(self.W) != len(self.dW):
            raise ValueError(
                f"the state has {len(self.W)} amplitudes and {len(self.dW)} rates; give one of "
                "each for every mode"
            )
