"""Doubts about elements that are too long, and about a state that is unstable because of them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from drillpetsc.doubts.doubt import Doubt, span
from drillpetsc.doubts.moments import Answer, Built, Moment, Solved, Start
from drillpetsc.model.element_length import instead_of_length
from drillpetsc.output.watches.coarse_mesh import Found, coarse_elements

Values = Iterable[dict[str, Any]]


def _placed(at: Moment, found: Iterable[Found]) -> Values:
    """Values with what may stand instead of a shorter length, and with the number of further places."""
    for values in found:
        more = f"; and {values['more']} more places with too long elements" if "more" in values else ""
        between = span(values["upper"], values["lower"], at.units) if "upper" in values else ""
        yield {**values, "span": between, "more": more, "instead": instead_of_length(at.case)}


class LongElements(Doubt):
    """Elements are too long for the shape of the string: a helix, the curvature of the hole, or a residual bend (manual: sec-mesh-coarse)."""

    about = (Built, Answer, Start)
    sentence = (
        "elements of {length:length 3} from MD {span} are too long for {cause}: element_length of {enough:length 2} or less "
        "({instead}){more}"
    )
    remedy = "Use `element_length: auto`, or the length of the message for the items there."

    def look(self, at: Any) -> Values:
        return _placed(at, at.long_elements.ranges)


class LongElementsAtSupport(Doubt):
    """Elements beside a support are longer than the layer in which the pipe bends, so side forces there are too large (manual: sec-mesh-coarse)."""

    about = (Built, Answer, Start)
    sentence = (
        "elements of {length:length 3} {where} {md:length} leave {size} in the bending moment, and make side forces and their "
        "friction too large: element_length of {enough:length 2} or less there ({instead}){more}"
    )
    remedy = "Use `element_length: auto`, or the length of the message beside the support."

    def look(self, at: Any) -> Values:
        return _placed(at, at.long_elements.supports)


class LongElementsOfBuckles(Doubt):
    """The string is buckled, and its elements are too long to show the shape (manual: sec-statics-report)."""

    about = (Answer, Start)
    sentence = (
        "elements of {length:length 3} from MD {span} are too long for the buckled shape: element_length of {enough:length 2} or less "
        "({instead}){more}"
    )
    remedy = "Use `element_length: auto`, or the length of the message where the string is buckled."

    def look(self, at: Any) -> Values:
        return _placed(at, at.long_elements.buckles)


class LimitedMesh(Doubt):
    """The automatic mesh has reached its largest number of elements, so elements are longer than the physics needs."""

    about = (Built, Answer, Start)
    sentence = (
        "the automatic mesh is limited to {most} elements, which are {times:.3g} times longer than needed; the shortest are needed from "
        "MD {span} ({reason})"
    )
    remedy = "Give `element_length` where the detail matters, and a larger one elsewhere."

    def look(self, at: Moment) -> Values:
        for values in at.model.mesh.limited:
            yield {**values, "span": span(values["upper"], values["lower"], at.units)}


class HeavyElements(Doubt):
    """Elements are so long that their bending cannot hold their own axial load (manual: eq-beam-length-limit)."""

    about = (Built,)
    sentence = (
        "{count} elements are longer than {limit:length 3} = (240 EI/w)^(1/3): their bending cannot hold their own axial load, statics "
        "may report negative pivots; shorten element_length"
    )
    remedy = "Use `element_length: auto`, or a length below the limit."

    def look(self, at: Built) -> Values:
        coarse, limit = coarse_elements(at.model)
        if coarse.any():
            yield {"count": int(coarse.sum()), "limit": limit[coarse].min()}


class UnstableByMesh(Doubt):
    """Statics counts directions in which the string moves away from the equilibrium, and the cause is a coarse mesh and not buckling."""

    about = (Solved,)
    sentence = (
        "{pivots} negative pivots: the mesh is too coarse ({count} elements longer than (240 EI/w)^(1/3)), which is not buckling; "
        "shorten element_length"
    )
    remedy = "Use `element_length: auto`, or a length below the limit."

    def look(self, at: Solved) -> Values:
        count = int(coarse_elements(at.model)[0].sum())
        if at.negative_pivots and count:
            yield {"pivots": at.negative_pivots, "count": count}


class NotShownStable(Doubt):
    """Loads without a potential act, so that negative pivots do not tell whether the equilibrium is stable (manual: eq-statics-stable)."""

    about = (Solved,)
    sentence = (
        "the state is not shown to be stable ({pivots} negative pivots of the symmetric stiffness; a moment or a load that turns with "
        "the section has no potential)"
    )
    remedy = "Simulate the motion with `run` from this state to see whether it stays there."

    def look(self, at: Solved) -> Values:
        if at.negative_pivots and not at.model.conservative and not coarse_elements(at.model)[0].any():
            yield {"pivots": at.negative_pivots}


class Unstable(Doubt):
    """The string would leave this equilibrium: it buckles (manual: eq-statics-stable)."""

    about = (Solved,)
    sentence = "the static state is unstable ({pivots} negative pivots)"
    remedy = "Do not read loads of this state. Give `initial: {imperfection: 0.01}`, finer elements, or less compression."

    def look(self, at: Solved) -> Values:
        if at.negative_pivots and at.model.conservative and not coarse_elements(at.model)[0].any():
            yield {"pivots": at.negative_pivots}
