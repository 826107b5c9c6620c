"""Items whose weight in air is given as weighed, instead of density times area.

The metal fills the ring between outer and inner diameter, so that mud displaces the ring: the density of the item
follows from its weight (manual: sec-tubulars-weighed).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from drillpetsc.case.block import overlaid
from drillpetsc.case.blocks.items.string import Beam, Bit, Item, Material, Rigid, Stabilizer, Tube
from drillpetsc.case.catalogue.formulas import POSSIBLE, STEEL, USUAL
from drillpetsc.case.pipe.section import ring, stabilizer_metal
from drillpetsc.case.quantities import said

STIFF = 150e9  # Young's modulus [Pa] of which only steel is


def checked_weight(
    weight: float, steel: float, length: float, refuse: Callable[..., Exception], bit: bool = False
) -> None:
    """Refuse a weight that no item of this size has, with the likely slip.

    weight: as given; steel: of a steel tube of this size [kg/m]; length: of the item [m]
    bit: of which `steel` is the weight of a cylinder around it, so that any lower weight is possible
    """
    ratio = weight / steel
    if (bit or ratio >= POSSIBLE[0]) and ratio <= POSSIBLE[1]:
        return
    slip = "is the unit right?"
    if length > 0 and USUAL[0] <= ratio / length <= USUAL[1]:
        slip = "is this the weight of the whole item? The key is per length"
    raise refuse(
        "weight",
        got=said(weight, "weight_per_length"),
        want=f"a weight per length, {POSSIBLE[0]:g} to {POSSIBLE[1]:g} times the weight of a steel tube of this size, "
        f"{said(steel, 'weight_per_length', digits=4)}",
        hint=slip,
    )


def with_weight(item: Item, base: Material, refuse: Callable[..., Exception]) -> dict[str, Any]:
    """Values of keys that follow from the weight of an item without tool joints, whose diameters are complete.

    base: material of the case. Raises for a weight beside another key that sets the mass.
    """
    weight = item.weight
    assert weight is not None
    own: Material | None = item.material
    if getattr(item, "mass", None) is not None:
        raise refuse("weight", want="weight per length or mass, not both")
    if own is not None and "density" in own.model_fields_set:
        raise refuse("weight", want="weight or material.density, not both")
    if isinstance(item, Beam):
        return {"mass": weight, "weight": None}
    values: dict[str, Any] = {"weight": None}
    area = ring(item.od, item.id)[0] if item.od is not None else 0.0
    if isinstance(item, Rigid):
        if not item.length > 0:
            raise refuse("weight", want="a length of the item above 0; or its mass")
        values["mass"] = weight * item.length
        if isinstance(item, Stabilizer):
            assert item.od is not None
            area = stabilizer_metal(item, item.od) / item.length
    if area:
        checked_weight(weight, STEEL * area, item.length, refuse, isinstance(item, Bit))
        if not isinstance(item, Bit):  # a bit does not fill its cylinder
            material = overlaid(base, own)
            values["material"] = material.model_copy(update={"density": weight / area})
    return values


def lighter_or_heavier(item: Item) -> float | None:
    """Weight of a tube over the weight of a steel tube of its size, if it is outside of USUAL; None otherwise.

    A material that is not as stiff as steel may be as light as it likes.
    """
    if not isinstance(item, Tube) or item.material.young < STIFF:
        return None
    ratio = item.material.density / STEEL
    return None if USUAL[0] <= ratio <= USUAL[1] else ratio
