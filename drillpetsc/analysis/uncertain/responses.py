"""Outputs of a case at many values of its uncertain numbers."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Protocol

import numpy as np

from drillpetsc.analysis.loads.torque_drag.batch import Hole, SoftStrings, TopLoads
from drillpetsc.analysis.loads.torque_drag.circulation import Circulation
from drillpetsc.analysis.loads.torque_drag.readings.sensor import DIRECTION, Sensor, sensor_of
from drillpetsc.analysis.loads.torque_drag.roadmap import RowsAsked, circulations, columns_of
from drillpetsc.analysis.sensitivities.hydraulics import SteadyHydraulics
from drillpetsc.analysis.sensitivities.roadmap import outputs_of, own_friction
from drillpetsc.analysis.sensitivities.solution import Output
from drillpetsc.analysis.uncertain.uncertain_keys import WEIGHT_FACTOR, Uncertain, case_at
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError, SolveError

BLOCK = "rig.block_weight"
_SECTION = re.compile(r"well\.sections\[(\d+)\]\.friction")
MOST_STRINGS = 20_000  # that are computed at once


class Response(Protocol):
    """Outputs as a function of the uncertain numbers.

    outputs: m of them; base: (m,) values in the case [SI].
    """

    outputs: list[Output]
    base: FloatArray

    def values(self, draws: FloatArray) -> FloatArray:
        """(n, m) outputs [SI] at (n, k) values of the uncertain numbers; nan where there is no solution."""


class _Strings:
    """Soft strings of all rows of a roadmap, of which only friction, weight and the block vary."""

    def __init__(self, asked: RowsAsked) -> None:
        self.keys, loads = asked.keys(), asked.loads()
        placed = [d for _, _, d in self.keys]
        self.strings = SoftStrings([Hole(asked.well, [rows]) for rows in asked.strings])
        flows = circulations(asked.case, asked.strings, loads)
        found = [flows.get((o, d)) for o, _, d in self.keys]
        edges = [hole.edges for hole in self.strings.holes]
        still = [np.zeros(len(q) - 1) for q in edges]
        self.columns = replace(
            columns_of(
                [loads[o] for o, _, _ in self.keys], placed, [asked.pairs[p] for _, p, _ in self.keys]
            ),
            lift=[
                q.lift(edges[d]) if isinstance(q, Circulation) else still[d]
                for q, d in zip(found, placed, strict=True)
            ],
            thrust=np.array([q.thrust if isinstance(q, Circulation) else 0.0 for q in found]),
        )
        self.failed = np.array(
            [
                bool(asked.strings[d].misfit) or isinstance(q, SolveError)
                for q, d in zip(found, placed, strict=True)
            ]
        )
        self.block = asked.block_weight
        sensor = sensor_of(asked.case)
        factors = np.array([sensor.factor(DIRECTION[o]) for o, _, _ in self.keys])
        self.factor = None if sensor == Sensor() else factors

    def found(self, friction: FloatArray, weight: FloatArray, block: FloatArray) -> dict[str, FloatArray]:
        """(n, rows) of each output [SI].

        friction: (n, s) of the sections; weight: (n,) factor; block: (n,) [N].
        """
        rows, per = len(self.keys), max(MOST_STRINGS // len(self.keys), 1)
        parts = [self._ends(friction[i : i + per], weight[i : i + per]) for i in range(0, len(friction), per)]
        found = TopLoads(*(np.concatenate(q).reshape(-1, rows) for q in zip(*parts, strict=True)))
        hook = found.tension
        out = {"hook_load": hook, "surface_torque": found.torque}
        out |= {"sinusoidal_ratio": found.sinusoidal, "helical_ratio": found.helical}
        total = hook + block[:, None]
        if self.block is not None:
            out["hook_load_total"] = total
        if self.factor is not None:
            out["hook_load_reading"] = total / self.factor
        for values in out.values():
            values[:, self.failed] = np.nan
        return out

    def _ends(self, friction: FloatArray, weight: FloatArray) -> TopLoads:
        n, rows, own = len(friction), len(self.keys), vars(self.columns)
        repeated = {name: np.tile(q, n) for name, q in own.items() if isinstance(q, np.ndarray)}
        repeated |= {"friction": np.repeat(friction, rows, axis=0), "weight_factor": np.repeat(weight, rows)}
        return self.strings.ends(replace(self.columns, **repeated, lift=own["lift"] * n))


class RoadmapResponse:
    """Hook load, torque and buckling of the soft string for all rows of a roadmap, with the friction of the hole's sections.

    Strings and flow are prepared once, unless a number changes that enters there.
    """

    def __init__(self, case: Case, keys: Sequence[Uncertain]) -> None:
        self._case, self._keys = case, keys
        asked = own_friction(case, False)
        self._strings = _Strings(asked)
        self.notes = asked.notes
        self._friction = np.asarray(asked.pairs[0].friction, dtype=float)
        weight = next((key.value for key in keys if key.name == WEIGHT_FACTOR), 1.0)
        base = self._strings.found(
            self._friction[None], np.array([weight]), np.array([self._strings.block or 0.0])
        )
        rows = [
            {"operation": o, "bit_depth": asked.strings[d].depth, **dict.fromkeys(base)}
            for o, _, d in asked.keys()
        ]
        self.outputs = outputs_of(asked, rows)
        self.base = self._flat(base)[0]
        self._prepared = [
            i for i, key in enumerate(keys) if key.name not in (WEIGHT_FACTOR, BLOCK) and not _sections(key)
        ]

    def _flat(self, found: dict[str, FloatArray]) -> FloatArray:
        """(n, m) in the order of the outputs: by row, then as in ``QUANTITIES``."""
        names = list(dict.fromkeys(output.quantity.name for output in self.outputs))
        stacked = np.stack([found[name] for name in names], axis=2)
        return stacked.reshape(len(stacked), -1)

    def values(self, draws: FloatArray) -> FloatArray:
        """As of ``Response``."""
        if not self._prepared:
            return self._at(self._strings, draws)
        keys = [self._keys[i] for i in self._prepared]

        def one(values: FloatArray) -> FloatArray:
            case = case_at(self._case, keys, values[self._prepared])
            return self._at(_Strings(own_friction(case, False)), values[None])[0]

        return _each(self, draws, one)

    def _at(self, strings: _Strings, draws: FloatArray) -> FloatArray:
        n = len(draws)
        friction = np.tile(self._friction, (n, 1))
        weight, block = np.ones(n), np.full(n, strings.block or 0.0)
        for key, values in zip(self._keys, draws.T, strict=True):
            sections = _sections(key)
            if sections:
                friction[:, sections] = values[:, None]
            elif key.name == WEIGHT_FACTOR:
                weight = values
            elif key.name == BLOCK:
                block = values
        out = self._flat(strings.found(np.maximum(friction, 0.0), weight, block))
        out[(friction < 0).any(axis=1) | (weight <= 0) | (block < 0)] = np.nan
        return out


class HydraulicsResponse:
    """Steady flow of a case."""

    def __init__(self, case: Case, keys: Sequence[Uncertain]) -> None:
        for key in keys:
            if key.name == WEIGHT_FACTOR:
                raise CaseError(
                    at=f"uncertain.{key.name}", want="--analysis roadmap: hydraulics has no weights"
                )
        self._case, self._keys, self._solution = case, keys, SteadyHydraulics(case)
        self.outputs, self.base = self._solution.outputs, self._solution.found.values
        self.notes = self._solution.notes

    def values(self, draws: FloatArray) -> FloatArray:
        """As of ``Response``."""
        return _each(
            self, draws, lambda values: self._solution.solved(case_at(self._case, self._keys, values)).values
        )


def _each(response: Response, draws: FloatArray, one: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """(n, m) outputs, ``one`` of which has those of a sample; samples without a solution count as failed."""
    out = np.full((len(draws), len(response.outputs)), np.nan)
    for row, values in zip(out, draws, strict=True):
        with suppress(CaseError, SolveError):
            row[:] = one(values)
    return out


def _sections(key: Uncertain) -> list[int]:
    """Numbers of the hole's sections whose friction it is."""
    return [int(match[1]) for one in key.keys if (match := _SECTION.fullmatch(one.name))]
