"""OpenSees on the problems of the yardstick: python scripts/tools/yardstick_opensees.py opensees.json [PROBLEM ...]

Run it with a Python that has openseespy and scipy. The note of an answer tells what the adapter adds to the program.
"""

from __future__ import annotations

import numpy as np
import openseespy.opensees as ops
from yardstick_common import Found, answer, buckling, friction_torques, rig_figures, threshold, tube
from yardstick_score import Problem

WALL = 1000  # the numbers of nodes and elements of the wall begin here


def beam(given: Found, length: float, count: int, geometry: str) -> float:
    """A plane beam along x in equal elements; length of one [m]."""
    young, area, second = tube(given)
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    for k in range(count + 1):
        ops.node(k, k * length / count, 0.0)
    ops.geomTransf(geometry, 1)
    for k in range(count):
        ops.element("elasticBeamColumn", k, k, k + 1, area, young, second, 1)
    return length / count


def springs(material: str, stiffness: float, nodes: range) -> None:
    """Springs across the beam at its nodes, to fixed nodes."""
    ops.uniaxialMaterial(material, 1, stiffness)
    for k in nodes:
        ops.node(WALL + k, *ops.nodeCoord(k))
        ops.fix(WALL + k, 1, 1, 1)
        ops.element("zeroLength", WALL + k, WALL + k, k, "-mat", 1, "-dir", 2)


def loads(series: str, tag: int) -> None:
    """Begin a pattern of loads."""
    ops.timeSeries(series, tag)
    ops.pattern("Plain", tag, tag)


def solve(step: float = 1.0, count: int = 1, system: str = "BandGeneral") -> None:
    """Static steps. RuntimeError if one does not converge."""
    ops.system(system)
    ops.numberer("Plain")
    ops.constraints("Transformation")
    ops.test("NormDispIncr", 1e-9, 100)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", step)
    ops.analysis("Static")
    if ops.analyze(count):
        raise RuntimeError("no convergence")


def tangent() -> np.ndarray:
    """Symmetric part of the tangent stiffness (n, n), which `solve` left in a full matrix."""
    size = ops.systemSize()
    stiffness = np.array(ops.printA("-ret")).reshape(size, size)
    return np.asarray(0.5 * (stiffness + stiffness.T))


def lubinski(problem: Problem) -> Found:
    """Negative eigenvalues of the tangent stiffness; the wall as one-sided springs, from which the bit is raised to the axis."""
    given = problem.given["buckling"]
    weight, length = given["weight in mud [N/m]"], given["length [m]"]
    young, _, second = tube(given)

    def shapes(wob: float) -> int:
        piece = beam(given, length, 100, "Corotational")
        ops.fix(0, 1, 1, 0)
        ops.fix(100, 0, 1, 1)
        loads("Linear", 1)
        for k in range(101):
            ops.load(k, -weight * piece * (0.5 if k in (0, 100) else 1.0), 0.0, 0.0)
        ops.load(100, weight * length - wob, 0.0, 0.0)
        solve(system="FullGeneral")
        return int((np.linalg.eigvalsh(tangent()) < 0).sum())

    found = buckling(shapes, (young * second * weight**2) ** (1 / 3))
    given = problem.given["side force"]
    across = given["weight in mud [N/m]"] * np.sin(given["inclination [rad]"])
    piece = beam(given, 40.0, 160, "Linear")
    ops.fix(0, 1, 0, 0)
    springs("ENT", 1e8, range(161))
    loads("Constant", 1)
    for k in range(161):
        ops.load(k, 0.0, -across * piece * (0.5 if k in (0, 160) else 1.0), 0.0)
    solve(0.0)
    loads("Linear", 2)
    ops.sp(0, 2, 0.5 * (given["hole diameter [m]"] - given["outside diameter [m]"]))
    solve(0.02, 50)
    ops.reactions()
    return found | {
        "side force at bit": ops.nodeReaction(0, 2),
        "note": "beam columns: 100 of 3 m, 160 of 0.25 m; one-sided springs of 1e8 N/m as wall",
    }


def dawson_paslay(problem: Problem) -> Found:
    """Loss of positive pivots of the tangent stiffness; the round wall is a bed of springs of weight over clearance."""
    found: Found = {
        "note": "beam columns of 0.5 m; the adapter gives the wall as springs of weight over clearance"
    }
    for part, quantity in (("first", "buckling of 200 m"), ("second", "buckling of a long pipe")):
        given = problem.given[part]
        young, _, second = tube(given)
        bed = 2 * given["weight in mud [N/m]"] / (given["hole diameter [m]"] - given["outside diameter [m]"])

        def unstable(force: float, given: Found = given, bed: float = bed) -> bool:
            count = round(given["length [m]"] / 0.5)
            piece = beam(given, given["length [m]"], count, "Corotational")
            ops.fix(0, 1, 1, 0)
            ops.fix(count, 0, 1, 0)
            springs("Elastic", bed * piece, range(1, count))
            loads("Linear", 1)
            ops.load(count, -force, 0.0, 0.0)
            solve(system="FullGeneral")
            try:
                np.linalg.cholesky(tangent())
            except np.linalg.LinAlgError:
                return True
            return False

        near = 2 * np.sqrt(young * second * bed)
        found[quantity] = threshold(unstable, 0.8 * near, 1.25 * near)
    return found


