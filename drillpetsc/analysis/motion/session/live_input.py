"""Inputs over time that a session changes while it runs."""

from __future__ import annotations

from typing import Any

from drillpetsc.case.quantities import largest


class LiveInput:
    """An input over time (``drillpetsc.time_function``) whose value can be set for the time to come.

    given: the input of the case, which holds until the first ``set``.

    The value before the last change is kept: a step that ends at the change sees it.
    """

    def __init__(self, given: Any) -> None:
        self._before: Any = given
        self._now: Any = given

    def set(self, t: float, value: float, until: float | None = None) -> float:
        """From the time ``t`` [s] on: ``value``, or on a straight line to it at ``until`` [s]; returns the jump at ``t``."""
        present = self._now.value(t)
        area = self._now.integral(t)
        start = present if until is not None and until > t else value
        slope = (value - start) / (until - t) if until is not None and until > t else 0.0
        self._before, self._now = self._now, Piece(t, start, area, slope, until if slope else None)
        return start - present

    def _at(self, t: float) -> Any:
        now = self._now
        return self._before if isinstance(now, Piece) and t < now.start else now

    def value(self, t: float, before: bool = False) -> float:
        return float(self._at(t).value(t, before))

    def rate(self, t: float, before: bool = False) -> float:
        return float(self._at(t).rate(t, before))

    def integral(self, t: float) -> float:
        return float(self._at(t).integral(t))

    def breaks(self) -> tuple[float, ...]:
        return tuple(self._now.breaks())

    def jumps(self) -> tuple[float, ...]:
        return tuple(self._now.jumps())

    @property
    def values(self) -> tuple[float, ...]:
        """Largest magnitude of the input, from which a mesh of automatic lengths is chosen."""
        now = self._now
        return (
            abs(now.value(now.breaks()[-1] if now.breaks() else 0.0))
            if isinstance(now, Piece)
            else largest(now),
        )

    def get_state(self) -> list[float] | None:
        """Numbers from which ``set_state`` continues; None as long as the input follows the case."""
        return None if not isinstance(self._now, Piece) else self._now.numbers()

    def set_state(self, state: list[float] | None, given: Any) -> None:
        """Continue from ``get_state``; ``given``: the input of the case."""
        self._before = given if state is None else Piece.of(state)
        self._now = self._before


class Piece:
    """Part of an input from a time on: a straight line, then constant.

    start: [s]; value: there; area: integral from 0 to there; slope: per second; until: end of the line [s].
    """

    def __init__(self, start: float, value: float, area: float, slope: float, until: float | None) -> None:
        self.start, self._value, self._area, self._slope, self._until = start, value, area, slope, until

    @classmethod
    def of(cls, numbers: list[float]) -> Piece:
        """A piece from its ``numbers``."""
        start, value, area, slope, until = numbers
        return cls(start, value, area, slope, None if until != until else until)

    def numbers(self) -> list[float]:
        """All numbers of the piece; nan for no end."""
        end = float("nan") if self._until is None else self._until
        return [self.start, self._value, self._area, self._slope, end]

    def value(self, t: float, before: bool = False) -> float:
        end = t if self._until is None else min(t, self._until)
        return self._value + self._slope * (end - self.start)

    def rate(self, t: float, before: bool = False) -> float:
        return self._slope if self._until is not None and t < self._until else 0.0

    def integral(self, t: float) -> float:
        if self._until is None or t <= self._until:
            passed = t - self.start
            return self._area + passed * (self._value + 0.5 * self._slope * passed)
        line = self._until - self.start
        area = self._area + line * (self._value + 0.5 * self._slope * line)
        return area + (t - self._until) * (self._value + self._slope * line)

    def breaks(self) -> tuple[float, ...]:
        return ()

    def jumps(self) -> tuple[float, ...]:
        return ()
