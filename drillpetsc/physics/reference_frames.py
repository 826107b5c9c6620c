"""Update of the reference frames at nodes whose tangent is far from the reference direction.

No physical quantity changes.

The spin angle is measured from a reference direction a, and is singular if the tangent t is opposite to it.
If a.t < -0.5 the reference direction becomes a' = t (manual: eq-beam-update-criterion).  The smallest
rotation moves the second director with it.  The spin angle changes by minus the solid angle of (a, a', v),
and the twist offset of each neighbouring element compensates the change of its twist (manual:
eq-beam-update).
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.geometry.frames import Frames, reference_change, smallest_rotation
from drillpetsc.kernels import function

_far_slopes = function("far_slopes", "ipppd", ctypes.c_int)

REFERENCE_LIMIT_COSINE = (
    -0.5
)  # largest cosine between reference direction and tangent at which it is replaced


def renew_reference_frames(system: DiscreteSystem, frames: Frames, twists: Callable[[], FloatArray]) -> bool:
    """Update reference frames if needed; True if any changed; collective.

    Call it between load steps or time steps only: a time formula with earlier spin angles must restart after
    a change.

    system: its assembly and all components get the new frames.
    frames: the same on all ranks.
    twists(): twist (nc,) of the local elements [rad].
    """
    if "string.tangent" not in system.layout.dofs:
        return False
    changes = _far_nodes(system, frames)
    if not changes:
        return False
    before = twists()
    local = {int(v): i for i, v in enumerate(system.chain.vertices)}
    asm, spin = system.assembly, system.layout.dofs["string.spin"][:, 0]
    for node, v in changes:
        a, t = frames.reference[node].copy(), v / np.linalg.norm(v)
        frames.second_director[node] = smallest_rotation(a, t, frames.second_director[node])
        frames.reference[node] = t
        if node in local:
            asm.x[spin[local[node]]] += reference_change(a, t, v)
    _update_components(system, frames)
    changed = before - twists()
    cells = system.chain.cells
    touched = np.isin(cells, [n for n, _ in changes]) | np.isin(cells + 1, [n for n, _ in changes])
    for cell, offset in system.all_entries(
        list(zip(cells[touched].tolist(), changed[touched].tolist(), strict=True))
    ):
        frames.twist0[cell] += offset
    _update_components(system, frames)
    return True


def _far_nodes(system: DiscreteSystem, frames: Frames) -> list[tuple[int, np.ndarray]]:
    """Find all nodes whose tangent is far from the reference direction: (node, slope (3,)).

    The same on all ranks.
    """
    asm = system.assembly
    if system.ends is None and not _far_slopes(*asm.spins_at, asm.state_at[0], REFERENCE_LIMIT_COSINE):
        return []
    chain, v = system.chain, system.field("string.tangent")
    along = np.einsum("ij,ij->i", frames.reference[chain.vertices], v)
    size = np.sqrt(np.einsum("ij,ij->i", v, v))
    far = np.flatnonzero((along < REFERENCE_LIMIT_COSINE * size) & chain.owned)
    return system.all_entries([(int(chain.vertices[i]), v[i].copy()) for i in far])


def _update_components(system: DiscreteSystem, frames: Frames) -> None:
    system.assembly.reference[:] = frames.reference[system.chain.vertices]
    for component in system.components:
        component.update_reference_frames()
