"""Checks of the drilling fluid against string, hole and ends."""

from __future__ import annotations

import math

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.fluid import Fluid
from drillpetsc.case.blocks.items.string import Beam, Bit, Flexible, Rigid, Stabilizer
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import largest, said

#: a pressure above this share of the mud's bulk modulus is none of a well: compression is no longer small (manual: sec-mud-content)
SHARE_OF_MODULUS = 0.25


def check_fluid(case: CaseBlocks) -> None:
    """Raise if the fluid has no way in, through or out."""
    if case.fluid is None:
        return
    _annulus(case)
    partly = [key for key in ("level_in_string", "floated_length") if getattr(case.fluid, key) is not None]
    if len(partly) == 2:
        raise refuse("fluid", "floated_length", want="level_in_string or floated_length, not both")
    if partly and not (case.bottom.plugged and not case.side_nozzles):
        want = "a plugged bottom, such as bottom: {kind: free, plugged: true}: an open string fills"
        raise refuse("fluid", partly[0], got=said(getattr(case.fluid, partly[0]), "length"), want=want)
    if case.fluid.surface_line is not None and not case.has_bore:
        want = "no surface_line without flow into the string"
        raise refuse("fluid", "surface_line", want=want)
    if case.fluid.annulus_rheology is not None and not case.fluid.annulus:
        raise refuse("fluid", "annulus_rheology", want="no annulus_rheology without an annulus")
    for i, item in enumerate(case.string):
        if isinstance(item, Beam) and item.od is None:
            raise refuse("string", i, "od", want="an outer diameter (and id): the case has a fluid")
        if item.pressure_loss is None:
            continue
        if not case.has_bore:
            raise refuse("string", i, "pressure_loss", want="no pressure_loss without flow in the string")
        if item.pressure_loss.coefficient is not None and not item.id:
            at = ("string", i, "pressure_loss", "coefficient")
            want = "an id of the item, whose bore the coefficient is of; or a value with its flow rate and density"
            raise refuse(*at, got=item.pressure_loss.coefficient, want=want)
    _mud_sections(case)
    _side_nozzles(case)
    _metal_of_rigid_items(case)
    _lower_end(case)
    _bore(case)


def _mud_sections(case: CaseBlocks) -> None:
    """Raise if the volume of the mud in an item, or its outer diameter for the mud, has no effect."""
    last = max(i for i, item in enumerate(case.string) if isinstance(item, Flexible))
    for i, item in enumerate(case.string):
        if item.bore_volume is not None and i > last:
            hint = "below the last pipe the chamber at the bit holds the mud: fluid.bit_volume"
            want = "no bore_volume of a rigid item below the last pipe"
            raise refuse(
                "string", i, "bore_volume", got=said(item.bore_volume, "volume"), want=want, hint=hint
            )
        if item.bore_volume is not None and not case.has_bore:
            want = "no bore_volume without flow in the string"
            raise refuse("string", i, "bore_volume", got=said(item.bore_volume, "volume"), want=want)
        if item.annulus_od is None:
            continue
        if isinstance(item, Bit):
            hint = "the mud flows past the metal of a bit, its mass over its density"
            raise refuse(
                "string",
                i,
                "annulus_od",
                got=said(item.annulus_od, "diameter"),
                want="no annulus_od of a bit",
                hint=hint,
            )
        if isinstance(item, Stabilizer) and item.bypass_area is not None:
            want = "annulus_od or bypass_area, not both"
            raise refuse("string", i, "annulus_od", got=said(item.annulus_od, "diameter"), want=want)


def _side_nozzles(case: CaseBlocks) -> None:
    """Raise if mud cannot flow through the nozzles of an item above the bit."""
    first = next(i for i, item in enumerate(case.string) if isinstance(item, Flexible))
    for i, _ in case.side_nozzles:
        item = case.string[i]
        sizes = isinstance(item, Stabilizer) and item.nozzles is not None
        at = ("string", i, "nozzles" if sizes else "nozzle_area")
        if i == len(case.string) - 1:
            hint = "kind: bit has the nozzles of the string's end; without any, the bore is open there"
            raise refuse(*at, want="no nozzles in the side of the string's last item", hint=hint)
        if i < first:
            raise refuse(*at, want="a pipe above the item with nozzles: the flow there is given")
        if not case.has_bore:
            want = "no nozzles without mud in the string"
            raise refuse(*at, want=want)


