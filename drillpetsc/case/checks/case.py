"""Checks of the blocks of a case against each other: string, hole, ends and start. `check_case` runs all
checks in order."""

from __future__ import annotations

import math

from drillpetsc.case.blocks.case_blocks import CaseBlocks
from drillpetsc.case.blocks.ends import PointLoad
from drillpetsc.case.blocks.items.reamer import Reamer
from drillpetsc.case.blocks.items.string import Beam, Bit, Item, Rigid, Stabilizer, Tube
from drillpetsc.case.checks.drilling import check_drilling
from drillpetsc.case.checks.exclusions import check_exclusions
from drillpetsc.case.checks.fit import LENGTH_TOLERANCE, Misfit, misfit
from drillpetsc.case.checks.fluid import check_fluid
from drillpetsc.case.checks.joints import check_joints
from drillpetsc.case.checks.limits import check_size
from drillpetsc.case.checks.machines import check_hoist, check_motor, check_steering
from drillpetsc.case.checks.reamer import check_reamer
from drillpetsc.case.checks.sensors import check_sensors
from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import said
from drillpetsc.unit_systems import System


def check_case(case: CaseBlocks) -> None:
    """Raise on the first contradiction between blocks."""
    check_exclusions(case)
    _bit_last(case)
    _well_or_none(case)
    check_fluid(case)
    if case.window is not None and case.well is None:
        hint = "pore and frac are limits of the open hole"
        raise refuse("window", want="no window without a well", hint=hint)
    _string_in_hole(case)
    _stabilizers(case)
    _bit_on_bottom(case)
    check_drilling(case)
    _start(case)
    check_hoist(case)
    _integrator(case)
    check_joints(case)
    check_steering(case)
    check_motor(case)
    check_reamer(case)
    _on_string(case)
    check_sensors(case)
    _stribeck(case)
    check_size(case)


def _bit_last(case: CaseBlocks) -> None:
    for i, item in enumerate(case.string[:-1]):
        if isinstance(item, Bit):
            raise refuse(
                "string",
                i,
                "kind",
                got="bit",
                want="a bit only as the last item; otherwise stabilizer or body",
            )
    if not any(isinstance(item, (Tube, Beam)) for item in case.string):
        raise refuse("string", got=f"{len(case.string)} rigid items", want="at least one pipe or beam")


def _integrator(case: CaseBlocks) -> None:
    kind = str(case.petsc.get("ts_type", "alpha2"))
    chosen = case.time is not None and case.time.integrator == "generalized_alpha"
    if chosen and kind not in ("alpha2", "genalpha"):
        want = "no ts_type with time.integrator: generalized_alpha"
        raise refuse("petsc", "ts_type", got=kind, want=want)
    if chosen and case.given_time.spectral_radius is not None and "ts_alpha_radius" in case.petsc:
        want = "either time.spectral_radius or petsc.ts_alpha_radius"
        raise refuse("petsc", "ts_alpha_radius", got=case.petsc["ts_alpha_radius"], want=want)


def _well_or_none(case: CaseBlocks) -> None:
    if case.well is None:
        if case.contact is not None:
            raise refuse(
                "contact", want="no contact without a well", hint="give a well, or leave contact out"
            )
        if case.bottom.kind == "bit":
            hint = "a bit is on the end of the hole; give a well"
            raise refuse("bottom", got="bit", want="free, pinned, clamped or force without a well", hint=hint)
        return
    for key in ("inclination", "azimuth"):
        if key in case.initial.model_fields_set:
            want = f"no {key} with a well: the string starts in the hole"
            raise refuse("initial", key, got=getattr(case.initial, key), want=want)


def _string_in_hole(case: CaseBlocks) -> None:
    if case.well is None:
        return
    end = case.well.survey.md[-1]
    units = case.said_units
    if case.string_length > end + LENGTH_TOLERANCE:
        whole, more = (said(v, "length", units) for v in (case.string_length, case.string_length - end))
        want = f"a string no longer than the hole, {said(end, 'length', units)}"
        raise refuse(
            "string",
            got=f"{len(case.string)} items, {whole}",
            want=want,
            hint=f"its {len(case.string)} items are {whole} long, {more} too long",
        )
    if case.contact is None and not case.has_annulus:
        return
    for i, (item, (above, below)) in enumerate(zip(case.string, case.item_depths, strict=True)):
        if isinstance(item, Beam) and item.od is None:
            raise refuse(
                "string", i, "od", want="an outer diameter: the case has a well", hint="or contact: none"
            )
        if isinstance(item, (Bit, Reamer)):  # checked separately
            continue
        found = misfit(case.well, item, above, below)
        if found is not None:
            _refuse_misfit(i, item, found, units)


