"""Doubts about a law of the user (manual: sec-own-physics)."""

from __future__ import annotations

from drillpetsc.case.blocks.contact import Contact
from drillpetsc.doubts.doubt import Values, doubt
from drillpetsc.doubts.moments import Answer, Built, Moment, Start
from drillpetsc.physics.own_law import FRICTION, OwnLaw


def _laws(at: Moment) -> list[OwnLaw]:
    return [law for component in at.model.components for law in component.own_laws]


@doubt(
    "{law}: {function} returns {name} = {given:.6g} at {where}, and differences of its result give {found:.6g} (SI units): "
    "steps may be short or fail",
    "Correct the derivative, or leave it out: the program then takes differences.",
)
def wrong_derivative(at: Built | Answer | Start) -> Values:
    """A derivative that the function of a law returns is not the slope of its result at a usual state."""
    for law in _laws(at):
        for q in law.mismatches:
            yield {
                "law": law.kind.key,
                "function": law.name,
                "name": q.name,
                "given": q.given,
                "found": q.found,
                "where": q.where,
            }


@doubt(
    "{law}: {function} depends on normal, the force of one contact point, which is proportional to the length of its element: "
    "results depend on the mesh",
    "Give `element_length` to all items, as long as the law is meant for, or use a law without `normal`.",
)
def load_of_a_point(at: Built | Answer | Start) -> Values:
    """A friction law uses the normal force of a contact point, which is the share of the point in the length of its element."""
    contact = at.model.case.contact
    for law in _laws(at):
        of_length = isinstance(contact, Contact) and contact.law != "hertz_point"
        if law.kind is FRICTION and of_length and law.changes_with("normal"):
            yield {"law": law.kind.key, "function": law.name}


@doubt(
    "{law}: {function} takes one state at a time, which is slow; with numpy functions (np.exp, np.where) it takes all at once"
)
def slow(at: Built) -> Values:
    laws = [law for law in _laws(at) if law.one_by_one]
    return {"law": laws[0].kind.key, "function": laws[0].name} if laws else {}
