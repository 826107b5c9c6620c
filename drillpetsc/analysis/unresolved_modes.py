"""Growing modes that the mesh does not resolve.  Manual: sec-eigen-bottom."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from drillpetsc.model.drilling_model import DrillingModel

if TYPE_CHECKING:
    from drillpetsc.analysis.modal import Modes

ELEMENTS_PER_WAVE = 4.0  # fewer do not resolve the exchange of work between string and mud


def unresolved_growth(model: DrillingModel, found: Modes) -> list[str]:
    """Return a warning on growing modes whose pressure waves are shorter than ``ELEMENTS_PER_WAVE`` elements.

    The exchange of work between string and mud is balanced up to the error of the mesh only.
    """
    if model.fluid is None or model.beam is None:
        return []
    mud, mesh = model.fluid.constants, model.mesh
    length = float(mesh.length[~mesh.is_joint].max())
    highest = np.sqrt(mud.bulk_modulus / mud.density) / (ELEMENTS_PER_WAVE * length)
    lateral = np.array([kind == "lateral" for kind in found.kind], dtype=bool)
    coarse = found._grows & (found.frequency > highest) & ~lateral
    if not coarse.any():
        return []
    return [
        f"{int(coarse.sum())} of the growing modes, from {found.frequency[coarse].min():.4g} Hz, have pressure waves shorter than "
        f"{ELEMENTS_PER_WAVE:g} elements of {length:.3g} m: their growth may come from the mesh; it is one of the model where it stays "
        f"with element_length below {length * highest / found.frequency[coarse].max():.2g} m"
    ]
