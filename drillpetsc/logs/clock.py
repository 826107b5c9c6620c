"""Clock times of a log as texts -> seconds since its first row."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import UTC, datetime

import numpy as np

from drillpetsc.arrays import FloatArray

_DATE = re.compile(r"(\d{1,2})[/.](\d{1,2})[/.](\d{4})(?:[T\s,]+(\d.*))?$")
_CLOCK = re.compile(r"(\d{1,2}):(\d{2})(?::(\d{2}(?:\.\d+)?))?\s*([AP]M)?$", re.IGNORECASE)

AMBIGUOUS = "a date whose day and month can be told apart, such as 2020-12-31: no row has a number above 12"
NO_TIME = "a date and time such as 2020-12-31T13:00:15; --map date=TITLE names a separate column of the date"


class ClockError(ValueError):
    """A time that cannot be read.  row: its number from 0; want: what is allowed."""

    def __init__(self, row: int, want: str) -> None:
        super().__init__(want)
        self.row, self.want = row, want


def order_of(texts: Sequence[str], known: str = "") -> str:
    """Whether dates have the `day` or the `month` first: which of the two numbers is above 12 in some row; of dates with dots the day.

    known: of rows before; empty if no row shows it. Raises ClockError for rows that contradict each other.
    """
    order, dotted = known, False
    for text in texts:
        match = _DATE.match(text)
        if match:
            first, second = int(match.group(1)), int(match.group(2))
            found = "day" if first > 12 >= second else "month" if second > 12 >= first else ""
            if found and order and found != order:
                raise ClockError(texts.index(text), f"the {order} first, as in other rows")
            order, dotted = found or order, dotted or text[match.end(1)] == "."
    return order or ("day" if dotted else "")


def clock_times(texts: Sequence[str], order: str = "") -> tuple[FloatArray, datetime]:
    """(seconds since the first row (n,), time of the first row).

    Accepts ISO 8601, and 31/12/2020 13:00, 31.12.2020 13:00 or 12/31/2020 1:00 PM. order: of rows before (`order_of`).
    Raises ClockError.
    """
    order = order_of(texts, order)
    out = np.empty(len(texts))
    first_time: datetime | None = None
    for i, text in enumerate(texts):
        time = _time(text, order, i)
        time = time.replace(tzinfo=UTC) if time.tzinfo is None else time.astimezone(UTC)
        first_time = first_time or time
        out[i] = (time - first_time).total_seconds()
    assert first_time is not None
    return out, first_time


def _time(text: str, order: str, row: int) -> datetime:
    match = _DATE.match(text)
    try:
        if not match:
            return datetime.fromisoformat(text)
        if not order:
            raise ClockError(row, AMBIGUOUS)
        a, b, year = (int(match.group(k)) for k in (1, 2, 3))
        clock = _CLOCK.match(match.group(4) or "0:00")
        if not clock:
            raise ValueError
        hour, noon = int(clock.group(1)), (clock.group(4) or "").upper()
        hour = hour % 12 + (12 if noon == "PM" else 0) if noon else hour
        second = float(clock.group(3) or 0)
        day, month = (a, b) if order == "day" else (b, a)
        return datetime(
            year, month, day, hour, int(clock.group(2)), int(second), round(second % 1 * 1e6) % 1_000_000
        )
    except ClockError:
        raise
    except ValueError:
        raise ClockError(row, NO_TIME) from None
