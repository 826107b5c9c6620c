"""Copy of a static state, which a search that fails puts back."""

from __future__ import annotations

from drillpetsc.model.drilling_model import DrillingModel


class Snapshot:
    """Copy of the unknowns and of the top's position, which ``restore`` puts back."""

    def __init__(self, model: DrillingModel):
        self.model, self.x = model, model.system.assembly.x.copy()
        self.top = model.top.anchor.copy()

    def restore(self) -> None:
        """Put the copied state back."""
        self.model.system.assembly.x[:] = self.x
        self.model.top.anchor[:] = self.top
