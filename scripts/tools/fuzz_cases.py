"""Random valid cases as plain data, small enough to build in milliseconds; every block of the case format
occurs.

`random` is a random.Random or anything with its methods, so that hypothesis may put its own in and shrink
what it finds.
"""

from __future__ import annotations

from typing import Any

Data = dict[str, Any]

#: other ways to write a value in the SI unit: (factor from SI to the text's number, text behind it)
SPELLINGS = {
    "m": ((1.0, " m"), (1000.0, " mm"), (100.0, "cm"), (1 / 0.3048, " ft")),
    "rad": ((1.0, " rad"), (57.29577951308232, " deg")),
    "rad/s": ((1.0, " rad/s"), (9.549296585513721, " rpm")),
    "Pa": ((1.0, " Pa"), (1e-9, " GPa"), (1e-5, " bar")),
    "kg/m3": ((1.0, " kg/m3"), (1e-3, " g/cm3")),
    "N": ((1.0, " N"), (1e-3, " kN")),
    "s": ((1.0, " s"), (1000.0, " ms")),
    "m3/s": ((1.0, " m3/s"), (1000.0, " l/s")),
    "kg": ((1.0, " kg"),),
    "m/s": ((1.0, " m/s"), (3600.0, " m/h")),
}


def spelt(random: Any, number: float, unit: str) -> Any:
    """A number in SI in one of the notations of a case file."""
    factor, text = random.choice([(1.0, ""), *SPELLINGS[unit]])
    return f"{number * factor:.12g}{text}" if text else number


def maybe(random: Any, share: float = 0.3) -> bool:
    return random.randint(0, 99) < 100 * share


def over_time(random: Any, number: float, unit: str) -> Any:
    """A constant, a ramp or a table with a jump, that ends at the number."""
    form = random.randint(0, 3)
    if form < 2:
        return spelt(random, number, unit)
    if form == 2:
        return {"ramp": spelt(random, 0.5, "s"), "value": spelt(random, number, unit)}
    return {"time": [0, "500 ms", 0.5, 1.0], "value": [0.0, 0.0, spelt(random, number, unit), number]}


def valid_case(random: Any) -> Data:
    """A case that is valid by construction."""
    has_well, has_fluid = maybe(random, 0.7), maybe(random, 0.5)
    bit = has_well and maybe(random, 0.5)
    held = has_fluid and not bit and maybe(random, 0.15)
    data: Data = {"string": _string(random, bit)}
    if maybe(random):
        data["title"] = random.choice(["a title", "12:30", "yes", "Öl, 日本 🛢", "0x10", "~", "- a: [b"])
    length = sum(item["length"] for item in data["string"])
    data["string"] = [
        {key: _written(random, key, value) for key, value in item.items()} for item in data["string"]
    ]
    if has_well:
        data["well"] = _well(random, length + (0.0 if bit else random.choice([0.0, 5.0])))
    if held:
        data["hold_string"] = True
    else:
        data |= _ends(random, bit)
        data |= _loads(random, length)
        if has_well and maybe(random, 0.5):
            data["contact"] = _contact(random)
    if has_fluid:
        data["fluid"] = _fluid(random, has_well)
    if bit and maybe(random, 0.6) and data.get("fluid", {}).get("formulation") != "hermite":
        data["formation"] = _formation(random)
    if not has_fluid and maybe(random):
        data |= random.choice(
            [
                {"joints": _joints(random)},
                {} if _knows_ancf_alone(data) else {"beam": {"formulation": "quaternion"}},
            ]
        )
    return data | _settings(random, has_well, length)


def _written(random: Any, key: str, value: Any) -> Any:
    units = {"length": "m", "od": "m", "id": "m", "element_length": "m", "eccentricity": "m", "mass": "kg"}
    return spelt(random, value, units[key]) if key in units and isinstance(value, float) else value


