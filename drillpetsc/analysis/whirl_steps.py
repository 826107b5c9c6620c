"""Whirl of rigid items that is faster than the vibrations which the time steps of a run leave (manual: sec-time-whirl-steps)."""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.rigid_items import RigidItems
from drillpetsc.parallel import total
from drillpetsc.unit_systems import shown

#: frequency of the whirl over that above which the steps damp by 1 % a period: from here on they take 8 % and more
MARGIN = 2.0
SLOWEST = 0.1  # rotation [rad/s] below which nothing whirls
#: clearance over radius below which an item fills its hole: the bit is no item that rolls on the wall
SMALLEST_CLEARANCE = 2e-3


class WhirlSteps:
    """Rotation of the rigid items of a run, and the whirl that its steps do not resolve; all ranks create and call it.

    model: the drilling model, in the state from which the run starts.
    """

    def __init__(self, model: DrillingModel) -> None:
        self.model = model
        items = RigidItems(model).items if model.beam is not None and model.well is not None else ()
        self.bodies = [model.mesh.bodies[k] for k in items]
        self._start = self._rates_and_depths()

    def _rates_and_depths(self) -> FloatArray:
        """(items, 2) rotation [rad/s] and measured depth in the hole [m] at present; the same on all ranks."""
        out = np.zeros((len(self.bodies), 2))
        if not self.bodies:
            return out
        system, beam, well = self.model.system, self.model.beam, self.model.well
        assert beam is not None and well is not None
        local = {int(v): i for i, v in enumerate(system.chain.vertices) if system.chain.owned[i]}
        for k, body in enumerate(self.bodies):
            if body.node in local:
                position, _, rate = beam.section(system.assembly, local[body.node])
                out[k] = abs(float(rate)), float(well.project(position[None]).md[0])
        return np.asarray(total(system.comm.tompi4py(), out))

    def warnings(self, damped_above: float | None, product: float | None) -> list[str]:
        """Sentence on the item whose rolling whirl is the fastest, where the steps damp it; collective.

        damped_above: frequency above which the steps take 1 % of an amplitude in a period [Hz]; product: of that
        frequency and the step [-]; None: the formula does not damp.
        An item of radius R that rolls on the wall without slip, with the clearance c and the rotation w, goes round the
        hole backward at the rate w R/c (Jansen, 1991).  w is the larger one of the rates at start and end of the run.
        """
        if damped_above is None or product is None or not self.bodies:
            return []
        assert self.model.well is not None
        now = self._rates_and_depths()
        found: list[tuple[float, str]] = []
        units = self.model.case.output.units or "metric"
        for k, body in enumerate(self.bodies):
            rotation = max(now[k, 0], self._start[k, 0])
            clearance = float(np.asarray(self.model.well.radius(now[k, 1]))) - body.radius
            if rotation < SLOWEST or clearance < SMALLEST_CLEARANCE * body.radius:
                continue
            whirl = rotation * body.radius / (2 * np.pi * clearance)
            if whirl > MARGIN * damped_above:
                text = (
                    f"{body.name} at MD {shown(now[k, 1], 'length', units, 5)} would roll along the wall at {whirl:.2g} Hz "
                    f"({60 * rotation / (2 * np.pi):.3g} rpm, radial clearance {shown(clearance, 'diameter', units, 3)})"
                )
                found.append((whirl, text))
        if not found:
            return []
        whirl, text = max(found)
        return [
            f"the steps of this run damp vibrations above {damped_above:.2g} Hz; {text}: a backward whirl that begins small, and "
            f"the torque it takes, are not in this run; -ts_adapt_dt_max {product / whirl:.2g} resolves it"
        ]
