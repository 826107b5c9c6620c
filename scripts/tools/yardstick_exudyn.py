"""Exudyn on the problems of the yardstick: python scripts/tools/yardstick_exudyn.py exudyn.json [PROBLEM ...]

Run it with a Python that has exudyn and scipy. The note of an answer tells what the adapter adds to the program.
"""

from __future__ import annotations

from typing import Any

import exudyn as exu
import exudyn.itemInterface as item
import numpy as np
from exudyn.beams import GenerateBeamElementsAlongLine
from yardstick_common import (
    GRAVITY,
    Found,
    answer,
    buckling,
    friction_torques,
    rig_figures,
    threshold,
    tube,
)
from yardstick_score import Problem

HINGE, GUIDE, CLAMP, FREE = [1, 1, 0, 0], [0, 1, 0, 0], [1, 1, 0, 1], [0, 0, 0, 0]  # x, y, x', y' of a node


def quiet() -> exu.SimulationSettings:
    """Settings without files and messages."""
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.staticSolver.verboseMode = settings.timeIntegration.verboseMode = 0
    return settings


class Beam:
    """A straight plane beam of ANCF cable elements along x: pieces of equal length, ends fixed as given."""

    def __init__(
        self,
        length: float,
        count: int,
        ends: tuple[list[int], list[int]],
        cable: Any,
        pull: tuple[float, float] = (0.0, 0.0),
    ):
        self.mbs = exu.SystemContainer().AddSystem()
        self.first = 0
        self.ends, self.count = ends, count
        made = cable(self.mbs)
        if isinstance(made, tuple):
            made, self.first = made
        line = GenerateBeamElementsAlongLine(
            self.mbs, [0, 0, 0], [length, 0, 0], count, beamTemplate=made, gravity=[*pull, 0],
            groundConstraintsStart=ends[0], groundConstraintsEnd=ends[1],
        )  # fmt: skip
        self.nodes = line["nodes"]
        self.ground = self.mbs.AddMarker(
            item.MarkerNodeCoordinate(nodeNumber=self.mbs.AddNode(item.NodePointGround()), coordinate=0)
        )

    def across(self, node: int) -> int:
        """Marker of the displacement across."""
        return int(self.mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=self.nodes[node], coordinate=1)))

    def push(self, force: float) -> None:
        """Axial force on the end [N]."""
        marker = self.mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=self.nodes[-1], coordinate=0))
        self.mbs.AddLoad(item.LoadCoordinate(markerNumber=marker, load=force))

    def equilibrium(self, steps: int = 1) -> None:
        """Static solution, which becomes the initial state."""
        self.mbs.Assemble()
        settings = quiet()
        settings.staticSolver.numberOfLoadSteps = steps
        settings.staticSolver.newton.relativeTolerance = 1e-7
        settings.staticSolver.newton.maxIterations = 100
        self.mbs.SolveStatic(settings, updateInitialValues=True)

    def matrices(self) -> list[np.ndarray]:
        """Mass, stiffness and damping matrices of the free coordinates."""
        fixed = [k for k, held in enumerate(self.ends[0]) if held]
        fixed += [4 * self.count + k for k, held in enumerate(self.ends[1]) if held]
        keep = np.setdiff1d(np.arange(4 * self.count + 4), fixed) + self.first
        return [np.asarray(q)[np.ix_(keep, keep)] for q in self.mbs.ComputeLinearizedSystem(quiet())[:3]]

    def negative(self) -> int:
        """Number of negative eigenvalues of the stiffness: unstable shapes."""
        stiffness = self.matrices()[1]
        return int((np.linalg.eigvalsh(0.5 * (stiffness + stiffness.T)) < 0).sum())


def cable(given: Found, mass: float) -> Any:
    """Maker of a cable element: mass per length [kg/m]."""
    young, area, second = tube(given)
    return lambda mbs: item.ObjectANCFCable2D(
        physicsMassPerLength=mass, physicsBendingStiffness=young * second, physicsAxialStiffness=young * area
    )


def lubinski(problem: Problem) -> Found:
    """Negative eigenvalues of the stiffness."""
    given = problem.given["buckling"]
    weight, length = given["weight in mud [N/m]"], given["length [m]"]
    young, _, second = tube(given)

    def negative(wob: float) -> int:
        beam = Beam(length, 100, (HINGE, [0, 1, 0, 1]), cable(given, weight / GRAVITY), (-GRAVITY, 0.0))
        beam.push(weight * length - wob)
        beam.equilibrium()
        return beam.negative()

    found = buckling(negative, (young * second * weight**2) ** (1 / 3))
    return found | {
        "note": "100 ANCF cables of 3 m; no side force: Newton's method did not converge with one-sided springs as the wall"
    }