def _metal_of_rigid_items(case: CaseBlocks) -> None:
    """Raise if a rigid item is heavier than a solid cylinder of its od.

    The mud flows past the volume of its metal, which would narrow the annulus more than the od does.
    """
    for i, item in enumerate(case.string[:-1]):
        if isinstance(item, Rigid) and item.annulus_od is None and item.od is not None and item.length > 0:
            density = (item.material or case.material).density
            most = density * item.length * math.pi / 4 * (item.od**2 - item.id**2)
            if item.mass is not None and item.mass > 1.01 * most:
                raise refuse(
                    "string",
                    i,
                    "mass",
                    got=said(item.mass, "mass"),
                    want=f"at most {said(most, 'mass', digits=4)}, the metal of a tube with this od, id and length",
                    hint="the mud flows past the item's metal; a larger od, or its own material: {density: ...}",
                )


def _choke(fluid: Fluid) -> None:
    """Raise if the pump's flow through the choke requires a pressure that mud cannot have."""
    if fluid.choke is None or fluid.pump_pressure is not None:
        return
    flow = largest(fluid.flow_rate)
    most = fluid.bulk_modulus * SHARE_OF_MODULUS
    loss = 0.5 * fluid.density * (flow / (fluid.choke.discharge_coefficient * fluid.choke.area)) ** 2
    if loss > most:
        least = fluid.choke.area * math.sqrt(loss / most)
        raise refuse(
            "fluid",
            "choke",
            "area",
            got=said(fluid.choke.area, "flow_area"),
            want=f"an area that passes {said(flow, 'flow')}: above {said(least, 'flow_area', digits=2)}",
            hint=f"the choke would hold {said(loss, 'pressure', digits=3)}; for a well that is shut in give flow_rate 0",
        )


def _annulus(case: CaseBlocks) -> None:
    fluid = case.given_fluid
    if fluid.annulus and case.well is None:
        hint = "give a well, or annulus: false"
        raise refuse("fluid", "annulus", got=True, want="no annulus without a well", hint=hint)
    if fluid.flow_line > 0 and not fluid.annulus:
        want = "no flow_line without an annulus: the fluid leaves at the string's lower end"
        raise refuse("fluid", "flow_line", got=fluid.flow_line, want=want)
    if fluid.choke is not None and not fluid.annulus:
        raise refuse("fluid", "choke", want="no choke without an annulus: it is a valve at the flow line")
    _choke(fluid)
    if case.well is not None and fluid.flow_line >= case.well.survey.md[-1]:
        want = f"above the end of the hole, {said(case.well.survey.md[-1], 'length')}"
        raise refuse("fluid", "flow_line", got=fluid.flow_line, want=want)


def _lower_end(case: CaseBlocks) -> None:
    """Raise if a plugged string has a flow rate, or no fluid is left.

    A plugged string that is not filled from above is empty. The fluid is then in the annulus only.
    """
    fluid = case.given_fluid
    if not case.bottom.plugged or fluid.pump_pressure is not None or case.side_nozzles:
        return
    if largest(fluid.flow_rate) > 0:
        hint = "plugged: false, or flow_rate 0, or a pump_pressure instead of a flow_rate"
        raise refuse(
            "bottom", "plugged", got=True, want="an open lower end for the flow rate of the pump", hint=hint
        )
    if not fluid.annulus:
        hint = "plugged: false, or an annulus, or a pump_pressure"
        want = "a string that is not sealed at both ends: no fluid would be left in this case"
        raise refuse("bottom", "plugged", got=True, want=want, hint=hint)


def _bore(case: CaseBlocks) -> None:
    """Raise unless all flexible items have a bore, or none has a bore and nothing is pumped."""
    fluid = case.given_fluid
    solid = [i for i, item in enumerate(case.string) if isinstance(item, Flexible) and item.id == 0]
    if not solid:
        return
    want = "an inner diameter above 0"
    if case.has_bore:
        raise refuse("string", solid[0], "id", got=0.0, want=f"{want}: fluid flows through the whole string")
    if fluid.pump_pressure is not None or largest(fluid.flow_rate) > 0:
        raise refuse("string", solid[0], "id", got=0.0, want=f"{want}: the pump feeds the string")
    if not fluid.annulus:
        raise refuse(
            "string", solid[0], "id", got=0.0, want=f"{want}, or an annulus: there is no space for the fluid"
        )
