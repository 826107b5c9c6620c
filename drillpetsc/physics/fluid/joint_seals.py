"""Seals of telescoping joints: the force of the mud that pushes their parts apart, and the mud that they take up.

Manual: sec-mud-joints (kernels/fluid/joint_flow.hpp).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component, ElementBlock
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.kernels.parameters import Parameters, columns
from drillpetsc.physics.beam import SLOTS
from drillpetsc.physics.fluid.channel_flow import FluidConstants, ambient_update
from drillpetsc.time_function import TimeFunction

SEAL_RESULTS = columns("seal_results").names
_STORED, _POTENTIAL = SEAL_RESULTS.index("stored"), SEAL_RESULTS.index("potential")
_CONTENT = [SEAL_RESULTS.index("bore_content"), SEAL_RESULTS.index("annulus_content")]


class JointSeals(Component):
    """Seals of all sliders that have a sealed area.

    mesh: of the string; fluid: constants.
    bore, annulus: there is mud inside or outside the string; at least one of them.
    ambient: pressure outside a string without an annulus over time [Pa].
    """

    name = "seals"

    def __init__(
        self, mesh: StringMesh, fluid: FluidConstants, bore: bool, annulus: bool, ambient: TimeFunction
    ):
        self.mesh, self.fluid, self.bore, self.annulus, self.ambient = mesh, fluid, bore, annulus, ambient
        #: numbers of the joints with seals
        self.sealed = np.array([k for k, j in enumerate(mesh.joints) if j.seal_area > 0], dtype=int)

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        place = {int(c): i for i, c in enumerate(part.cells)}
        joints = self.mesh.joints
        self._chosen = np.array([k for k in self.sealed if joints[k].cell in place], dtype=int)
        cells = np.array([joints[k].cell for k in self._chosen], dtype=int)
        kernel = "joint_seal" + ("" if self.bore and self.annulus else "_bore" if self.bore else "_annulus")
        slots = SLOTS + ((("bore.pressure", 1),) if self.bore else ())
        slots += (("annulus.pressure", 1),) if self.annulus else ()
        params = Parameters(
            kernel,
            len(cells),
            rigid=self.mesh.rigid_above[cells],
            area=[joints[k].seal_area for k in self._chosen],
            ambient=0.0,
        )
        points = np.array([place[int(c)] for c in cells], dtype=np.int32)
        self._block = ElementBlock(
            "seals",
            kernel,
            "cell",
            points,
            slots,
            (),
            params.array,
            context=self.fluid.address,
            update=None if self.annulus else ambient_update(params, self.ambient),
        )
        self._block.keep = (self.fluid,)
        return (self._block,)

    def element_results(self, state) -> FloatArray:
        """(k, 6) of the local joints with seals: columns of ``physics.fluid.joint_seals.SEAL_RESULTS``."""
        return np.asarray(state.results(self._block, self._block.results_kernel, len(SEAL_RESULTS)).table)

    def _sums_of(self, steps) -> FloatArray:
        return np.asarray(steps.sums(self._block, self._block.results_kernel, len(SEAL_RESULTS)))

    def content_of(self, steps) -> FloatArray:
        """(k,) volume at zero pressure that the travel of the local joints adds to bore and annulus [m3]."""
        return np.asarray(self._sums_of(steps)[:, _CONTENT].sum(axis=1))

    def energies_of(self, steps) -> tuple[Any, Any, Any]:
        total = self._sums_of(steps)
        return 0.0, total[:, _STORED], total[:, _POTENTIAL]

    def breaks(self) -> tuple[float, ...]:
        return () if self.annulus else self.ambient.breaks()
