"""`window`: pressures between which the open hole holds."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field, model_validator

from drillpetsc.case.block import Block
from drillpetsc.case.files.quantity_file import QuantityColumn, QuantityFile
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import Quantity, as_list, said


def _list(value: Any) -> Any:
    """One value as a list of one."""
    value = as_list(value)
    return value if isinstance(value, (list, tuple)) else [value]


_Density = Annotated[float, Quantity("kg/m^3", above=0, at_most=5e3, kind="mud_weight")]
Densities = Annotated[
    tuple[_Density, ...], BeforeValidator(_list, json_schema_input_type=_Density | tuple[_Density, ...])
]


class Window(Block):
    """Pressures between which the open hole holds, as equivalent densities: one pair, or a table over the depth."""

    tvd: tuple[Annotated[float, Quantity("m", at_least=0, at_most=50e3)], ...] | None = Field(
        default=None,
        description="vertical depths below the rotary table, rising; linear between them; "
        "when not given, pore and frac are one value each for all depths",
    )
    pore: Densities = Field(
        description="lower limit (pore pressure or stability) as the density of a column from the flow line"
    )
    frac: Densities = Field(
        description="upper limit (fracture or loss) as the density of a column from the flow line"
    )

    @model_validator(mode="after")
    def _rows(self) -> Window:
        count = 1 if self.tvd is None else len(self.tvd)
        if self.tvd is not None and count < 2:
            raise refuse(
                "tvd", got=f"{count} values", want="two depths or more", hint="leave tvd out for one pair"
            )
        for i in range(1, count):
            assert self.tvd is not None
            if self.tvd[i] <= self.tvd[i - 1]:
                want = f"rising depths: above {said(self.tvd[i - 1], 'length')}, the row before"
                raise refuse("tvd", i, got=self.tvd[i], want=want)
        for key in ("pore", "frac"):
            values = getattr(self, key)
            if len(values) != count:
                want = "one value without tvd" if self.tvd is None else f"{count} values, one for each tvd"
                raise refuse(key, got=f"{len(values)} values", want=want)
        for i, (low, high) in enumerate(zip(self.pore, self.frac, strict=True)):
            if high <= low:
                raise refuse("frac", i, got=high, want=f"above pore, {said(low, 'mud_weight')}")
        return self


#: a pressure window; a column without a unit has that of the bare numbers of the case
WINDOW_FILE = QuantityFile(
    {
        "tvd": QuantityColumn("m", ("tvd",), {}),
        "pore": QuantityColumn("kg/m^3", ("pore",), {}),
        "frac": QuantityColumn("kg/m^3", ("frac",), {}),
    },
    "tvd [ft], pore [ppg], frac [ppg]",
    "{pore: ..., frac: ...}, or {tvd: [...], pore: [...], frac: [...]}",
    bare=True,
)
