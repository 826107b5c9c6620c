"""The mud around and in a string that stands or moves along its hole: a model with the flow as its only unknown.

A case becomes a flow case: the same well, string and mud, without drive, loads, joints, contact and rock.  The
unstrained string lies on the axis of the hole.  `steady_flow` solves for the flow, with the equations of the
simulation (manual: sec-mud-steady).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeVar

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.statics.placement import hole_at_string, place_along_hole
from drillpetsc.analysis.statics.steady_flow import fluid_unknowns, set_fluid_at_rest, steady_flow
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.ends import HeldBottom, HeldTop
from drillpetsc.case.blocks.fluid import Fluid
from drillpetsc.case.blocks.items.motor import PositiveDisplacementMotor
from drillpetsc.case.blocks.items.string import Flexible, Item
from drillpetsc.case.blocks.items.tools import TelescopingTool
from drillpetsc.case.blocks.settings import BeamTheory
from drillpetsc.case.blocks.well import Well as WellCase
from drillpetsc.case.case import Case
from drillpetsc.case.quantities import said
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.model.drilling_model import DrillingModel, build_model, build_well
from drillpetsc.model.fluid import build_rheology
from drillpetsc.model.hole import top_of_string
from drillpetsc.model.mesh import MeshOf
from drillpetsc.output.measured.in_hole import equivalent_density
from drillpetsc.physics.fluid.channel_flow import ChannelFlow
from drillpetsc.time_function import Constant, PiecewiseLinear

Pipe = Literal["closed", "open", "pumping"]

LARGEST_FLOW = 1.0  # largest flow rate of a pump that is accepted [m3/s]
LARGEST_SPEED = 10.0  # largest speed of the string that is accepted [m/s]
BELOW_BIT = 10.0  # length of the hole below the bit of a moving string, which never stands on bottom [m]
RAMP = (
    1 / 64,
    1 / 16,
    1 / 4,
    1 / 2,
    1.0,
)  # shares of flow rate and speed where the whole does not converge at once
SHORTEST_PIECE = 1e-3  # shorter pieces of an item are not split off [m]

# The inputs of a flow model are functions of the flow rate: at the "time" q the pump delivers q m3/s.
_FLOW_AS_TIME = PiecewiseLinear((0.0, 2 * LARGEST_FLOW), (0.0, 2 * LARGEST_FLOW))


AnyItem = TypeVar("AnyItem", bound=Item)


@dataclass(frozen=True)
class PlacedString:
    """The part of a string that is in the hole.

    items: from the top down; number: of each in the case's string.
    top: measured depth of the upper end [m].
    """

    items: tuple[Item, ...]
    number: tuple[int, ...]
    top: float

    @property
    def length(self) -> float:
        """Length of the string [m]."""
        return sum(item.length for item in self.items)

    @property
    def depth(self) -> float:
        """Measured depth of the lower end [m]."""
        return self.top + self.length


def with_length(item: AnyItem, length: float, above: float = 0.0) -> AnyItem:
    """A piece of an item, or the item lengthened; a tool's loss and volume go with the length, its joint stays where it is.

    length: of the piece [m]; above: length of the item that is cut off above it, negative where it is lengthened there [m].
    """
    loss = item.pressure_loss
    if loss is not None:
        loss = loss.times(length / item.length)
    update: dict[str, object] = {"length": length, "pressure_loss": loss}
    if item.bore_volume is not None:
        update["bore_volume"] = item.bore_volume * length / item.length
    if isinstance(item, (TelescopingTool, PositiveDisplacementMotor)):
        at = item.joint_at - above
        # one piece has the joint; in the others it lies at the end, where there is none (``CaseBlocks.tools``)
        update["joint_at"] = min(at, length - 0.5 * SHORTEST_PIECE) if 0 < at <= length else length
    return item.model_copy(update=update)


def whole_string(case: Case) -> PlacedString:
    """The case's string where statics puts it: on bottom with a weight on bit, else with its top at the rig."""
    top = top_of_string(case, case.string_length)
    return PlacedString(tuple(case.string), tuple(range(len(case.string))), top)


