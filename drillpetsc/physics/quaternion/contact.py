"""Contact of the quaternion string with the wall (kernels/quaternion/quaternion_contact.cpp)."""

from __future__ import annotations

from drillpetsc.physics.contact import Contact
from drillpetsc.physics.quaternion.beam import SLOTS


class QuaternionContact(Contact):
    """The wall contact of ``Contact``, on the unknowns of the quaternion element.

    The block below rigid items is that of ``Contact``, and ``QuaternionBeam.translate`` rewrites it.
    """

    _element = "quaternion_contact", SLOTS, ()
