"""Hook loads and torques of many soft strings, compiled: what a calibration needs of `batch.soft_strings`, which draws them too.

Each string has steps of its own, and not those of all strings, so that hundreds of bit depths cost what they cost alone.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from drillpetsc.analysis.loads.torque_drag.batch import LARGEST_FORCE, Columns, Hole
from drillpetsc.analysis.loads.torque_drag.string_rows import StringRows
from drillpetsc.arrays import FloatArray
from drillpetsc.geometry.well import Well
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import structure


class TopLoads(NamedTuple):
    """What a soft string gives at its top, (c,) each.

    tension [N], torque [N m]: nan for a string that cannot carry its weight on bit.
    sinusoidal, helical: largest compression along the string over the load at which it buckles so [-].
    """

    tension: FloatArray
    torque: FloatArray
    sinusoidal: FloatArray
    helical: FloatArray


class SoftEnds:
    """Soft strings with their steps.

    edges: for each string the (k+1,) measured depths of its steps [m].
    """

    def __init__(self, well: Well, strings: Sequence[StringRows], max_step: float) -> None:
        rows, sections, ends, self.edges = [], [], [], []
        for string in strings:
            hole = Hole(well, [string], max_step)
            of = {name: values[:, 0] for name, values in hole.of.items()}
            rows.append(
                np.column_stack(
                    [
                        *(hole.h, hole.down, hole.kk, hole.kz, hole.zz, of["weight"], of["contact_radius"]),
                        *(of["bending_stiffness"], of["clearance"], of["friction"], hole.vertical),
                    ]
                )
            )
            sections.append(hole.section)
            ends.append((string.end_weight, float(np.asarray(well.at(np.array([string.depth]))[1])[0, 2])))
            self.edges.append(hole.edges)
        counts = [len(q) for q in rows]
        self._first = np.append(0, np.cumsum(counts)).astype(np.int32)
        self._rows = np.ascontiguousarray(np.concatenate(rows), dtype=float)
        self._section = np.concatenate(sections).astype(np.int32)
        self._end = np.array(ends, dtype=float)

    def ends(self, loads: Columns, lifts: Sequence[FloatArray] | None = None) -> TopLoads:
        """Both ends of c strings.

        loads: of c strings, without `lift`; lifts: (k,) force per length [N/m] in the steps of the string of each column.
        """
        count = len(loads.placed)
        if lifts is None:
            lift, lift_at = np.zeros(1), np.full(count, -1, dtype=np.int32)
        else:
            shared: dict[int, int] = {}  # columns of one point have one array
            pieces, at = [], 0
            lift_at = np.empty(count, dtype=np.int32)
            for c, values in enumerate(lifts):
                if id(values) not in shared:
                    shared[id(values)] = at
                    pieces.append(values)
                    at += len(values)
                lift_at[c] = shared[id(values)]
            lift = np.ascontiguousarray(np.concatenate(pieces), dtype=float)
        arrays = {
            "first": self._first,
            "rows": self._rows,
            "section": self._section,
            "end": self._end,
            "placed": np.ascontiguousarray(loads.placed, dtype=np.int32),
            "friction": np.ascontiguousarray(loads.friction, dtype=float),
            "factor": loads.item_factor,
            "wob": loads.wob,
            "moment": loads.torque,
            "velocity": loads.axial_velocity,
            "rotation": loads.rotation,
            "weight": loads.weight_factor,
            "thrust": np.zeros(count) if loads.thrust is None else loads.thrust,
            "lift": lift,
            "lift_at": lift_at,
            **{name: np.empty(count) for name in TopLoads._fields},
        }
        for name in ("factor", "wob", "moment", "velocity", "rotation", "weight", "thrust"):
            arrays[name] = np.ascontiguousarray(arrays[name], dtype=float)
        call = _Call(**{name: pointer(array) for name, array in arrays.items()})
        call.largest, call.count, call.sections = LARGEST_FORCE, count, arrays["friction"].shape[1]
        _soft_string_ends(ctypes.addressof(call))
        return TopLoads(*(arrays[name] for name in TopLoads._fields))


_Call = structure("soft_string_call")
_soft_string_ends = function("soft_string_ends", "p")
