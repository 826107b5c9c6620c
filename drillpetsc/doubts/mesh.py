"""Doubts about elements that are too long, and about a state that is unstable because of them."""

from __future__ import annotations

from collections.abc import Iterable

from drillpetsc.doubts.doubt import Values, doubt, span
from drillpetsc.doubts.moments import Answer, Built, Moment, Solved, Start
from drillpetsc.model.element_length import instead_of_length
from drillpetsc.output.watches.coarse_mesh import Found, coarse_elements


def _placed(at: Moment, found: Iterable[Found]) -> Values:
    """Values with what may stand instead of a shorter length, and with the number of further places."""
    for values in found:
        more = f"; and {values['more']} more places with too long elements" if "more" in values else ""
        between = span(values["upper"], values["lower"], at.units) if "upper" in values else ""
        yield {**values, "span": between, "more": more, "instead": instead_of_length(at.case)}


@doubt(
    "elements of {length:length 3} from MD {span} are too long for {cause}: element_length of {enough:length 2} or less "
    "({instead}){more}",
    "Use `element_length: auto`, or the length of the message for the items there.",
)
def long_elements(at: Built | Answer | Start) -> Values:
    """Elements are too long for the shape of the string: a helix, the curvature of the hole, or a residual bend (manual: sec-mesh-coarse)."""
    return _placed(at, at.long_elements.ranges)


@doubt(
    "elements of {length:length 3} {where} {md:length} leave {size} in the bending moment, and make side forces and their "
    "friction too large: element_length of {enough:length 2} or less there ({instead}){more}",
    "Use `element_length: auto`, or the length of the message beside the support.",
)
def long_elements_at_support(at: Built | Answer | Start) -> Values:
    """Elements beside a support are longer than the layer in which the pipe bends, so side forces there are too large (manual: sec-mesh-coarse)."""
    return _placed(at, at.long_elements.supports)


@doubt(
    "elements of {length:length 3} from MD {span} are too long for the buckled shape: element_length of {enough:length 2} or less "
    "({instead}){more}",
    "Use `element_length: auto`, or the length of the message where the string is buckled.",
)
def long_elements_of_buckles(at: Answer | Start) -> Values:
    """The string is buckled, and its elements are too long to show the shape (manual: sec-statics-report)."""
    return _placed(at, at.long_elements.buckles)


@doubt(
    "the automatic mesh is limited to {most} elements, which are {times:.3g} times longer than needed; the shortest are needed from "
    "MD {span} ({reason})",
    "Give `element_length` where the detail matters, and a larger one elsewhere.",
)
def limited_mesh(at: Built | Answer | Start) -> Values:
    """The automatic mesh has reached its largest number of elements, so elements are longer than the physics needs."""
    for values in at.model.mesh.limited:
        yield {**values, "span": span(values["upper"], values["lower"], at.units)}


@doubt(
    "{count} elements are longer than {limit:length 3} = (240 EI/w)^(1/3): their bending cannot hold their own axial load, statics "
    "may report negative pivots; shorten element_length",
    "Use `element_length: auto`, or a length below the limit.",
)
def heavy_elements(at: Built) -> Values:
    """Elements are so long that their bending cannot hold their own axial load (manual: eq-beam-length-limit)."""
    coarse, limit = coarse_elements(at.model)
    return coarse.any() and {"count": int(coarse.sum()), "limit": limit[coarse].min()}


@doubt(
    "{pivots} negative pivots: the mesh is too coarse ({count} elements longer than (240 EI/w)^(1/3)), which is not buckling; "
    "shorten element_length",
    "Use `element_length: auto`, or a length below the limit.",
)
def unstable_by_mesh(at: Solved) -> Values:
    """Statics counts directions in which the string moves away from the equilibrium, and the cause is a coarse mesh and not buckling."""
    count = int(coarse_elements(at.model)[0].sum())
    return at.negative_pivots and count and {"pivots": at.negative_pivots, "count": count}


@doubt(
    "the state is not shown to be stable ({pivots} negative pivots of the symmetric stiffness; a moment or a load that turns with "
    "the section has no potential)",
    "Simulate the motion with `run` from this state to see whether it stays there.",
)
def not_shown_stable(at: Solved) -> Values:
    """Loads without a potential act, so that negative pivots do not tell whether the equilibrium is stable (manual: eq-statics-stable)."""
    if at.negative_pivots and not at.model.conservative and not coarse_elements(at.model)[0].any():
        yield {"pivots": at.negative_pivots}


@doubt(
    "the static state is unstable ({pivots} negative pivots)",
    "Do not read loads of this state. Give `initial: {imperfection: 0.01}`, finer elements, or less compression.",
)
def unstable(at: Solved) -> Values:
    """The string would leave this equilibrium: it buckles (manual: eq-statics-stable)."""
    if at.negative_pivots and at.model.conservative and not coarse_elements(at.model)[0].any():
        yield {"pivots": at.negative_pivots}
