"""Columns of indices.csv."""

from __future__ import annotations

from drillpetsc.fem.quantity import DEPTH, NAME, Entity, Quantity


def _index(
    name: str, unit: str, label: str, mnemonic: str, doc: str, sign: str = "", kind: str = ""
) -> Quantity:
    on: Entity = "probe" if DEPTH in name else "sensor" if NAME in name else "item"
    return Quantity(name, unit, on=on, label=label, mnemonic=mnemonic, sign=sign, doc=doc, kind=kind)


WINDOW = _index(
    "window",
    "s",
    "Length of the window",
    "WNDW",
    "Time before the row that its indices cover.",
    "not negative",
)
ROTATION = (
    _index(
        "rotation",
        "rad/s",
        "Mean rotation of the lower end",
        "RPMB",
        "Mean spin rate of the lower end over the window.",
        "clockwise (looking down)",
    ),
    _index(
        "stick_slip",
        "-",
        "Stick-slip index of the lower end",
        "SSI",
        "Range of the spin rate over twice its mean, (max - min)/(2 mean); nan if the mean is below 1 rpm.",
        "not negative; 1 is full stick-slip",
    ),
    _index(
        "stuck_share",
        "-",
        "Share of the time that the lower end is stuck",
        "STCK",
        "Share of the window in which the spin rate is below 1 rpm.",
    ),
)
DRILLING = (
    _index(
        "mse",
        "Pa",
        "Mechanical specific energy",
        "MSE",
        "Energy per volume of rock from weight, torque, rotation and rate of penetration; nan without progress.",
        "not negative",
        kind="stress",
    ),
    _index(
        "efficiency",
        "-",
        "Drilling efficiency",
        "DEFF",
        "Specific energy of the rock over the mechanical specific energy.",
    ),
    _index(
        "depth_of_cut",
        "m",
        "Depth of cut",
        "DOC",
        "Length drilled in a turn of the bit; nan below 1 rpm.",
        kind="diameter",
    ),
)
WHIRL = (
    _index(
        "whirl_ratio_NNN",
        "-",
        "Whirl ratio at NNN m",
        "WRNNN",
        "Turns about the hole by turns of the string in three revolutions; nan if they are not resolved.",
        "forward",
    ),
    _index(
        "whirl_NNN",
        "-",
        "Whirl at NNN m",
        "WCNNN",
        "Class: none, forward synchronous, forward, backward rolling, backward slipping, chaotic or unresolved.",
    ),
)
OF_SENSOR = (
    _index(
        "stick_slip_NAME",
        "-",
        "Stick-slip index of NAME",
        "SSINAME",
        "Range of the sensor's spin rate over twice its mean, (max - min)/(2 mean); nan if the mean is below 1 rpm.",
        "not negative",
    ),
    *(
        _index(
            f"{kind}_{way}_NAME",
            "m/s2",
            f"{words} {way} acceleration of NAME",
            f"{mnemonic}{way[0].upper()}NAME",
            f"{words} {way} acceleration in the window, without gravity.",
            "not negative",
        )
        for kind, words, mnemonic in (("rms", "RMS", "GR"), ("peak", "Peak", "GP"))
        for way in ("axial", "lateral", "torsional")
    ),
    _index(
        "impacts_NAME",
        "-",
        "Impacts of NAME",
        "IMPNAME",
        "How often the lateral acceleration without gravity rises above 10 g in the window.",
        "not negative",
    ),
)
