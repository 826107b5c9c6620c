"""Pressure losses of a tool from a CSV file: columns flow and loss, in either order."""

from __future__ import annotations

from drillpetsc.case.files.quantity_file import QuantityColumn, QuantityFile

_FILE = QuantityFile(
    {
        "flow_rate": QuantityColumn("m^3/s", ("flow", "flowrate", "q"), {}),
        "loss": QuantityColumn("Pa", ("loss", "pressureloss", "pressure", "dp", "differentialpressure"), {}),
    },
    "flow [gpm], loss [psi]",
    "{flow_rate: [...], loss: [...]}",
)


def read_loss_curve(name: str) -> dict[str, list[float]]:
    """Columns flow_rate [m3/s] and loss [Pa] of a CSV file; see ``QuantityFile.read``."""
    return _FILE.read(name)