def string_at(case: Case, depth: float) -> PlacedString:
    """The lowest ``depth`` metres of the string, with its top at the rig; a topmost pipe is cut, or lengthened.

    Raises CaseError if the string cannot be made so long, or the hole is not so deep.
    """
    units = case.shown_units

    def wrong(want: str) -> CaseError:
        return CaseError(at="--bit-depth", got=said(depth, "length", units), want=want)

    if case.well is not None and depth > case.well.survey.md[-1] + 1e-6:
        raise wrong(f"at most {said(case.well.survey.md[-1], 'length', units)}, the end of the hole")
    items: list[Item] = []
    number: list[int] = []
    left = depth
    for i, item in reversed(list(enumerate(case.string))):
        if left < SHORTEST_PIECE:
            break
        if isinstance(item, Flexible) and (i == 0 or item.length > left):
            item = with_length(item, left, item.length - left)
        elif item.length > left + SHORTEST_PIECE:
            raise wrong(f"a depth at which the top of the string is not inside a rigid item ({item.name})")
        items.insert(0, item)
        number.insert(0, i)
        left -= item.length
    if left >= SHORTEST_PIECE:
        length = said(case.string_length, "length", units)
        raise wrong(f"at most {length}, the length of the string: its topmost item is not a pipe")
    if not any(isinstance(item, Flexible) for item in items):
        raise wrong("a depth at which a pipe is in the hole")
    return PlacedString(tuple(items), tuple(number), 0.0)


def _split(string: PlacedString, depths: list[float]) -> PlacedString:
    """The same string with pipes cut at measured depths [m], so that an element has one section of the hole."""
    items: list[Item] = []
    number: list[int] = []
    above = string.top
    for item, i in zip(string.items, string.number, strict=True):
        inside = [d for d in depths if above + SHORTEST_PIECE < d < above + item.length - SHORTEST_PIECE]
        edges = [above, *(inside if isinstance(item, Flexible) else ()), above + item.length]
        for a, b in zip(edges, edges[1:], strict=False):
            items.append(item if len(edges) == 2 else with_length(item, b - a, a - above))
            number.append(i)
        above += item.length
    return PlacedString(tuple(items), tuple(number), string.top)


def need_mud(case: Case, command: str) -> Fluid:
    """The fluid of the case; CaseError where it has none.

    command: for the message.
    """
    if case.fluid is None:
        raise CaseError(
            at="fluid",
            want=f"a fluid for {command}",
            hint="without mud there is no pressure: give fluid: {density: ..., rheology: {...}}",
        )
    return case.fluid


def _ending_below(case: Case, depth: float, below: float) -> WellCase:
    """The well with a straight end ``below`` metres below a measured depth [m].

    The flow at the bit takes the direction of the hole's end for that at the bit (manual: sec-mud-bit), so the end of
    a hole in which the string moves must lie right below it.
    """
    well, path = case.well, build_well(case)
    assert well is not None and path is not None
    survey, end = well.survey, depth + below
    kept = [i for i, md in enumerate(survey.md) if md < depth - SHORTEST_PIECE]
    tangent = np.asarray(path.at(np.array([depth]))[1])[0]
    inclination = float(np.arctan2(np.hypot(tangent[0], tangent[1]), tangent[2]))
    azimuth = float(np.arctan2(tangent[1], tangent[0]))
    stations = survey.model_copy(
        update={
            "md": (*(survey.md[i] for i in kept), depth, end),
            "inclination": (*(survey.inclination[i] for i in kept), inclination, inclination),
            "azimuth": (*(survey.azimuth[i] for i in kept), azimuth, azimuth),
        }
    )
    number = next(i for i, s in enumerate(well.sections) if s.to >= depth - SHORTEST_PIECE)
    last = well.sections[number].model_copy(update={"to": end})
    return well.model_copy(update={"survey": stations, "sections": (*well.sections[:number], last)})


