"""`kind: reamer`: blades above the bit that widen the hole."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from drillpetsc.case.blocks.items.string import Diameter, Stabilizer
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import Quantity


class Reamer(Stabilizer):
    """A reamer: its blades cut the ring around the pilot hole of the bit, and touch the reamed hole above."""

    kind: Literal["reamer"] = Field(description="reamer")  # type: ignore[assignment]
    pilot: Diameter | None = Field(
        default=None, description="diameter of the pilot hole; the bit's diameter, which is also the default"
    )
    blades: int = Field(default=4, ge=1, le=20, strict=True, description="number of blades")
    specific_energy: Annotated[float, Quantity("Pa", above=0)] = Field(
        default=60e6,
        description="intrinsic specific energy: work of cutting per volume of rock, 1 J/m3 = 1 Pa",
    )
    inclination_ratio: Annotated[float, Quantity("", above=0, at_most=10)] = Field(
        default=0.6, description="vertical over horizontal force of a cutter"
    )

    @model_validator(mode="after")
    def _rigid_and_wide(self) -> Reamer:
        if not self.stiff:
            raise refuse("stiff", got=False, want="true: a reamer is a rigid item")
        if self.gauge is not None:
            raise refuse("gauge", got=self.gauge, want="od: a reamer is wider than the bit")
        return self
