"""Types of numbers within a range, for entries of files: see `answers.documents.typed`."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

NotNegative = Annotated[float, Meta(ge=0)]
Positive = Annotated[float, Meta(gt=0)]
Share = Annotated[float, Meta(ge=0, le=1)]
Count = Annotated[int, Meta(ge=0)]
CountFromOne = Annotated[int, Meta(ge=1)]