def dawson_paslay(problem: Problem) -> Found:
    """Negative eigenvalues of the stiffness; the round wall is a bed of springs of weight over clearance."""
    found: Found = {
        "note": "ANCF cables of 2 m; the adapter gives the wall as springs of weight over clearance"
    }
    for part, quantity in (("first", "buckling of 200 m"), ("second", "buckling of a long pipe")):
        given = problem.given[part]
        weight, length = given["weight in mud [N/m]"], given["length [m]"]
        young, _, second = tube(given)
        bed = 2 * weight / (given["hole diameter [m]"] - given["outside diameter [m]"])
        count = round(length / 2)

        def negative(
            force: float, given: Found = given, length: float = length, bed: float = bed, count: int = count
        ) -> int:
            beam = Beam(length, count, (HINGE, GUIDE), cable(given, 30.0))
            for node in range(1, count):
                beam.mbs.AddObject(
                    item.CoordinateSpringDamper(
                        markerNumbers=[beam.ground, beam.across(node)], stiffness=bed * length / count
                    )
                )
            beam.push(-force)
            beam.equilibrium()
            return beam.negative()

        near = 2 * np.sqrt(young * second * bed)
        found[quantity] = threshold(lambda f, n=negative: n(f) >= 1, 0.8 * near, 1.25 * near)
    return found


def _angles(mbs: Any, count: int) -> list[Any]:
    """Nodes of one angle each."""
    zero = {"referenceCoordinates": [0.0], "initialCoordinates": [0.0], "initialCoordinates_t": [0.0]}
    return [mbs.AddNode(item.NodeGenericODE2(numberOfODE2Coordinates=1, **zero)) for _ in range(count)]


def aarsnes_shor(problem: Problem) -> Found:
    """A chain of 200 torsional springs, loaded by the friction of its pieces."""
    stiffness, torque = friction_torques(problem.given, 100)
    mbs = exu.SystemContainer().AddSystem()
    nodes = _angles(mbs, len(stiffness))
    marks = [mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=node, coordinate=0)) for node in nodes]
    ground = mbs.AddMarker(
        item.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(item.NodePointGround()), coordinate=0)
    )
    # a piece's friction acts at its middle: half a spring on both sides
    soft = np.r_[1 / (0.5 / stiffness[:-1] + 0.5 / stiffness[1:]), 2 * stiffness[-1]]
    for low, high, k, load in zip(marks, [*marks[1:], ground], soft, torque, strict=True):
        mbs.AddObject(item.CoordinateSpringDamper(markerNumbers=[high, low], stiffness=k))
        mbs.AddLoad(item.LoadCoordinate(markerNumber=low, load=-load))
    mbs.Assemble()
    mbs.SolveStatic(quiet(), updateInitialValues=True)
    angle = mbs.systemData.GetODE2Coordinates(exu.ConfigurationType.Initial)
    return {
        "break-off torque": float(-soft[-1] * angle[-1]),
        "break-off twist": float(-angle[0]),
        "note": "200 torsional springs; the adapter gives the friction of each",
    }


def paidoussis(problem: Problem) -> Found:
    """Eigenvalues of the matrices of ALE cables, whose moving part is the fluid."""
    g = problem.given
    length, bending = g["length [m]"], g["bending stiffness [N m2]"]
    fluid = g["fluid density [kg/m3]"] * np.pi / 4 * g["inside diameter [m]"] ** 2

    def roots(u: float, which: Found, ends: tuple[list[int], list[int]]) -> np.ndarray:
        mass = fluid / which["beta [-]"]
        speed = u / length * np.sqrt(bending / fluid)

        def made(mbs: Any) -> tuple[Any, int]:
            moving = mbs.AddNode(
                item.NodeGenericODE2(
                    referenceCoordinates=[0.0],
                    initialCoordinates=[0.0],
                    initialCoordinates_t=[0.0],
                    numberOfODE2Coordinates=1,
                )
            )
            return item.ObjectALEANCFCable2D(
                physicsMassPerLength=mass, physicsBendingStiffness=bending, physicsAxialStiffness=1e8,
                physicsMovingMassFactor=which["beta [-]"], nodeNumbers=[0, 0, moving],
            ), 1  # fmt: skip

        gravity = which.get("gamma [-]", 0.0) * bending / (mass * length**3)
        beam = Beam(length, 16, ends, made, (gravity, 0.0))
        moving = beam.mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=0, coordinate=0))
        beam.mbs.AddObject(item.CoordinateConstraint(markerNumbers=[beam.ground, moving]))
        if gravity:
            beam.equilibrium()
        else:
            beam.mbs.Assemble()
        start = beam.mbs.systemData
        speeds = np.array(start.GetODE2Coordinates_t(exu.ConfigurationType.Initial))
        speeds[0] = speed
        start.SetODE2Coordinates_t(speeds, exu.ConfigurationType.Initial)
        inertia, stiffness, damping = beam.matrices()
        count = len(inertia)
        first_order = np.block(
            [
                [np.zeros((count, count)), np.eye(count)],
                [-np.linalg.solve(inertia, stiffness), -np.linalg.solve(inertia, damping)],
            ]
        )
        return np.asarray(np.linalg.eigvals(first_order)) * length**2 * np.sqrt(mass / bending)

    found: Found = {"note": "16 ALE ANCF cables"}
    grows = 1e-4  # rounding leaves 1e-10
    pinned, hanging = (HINGE, GUIDE), (CLAMP, FREE)
    found["divergence"] = threshold(lambda u: roots(u, g["hinged"], pinned).real.max() > grows, 2.0, 5.0)
    for name, words in (("cantilever", "flutter"), ("hanging cantilever", "hanging flutter")):
        u = threshold(lambda u, which=g[name]: roots(u, which, hanging).real.max() > grows, 3.0, 8.0)
        at = roots(u, g[name], hanging)
        found |= {f"{words} speed": u, f"{words} frequency": float(abs(at[np.argmax(at.real)].imag))}
    return found


