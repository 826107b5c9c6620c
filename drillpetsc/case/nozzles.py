"""Nozzles of a bit as the trade writes them: `3 x 12/32 in`, `3x12`, `[12, 12, 12]`, `2 x 12 + 1 x 14`, `3 x 9.5 mm`."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

from drillpetsc.case.catalogue.sizes import INCH, size_at_start
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import Value, as_list, said, with_unit
from drillpetsc.units import to_si

WANT = "3 x 12/32 in, 3x12, [12, 12, 12], 2 x 12 + 1 x 14 or 3 x 9.5 mm; whole numbers from 6 to 40 are 32nds of an inch"
LARGEST = 2 * INCH  # [m]
SMALLEST = 1e-3  # [m]
MOST = 30  # nozzles of a bit

_SHARE = re.compile(r"\s*(?:(\d{1,4})\s*[xX*\u00d7]\s*)?(.+?)\s*")


@dataclass(frozen=True)
class Nozzles(Value):
    """Diameters of nozzles [m]; whole numbers from 6 to 40 are 32nds of an inch, other bare numbers have the unit of diameters."""

    unit: str = "m"
    kind: str = "diameter"

    def read(self, value: object) -> tuple[float, ...]:
        """Diameters [m], one a nozzle."""
        value = as_list(value)
        if isinstance(value, str):
            sizes = [d for share in value.split("+") for d in self._share(value, share)]
        elif isinstance(value, (list, tuple)) and value:
            sizes = [d for entry in value for d in self._entry(value, entry)]
        else:
            raise refuse(got=value, want=WANT)
        if len(sizes) > MOST:
            raise refuse(got=value, want=f"at most {MOST} nozzles")
        for diameter in sizes:
            if not SMALLEST <= diameter <= LARGEST:
                want = f"nozzles of {said(SMALLEST, 'diameter')} to {said(LARGEST, 'diameter')}; this is one of {said(diameter, 'diameter')}"
                raise refuse(got=value, want=want)
        return tuple(sizes)

    def _entry(self, whole: object, entry: object) -> list[float]:
        if isinstance(entry, str):
            return self._share(whole, entry)
        if getattr(entry, "dtype", None) is not None:
            entry = entry.item()  # type: ignore[attr-defined]  # a number of numpy
        if isinstance(entry, bool) or not isinstance(entry, (int, float)):
            raise refuse(got=whole, want=WANT)
        if float(entry).is_integer() and 6 <= entry <= 40:
            return [entry / 32 * INCH]
        if isinstance(entry, int):
            raise refuse(got=whole, want=WANT)
        return [to_si(with_unit(entry, self.unit, self.kind), self.unit)]

    def _share(self, whole: object, text: str) -> list[float]:
        match = _SHARE.fullmatch(text[:60])
        size = size_at_start(match[2]) if match else None
        if match is None or size is None or size[1].strip():
            raise refuse(got=whole, want=WANT)
        inches, bare = size[0], re.fullmatch(r"\d+", match[2])
        if bare:
            if not 6 <= int(match[2]) <= 40:
                raise refuse(got=whole, want=WANT)
            inches = int(match[2]) / 32
        elif re.fullmatch(r"\d+\.\d*", match[2]):
            raise refuse(got=whole, want=WANT, hint="a size that is not in 32nds needs a unit, in or mm")
        count = int(match[1] or 1)
        if not 0 < count <= MOST:
            raise refuse(got=whole, want=f"1 to {MOST} nozzles")
        return [inches * INCH] * count

    def json(self) -> dict[str, Any]:
        one = {"anyOf": [{"type": "number"}, {"type": "string"}]}
        return {"anyOf": [{"type": "string"}, {"type": "array", "items": one, "minItems": 1}]}