def chain(stiffness: np.ndarray, fixed: int) -> None:
    """Springs (n,) between n + 1 nodes of one coordinate, one of them fixed."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    for k in range(len(stiffness) + 1):
        ops.node(k, 0.0)
    ops.fix(fixed, 1)
    for k, one in enumerate(stiffness):
        ops.uniaxialMaterial("Elastic", k + 1, float(one))
        ops.element("zeroLength", k, k, k + 1, "-mat", k + 1, "-dir", 1)


def aarsnes_shor(problem: Problem) -> Found:
    """A chain of 200 torsional springs, loaded by the friction of its pieces."""
    stiffness, torque = friction_torques(problem.given, 100)
    # a piece's friction acts at its middle: half a spring on both sides
    chain(np.r_[1 / (0.5 / stiffness[:-1] + 0.5 / stiffness[1:]), 2 * stiffness[-1]], len(stiffness))
    loads("Linear", 1)
    for k, load in enumerate(torque):
        ops.load(k, -float(load))
    solve()
    ops.reactions()
    return {
        "break-off torque": ops.nodeReaction(len(stiffness), 1), "break-off twist": -ops.nodeDisp(0, 1),
        "note": "200 torsional springs; the adapter gives the friction of each",
    }  # fmt: skip


def laboratory_rig(problem: Problem) -> Found:
    """Two rotors with a spring, in explicit steps; the torques of motor and bit are set before each."""
    g = problem.given
    motor, law, step = g["motor"], g["torque on bit"], 5e-5
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    for node, inertia in enumerate((motor["inertia [kg m2]"], g["bit"]["inertia [kg m2]"])):
        ops.node(node, 0.0)
        ops.mass(node, inertia)
    ops.uniaxialMaterial("Elastic", 1, g["shaft"]["stiffness [N m/rad]"], g["shaft"]["damping [N m s/rad]"])
    ops.element("zeroLength", 0, 0, 1, "-mat", 1, "-dir", 1, "-doRayleigh", 0)
    for system in (
        ("system", "FullGeneral"),
        ("numberer", "Plain"),
        ("constraints", "Plain"),
        ("algorithm", "Linear"),
    ):
        getattr(ops, system[0])(system[1])
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    torque, speeds = motor["stall torque [N m]"], [0.0]
    ops.timeSeries("Constant", 1)
    for k in range(round(8 / step)):
        top, bit = ops.nodeVel(0, 1), ops.nodeVel(1, 1)
        torque += (
            step
            * (motor["stall torque [N m]"] - motor["loss of speed [N m s/rad]"] * top - torque)
            / motor["lag [s]"]
        )
        ops.remove("loadPattern", 1)
        ops.pattern("Plain", 1, 1)
        ops.load(0, torque)
        ops.load(
            1,
            float(
                -law["static [N m]"] * np.exp(-((bit / law["speed w0 [rad/s]"]) ** 2)) * np.tanh(bit / 0.05)
            ),
        )
        if ops.analyze(1, step):
            raise RuntimeError("no convergence")
        if (k + 1) % round(1e-3 / step) == 0:
            speeds.append(ops.nodeVel(1, 1))
    note = "steps of 0.05 ms; the adapter gives the torques of bit (smooth below 0.05 rad/s) and motor"
    return rig_figures(np.arange(len(speeds)) * 1e-3, np.array(speeds)) | {"note": note}


def volve_f5(problem: Problem) -> Found:
    """Hanging weights: a chain of 200 pieces, loaded by their weight along the hole."""
    table, depth = problem.table("string.csv"), problem.column("survey.csv", "measured depth [m]")
    inclination, mud = problem.column("survey.csv", "inclination [rad]"), problem.given["mud density [kg/m3]"]
    found: Found = {
        "note": "chain of 200 pieces; the adapter gives the weight of each; friction of a moving string is not in the program"
    }
    for bit in (1900.0, 2400.0):
        lengths = np.array([float(cell) if cell else 0.0 for cell in table["length [m]"]])
        lengths[0] += bit - lengths.sum()
        weights = np.array([float(cell) if cell else 0.0 for cell in table["weight in air [N/m]"]])
        edges = np.linspace(0.0, bit, 201)
        middle = 0.5 * (edges[1:] + edges[:-1])
        part = np.minimum(np.searchsorted(np.cumsum(lengths), middle), len(lengths) - 1)
        weight = (
            weights[part] * (1 - mud / 7850) * np.diff(edges) * np.cos(np.interp(middle, depth, inclination))
        )
        chain(np.full(200, 1e8), 0)
        loads("Linear", 1)
        for k, load in enumerate(weight):
            ops.load(k + 1, float(load))
        solve()
        ops.reactions()
        found[f"hanging weight at {bit:.0f} m"] = -ops.nodeReaction(0, 1)
    return found


if __name__ == "__main__":
    answer(
        {
            "lubinski": lubinski,
            "dawson-paslay": dawson_paslay,
            "aarsnes-shor": aarsnes_shor,
            "volve-f5": volve_f5,
            "laboratory-rig": laboratory_rig,
        }  # fmt: skip
    )