def _string(random: Any, bit: bool) -> list[Data]:
    """Items with all lengths as SI numbers; the last is a bit where one is asked for."""
    items: list[Data] = [{"kind": "pipe", "length": 30.0, "od": 0.127, "id": 0.1086, "element_length": 10.0}]
    if maybe(random):
        items[0] |= {
            "name": "drill pipe",
            "friction": 0.25,
            "curvature": "1e-4 1/m",
            "curvature_angle": "30 deg",
        }
    if maybe(random):
        steel = {"young": "200 GPa", "density": 7800.0, "damping": {"stiffness": 1e-4, "mass": "0.1 1/s"}}
        items.append({"kind": "pipe", "length": 18.0, "od": 0.1651, "id": 0.0714, "element_length": 6.0, "eccentricity": 2e-3,
                      "material": steel, "initial": {"imperfection": 0.01}})  # fmt: skip
    if maybe(random):
        items.append(
            {
                "kind": "stabilizer",
                "length": 1.5,
                "od": 0.21,
                "id": 0.0714,
                "mass": 200.0,
                "unbalance": "0.05 kg m",
            }
        )
        if maybe(random, 0.5):
            items[-1] |= {"bend": {"angle": "1 deg", "tool_face": "20 deg"}, "inertia": {"axial": 1.0}}
        items.append({"kind": "pipe", "length": 9.0, "od": 0.1651, "id": 0.0714})
    if maybe(random, 0.2):
        items.append({"kind": "beam", "length": 8.0, "axial_stiffness": "4e9 N", "bending_stiffness": 9.8e6, "torsional_stiffness": 7.5e6,
                      "mass": "140 kg/m", "polar_inertia": 0.6, "od": 0.15, "id": 0.07, "bend": {"angle": 0.01}})  # fmt: skip
    if maybe(random, 0.2):
        items.append(
            {"kind": "body", "length": 2.0, "od": 0.15, "id": 0.05, "center_of_gravity": [1.0, 0.0, "1 mm"]}
        )
    if bit:
        items.append({"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60.0, "nozzle_area": "400 mm2"})
    return items


def _joints(random: Any) -> list[Data]:
    hinge = {"at": 15.0, "kind": random.choice(["revolute", "universal", "fixed"])}
    return [
        hinge,
        {"at": "20 m", "kind": "slider", "spring": "1 kN/m", "damping": 10.0, "stroke": [-0.1, "1 cm"]},
    ][: random.randint(1, 2)]


def _knows_ancf_alone(data: Data) -> bool:
    """Whether the case has parts that the quaternion element does not support."""
    rigid = any(
        item["kind"] in ("stabilizer", "body", "bit") or "eccentricity" in item for item in data["string"]
    )
    return (
        rigid or data["top"] == "driven" or isinstance(data["top"], dict) and data["top"]["kind"] == "driven"
    )


def _well(random: Any, end: float) -> Data:
    stations = random.randint(2, 4)
    md = [end * i / (stations - 1) for i in range(stations)]
    survey = {"md": md, "inclination": [spelt(random, 0.1 * i, "rad") for i in range(stations)],
              "azimuth": [spelt(random, 0.3, "rad") for _ in range(stations)]}  # fmt: skip
    hole: Data = {"to": end, "kind": "open_hole", "diameter": "215.9 mm"}
    if maybe(random):
        hole |= {"friction": 0.3, "compliance": {"young": "20 GPa", "poisson": 0.25}}
    casing = {"to": 10.0, "kind": "casing", "diameter": spelt(random, 0.2244, "m"), "friction": 0.2}
    return {"survey": survey, "sections": [casing, hole] if maybe(random, 0.5) else [hole]}


def _ends(random: Any, bit: bool) -> Data:
    turn, down = over_time(random, 8.0, "rad/s"), over_time(random, 0.01, "m/s")
    tops: list[Any] = [
        "clamped",
        "pinned",
        {"kind": "clamped"},
        {"kind": "top_drive", "rotation": turn, "lowering": down},
        {"kind": "top_drive", "rotation": turn, "force": over_time(random, 1e5, "N")},
        {
            "kind": "driven",
            "rotation": turn,
            "stiffness": 100.0,
            "damping": "500 N m s/rad",
            "inertia": "2000 kg m2",
        },
    ]
    bottoms: list[Any] = [
        "free",
        "pinned",
        {"kind": "clamped"},
        {"kind": "force", "force": [0, 0, "-1 kN"], "moment": [0, "1 N m", 0]},
    ]
    if bit:
        bottoms = ["bit", {"kind": "bit", "stiffness": "1e8 N/m", "friction": 0.3}]
    return {"top": random.choice(tops), "bottom": random.choice(bottoms)}


def _loads(random: Any, length: float) -> Data:
    loads: list[Data] = []
    if maybe(random):
        loads.append({"at": 7.5, "force": ["1 kN", 0, 0], "value_over": {"time": [0, 1], "value": [0, 1]}})
    if maybe(random):
        loads.append(
            {
                "from": 2.0,
                "to": length - 1.0,
                "moment": [0, 0, "1 N m/m"],
                "frame": random.choice(["global", "section"]),
            }
        )
    return {"loads": loads} if loads else {}


def _contact(random: Any) -> Any:
    if maybe(random, 0.2):
        return "none"
    law = random.choice([{"stiffness": "1e8 Pa", "law": "linear"}, {"stiffness": "3e9 N/m^2.5", "law": "hertz"},
                         {"stiffness": 1e9, "law": "hertz_point", "points_per_element": 3}])  # fmt: skip
    contact: Data = {**law, "restitution": 0.5, "slip_velocity": spelt(random, 0.01, "m/s")}
    if maybe(random):
        contact["stribeck"] = {"static": 0.5, "speed": 0.1}
    return contact


def _fluid(random: Any, has_well: bool) -> Data:
    rheology = random.choice([
        {"model": "newtonian", "viscosity": "20 cP"},
        {"model": "power_law", "consistency": "0.5 Pa s^n", "index": 0.7, "law": "api"},
        {"model": "bingham", "yield_stress": "5 Pa", "plastic_viscosity": 0.02, "law": "exact"},
        {"model": "casson", "yield_stress": 2.0, "plastic_viscosity": "20 cP"},
        {"model": "herschel_bulkley", "yield_stress": 3.0, "consistency": 0.4, "index": 0.8, "shear_rate": "2 1/s"},
    ])  # fmt: skip
    fluid: Data = {"density": spelt(random, 1200.0, "kg/m3"), "rheology": rheology}
    if maybe(random, 0.8):
        fluid["flow_rate"] = over_time(random, 0.03, "m3/s")
    elif maybe(random, 0.5):
        fluid["pump_pressure"] = over_time(random, 1e7, "Pa")
    if maybe(random):
        fluid |= {"bulk_modulus": spelt(random, 2e9, "Pa"), "discharge_coefficient": 0.9, "bit_volume": "7 l"}
    if has_well and maybe(random):
        fluid |= {"added_mass": random.choice(["confined", "eccentric", "paper_plug", "none", 1.5]), "clinging": 0.4, "flow_line": 1.0,
                  "lateral_damping": random.choice(["stokes", "none", "20 N s/m^2"]), "rotation_drag": True}  # fmt: skip
    if has_well and maybe(random, 0.2):
        fluid["choke"] = {"area": "400 mm2"}
    elif "pump_pressure" not in fluid and maybe(random, 0.2):
        fluid["formulation"] = "hermite"
    if maybe(random, 0.2):
        fluid |= {"dynamics": "quasi_steady", "elastic_walls": False, "check_valve": True}
    return fluid


def _formation(random: Any) -> Data:
    rock: Data = {"drillability": "2.8e-8 m/(s N)", "bit_anisotropy": 0.3}
    if maybe(random):
        rock["rock_anisotropy"] = {"dip": "20 deg", "dip_azimuth": 0.5, "index_dip": 1.05}
    if maybe(random):
        rock |= {
            "layers": [
                {"from": 5.0, "to": 20.0, "drillability": 1e-8},
                {"from": "20 m", "threshold": "5 kN"},
            ],
            "walk": "2 deg",
        }
    rock["bit_law"] = random.choice(["rop", {"kind": "rop"}, {"kind": "drag_bit", "blades": 5, "wear_flat": "1.2 mm"},
                                     {"kind": "velocity_weakening", "static": "5 kN m", "dynamic": 2000.0, "speed": "30 rpm"}])  # fmt: skip
    return rock


def _settings(random: Any, has_well: bool, length: float) -> Data:
    data: Data = {"time": {"end": spelt(random, 2.0, "s")}}
    if maybe(random):
        data["material"] = {"young": "206 GPa", "poisson": 0.29, "damping": {"stiffness": 1e-4}}
    if maybe(random):
        data["gravity"] = random.choice([9.81, "9.80665 m/s^2", [0, 0, 9.8]])
    if maybe(random):
        data["initial"] = {"from": random.choice(["statics", "rest", "straight"]), "imperfection": 1e-3}
        if not has_well:
            data["initial"] |= {"inclination": "30 deg", "azimuth": 0.2}
    if maybe(random):
        data["output"] = {
            "history_every": "10 ms",
            "field_every": 0.1,
            "probes": [3.0, f"{length - 1} m"],
            "checkpoint_every": 1.0,
        }
    if maybe(random):
        data["petsc"] = {
            "ts_type": "bdf",
            "ts_bdf_order": 2,
            "ts_rtol": 1e-4,
            "ts_monitor": None,
            "q_flag": True,
        }
    return data
