"""What makes a result doubtful: one function a doubt, in the file of its subject; see ``doubts/doubt.py``.

The order of these imports is the order in which the user reads doubts.
"""

from drillpetsc.doubts import place, buckles, mesh, own_laws, state, tools, motion  # noqa: F401, I001
from drillpetsc.doubts.doubt import DOUBTS, Doubt, doubts_at

__all__ = ["DOUBTS", "Doubt", "doubts_at"]
