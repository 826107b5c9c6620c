"""Stabilizers: gauge, mass, and a body that bends beside the blades."""

from __future__ import annotations

import re
from typing import Any

from drillpetsc.case.block import overlaid
from drillpetsc.case.blocks.items.reamer import Reamer
from drillpetsc.case.blocks.items.string import Bit, Item, Pipe, Stabilizer
from drillpetsc.case.catalogue.sizes import INCH, size_at_start
from drillpetsc.case.pipe.completion import Completion
from drillpetsc.case.pipe.section import BLADE_METAL, ring, stabilizer_metal
from drillpetsc.case.pipe.weighed import with_weight
from drillpetsc.case.quantities import said

BLADE_OVER_BIT = INCH / 16  # [m]


class StabilizerCompletion(Completion):
    """Completes a stabilizer; one whose body bends becomes up to three items."""

    def items(self) -> list[Item]:
        item = self.item
        assert isinstance(item, Stabilizer)
        self.nozzles(item)
        if item.gauge is not None:
            self._gauge(item)
        outer, bit = self.value("od"), self.case.string[-1]
        asked = item.gauge is not None or item.body_od is not None or item.blade_length is not None
        if (
            asked
            and isinstance(bit, Bit)
            and not isinstance(item, Reamer)
            and outer > bit.od + BLADE_OVER_BIT + 1e-9
        ):
            units = self.case.said_units
            want = f"at most 1/16 in above the bit, {said(bit.od + BLADE_OVER_BIT, 'diameter', units)}"
            key = "blade_od" if "blade_od" in item.model_fields_set else "od"
            raise self.refuse(key, got=said(outer, "diameter", units), want=want)
        if item.body_od is not None and item.body_od > outer:
            raise self.refuse(
                "body_od",
                got=item.body_od,
                want=f"at most the diameter of the blades, {said(outer, 'diameter')}",
            )
        if item.id >= outer:
            raise self.refuse("id", got=item.id, want=f"below the outer diameter, {said(outer, 'diameter')}")
        if not item.stiff:
            return self._bending_stabilizer(item, outer)
        if item.weight is not None:
            whole = item.model_copy(update={"od": outer})
            self.values |= with_weight(whole, self.case.material, self.refuse)
            self.note_density()
        if item.body_od is not None and self.value("mass") is None:
            density = overlaid(self.case.material, item.material).density
            mass = density * stabilizer_metal(item, outer)
            text = f"body and blades that fill {BLADE_METAL:.0%} of their ring, times density"
            self.default("mass", mass, "kg", text)
        return self.completed()

    def _gauge(self, item: Stabilizer) -> None:
        """Blade diameter relative to the bit."""
        bit = self.case.string[-1]
        words = re.fullmatch(r"\s*(.*?)\s*(under|full)(?:\s*gauge)?\s*", item.gauge or "", re.IGNORECASE)
        want = "full, or a size under gauge, such as 1/8 in under"
        if words is None:
            raise self.refuse("gauge", got=item.gauge, want=want)
        under = 0.0
        if words[2].lower() == "under":
            size = size_at_start(words[1])
            if size is None or size[1].strip() or size[0] > 2:
                raise self.refuse("gauge", got=item.gauge, want=want)
            under = size[0] * INCH
        elif words[1]:
            raise self.refuse("gauge", got=item.gauge, want=want)
        if not isinstance(bit, Bit):
            raise self.refuse("gauge", got=item.gauge, want="od with a string without a bit")
        self.values |= {"od": bit.od - under, "gauge": None}
        self.note("od", bit.od - under, "m", f"diameter of the bit, {item.gauge}")

    def _bending_stabilizer(self, item: Stabilizer, outer: float) -> list[Item]:
        """Pipe above and below the blades, and rigid blades."""
        assert item.body_od is not None and item.blade_length is not None
        for key in ("bore_volume", "annulus_od"):
            if getattr(item, key) is not None:
                raise self.refuse(key, got=getattr(item, key), want=f"no {key} with stiff: false")
        key = next((key for key in ("mass", "weight", "unbalance") if getattr(item, key)), "")
        if key:
            raise self.refuse(key, got=getattr(item, key), want=f"no {key} with stiff: false")
        density = overlaid(self.case.material, item.material).density
        above = item.touching[0]
        below = item.length - above - item.blade_length
        mass = density * (ring(item.body_od, item.id)[0] + BLADE_METAL * ring(outer, item.body_od)[0])
        self.note("mass", mass * item.blade_length, "kg", "blades and the body inside them, times density")
        parts: list[Item] = []
        common: dict[str, Any] = {"id": item.id, "friction": item.friction}
        bend = item.bend
        for length in (above, None, below):
            if length is None:
                parts.append(
                    item.model_copy(
                        update=self.values
                        | {
                            "od": outer,
                            "length": item.blade_length,
                            "mass": mass * item.blade_length,
                            "stiff": True,
                            "blade_position": 0.5 * item.blade_length,
                            "center_of_gravity": (0.5 * item.blade_length, 0.0, 0.0),
                            "bend": None if bend is None else bend.model_copy(update={"position": None}),
                        }
                    )
                )
            elif length > 1e-3:
                parts.append(
                    Pipe(
                        kind="pipe",
                        name=f"{item.name} body",
                        length=length,
                        od=item.body_od,
                        element_length=max(length, 1e-3),
                        **common,
                    ).model_copy(
                        update={
                            "material": item.material,
                            "bend": None if bend is None else bend.model_copy(update={"position": None}),
                        }
                    )
                )
            else:
                continue
            bend = None
        return parts
