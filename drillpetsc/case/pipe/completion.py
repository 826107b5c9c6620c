"""Completes one item of the string: figures that a case leaves out, each with its source."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.items.string import Bit, Item, Stabilizer
from drillpetsc.case.catalogue.reference import ReferenceProblem
from drillpetsc.case.catalogue.tables import Catalogue
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.pipe.figures import Figure
from drillpetsc.case.pipe.weighed import with_weight


class Completion:
    """Completes an item of any kind.

    values: keys to be set; figures: what was added, with sources.
    """

    def __init__(self, number: int, item: Item, case: CaseBlocks, catalogue: Catalogue) -> None:
        self.number, self.item, self.case, self.catalogue = number, item, case, catalogue
        self.values: dict[str, Any] = {}
        self.figures: list[Figure] = []

    # ------------------------------------------------------------------ helpers
    def refuse(self, *key: str, got: Any = None, want: str, hint: str = "") -> Exception:
        return refuse("string", self.number, *key, got=got, want=want, hint=hint)

    def value(self, key: str) -> Any:
        """Value of a key: given, or set already."""
        return self.values.get(key, getattr(self.item, key))

    def note(self, key: str, value: Any, unit: str, source: str) -> None:
        self.figures.append(Figure(key, value, unit, source))

    def default(self, key: str, value: Any, unit: str, source: str) -> None:
        """Set a key that is not given."""
        if self.value(key) is None:
            self.values[key] = value
            self.note(key, value, unit, source)

    def looked_up(self, key: str, find: Callable[[], Any], got: Any) -> Any:
        try:
            return find()
        except ReferenceProblem as problem:
            raise self.refuse(key, got=got, want=problem.want, hint=problem.hint) from None

    # ------------------------------------------------------------------ any kind
    def items(self) -> list[Item]:
        """The item with all its figures; several where it becomes more than one."""
        if isinstance(self.item, Bit):
            self.nozzles(self.item)
        if self.item.weight is not None:
            self.values |= with_weight(self.item, self.case.material, self.refuse)
            self.note_density()
        return self.completed()

    def completed(self) -> list[Item]:
        """The item with the values that were set."""
        return [self.item.model_copy(update=self.values)] if self.values else [self.item]

    def nozzles(self, item: Stabilizer | Bit) -> None:
        """Note the area of nozzles that are given by their sizes."""
        if item.nozzles is not None and "nozzle_area" not in item.model_fields_set:
            text = f"sum of pi d^2/4 of {len(item.nozzles)} nozzles"
            self.note("nozzle_area", float(item.nozzle_area or 0.0), "m^2", text)

    def note_density(self) -> None:
        material = self.values.get("material")
        if material is not None:
            self.note("material.density", material.density, "kg/m^3", "weight over the ring of od and id")
