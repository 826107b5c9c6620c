"""Growing modes that the mesh does not resolve, and those that the mud feeds.  Manual: sec-eigen-bottom, sec-mud-swirl."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.linear.modes import Modes
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.unit_systems import shown

ELEMENTS_PER_WAVE = 4.0  # fewer do not resolve the exchange of work between string and mud


def unresolved_growth(model: DrillingModel, found: Modes) -> list[str]:
    """Return a warning on growing modes whose waves are shorter than ``ELEMENTS_PER_WAVE`` elements.

    The exchange of work between string and mud is balanced up to the error of the mesh only.  Waves are those of pressure in the mud, or
    of bending, at the frequency w of the pipe's own mass m per length: (m w^2/EI)^(1/4).
    """
    if model.fluid is None or model.beam is None:
        return []
    mud, mesh = model.fluid.constants, model.mesh
    pipe = ~mesh.is_joint & (mesh.mass > 0)
    length = float(mesh.length[~mesh.is_joint].max())
    slowest = np.sqrt(mesh.bending_stiffness[pipe] / mesh.mass[pipe]) * (2 * np.pi / mesh.length[pipe]) ** 2
    limits = {
        "pressure": np.sqrt(mud.bulk_modulus / mud.density) / (ELEMENTS_PER_WAVE * length),
        "bending": float(slowest.min()) / (2 * np.pi * ELEMENTS_PER_WAVE**2),
    }
    lateral = np.array([kind == "lateral" for kind in found.kind], dtype=bool)
    units, out = model.case.shown_units, []
    for waves, power, of_kind in (("pressure", 1.0, ~lateral), ("bending", 0.5, lateral)):
        coarse = found._grows & (found.frequency > limits[waves]) & of_kind
        if coarse.any():
            enough = length * (limits[waves] / found.frequency[coarse].max()) ** power
            out.append(
                f"{int(coarse.sum())} of the growing modes, from {found.frequency[coarse].min():.4g} Hz, have {waves} waves shorter than "
                f"{ELEMENTS_PER_WAVE:g} elements of {shown(length, 'length', units, 3)}: their growth may come from the mesh; it is one of the "
                f"model where it stays with element_length below {shown(enough, 'length', units, 2)}"
            )
    return out


def fed_by_swirl(model: DrillingModel, found: Modes) -> list[str]:
    """Return a note on forward whirls that grow since the mud swirls faster about the string than they go round; collective."""
    annulus = None if model.fluid is None else model.fluid.annulus
    if annulus is None or model.beam is None:
        return []
    own = float(np.abs(annulus.parameter("swirl")).max(initial=0.0))
    fastest = max(model.system.comm.tompi4py().allgather(own)) / (2 * np.pi)
    lateral = np.array([kind == "lateral" for kind in found.kind], dtype=bool)
    fed = found._grows & lateral & (found.frequency > 0) & (found.frequency < fastest)
    if not fed.any():
        return []
    return [
        f"forward whirls that grow: {int(fed.sum())}; the mud swirls with the string at up to {fastest:.3g} Hz and feeds whirls that are "
        "slower; campbell finds the rotary speed from which on, and --set fluid.swirl=NUMBER what hangs on the swirl (by default 0.26 "
        "of the spin about 5 in pipe in 8 1/2 in hole; rough walls and turbulence halve it)"
    ]
