"""Checks of parts in one job: sums over the ranks, and the exchange at shared nodes."""

import ends_mpi  # noqa: F401
import totals_mpi  # noqa: F401
