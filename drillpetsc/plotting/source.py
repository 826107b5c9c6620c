"""What a picture is drawn from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from drillpetsc.output.files.run_folder import RunFolder
from drillpetsc.output.files.tables import read_table
from drillpetsc.unit_systems import System, system_named

Table = dict[str, np.ndarray]


@dataclass(frozen=True)
class Source:
    """A run folder, and the units to show.

    units: None: the results'.
    """

    folder: RunFolder
    units: System | None = None

    @cached_property
    def summary(self) -> dict[str, Any]:
        """Contents of summary.json."""
        return self.folder.read_summary()

    @property
    def title(self) -> str:
        """Title of the case, or name of the folder."""
        return str(self.summary.get("title") or self.folder.path.name)

    @property
    def system(self) -> System:
        """Units of the axes."""
        return self.units or system_named(self.summary.get("units")) or "metric"

    def has(self, *files: str) -> bool:
        """Whether the folder has all of the files."""
        return all((self.folder.path / file).is_file() for file in files)

    def table(self, file: str) -> Table:
        """A table by the name of its file."""
        return read_table(self.folder.path / file)


Picture = Callable[[Source], Any]
Pictures = dict[str, tuple[tuple[str, ...], Picture]]
"""Functions that draw a folder that has some files, by the name of the picture; None if there is nothing to draw."""
