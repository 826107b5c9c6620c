"""Point data of the deformed string for VTK: all quantities at nodes and elements, gathered on rank 0."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.fem.component import FloatArray
from drillpetsc.fem.quantity import Quantity, Sample, Source
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.catalogue import in_order
from drillpetsc.output.measured.flow_recorder import flow_recorder
from drillpetsc.output.measured.string_fields import StringFields
from drillpetsc.output.quantities.along_string import OFFSET_X

Key = tuple[int, Any]  # of a value: its source, its function


class FieldOutput:
    """Evaluates the fields of a model.  Quantities with the same value share the gathered array."""

    def __init__(self, model: DrillingModel) -> None:
        self.model, self.system = model, model.system
        mud = flow_recorder(model)
        self.string, optional = StringFields(model, mud), (mud,) if mud is not None else ()
        found: list[tuple[Source, Quantity]] = [
            (source, q)
            for source in (self.string, *model.components, *optional)
            for q in source.quantities()
            if q.on in ("node", "element")
        ]
        self._quantities = in_order(found, "string/*.vtu")
        self._element = ~model.mesh.is_joint
        #: (n+1, 1) number of elements that meet at a node; 1 if there is none, at a rigid item between joints
        self._meeting = np.maximum(np.append(self._element, 0) + np.append(0, self._element), 1)[:, None]

    def fields(self, t: float) -> tuple[FloatArray, dict[str, FloatArray]] | None:
        """Points (n, 3) [m] and point data ``name [unit]`` of the deformed string in depth order, on rank 0; None
        elsewhere.  Collective."""
        sample = Sample(self.system, t)
        local: dict[str, dict[Key, FloatArray]] = {"node": {}, "element": {}}
        for source, q in self._quantities:
            key = id(source), q.value
            if key not in local[q.on]:
                assert q.value is not None
                local[q.on][key] = np.asarray(q.value(source, sample))
        nodes, elements = self._gathered(local["node"], "vertex"), self._gathered(local["element"], "cell")
        if nodes is None or elements is None:
            return None
        at_nodes = nodes | self._means_at_nodes(elements)
        data, finished = {}, dict[Any, FloatArray]()
        for source, q in self._quantities:
            values = at_nodes[id(source), q.value]
            if q.finish is not None:
                shared = id(source), q.finish, q.value
                if shared not in finished:
                    finished[shared] = q.finish(source, values, self.model.mesh.node_depth)
                values = finished[shared]
            data[q.title] = values if q.index is None else values[:, q.index]
        position = id(self.string), OFFSET_X.value
        return nodes.get(position, self.model.position), data

    def _gathered(self, parts: dict[Key, FloatArray], on: str) -> dict[Key, FloatArray] | None:
        """Local values (k, ...) collected in depth order on rank 0, as (n, m); None elsewhere."""
        if self.system.comm.size == 1:  # nothing to send; data kept elsewhere is copied, since it will change
            chain = self.system.chain
            numbers = chain.vertices if on == "vertex" else chain.cells
            if np.array_equal(numbers, np.arange(len(numbers))):
                return {k: np.array(v[:, None] if v.ndim == 1 else v) for k, v in parts.items()}
        # -1 would not do on a rank without elements
        flat = {k: v.reshape(len(v), int(np.prod(v.shape[1:]))) for k, v in parts.items()}
        whole = self.system.gather(np.hstack(list(flat.values())), on)
        if whole is None:
            return None
        pieces = np.split(whole, np.cumsum([values.shape[1] for values in flat.values()])[:-1], axis=1)
        return {
            key: piece.reshape(-1, *values.shape[1:]) if values.ndim > 1 else piece
            for (key, values), piece in zip(parts.items(), pieces, strict=True)
        }

    def _means_at_nodes(self, elements: dict[Key, FloatArray]) -> dict[Key, FloatArray]:
        """(n+1, size) mean of the elements that meet at a node, of each of several values of elements.

        elements: (n, 1), or (n, 2, ...) at the elements' ends.
        """
        if not elements:
            return {}
        ends = [(v, v) if v.shape[1] == 1 else (v[:, 0], v[:, 1]) for v in elements.values()]
        upper, lower = (np.hstack([v.reshape(len(v), -1) for v in side]) for side in zip(*ends, strict=True))
        means = np.zeros((len(upper) + 1, upper.shape[1]))
        means[:-1] += upper * self._element[:, None]
        means[1:] += lower * self._element[:, None]
        means /= self._meeting
        sizes = [v[0].size // len(v[0]) for v in ends]
        return dict(zip(elements, np.split(means, np.cumsum(sizes)[:-1], axis=1), strict=True))
