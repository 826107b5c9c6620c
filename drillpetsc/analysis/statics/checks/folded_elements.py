"""Solutions of the equations that are no string: elements that run backwards, a string that has fallen over.

Manual: sec-statics-sequence.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.statics.placement import top_depth
from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.parallel import total


def backwards(chord: FloatArray, above: FloatArray, below: FloatArray, length: FloatArray) -> np.ndarray:
    """Whether the middle of an element runs against its ends (m,).

    chord: (m, 3) from its upper to its lower node [m]; above, below: (m, 3) derivatives of the position by arc length at
    its ends [-]; length: (m,) without strain [m].

    The cubic with these ends has in its middle the derivative 1.5 chord/length - (above + below)/4.
    """
    ends = above + below
    middle = 1.5 * chord / length[:, None] - 0.25 * ends
    return np.asarray(np.sum(middle * ends, axis=1) <= 0)


def refuse_folded(model: DrillingModel) -> None:
    """Raise SolveError where an element of the string runs backwards; collective.

    Such a state may fulfil all equations, with a strain as of a pipe that is turned inside out: a force of hundreds of kN
    that no load asks for.
    """
    system, mesh = model.system, model.mesh
    chain, first = system.chain, mesh.nodes
    if len(chain.cells):
        position, tangent = system.field("string.position"), system.field("string.tangent")
        top, bottom = chain.ends.T
        here = ~mesh.is_joint[chain.cells]
        folded = np.zeros(len(here), dtype=bool)
        folded[here] = backwards(
            (position[bottom] - position[top])[here],
            tangent[top][here],
            tangent[bottom][here],
            mesh.length[chain.cells][here],
        )
        first = int(chain.cells[folded].min(initial=mesh.nodes))
    if system.comm.size > 1:
        first = int(min(system.comm.tompi4py().allgather(first)))
    if first < mesh.nodes:
        raise SolveError(
            "statics found a state in which an element of the string runs backwards: it is no state of a pipe",
            component="beam",
            element=first,
            measured_depth=float(mesh.node_depth[first]) + top_depth(model),
            item=model.case.string[int(mesh.item[first])].name or "",
            hint="an end may be held where the string cannot reach it; a finer mesh there may help",
        )


def refuse_fallen(model: DrillingModel) -> None:
    """Raise SolveError where a string that stands on its bit, and that no wall keeps in its hole, has fallen over; collective.

    Pushed beyond its buckling load it makes a loop: part of it runs up the hole.
    """
    if model.bit is None or model.contact is not None:
        return
    system = model.system
    along = np.sum(system.field("string.tangent") * model.tangent[system.chain.vertices], axis=1)
    if not total(system.comm.tompi4py(), float((along < 0).any())):
        return
    raise SolveError(
        "the string falls over: its buckling load is passed, and nothing holds it across (contact: none)",
        hint="contact: {} keeps it in its hole; or less weight on bit",
    )
