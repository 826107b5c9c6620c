"""Strings of the checks of the frequency domain: standard drill pipe and drill collars, and their constants."""

from __future__ import annotations

from typing import Any

import numpy as np

YOUNG, DENSITY = 206e9, 7850.0
SHEAR = YOUNG / 2.6
OD, ID = 0.127, 0.1086
AREA = np.pi / 4 * (OD**2 - ID**2)
EI = YOUNG * np.pi / 64 * (OD**4 - ID**4)
GJ = SHEAR * np.pi / 32 * (OD**4 - ID**4)
MASS = DENSITY * AREA
AXIAL_SPEED, TORSIONAL_SPEED = float(np.sqrt(YOUNG / DENSITY)), float(np.sqrt(SHEAR / DENSITY))
COLLAR_AREA = np.pi / 4 * (0.1778**2 - 0.0714**2)
RPM = 2 * np.pi / 60


def steel(stiffness_damping: float = 0.0) -> dict:
    """Material of a pipe, with its stiffness damping [s]."""
    return {"young": YOUNG, "poisson": 0.3, "density": DENSITY, "damping": {"stiffness": stiffness_damping}}


def drill_pipe(length: float, elements: int, damping: float = 0.0, **more: Any) -> dict:
    """127 x 108.6 mm."""
    size = {"length": length, "od": OD, "id": ID, "element_length": length / elements}
    return {"kind": "pipe", **size, "material": steel(damping), **more}


def collars(length: float, elements: int, damping: float = 0.0) -> dict:
    """177.8 x 71.4 mm."""
    size = {"length": length, "od": 0.1778, "id": 0.0714, "element_length": length / elements}
    return {"kind": "pipe", **size, "material": steel(damping)}


def rotor(elements: int = 10, damping: float = 1e-4) -> dict:
    """20 m of drill pipe hinged at both ends, with a body of 100 kg and an unbalance of 0.5 kg m in the middle."""
    body = {"kind": "body", "mass": 100.0, "unbalance": 0.5, "inertia": {"axial": 1.0, "transverse": 1e-6}}
    half = drill_pipe(10.0, elements, damping)
    return {
        "string": [half, body, half],
        "top": "pinned",
        "bottom": "pinned",
        "gravity": 0.0,
        "initial": {"from": "straight"},
    }


def two_part_string(elements: int = 1) -> dict:
    """1800 m of drill pipe over 200 m of collars, the top held, the lower end free; no gravity, no damping."""
    return {
        "string": [drill_pipe(1800.0, 180 * elements), collars(200.0, 40 * elements)],
        "top": {"kind": "top_drive"},
        "bottom": "free",
        "gravity": 0.0,
        "initial": {"from": "straight"},
    }


def disc(elements: int = 4, rpm: float = 600.0) -> dict:
    """A disc of 300 kg, 12 and 20 kg m2, at the end of 2 m of drill pipe almost without mass, which turns."""
    pipe = {
        "kind": "beam",
        "length": 2.0,
        "element_length": 2.0 / elements,
        "axial_stiffness": YOUNG * AREA,
        "bending_stiffness": EI,
        "torsional_stiffness": GJ,
        "mass": 0.01,
        "polar_inertia": 1e-6,
    }
    body = {"kind": "body", "mass": 300.0, "inertia": {"axial": 20.0, "transverse": 12.0}}
    return {
        "string": [pipe, body],
        "top": {"kind": "top_drive", "rotation": f"{rpm} rpm"},
        "bottom": "free",
        "gravity": 0.0,
        "initial": {"from": "straight"},
    }
