"""Limit of the work of a search for a static state.

Manual: sec-statics-limit-of-search.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.errors import SolveError

#: factorisations times nodes of the string: some twenty seconds on one core; ordinary wells take a hundredth of it, the hardest tests a half
MOST_WORK = 1_600_000
FIXED_NODES = 50  # the part of a factorisation's time that does not depend on the nodes, as nodes


class SearchEnded(SolveError):
    """The search has taken as much work as it may."""


class SearchLimit:
    """Counts the factorisations of a search over all its methods.

    nodes: of the string; None: without a limit.
    """

    def __init__(self, nodes: int | None = None) -> None:
        self.most = np.inf if nodes is None else max(1, MOST_WORK // (nodes + FIXED_NODES))
        self.used = 0.0

    def begin_again(self) -> None:
        """Forget what was counted: a state is held, and further work only adds to it."""
        self.used = 0.0

    def count(self, share: float = 1.0) -> None:
        """Count one factorisation, or a ``share`` of one; raises SearchEnded beyond the limit."""
        self.used += share
        if self.used > self.most:
            raise SearchEnded(
                f"no static state was found in {self.most} factorisations; the string may be about to lock up, or its buckles may have "
                "none with this friction",
                hint="less weight or friction, or rotation; a coarser element_length tries more in the same time; "
                "--path sliding searches without a limit",
            )