def flow_case(
    case: Case, string: PlacedString, pipe: Pipe, moving: bool = False, below: float = BELOW_BIT
) -> tuple[Case, PlacedString]:
    """The case of the flow alone, and its string with pipes cut at the ends of hole sections.

    pipe: closed: no flow through the bit; open: the bore is open at the top, filled to the height of the flow line;
    pumping: a flow rate into the bore, given as the time of the solution.
    moving: the hole ends ``below`` metres below the bit, so that a bit on bottom displaces mud.
    """
    fluid, well = need_mud(case, "hydraulics"), case.well
    if well is not None:
        string = _split(string, [section.to for section in well.sections[:-1]])
    if well is not None and moving:
        well = _ending_below(case, string.depth, below)
    gravity = np.array(case.gravity, dtype=float)
    if not gravity.any():
        raise CaseError(
            at="gravity", got=0, want="gravity above 0: pressures and densities along the depth need it"
        )
    path = build_well(case)
    plugged = case.bottom.plugged and bool(case.side_nozzles)  # the mud gets out above
    top = (
        string.top * gravity[2]
        if path is None
        else float(np.asarray(path.at(np.array([string.top]))[0])[0] @ gravity)
    )
    filled = fluid.density * (top - fluid.flow_line * float(np.linalg.norm(gravity)))  # up to the flow line
    mud = fluid.model_copy(
        update={
            "formulation": "mixed",
            "dynamics": "full",
            "cuttings": "removed",
            "flow_rate": _FLOW_AS_TIME if pipe == "pumping" else Constant(0.0) if pipe == "closed" else None,
            "pump_pressure": Constant(filled) if pipe == "open" else None,
            "outlet_pressure": Constant(fluid.outlet_pressure.value(0.0)),
        }
    )
    bare = case.model_copy(
        update={
            "string": string.items,
            "well": well,
            "fluid": mud,
            "beam": BeamTheory(),
            "hold_string": False,
            "top": HeldTop(kind="clamped"),
            "bottom": HeldBottom(kind="free", plugged=pipe == "closed" or plugged),
            "contact": None,
            "formation": None,
            "joints": (),
            "loads": (),
            "time": None,
        }
    )
    return bare, string