def laboratory_rig(problem: Problem) -> Found:
    """Two rotors with a spring; the law of the bit and the lag of the motor are functions of the adapter."""
    g = problem.given
    motor, law = g["motor"], g["torque on bit"]
    mbs = exu.SystemContainer().AddSystem()
    nodes = _angles(mbs, 2)
    for node, inertia in zip(nodes, (motor["inertia [kg m2]"], g["bit"]["inertia [kg m2]"]), strict=True):
        mbs.AddObject(item.ObjectGenericODE2(nodeNumbers=[node], massMatrix=[[inertia]]))
    marks = [mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=node, coordinate=0)) for node in nodes]
    shaft = {
        "stiffness": g["shaft"]["stiffness [N m/rad]"],
        "damping": g["shaft"]["damping [N m s/rad]"],
    }
    mbs.AddObject(item.CoordinateSpringDamper(markerNumbers=marks, **shaft))
    torque = mbs.AddNode(
        item.NodeGenericODE1(
            referenceCoordinates=[0.0],
            initialCoordinates=[motor["stall torque [N m]"]],
            numberOfODE1Coordinates=1,
        )
    )
    speed_of = exu.OutputVariableType.Coordinates_t

    def lag(mbs: Any, t: float, number: int, state: list[float]) -> list[float]:
        speed = float(np.ravel(mbs.GetNodeOutput(nodes[0], speed_of))[0])
        wanted = motor["stall torque [N m]"] - motor["loss of speed [N m s/rad]"] * speed
        return [(wanted - state[0]) / motor["lag [s]"]]

    def driven(mbs: Any, t: float, load: float) -> float:
        return float(np.ravel(mbs.GetNodeOutput(torque, exu.OutputVariableType.Coordinates))[0])

    def resisted(mbs: Any, t: float, load: float) -> float:
        w = float(np.ravel(mbs.GetNodeOutput(nodes[1], speed_of))[0])
        return float(-law["static [N m]"] * np.exp(-((w / law["speed w0 [rad/s]"]) ** 2)) * np.tanh(w / 0.02))

    mbs.AddObject(item.ObjectGenericODE1(nodeNumbers=[torque], rhsUserFunction=lag))
    mbs.AddLoad(item.LoadCoordinate(markerNumber=marks[0], load=1.0, loadUserFunction=driven))
    mbs.AddLoad(item.LoadCoordinate(markerNumber=marks[1], load=1.0, loadUserFunction=resisted))
    sensor = mbs.AddSensor(
        item.SensorNode(
            nodeNumber=nodes[1], outputVariableType=speed_of, storeInternal=True, writeToFile=False
        )
    )
    mbs.Assemble()
    settings = quiet()
    settings.timeIntegration.endTime, settings.timeIntegration.numberOfSteps = 8.0, 80000
    settings.solution.sensors.writePeriod = 1e-3
    mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.RK44)
    history = mbs.GetSensorStoredData(sensor)
    time = np.arange(8001) * 1e-3
    return rig_figures(time, np.interp(time, history[:, 0], history[:, 1])) | {
        "note": "explicit steps of 0.1 ms; the adapter gives the law of the bit, smooth below 0.02 rad/s, and the lag"
    }


if __name__ == "__main__":
    answer(
        {
            "lubinski": lubinski,
            "dawson-paslay": dawson_paslay,
            "aarsnes-shor": aarsnes_shor,
            "paidoussis": paidoussis,
            "laboratory-rig": laboratory_rig,
        }  # fmt: skip
    )