def _refuse_misfit(i: int, item: Item, found: Misfit, units: System) -> None:
    """Raise for the item of number ``i`` that is too wide for the hole."""
    place = f"the {found.kind.replace('_', ' ')} at {said(found.depth, 'length', units)}"
    want = f"the diameter of {place}, {said(found.hole, 'diameter', units)}"
    rigid = isinstance(item, Rigid)
    want = f"at most 1/16 in above {want}" if rigid else f"less than {want}"
    hint = (
        "it could not pass there; " if rigid else ""
    ) + f"or another well.sections[{found.section}].diameter"
    raise refuse("string", i, *found.key, got=said(found.outer, "diameter", units), want=want, hint=hint)


def _stabilizers(case: CaseBlocks) -> None:
    """Raise if a bypass area does not fit the hole of the stabilizer."""
    for i, (item, depths) in enumerate(zip(case.string, case.item_depths, strict=True)):
        if not isinstance(item, Stabilizer) or item.bypass_area is None:
            continue
        if case.well is None:
            raise refuse(
                "string", i, "bypass_area", got=item.bypass_area, want="no bypass_area without a well"
            )
        hole = case.well.diameter_at(0.5 * sum(depths))
        body = item.body_od or item.id
        most = math.pi / 4 * (hole**2 - body**2)
        if item.bypass_area >= most:
            want = f"less than the hole around the body, {most:.4g} m2"
            raise refuse("string", i, "bypass_area", got=item.bypass_area, want=want)


def _bit_on_bottom(case: CaseBlocks) -> None:
    if case.bottom.kind == "bit" and case.string[-1].od is None:
        last = len(case.string) - 1
        raise refuse(
            "string", last, "od", want="an outer diameter of the last item, for the torque of the bit"
        )


def _start(case: CaseBlocks) -> None:
    if case.initial.wob is None:
        return
    got = case.initial.wob
    if case.bottom.kind != "bit":
        raise refuse("initial", "wob", got=got, want="no wob unless bottom is a bit", hint="bottom: bit")
    if case.top.kind == "free":
        hint = "wob is met by the top's axial position, which a free top does not have"
        raise refuse("initial", "wob", got=got, want="no wob with a free top", hint=hint)
    if case.top.force is not None and case.beam.formulation == "quaternion":
        want = "no wob with a top force: not with quaternion yet"
        raise refuse("initial", "wob", got=got, want=want, hint="take beam.formulation ancf")
    if case.top.force is not None and case.time is not None and case.time.mode == "quasi_static":
        hint = "leave wob out: without inertia the top force sets the weight on bit"
        raise refuse(
            "initial", "wob", got=got, want="no wob with a top force in a quasi-static run", hint=hint
        )


def _on_string(case: CaseBlocks) -> None:
    end = case.string_length
    range_of_string = f"a measured depth on the string, 0 to {said(end, 'length', case.said_units)}"
    for i, probe in enumerate(case.output.probes):
        if probe > end + LENGTH_TOLERANCE:
            raise refuse("output", "probes", i, got=probe, want=range_of_string)
    for i, load in enumerate(case.loads):
        key, depth = ("at", load.at) if isinstance(load, PointLoad) else ("to", load.to)
        if depth > end + LENGTH_TOLERANCE:
            raise refuse("loads", i, key, got=depth, want=range_of_string)


def _stribeck(case: CaseBlocks) -> None:
    if case.contact is None or case.contact.stribeck is None or case.well is None:
        return
    static = case.contact.stribeck.static
    kinetic = max(section.friction for section in case.well.sections)
    kinetic = max([kinetic, *(item.friction for item in case.string if item.friction is not None)])
    if static < kinetic:
        want = f"at least the largest friction of the hole and the string, {kinetic:g}"
        raise refuse("contact", "stribeck", "static", got=static, want=want)
