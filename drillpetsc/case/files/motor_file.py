"""Performance of a downhole motor from a CSV file: columns flow, differential pressure, torque and speed, in any order."""

from __future__ import annotations

from drillpetsc.case.files.quantity_file import QuantityColumn, QuantityFile

_FILE = QuantityFile(
    {
        "flow_rate": QuantityColumn("m^3/s", ("flow", "flowrate", "q"), {}),
        "differential_pressure": QuantityColumn(
            "Pa", ("differentialpressure", "pressure", "dp", "diffpressure"), {}
        ),
        "torque": QuantityColumn("N m", ("torque",), {}),
        "speed": QuantityColumn("rad/s", ("speed", "rpm"), {"rpm": "rpm"}),
    },
    "flow [gpm], differential_pressure [psi], torque [ft lbf], speed [rpm]",
    "{flow_rate: [...], differential_pressure: [...], torque: [...], speed: [...]}",
)


def read_motor_curve(name: str) -> dict[str, list[float]]:
    """Columns flow_rate [m3/s], differential_pressure [Pa], torque [N m], speed [rad/s] of a CSV file.

    See ``QuantityFile.read``; a column named `rpm` needs no unit.
    """
    return _FILE.read(name)