class FlowModel:
    """Steady flow for flow rates and speeds of the string; one process.

    case: the user's case; string: its part in the hole; pipe, moving: as in `flow_case`.
    like: a model of nearly the same case, whose elements are taken.
    """

    def __init__(
        self,
        case: Case,
        string: PlacedString,
        pipe: Pipe,
        moving: bool = False,
        like: FlowModel | None = None,
    ) -> None:
        bare, self.string = flow_case(case, string, pipe, moving)
        self.case, self.pipe, self.moving = case, pipe, moving
        mesh_of: MeshOf | None = None if like is None else like.mesh_of
        self.model: DrillingModel = build_model(bare, PETSc.COMM_SELF, like=mesh_of)
        self.mesh_of: MeshOf = MeshOf(bare, self.model.mesh)
        assert self.model.fluid is not None
        self.fluid, self.system, self.mesh = self.model.fluid, self.model.system, self.model.mesh
        self._placed = False

    def solve(self, flow: float = 0.0, speed: float = 0.0) -> None:
        """Solve for the steady flow.

        flow: rate of the pump [m3/s], for a pumping string.
        speed: of the string along the hole, positive down [m/s].
        Raises SolveError if there is no steady flow.
        """
        try:
            self._solve_from_here(flow, speed)
        except SolveError:
            self._placed = False
            for share in RAMP:  # from rest, in steps
                self._solve_from_here(share * flow, share * speed)

    def place(self, flow: float, speed: float) -> None:
        """Put the string into its hole, with its speed; mud at rest where it has not been placed before."""
        model = self.model
        if not self._placed:
            place_along_hole(model, self.string.top)
            set_fluid_at_rest(self.system, self.fluid, flow)
            self._axis = hole_at_string(model)
            self._placed = True
        model.beam.set_rigid_motion(self.system, *self._axis, speed, 0.0)

    def _solve_from_here(self, flow: float, speed: float) -> None:
        """Solve from the present unknowns, or from mud at rest in a string that has not been placed."""
        self.place(flow, speed)
        try:
            steady_flow(self.system, flow)
        except SolveError as error:
            self._placed = False  # the unknowns are those of a failed iteration
            error.time = None  # the "time" is the flow rate
            if flow:
                error.what = f"at {flow:g} m3/s {error.what}"
            if not build_rheology(self.case).yield_stress:
                error.hint = "can the nozzles, the bore and the choke take this flow?"
            raise

    # ------------------------------------------------------------------ state
    def take_flow(self, unknowns: FloatArray) -> None:
        """Take pressures and flows from the ``unknowns`` (n,) of a model with the same elements; the string stays where it is."""
        mud = fluid_unknowns(self.system)
        self.system.assembly.x[: len(mud)][mud] = unknowns[: len(mud)][mud]

    @property
    def md(self) -> FloatArray:
        """(n+1,) measured depths of the nodes [m]."""
        return self.mesh.node_depth + self.string.top

    @property
    def gravity(self) -> float:
        """Gravity [m/s2]."""
        return float(np.linalg.norm(self.fluid.constants.gravity))

    @property
    def tvd(self) -> FloatArray:
        """(n+1,) vertical depths of the nodes below the rotary table [m]."""
        return self.system.field("string.position") @ self.fluid.constants.gravity / self.gravity

    @property
    def flow_line(self) -> float:
        """Vertical depth of the flow line below the rotary table [m]."""
        return self.case.given_fluid.flow_line

    def channel(self, name: str) -> ChannelFlow | None:
        """The flow in ``bore`` or ``annulus``; None if there is none."""
        return self.fluid.bore if name == "bore" else self.fluid.annulus

    def pressure(self, channel: str) -> FloatArray | None:
        """(n+1,) gauge pressures at the nodes [Pa] of ``bore`` or ``annulus``; None if there is none."""
        component = self.channel(channel)
        return None if component is None else np.array(component.pressures(self.system))

    def flow_rate(self, channel: str) -> FloatArray | None:
        """(n,) flow rates at zero pressure [m3/s] in the elements, towards the bit; None if there is none."""
        component = self.channel(channel)
        return None if component is None else np.array(component.flows(self.system))

    def bottom_pressure(self) -> float:
        """Gauge pressure of the mud under the bit [Pa]."""
        annulus = self.pressure("annulus")
        if annulus is not None:
            return float(annulus[-1])
        return self.case.given_fluid.outlet_pressure.value(0.0)

    def pressure_above(self, depth: FloatArray) -> FloatArray:
        """Compute the gauge pressure [Pa] of the mud above the string's top at vertical depths (k,) [m].

        It is the column, of the density without pressure, that gives the annulus its pressure at the top.
        """
        pressure = self.pressure("annulus")
        assert pressure is not None
        rise = np.asarray(depth) - float(self.tvd[0])
        return np.asarray(pressure[0] + self.fluid.constants.density * self.gravity * rise)

    def pressure_below(self, depth: FloatArray) -> FloatArray:
        """Compute the gauge pressure [Pa] of still mud below the bit at vertical depths (k,) [m]."""
        f, p, z = self.fluid.constants, self.bottom_pressure(), float(self.tvd[-1])
        rise = f.density * self.gravity * (np.asarray(depth) - z)
        # d(exp(-p/K)) = -rho0 g dz/K
        return np.asarray(p - f.bulk_modulus * np.log1p(-np.exp(p / f.bulk_modulus) * rise / f.bulk_modulus))

    def equivalent_density(self, pressure: FloatArray | float, depth: FloatArray | float) -> FloatArray:
        """Compute p/(g z) [kg/m3] with the vertical depth below the flow line; nan less than 1 m below it and above.

        pressure: (k,) gauge [Pa]; depth: (k,) vertical, below the rotary table [m].
        """
        return equivalent_density(pressure, np.asarray(depth, dtype=float) - self.flow_line, self.gravity)
