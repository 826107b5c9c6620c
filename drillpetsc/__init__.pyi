"""Types of the public names. Written by `python -m drillpetsc.api.stub`; do not edit."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from drillpetsc import units as units, vibration as vibration
from drillpetsc.analysis.motion.session.session import Session as Session
from drillpetsc.case import Case as _Case
from drillpetsc.case.catalogue import catalogue as catalogue
from drillpetsc.errors import CaseError as CaseError, SolveError as SolveError
from drillpetsc.physics.tools.motor_law import MotorLaw
from drillpetsc.results import Result
from drillpetsc.studies.convergence.study import StudyResult
from drillpetsc.studies.sweep.sweep import SweepResult

__version__: str

Value = float | str
"""A text with a unit, or a number in the unit of the case."""

class PythonBlock:
    """A block of a case: a mapping of its keys."""
    def __getitem__(self, key: str) -> Any: ...
    def __setitem__(self, key: str, value: Any) -> None: ...

class AgitatorSection(PythonBlock):
    """Valve, piston and spring of an agitator.

    rev_per_volume: turns of the rotor, a pulse each, per volume of mud, `0.5 rev/l` [rad/m3]
    pressure_amplitude: amplitude of the pressure of a pulse [Pa]
    piston_area: area on which the pulses push the halves apart [m2]
    spring: stiffness of the spring between the halves [N/m]
    damping: force over the speed at which the halves telescope [N s/m]
    pulse: form of the pulses
    flow_rate: flow rate over time of a case without fluid [m3/s]; 0 when not given, which leaves a shock sub
    """
    def __init__(
        self,
        *,
        rev_per_volume: Value,
        pressure_amplitude: Value,
        piston_area: Value,
        spring: Value,
        damping: Value | None = None,
        pulse: Literal['sine', 'square'] | None = None,
        flow_rate: Value | dict[str, Any] | None = None,
    ) -> None: ...

class Agitator(PythonBlock):
    """An agitator: a valve in the mud shakes the string along its axis.

    length: length [m]
    od: outer diameter [m]
    agitator: valve, piston and spring
    name: name in reports; the kind when not given
    friction: friction coefficient of this item, instead of the hole section's [-]
    weight: weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area [kg/m]; mud displaces the ring between od and id
    pressure_loss: pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or {curve: loss.csv, density: 10 ppg}
    element_length: target length of an element, rounded so that elements fit the item [m]; auto: chosen from the physics along the string and graded
    eccentricity: offset of the mass centre from the axis [m]
    eccentricity_angle: direction of the eccentricity in the section [rad]
    curvature: stress-free curvature [1/m]
    curvature_angle: direction in which the item bends downward [rad]: 0 is the high side, 90 deg to the right looking down the hole; measured from north if the inclination is below 5 deg; at spin angle zero
    bend: bent sub: kink at the item's upper end
    initial: imperfection of this item
    id: inner diameter [m]
    material: material of this item; keys left out are the case's
    bore_volume: volume of the mud inside the item [m3]; the volume of a bore of its id when not given
    annulus_od: outer diameter that the mud outside flows past and that displaces it [m]; od when not given
    mass: mass [kg]; when not given, the mass of a tube with this od, id, length and density
    joint_at: distance of the slider below the item's upper end [m]; half the length when not given
    seal_area: area inside the seals, on which the pressure difference between string and annulus pushes the parts apart (pump-open force) [m2]
    stop_stiffness: stiffness of the stops at the ends of the stroke [N/m]
    """
    def __init__(
        self,
        *,
        length: Value,
        od: Value,
        agitator: AgitatorSection | dict[str, Any],
        name: str | None = None,
        friction: float | None = None,
        weight: Value | None = None,
        pressure_loss: PressureLoss | dict[str, Any] | None = None,
        element_length: Value | None = None,
        eccentricity: Value | None = None,
        eccentricity_angle: Value | None = None,
        curvature: Value | None = None,
        curvature_angle: Value | None = None,
        bend: Bend | dict[str, Any] | None = None,
        initial: ItemInitial | dict[str, Any] | None = None,
        id: Value | None = None,
        material: Material | dict[str, Any] | None = None,
        bore_volume: Value | None = None,
        annulus_od: Value | None = None,
        mass: Value | None = None,
        joint_at: Value | None = None,
        seal_area: Value | None = None,
        stop_stiffness: Value | None = None,
    ) -> None: ...

class Autodriller(PythonBlock):
    """Control of the drum's speed; of several modes the one with the least speed acts.

    mode: what is held at its set point, or the first limit of several
    wob: set point of the weight on bit over time [N]
    rop: set point of the rate of penetration over time [m/s]: the speed of the drum
    torque: set point of the surface torque over time [N m]
    differential_pressure: set point of the pump pressure minus the pump pressure at the time from [Pa]
    p: proportional gain of mode wob [m/(s N)]
    i: integral gain of mode wob [m/(s2 N)]
    torque_p: proportional gain of mode torque [m/(s N m)]
    torque_i: integral gain of mode torque [m/(s2 N m)]
    pressure_p: proportional gain of mode differential_pressure [m/(s Pa)]
    pressure_i: integral gain of mode differential_pressure [m/(s2 Pa)]
    measure: weight on bit: surface, from the hook load, tared at the start; bit, the true one
    from_: time from which it acts [s]; before, the drum has the speed lowering
    max_speed: largest speed of the drum [m/s]; default: the largest speed of the hoist
    reverse: true: the drum may also hoist, up to max_speed
    ramp: largest rate of the weight's set point, which begins at the weight at from [N/s]
    filter: time constant of the filter of the measurements [s]
    sample: interval of the measurements, held in between [s]; 0: continuous
    """
    def __init__(
        self,
        *,
        mode: Literal['wob', 'rop', 'torque', 'differential_pressure'] | Sequence[Literal['wob', 'rop', 'torque', 'differential_pressure']] | None = None,
        wob: Value | dict[str, Any] | None = None,
        rop: Value | dict[str, Any] | None = None,
        torque: Value | dict[str, Any] | None = None,
        differential_pressure: Value | dict[str, Any] | None = None,
        p: Value | None = None,
        i: Value | None = None,
        torque_p: Value | None = None,
        torque_i: Value | None = None,
        pressure_p: Value | None = None,
        pressure_i: Value | None = None,
        measure: Literal['surface', 'bit'] | None = None,
        from_: Value | None = None,
        max_speed: Value | None = None,
        reverse: bool | None = None,
        ramp: Value | None = None,
        filter: Value | None = None,
        sample: Value | None = None,
    ) -> None: ...

class Backreaming(PythonBlock):
    """Pulling out with rotation.

    speed: upward speed [m/s]
    rpm: rotation [rad/s]
    tob: torque of the rock on the bit [N m]
    flow_rate: flow rate of the pump, which drags and lifts the string [m3/s]; 0: the mud is at rest; fluid.flow_rate at time 0 when not given
    """
    def __init__(
        self,
        *,
        speed: Value | None = None,
        rpm: Value | None = None,
        tob: Value | None = None,
        flow_rate: Value | None = None,
    ) -> None: ...

class Beam(PythonBlock):
    """An item given by its stiffnesses, for anything that is not a round tube.

    length: length [m]
    axial_stiffness: axial stiffness EA [N]
    bending_stiffness: bending stiffness EI [N m2]
    torsional_stiffness: torsional stiffness GJ [N m2]
    polar_inertia: polar mass moment of inertia per length [kg m]
    name: name in reports; the kind when not given
    friction: friction coefficient of this item, instead of the hole section's [-]
    weight: weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area [kg/m]; mud displaces the ring between od and id
    pressure_loss: pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or {curve: loss.csv, density: 10 ppg}
    element_length: target length of an element, rounded so that elements fit the item [m]; auto: chosen from the physics along the string and graded
    eccentricity: offset of the mass centre from the axis [m]
    eccentricity_angle: direction of the eccentricity in the section [rad]
    curvature: stress-free curvature [1/m]
    curvature_angle: direction in which the item bends downward [rad]: 0 is the high side, 90 deg to the right looking down the hole; measured from north if the inclination is below 5 deg; at spin angle zero
    bend: bent sub: kink at the item's upper end
    initial: imperfection of this item
    mass: mass per length [kg/m]; or give the weight
    od: outer diameter [m]; needed in a well and with a fluid
    id: inner diameter [m]
    damping: damping; keys left out are the case's material.damping
    """
    def __init__(
        self,
        *,
        length: Value,
        axial_stiffness: Value,
        bending_stiffness: Value,
        torsional_stiffness: Value,
        polar_inertia: Value,
        name: str | None = None,
        friction: float | None = None,
        weight: Value | None = None,
        pressure_loss: PressureLoss | dict[str, Any] | None = None,
        element_length: Value | None = None,
        eccentricity: Value | None = None,
        eccentricity_angle: Value | None = None,
        curvature: Value | None = None,
        curvature_angle: Value | None = None,
        bend: Bend | dict[str, Any] | None = None,
        initial: ItemInitial | dict[str, Any] | None = None,
        mass: Value | None = None,
        od: Value | None = None,
        id: Value | None = None,
        damping: Damping | dict[str, Any] | None = None,
    ) -> None: ...

class BeamTheory(PythonBlock):
    """Unknowns of the string.

    formulation: ancf: position, slope and spin angle at each node; quaternion: strain and Euler parameters, the element of the reference formulation (DOI 10.1177/1687814016656703)
    constraint: constraints of the quaternion element: index3 (when not given): on positions; index2: on velocities, positions drift; stabilized: on velocities, positions restored after each step
    """
    def __init__(
        self,
        *,
        formulation: Literal['ancf', 'quaternion'] | None = None,
        constraint: Literal['index3', 'index2', 'stabilized'] | None = None,
    ) -> None: ...

class Bend(PythonBlock):
    """A kink in an item, at its upper end when no position is given (bent sub).

    angle: bend angle [rad]
    tool_face: direction in which the string below the kink points [rad]: 0 is the high side, 90 deg to the right looking down the hole; measured from north if the inclination is below 5 deg; at spin angle zero
    position: height of the kink above the item's lower end [m]; the item's upper end when not given. A rigid item bends at its upper end only
    """
    def __init__(
        self,
        *,
        angle: Value,
        tool_face: Value | None = None,
        position: Value | None = None,
    ) -> None: ...

class Bingham(PythonBlock):
    """Plastic above a yield stress.

    yield_stress: yield stress [Pa]
    plastic_viscosity: plastic viscosity [Pa s]
    law: friction in pipe and annulus: exact: laminar profile integrated; blend: a formula for it, too high in slow flow
    shear_rate: shear rate below which stresses go smoothly to zero [1/s]
    dial: readings of a viscometer in degrees by its speed in rpm, {600: 64, 300: 41}; the model's constants are fitted to them unless given
    fit: fit to the readings: api: rules of API RP 13D (default with two readings and with law api); least_squares: in stress
    """
    def __init__(
        self,
        *,
        yield_stress: Value,
        plastic_viscosity: Value,
        law: Literal['blend', 'exact'] | None = None,
        shear_rate: Value | None = None,
        dial: dict[str, Any] | None = None,
        fit: Literal['api', 'least_squares'] | None = None,
    ) -> None: ...

class Bit(PythonBlock):
    """The bit: the last item.

    length: length [m]
    od: diameter of the bit [m]
    name: name in reports; the kind when not given
    friction: friction coefficient of this item, instead of the hole section's [-]
    weight: weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area [kg/m]; mud displaces the ring between od and id
    pressure_loss: pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or {curve: loss.csv, density: 10 ppg}
    id: inner diameter [m]
    mass: mass [kg]; when not given, the mass of a tube with this od, id, length and density
    unbalance: mass times offset of the mass centre from the axis [kg m]
    unbalance_angle: direction of the unbalance in the section [rad]
    inertia: moments of inertia about the centre of gravity
    center_of_gravity: distance below the item's upper end along the axis, or [distance, two offsets across the axis] [m]; half the length when not given
    material: material of this item (for its density); keys left out are the case's
    bore_volume: volume of the mud inside the item [m3]; the volume of a bore of its id when not given
    annulus_od: diameter of a cylinder of the item's length that displaces as much mud [m]; by its metal, mass over density, when not given
    side: side of the bit in its hole. guided: friction brakes its rotation and does not push it round the hole; cutting: it rolls and slides on rock that yields at formation.strength; rolling: the same on a wall that does not yield. When not given, cutting with a formation whose strength is given, otherwise guided
    gauge_length: length of the gauge in contact with the rock (side [m]: cutting)
    gauge_width: width of the gauge in contact with the rock, one blade (side [m]: cutting); a tenth of od when not given
    bit_type: type of the bit; only shown in reports
    nozzle_area: total flow area of the nozzles (used by a fluid) [m2]; the open bore when not given
    nozzles: diameters of the nozzles, `3 x 12/32 in` or [12, 12, 12] in 32nds of an inch [m]; sets nozzle_area
    """
    def __init__(
        self,
        *,
        length: Value,
        od: Value,
        name: str | None = None,
        friction: float | None = None,
        weight: Value | None = None,
        pressure_loss: PressureLoss | dict[str, Any] | None = None,
        id: Value | None = None,
        mass: Value | None = None,
        unbalance: Value | None = None,
        unbalance_angle: Value | None = None,
        inertia: Inertia | dict[str, Any] | None = None,
        center_of_gravity: Value | Sequence[Value] | None = None,
        material: Material | dict[str, Any] | None = None,
        bore_volume: Value | None = None,
        annulus_od: Value | None = None,
        side: Literal['guided', 'cutting', 'rolling'] | None = None,
        gauge_length: Value | None = None,
        gauge_width: Value | None = None,
        bit_type: Literal['PDC', 'roller_cone', 'diamond', 'core'] | None = None,
        nozzle_area: Value | None = None,
        nozzles: str | Sequence[Value] | None = None,
    ) -> None: ...

class BitBottom(PythonBlock):
    """A bit that rests on the end of the hole.

    stiffness: contact stiffness of the bit on the rock [N/m]
    friction: friction coefficient of the bit face on the rock [-]
    pump_off_area: area on which the pressure drop of the bit lowers a weight on bit that is read [m2]: weight read = weight - pressure drop of the bit times area; for measured points
    plugged: true: the lower end is closed, and the string is empty unless a pump_pressure holds fluid in it; false: the end is open (used by a fluid)
    """
    def __init__(
        self,
        *,
        stiffness: Value | None = None,
        friction: float | None = None,
        pump_off_area: Value | None = None,
        plugged: bool | None = None,
    ) -> None: ...

class Body(PythonBlock):
    """Any other rigid item; contact with the hole if it has an outer diameter.

    name: name in reports; the kind when not given
    friction: friction coefficient of this item, instead of the hole section's [-]
    weight: weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area [kg/m]; mud displaces the ring between od and id
    pressure_loss: pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or {curve: loss.csv, density: 10 ppg}
    length: length [m]
    od: outer diameter [m]
    id: inner diameter [m]
    mass: mass [kg]; when not given, the mass of a tube with this od, id, length and density
    unbalance: mass times offset of the mass centre from the axis [kg m]
    unbalance_angle: direction of the unbalance in the section [rad]
    inertia: moments of inertia about the centre of gravity
    center_of_gravity: distance below the item's upper end along the axis, or [distance, two offsets across the axis] [m]; half the length when not given
    material: material of this item (for its density); keys left out are the case's
    bore_volume: volume of the mud inside the item [m3]; the volume of a bore of its id when not given
    annulus_od: diameter of a cylinder of the item's length that displaces as much mud [m]; by its metal, mass over density, when not given
    bend: bent sub: kink at the item's upper end
    """
    def __init__(
        self,
        *,
        name: str | None = None,
        friction: float | None = None,
        weight: Value | None = None,
        pressure_loss: PressureLoss | dict[str, Any] | None = None,
        length: Value | None = None,
        od: Value | None = None,
        id: Value | None = None,
        mass: Value | None = None,
        unbalance: Value | None = None,
        unbalance_angle: Value | None = None,
        inertia: Inertia | dict[str, Any] | None = None,
        center_of_gravity: Value | Sequence[Value] | None = None,
        material: Material | dict[str, Any] | None = None,
        bore_volume: Value | None = None,
        annulus_od: Value | None = None,
        bend: Bend | dict[str, Any] | None = None,
    ) -> None: ...

class BumperSub(PythonBlock):
    """A bumper sub: two parts that telescope freely between stops.

    length: length [m]
    od: outer diameter [m]
    stroke: [least, largest] travel between the stops, negative as the tool closes [m]
    name: name in reports; the kind when not given
    friction: friction coefficient of this item, instead of the hole section's [-]
    weight: weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area [kg/m]; mud displaces the ring between od and id
    pressure_loss: pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or {curve: loss.csv, density: 10 ppg}
    element_length: target length of an element, rounded so that elements fit the item [m]; auto: chosen from the physics along the string and graded
    eccentricity: offset of the mass centre from the axis [m]
    eccentricity_angle: direction of the eccentricity in the section [rad]
    curvature: stress-free curvature [1/m]
    curvature_angle: direction in which the item bends downward [rad]: 0 is the high side, 90 deg to the right looking down the hole; measured from north if the inclination is below 5 deg; at spin angle zero
    bend: bent sub: kink at the item's upper end
    initial: imperfection of this item
    id: inner diameter [m]
    material: material of this item; keys left out are the case's
    bore_volume: volume of the mud inside the item [m3]; the volume of a bore of its id when not given
    annulus_od: outer diameter that the mud outside flows past and that displaces it [m]; od when not given
    mass: mass [kg]; when not given, the mass of a tube with this od, id, length and density
    joint_at: distance of the slider below the item's upper end [m]; half the length when not given
    seal_area: area inside the seals, on which the pressure difference between string and annulus pushes the parts apart (pump-open force) [m2]
    stop_stiffness: stiffness of the stops at the ends of the stroke [N/m]
    """
    def __init__(
        self,
        *,
        length: Value,
        od: Value,
        stroke: Sequence[Value],
        name: str | None = None,
        friction: float | None = None,
        weight: Value | None = None,
        pressure_loss: PressureLoss | dict[str, Any] | None = None,
        element_length: Value | None = None,
        eccentricity: Value | None = None,
        eccentricity_angle: Value | None = None,
        curvature: Value | None = None,
        curvature_angle: Value | None = None,
        bend: Bend | dict[str, Any] | None = None,
        initial: ItemInitial | dict[str, Any] | None = None,
        id: Value | None = None,
        material: Material | dict[str, Any] | None = None,
        bore_volume: Value | None = None,
        annulus_od: Value | None = None,
        mass: Value | None = None,
        joint_at: Value | None = None,
        seal_area: Value | None = None,
        stop_stiffness: Value | None = None,
    ) -> None: ...

class Casing(PythonBlock):
    """Casing or liner that is run into the hole.

    length: length [m]; fill for the topmost pipe: bit_depth, or the end of the survey, less all other items
    name: name in reports; the kind when not given
    friction: friction coefficient of this item, instead of the hole section's [-]
    weight: weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area [kg/m]; mud displaces the ring between od and id
    pressure_loss: pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or {curve: loss.csv, density: 10 ppg}
    element_length: target length of an element, rounded so that elements fit the item [m]; auto: chosen from the physics along the string and graded
    eccentricity: offset of the mass centre from the axis [m]
    eccentricity_angle: direction of the eccentricity in the section [rad]
    curvature: stress-free curvature [1/m]
    curvature_angle: direction in which the item bends downward [rad]: 0 is the high side, 90 deg to the right looking down the hole; measured from north if the inclination is below 5 deg; at spin angle zero
    bend: bent sub: kink at the item's upper end
    initial: imperfection of this item
    od: outer diameter of the tube [m]
    id: inner diameter of the tube [m]; or give the wall
    material: material of this item; keys left out are the case's
    wall: wall of the tube, instead of id [m]
    adjusted_weight: average mass per length in air, with tool joints [kg/m]; from the catalogue, else by a formula
    grade: steel grade, such as S-135; sets yield_strength
    yield_strength: yield strength, for limits [Pa]
    contact_on: diameter that touches the hole: tool joints, or body
    override: od and id may differ from the catalogue by more than 1 %
    nominal_weight: name of the weight, with threads and couplings [kg/m]; finds the row of the catalogue, never a weight
    """
    def __init__(
        self,
        *,
        length: Value,
        name: str | None = None,
        friction: float | None = None,
        weight: Value | None = None,
        pressure_loss: PressureLoss | dict[str, Any] | None = None,
        element_length: Value | None = None,
        eccentricity: Value | None = None,
        eccentricity_angle: Value | None = None,
        curvature: Value | None = None,
        curvature_angle: Value | None = None,
        bend: Bend | dict[str, Any] | None = None,
        initial: ItemInitial | dict[str, Any] | None = None,
        od: Value | None = None,
        id: Value | None = None,
        material: Material | dict[str, Any] | None = None,
        wall: Value | None = None,
        adjusted_weight: Value | None = None,
        grade: str | None = None,
        yield_strength: Value | None = None,
        contact_on: Literal['tool_joint', 'body'] | None = None,
        override: bool | None = None,
        nominal_weight: Value | None = None,
    ) -> None: ...

class Casson(PythonBlock):
    """Plastic above a yield stress, in square roots.

    yield_stress: yield stress [Pa]
    plastic_viscosity: plastic viscosity [Pa s]
    law: friction in pipe and annulus: exact: laminar profile integrated; blend: a formula for it, too high in slow flow
    shear_rate: shear rate below which stresses go smoothly to zero [1/s]
    dial: readings of a viscometer in degrees by its speed in rpm, {600: 64, 300: 41}; the model's constants are fitted to them unless given
    fit: fit to the readings: api: rules of API RP 13D (default with two readings and with law api); least_squares: in stress
    """
    def __init__(
        self,
        *,
        yield_stress: Value,
        plastic_viscosity: Value,
        law: Literal['blend', 'exact'] | None = None,
        shear_rate: Value | None = None,
        dial: dict[str, Any] | None = None,
        fit: Literal['api', 'least_squares'] | None = None,
    ) -> None: ...

class CenterUpset(PythonBlock):
    """Thick middle of heavy-wall drill pipe, which also touches the wall.

    od: outer diameter [m]
    length: length [m]
    """
    def __init__(
        self,
        *,
        od: Value,
        length: Value,
    ) -> None: ...

class Choke(PythonBlock):
    """A valve at the flow line. Its pressure drop is rho q |q| / (2 Cd^2 A^2).

    area: open area A [m2]
    discharge_coefficient: discharge coefficient Cd [-]
    """
    def __init__(
        self,
        *,
        area: Value,
        discharge_coefficient: float | None = None,
    ) -> None: ...

class CoiledTubing(PythonBlock):
    """Coiled tubing.

    length: length [m]; fill for the topmost pipe: bit_depth, or the end of the survey, less all other items
    name: name in reports; the kind when not given
    friction: friction coefficient of this item, instead of the hole section's [-]
    weight: weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area [kg/m]; mud displaces the ring between od and id
    pressure_loss: pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or {curve: loss.csv, density: 10 ppg}
    element_length: target length of an element, rounded so that elements fit the item [m]; auto: chosen from the physics along the string and graded
    eccentricity: offset of the mass centre from the axis [m]
    eccentricity_angle: direction of the eccentricity in the section [rad]
    curvature: stress-free curvature [1/m]
    curvature_angle: direction in which the item bends downward [rad]: 0 is the high side, 90 deg to the right looking down the hole; measured from north if the inclination is below 5 deg; at spin angle zero
    bend: bent sub: kink at the item's upper end
    initial: imperfection of this item
    od: outer diameter of the tube [m]
    id: inner diameter of the tube [m]; or give the wall
    material: material of this item; keys left out are the case's
    wall: wall of the tube, instead of id [m]
    adjusted_weight: average mass per length in air, with tool joints [kg/m]; from the catalogue, else by a formula
    grade: steel grade, such as S-135; sets yield_strength
    yield_strength: yield strength, for limits [Pa]
    contact_on: diameter that touches the hole: tool joints, or body
    override: od and id may differ from the catalogue by more than 1 %
    """
    def __init__(
        self,
        *,
        length: Value,
        name: str | None = None,
        friction: float | None = None,
        weight: Value | None = None,
        pressure_loss: PressureLoss | dict[str, Any] | None = None,
        element_length: Value | None = None,
        eccentricity: Value | None = None,
        eccentricity_angle: Value | None = None,
        curvature: Value | None = None,
        curvature_angle: Value | None = None,
        bend: Bend | dict[str, Any] | None = None,
        initial: ItemInitial | dict[str, Any] | None = None,
        od: Value | None = None,
        id: Value | None = None,
        material: Material | dict[str, Any] | None = None,
        wall: Value | None = None,
        adjusted_weight: Value | None = None,
        grade: str | None = None,
        yield_strength: Value | None = None,
        contact_on: Literal['tool_joint', 'body'] | None = None,
        override: bool | None = None,
    ) -> None: ...

class Compliance(PythonBlock):
    """Elastic constants of rock and casing around a section, which widens under the fluid's pressure.

    young: Young's modulus of the rock, or of casing and rock together [Pa]
    poisson: Poisson's ratio [-]
    """
    def __init__(
        self,
        *,
        young: Value,
        poisson: float | None = None,
    ) -> None: ...

class Contact(PythonBlock):
    """Contact between string and hole.

    law: force per length: stiffness * penetration (linear) or * penetration^1.5 (hertz); hertz_point: force at each point of an element, stiffness * penetration^1.5
    stiffness: contact stiffness per length (linear, hertz) or of a point (hertz_point): linear [Pa], hertz [N/m^2.5], hertz_point [N/m^1.5]; a default only for linear. physical (linear only): from the moduli of casing and rock (formation.young) at each part of the string
    restitution: coefficient of restitution [-]: speed after over speed before an impact
    restitution_speed: impact speed at which the restitution holds [m/s]
    slip_velocity: slip speed over which friction builds up [m/s]; when not given 0.01 m/s, or a twentieth of the slowest top.lowering of a string that does not turn (5 m/h where an autodriller finds it), if that is less
    stribeck: static friction; none when not given
    friction_law: the friction coefficient as a function of the state at each contact point; Coulomb's law, with stribeck, when not given. The soft string of torque-and-drag uses the coefficients of the wall
    points_per_element: contact points per element
    energy_strict: true: no step longer than half the shortest impact, so that the energy balance holds across impacts
    """
    def __init__(
        self,
        *,
        law: Literal['linear', 'hertz', 'hertz_point'] | None = None,
        stiffness: Value | None = None,
        restitution: float | None = None,
        restitution_speed: Value | None = None,
        slip_velocity: Value | None = None,
        stribeck: Stribeck | dict[str, Any] | None = None,
        friction_law: OwnFriction | dict[str, Any] | None = None,
        points_per_element: int | None = None,
        energy_strict: bool | None = None,
    ) -> None: ...

class Damping(PythonBlock):
    """Damping of the pipe: Kelvin-Voigt in the rotating section, and external, proportional to the mass.

    stiffness: Kelvin-Voigt time constant [s]: stress E (strain + stiffness * strain rate)
    mass: external damping rate [1/s]: force per mass over velocity
    """
    def __init__(
        self,
        *,
        stiffness: Value | None = None,
        mass: Value | None = None,
    ) -> None: ...

class DepthRange(PythonBlock):
    """Bit depths from `from` to `to` in equal steps.

    from_: first depth [m], or shoe: the last casing shoe
    step: distance between depths [m]; the last one may be shorter
    to: last depth [m], or td: the end of the hole
    """
    def __init__(
        self,
        *,
        from_: Value,
        step: Value,
        to: Value | None = None,
    ) -> None: ...

class DragBit(PythonBlock):
    """Blades that cut and rub (Detournay and Defourny). Each blade cuts in the groove left by the one before.

    blades: number of blades
    specific_energy: intrinsic specific energy [Pa]: work of cutting per volume of rock, 1 J/m3 = 1 Pa
    inclination_ratio: vertical over horizontal force of a cutter [-]
    contact_stress: largest stress between wear flats and rock [Pa]
    wear_flat: width of all wear flats together [m]; 0 for a sharp bit
    friction: friction coefficient of the wear flats times the shape factor of the bit, mu gamma [-]
    exposure: cutter exposure above the blades. It limits the cut of a blade per passage [m]; the rest of the weight presses the body on the rock. Default: half the diameter of a 13 mm cutter
    stiffness: contact stiffness of bit on rock [N/m]; bottom.stiffness is set to this value
    """
    def __init__(
        self,
        *,
        blades: int | None = None,
        specific_energy: Value | None = None,
        inclination_ratio: float | None = None,
        contact_stress: Value | None = None,
        wear_flat: Value | None = None,
        friction: float | None = None,
        exposure: Value | None = None,
        stiffness: Value | None = None,
    ) -> None: ...

class DrillCollar(PythonBlock):
    """Drill collar, round or spiral.

    length: length [m]; fill for the topmost pipe: bit_depth, or the end of the survey, less all other items
    name: name in reports; the kind when not given
    friction: friction coefficient of this item, instead of the hole section's [-]
    weight: weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area [kg/m]; mud displaces the ring between od and id
    pressure_loss: pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or {curve: loss.csv, density: 10 ppg}
    element_length: target length of an element, rounded so that elements fit the item [m]; auto: chosen from the physics along the string and graded
    eccentricity: offset of the mass centre from the axis [m]
    eccentricity_angle: direction of the eccentricity in the section [rad]
    curvature: stress-free curvature [1/m]
    curvature_angle: direction in which the item bends downward [rad]: 0 is the high side, 90 deg to the right looking down the hole; measured from north if the inclination is below 5 deg; at spin angle zero
    bend: bent sub: kink at the item's upper end
    initial: imperfection of this item
    od: outer diameter of the tube [m]
    id: inner diameter of the tube [m]; or give the wall
    material: material of this item; keys left out are the case's
    wall: wall of the tube, instead of id [m]
    adjusted_weight: average mass per length in air, with tool joints [kg/m]; from the catalogue, else by a formula
    grade: steel grade, such as S-135; sets yield_strength
    yield_strength: yield strength, for limits [Pa]
    contact_on: diameter that touches the hole: tool joints, or body
    override: od and id may differ from the catalogue by more than 1 %
    joint_length: length of a joint [m]; 31.0 ft
    spiral: spiral grooves: less mass, the same stiffness
    spiral_weight_factor: mass of a spiral collar over the mass of a round one [-]
    nonmagnetic: density 7860 kg/m3 and Young's modulus 193 GPa unless the item's material gives them
    """
    def __init__(
        self,
        *,
        length: Value,
        name: str | None = None,
        friction: float | None = None,
        weight: Value | None = None,
        pressure_loss: PressureLoss | dict[str, Any] | None = None,
        element_length: Value | None = None,
        eccentricity: Value | None = None,
        eccentricity_angle: Value | None = None,
        curvature: Value | None = None,
        curvature_angle: Value | None = None,
        bend: Bend | dict[str, Any] | None = None,
        initial: ItemInitial | dict[str, Any] | None = None,
        od: Value | None = None,
        id: Value | None = None,
        material: Material | dict[str, Any] | None = None,
        wall: Value | None = None,
        adjusted_weight: Value | None = None,
        grade: str | None = None,
        yield_strength: Value | None = None,
        contact_on: Literal['tool_joint', 'body'] | None = None,
        override: bool | None = None,
        joint_length: Value | None = None,
        spiral: bool | None = None,
        spiral_weight_factor: float | None = None,
        nonmagnetic: bool | None = None,
    ) -> None: ...

class DrillPipe(PythonBlock):
    """Drill pipe with tool joints, by a text reference to the catalogue or by its dimensions.

    pipe: text reference to the catalogue: 5in 19.50 S-135 NC50 premium
    length: length [m]; fill for the topmost pipe: bit_depth, or the end of the survey, less all other items
    name: name in reports; the kind when not given
    friction: friction coefficient of this item, instead of the hole section's [-]
    weight: weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area [kg/m]; mud displaces the ring between od and id
    pressure_loss: pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or {curve: loss.csv, density: 10 ppg}
    element_length: target length of an element, rounded so that elements fit the item [m]; auto: chosen from the physics along the string and graded
    eccentricity: offset of the mass centre from the axis [m]
    eccentricity_angle: direction of the eccentricity in the section [rad]
    curvature: stress-free curvature [1/m]
    curvature_angle: direction in which the item bends downward [rad]: 0 is the high side, 90 deg to the right looking down the hole; measured from north if the inclination is below 5 deg; at spin angle zero
    bend: bent sub: kink at the item's upper end
    initial: imperfection of this item
    od: outer diameter of the tube [m]
    id: inner diameter of the tube [m]; or give the wall
    material: material of this item; keys left out are the case's
    wall: wall of the tube, instead of id [m]
    adjusted_weight: average mass per length in air, with tool joints [kg/m]; from the catalogue, else by a formula
    grade: steel grade, such as S-135; sets yield_strength
    yield_strength: yield strength, for limits [Pa]
    contact_on: diameter that touches the hole: tool joints, or body
    override: od and id may differ from the catalogue by more than 1 %
    tool_joint: tool joint; keys left out are taken from the catalogue
    joint_length: length of a joint, shoulder to shoulder [m]; 31.0 ft, with range: 3 44.0 ft
    range: length range of the joints, instead of joint_length
    stiffness: tube and tool joints in series, or the tube alone
    clearance: diameter from which the clearance of buckling loads is measured: tool joints (API RP 7G), or body
    nominal_weight: name of the weight, with threads and couplings [kg/m]; finds the row of the catalogue, never a weight
    class_: wear: wall of 100, 80 or 70 %; premium when not given; for limits only
    remaining_wall: fraction of the wall that is left, instead of class [-]; for limits only
    """
    def __init__(
        self,
        pipe: str | None = None,
        *,
        length: Value,
        name: str | None = None,
        friction: float | None = None,
        weight: Value | None = None,
        pressure_loss: PressureLoss | dict[str, Any] | None = None,
        element_length: Value | None = None,
        eccentricity: Value | None = None,
        eccentricity_angle: Value | None = None,
        curvature: Value | None = None,
        curvature_angle: Value | None = None,
        bend: Bend | dict[str, Any] | None = None,
        initial: ItemInitial | dict[str, Any] | None = None,
        od: Value | None = None,
        id: Value | None = None,
        material: Material | dict[str, Any] | None = None,
        wall: Value | None = None,
        adjusted_weight: Value | None = None,
        grade: str | None = None,
        yield_strength: Value | None = None,
        contact_on: Literal['tool_joint', 'body'] | None = None,
        override: bool | None = None,
        tool_joint: ToolJoint | dict[str, Any] | None = None,
        joint_length: Value | None = None,
        range: Literal[2, 3] | None = None,
        stiffness: Literal['series', 'body'] | None = None,
        clearance: Literal['tool_joint', 'body'] | None = None,
        nominal_weight: Value | None = None,
        class_: Literal['new', 'premium', 'class_2'] | None = None,
        remaining_wall: float | None = None,
    ) -> None: ...

class Drilling(PythonBlock):
    """Drilling with rotation.

    wob: weight on bit [N]; initial.wob when not given, else 25 klbf
    tob: torque of the rock on the bit [N m]
    rop: rate of penetration [m/s]
    flow_rate: flow rate of the pump, which drags and lifts the string [m3/s]; 0: the mud is at rest; fluid.flow_rate at time 0 when not given
    """
    def __init__(
        self,
        *,
        wob: Value | None = None,
        tob: Value | None = None,
        rop: Value | None = None,
        flow_rate: Value | None = None,
    ) -> None: ...

class DrillingLine(PythonBlock):
    """The rope between drum, sheaves and dead-line anchor.

    axial_stiffness: axial stiffness EA of the rope [N]; or its diameter
    diameter: diameter d of the rope, instead of axial_stiffness [m]: modulus times fill times d^2
    modulus: modulus of the rope's metal, as it lies in the strands (used with diameter) [Pa]
    fill: area of metal over the squared diameter (used with diameter) [-]
    """
    def __init__(
        self,
        *,
        axial_stiffness: Value | None = None,
        diameter: Value | None = None,
        modulus: Value | None = None,
        fill: float | None = None,
    ) -> None: ...

class DrivenTop(PythonBlock):
    """A rotary drive with inertia, held at `rotation` by a spring and a damper (PI control).

    Position and direction of the upper end are clamped.

    torque on the drive = stiffness * (prescribed angle - angle) + damping * (prescribed speed - speed).

    rotation: rotation speed over time, positive clockwise seen from above [rad/s]
    lowering: speed of the top over time, positive downward [m/s]
    stiffness: rotational stiffness [N m/rad]
    damping: rotational damping [N m s/rad]
    inertia: inertia of the drive [kg m2]
    """
    def __init__(
        self,
        *,
        rotation: Value | dict[str, Any] | None = None,
        lowering: Value | dict[str, Any] | None = None,
        stiffness: Value | None = None,
        damping: Value | None = None,
        inertia: Value | None = None,
    ) -> None: ...

class FloorHeave(PythonBlock):
    """Harmonic motion of a floating rig's floor.

    amplitude: amplitude over time [m]
    period: period [s]
    phase: phase at time 0 [rad]
    compensation: share of the motion that a compensator keeps from the block [-]
    """
    def __init__(
        self,
        *,
        amplitude: Value | dict[str, Any],
        period: Value,
        phase: Value | None = None,
        compensation: float | None = None,
    ) -> None: ...

class Fluid(PythonBlock):
    """The drilling fluid: down the string's bore, through the bit, up the annulus.

    density: density at zero (gauge) pressure [kg/m3]
    rheology: shear stress as a function of the shear rate; also as in a mud report: {pv, yp}, {n, k}, {ty, n, k} or {dial: {600: 64, 300: 41}}
    annulus_rheology: rheology in the annulus, if it differs; with law api and dial readings at 100 and 3 rpm, the power law through these
    surface_line: lines between pump and string, whose loss the pump pressure contains
    bulk_modulus: bulk modulus of the fluid alone [Pa]
    flow_rate: volume pumped into the string over time, negative in reverse circulation [m3/s]; 0 when this and pump_pressure are not given
    pump_pressure: gauge pressure at the string's upper end over time, instead of a flow_rate [Pa]
    outlet_pressure: gauge pressure at the flow line, or without an annulus at the string's lower end, over time [Pa]
    choke: a valve between annulus and outlet; none when not given
    flow_line: depth of the flow line below the rotary table, straight down [m]
    level_in_string: measured depth of the mud's surface in a plugged string, which is empty above [m]: a string that is not filled (roadmap and calibrate with the soft string)
    floated_length: length of the lower end of a plugged string that holds air below a flotation collar, with mud above it (roadmap and calibrate with the soft string) [m]
    annulus: whether there is fluid between string and hole; when not given, true in a case with a well
    bit_volume: volume around the bit, between nozzles and annulus [m3]
    discharge_coefficient: discharge coefficient of the nozzles [-]
    check_valve: a valve against backflow into the string, above the bit or at an open end (float shoe)
    formulation: mixed: pressure at the nodes, flow rate in the elements; hermite: the volume passed, as a cubic between the nodes, as in the reference formulation (DOI 10.1177/1687814016656703); takes a flow_rate
    dynamics: full: with inertia and compression of the fluid; quasi_steady: steady flow at every moment
    elastic_walls: pipe and hole widen under pressure; false: rigid walls
    added_mass: mass of annulus fluid that moves sideways with the string, over the displaced mass. confined [-]: (Dw^2 + Do^2)/(Dw^2 - Do^2); eccentric: increases towards the wall, with the forces of its gradient; stokes: from the oscillating viscous flow, at lateral_damping_speed in runs and at each mode's own frequency in modes; paper_plug: Do^2/(Dw^2 - Do^2), as in the reference formulation (DOI 10.1177/1687814016656703); a number; none: 0
    lateral_damping: force per length over sideways speed in still fluid [N s/m2]; stokes: from the oscillating viscous flow at lateral_damping_speed; none: 0
    lateral_damping_speed: angular frequency for lateral_damping stokes [rad/s]; when not given, the fastest rotation of the top, or 1 rad/s if the top does not turn
    swirl: spin of the annulus mud about the hole over the string's spin, used by the sideways forces of the mud. auto [-]: Do^2/(Do^2 + Dw^2), the mean of a flow between turning pipe and fixed wall; a number up to 0.5; none: 0
    swirl_lag: the swirl follows a change of the string's spin within the time that friction takes; false: at once
    clinging: clinging factor [-]: fraction of the string's axial speed that the fluid in the annulus takes on
    rotation_drag: viscous torque of the annulus fluid on the turning string
    cuttings: removed: fluid fills the volume of the rock that is cut; returned: the cuttings rise with the fluid, whose volume is constant (needs a formation)
    """
    def __init__(
        self,
        *,
        density: Value,
        rheology: Newtonian | dict[str, Any] | Bingham | PowerLaw | Casson | HerschelBulkley | OwnRheology,
        annulus_rheology: Newtonian | dict[str, Any] | Bingham | PowerLaw | Casson | HerschelBulkley | OwnRheology | None = None,
        surface_line: SurfaceLine | dict[str, Any] | None = None,
        bulk_modulus: Value | None = None,
        flow_rate: Value | dict[str, Any] | None = None,
        pump_pressure: Value | dict[str, Any] | None = None,
        outlet_pressure: Value | dict[str, Any] | None = None,
        choke: Choke | dict[str, Any] | None = None,
        flow_line: Value | None = None,
        level_in_string: Value | None = None,
        floated_length: Value | None = None,
        annulus: bool | None = None,
        bit_volume: Value | None = None,
        discharge_coefficient: float | None = None,
        check_valve: bool | None = None,
        formulation: Literal['mixed', 'hermite'] | None = None,
        dynamics: Literal['full', 'quasi_steady'] | None = None,
        elastic_walls: bool | None = None,
        added_mass: Literal['confined', 'eccentric', 'stokes', 'paper_plug', 'none'] | float | None = None,
        lateral_damping: Value | None = None,
        lateral_damping_speed: Value | None = None,
        swirl: Literal['auto', 'none'] | float | None = None,
        swirl_lag: bool | None = None,
        clinging: float | None = None,
        rotation_drag: bool | None = None,
        cuttings: Literal['removed', 'returned'] | None = None,
    ) -> None: ...

class ForcedBottom(PythonBlock):
    """A dead force and moment at the lower end.

    force: force on the string, north, east, down [N]
    moment: moment on the string, north, east, down [N m]
    plugged: true: the lower end is closed, and the string is empty unless a pump_pressure holds fluid in it; false: the end is open (used by a fluid)
    """
    def __init__(
        self,
        *,
        force: Sequence[Value] | None = None,
        moment: Sequence[Value] | None = None,
        plugged: bool | None = None,
    ) -> None: ...

class Formation(PythonBlock):
    """The rock below the bit. velocity = D (speed/reference)^a (weight/reference)^(b-1) M_r M_b force.

    drillability: rate of penetration over force, at reference_speed and reference_weight [m/(s N)]; 0 cannot be drilled
    bit_anisotropy: drillability sideways over drillability ahead of the bit [-]
    rock_anisotropy: bedding of the rock
    rotary_exponent: exponent of the rotation speed over reference_speed [-]
    weight_exponent: exponent of the weight on bit over reference_weight in the rate of penetration [-]
    threshold: weight on bit below which the bit does not cut [N]
    reference_speed: rotation speed at which the drillability is given [rad/s]
    reference_weight: weight on bit at which the drillability is given [N]
    walk: walk angle about the bit's axis, from the side force to the sideways motion of the bit [rad]
    overgauge: radius of the new hole minus radius of the bit [m]; negative for an under-gauge hole
    strength: compressive strength of the rock, at which the wall yields to a bit with side [Pa]: cutting; 60 MPa for such a bit when not given
    young: Young's modulus of the rock [Pa]; sets the wall stiffness for contact.stiffness: physical and a bit with side: cutting; 20 GPa when not given
    growth: state: the hole's end is integrated with the string; post_step: moved after each step (for comparison)
    direction: rop_vector: the hole grows along the velocity of penetration; bit_axis: along the bit's axis, with the component of the velocity in that direction
    node_spacing: distance between the nodes of the drilled hole [m]
    layers: other rock, from the first layer down; above the first layer the values of this block hold
    rock_law: the strength of the rock as a function of depth, relative to the rock that the other keys describe: so many times the force is needed for the same rate, or of a drag bit for the same cut; none when not given
    bit_law: torque and weight of the bit as it cuts
    """
    def __init__(
        self,
        *,
        drillability: Value | None = None,
        bit_anisotropy: float | None = None,
        rock_anisotropy: RockAnisotropy | dict[str, Any] | None = None,
        rotary_exponent: float | None = None,
        weight_exponent: float | None = None,
        threshold: Value | None = None,
        reference_speed: Value | None = None,
        reference_weight: Value | None = None,
        walk: Value | None = None,
        overgauge: Value | None = None,
        strength: Value | None = None,
        young: Value | None = None,
        growth: Literal['state', 'post_step'] | None = None,
        direction: Literal['rop_vector', 'bit_axis'] | None = None,
        node_spacing: Value | None = None,
        layers: Sequence[Layer | dict[str, Any]] | None = None,
        rock_law: OwnRockLaw | dict[str, Any] | None = None,
        bit_law: Literal['rop', 'drag_bit'] | RopLaw | dict[str, Any] | DragBit | VelocityWeakening | RollerCone | OwnBitLaw | None = None,
    ) -> None: ...

class FrictionFactors(PythonBlock):
    """Friction factors of cased and open hole, in pairs.

    cased: friction factors of cased hole [-]; the sections' own when not given
    open_hole: friction factors of open hole [-]; the sections' own when not given
    groups: friction factors of sections with a ff_group, by its name [-]; the sections' own when not given
    combine: pairs: first with first, second with second; all: every pair
    """
    def __init__(
        self,
        *,
        cased: float | Sequence[float] | None = None,
        open_hole: float | Sequence[float] | None = None,
        groups: dict[str, Any] | None = None,
        combine: Literal['pairs', 'all'] | None = None,
    ) -> None: ...

class HWDP(PythonBlock):
    """Heavy-wall drill pipe.

    pipe: text reference to the catalogue: 5in 19.50 S-135 NC50 premium
    length: length [m]; fill for the topmost pipe: bit_depth, or the end of the survey, less all other items
    name: name in reports; the kind when not given
    friction: friction coefficient of this item, instead of the hole section's [-]
    weight: weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area [kg/m]; mud displaces the ring between od and id
    pressure_loss: pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or {curve: loss.csv, density: 10 ppg}
    element_length: target length of an element, rounded so that elements fit the item [m]; auto: chosen from the physics along the string and graded
    eccentricity: offset of the mass centre from the axis [m]
    eccentricity_angle: direction of the eccentricity in the section [rad]
    curvature: stress-free curvature [1/m]
    curvature_angle: direction in which the item bends downward [rad]: 0 is the high side, 90 deg to the right looking down the hole; measured from north if the inclination is below 5 deg; at spin angle zero
    bend: bent sub: kink at the item's upper end
    initial: imperfection of this item
    od: outer diameter of the tube [m]
    id: inner diameter of the tube [m]; or give the wall
    material: material of this item; keys left out are the case's
    wall: wall of the tube, instead of id [m]
    adjusted_weight: average mass per length in air, with tool joints [kg/m]; from the catalogue, else by a formula
    grade: steel grade, such as S-135; sets yield_strength
    yield_strength: yield strength, for limits [Pa]
    contact_on: diameter that touches the hole: tool joints, or body
    override: od and id may differ from the catalogue by more than 1 %
    tool_joint: tool joint; keys left out are taken from the catalogue
    joint_length: length of a joint, shoulder to shoulder [m]; 31.0 ft, with range: 3 44.0 ft
    range: length range of the joints, instead of joint_length
    stiffness: tube and tool joints in series, or the tube alone
    clearance: diameter from which the clearance of buckling loads is measured: tool joints (API RP 7G), or body
    center_upset: thick middle of a joint; the catalogue's; for contact only
    """
    def __init__(
        self,
        pipe: str | None = None,
        *,
        length: Value,
        name: str | None = None,
        friction: float | None = None,
        weight: Value | None = None,
        pressure_loss: PressureLoss | dict[str, Any] | None = None,
        element_length: Value | None = None,
        eccentricity: Value | None = None,
        eccentricity_angle: Value | None = None,
        curvature: Value | None = None,
        curvature_angle: Value | None = None,
        bend: Bend | dict[str, Any] | None = None,
        initial: ItemInitial | dict[str, Any] | None = None,
        od: Value | None = None,
        id: Value | None = None,
        material: Material | dict[str, Any] | None = None,
        wall: Value | None = None,
        adjusted_weight: Value | None = None,
        grade: str | None = None,
        yield_strength: Value | None = None,
        contact_on: Literal['tool_joint', 'body'] | None = None,
        override: bool | None = None,
        tool_joint: ToolJoint | dict[str, Any] | None = None,
        joint_length: Value | None = None,
        range: Literal[2, 3] | None = None,
        stiffness: Literal['series', 'body'] | None = None,
        clearance: Literal['tool_joint', 'body'] | None = None,
        center_upset: CenterUpset | dict[str, Any] | None = None,
    ) -> None: ...

class HeldBottom(PythonBlock):
    """A bottom end that is free or held.

    kind: free: nothing held; pinned: position held; clamped: position, direction and spin held
    plugged: true: the lower end is closed, and the string is empty unless a pump_pressure holds fluid in it; false: the end is open (used by a fluid)
    """
    def __init__(
        self,
        *,
        kind: Literal['free', 'pinned', 'clamped'],
        plugged: bool | None = None,
    ) -> None: ...

class HeldTop(PythonBlock):
    """A top end without a drive.

    kind: clamped: position, direction and spin held; pinned: position and spin held, it bends freely; free: nothing held
    """
    def __init__(
        self,
        *,
        kind: Literal['clamped', 'pinned', 'free'],
    ) -> None: ...

class HerschelBulkley(PythonBlock):
    """A power law above a yield stress.

    yield_stress: yield stress [Pa]
    consistency: consistency [Pa s^n]
    index: flow index n, 1 for a Bingham fluid [-]
    law: friction in pipe and annulus: exact: laminar profile integrated; blend: a formula for it, too high in slow flow
    shear_rate: shear rate below which stresses go smoothly to zero [1/s]
    dial: readings of a viscometer in degrees by its speed in rpm, {600: 64, 300: 41}; the model's constants are fitted to them unless given
    fit: fit to the readings: api: rules of API RP 13D (default with two readings and with law api); least_squares: in stress
    """
    def __init__(
        self,
        *,
        yield_stress: Value,
        consistency: Value,
        index: float,
        law: Literal['blend', 'exact'] | None = None,
        shear_rate: Value | None = None,
        dial: dict[str, Any] | None = None,
        fit: Literal['api', 'least_squares'] | None = None,
    ) -> None: ...

class Hoist(PythonBlock):
    """Block, line and drum that hold the top drive. Without a line the block moves with the drum.

    block_mass: mass of block, hook and top drive [kg]
    lines: number of lines between crown and block
    line: the rope, which stretches; without it the block moves with the drum
    height: height of the block over the floor at the start [m]
    crown_height: height of the crown over the floor, which sets the length of the lines [m]; default twice height
    fast_line: length of the fast line, from the crown to the drum [m]
    dead_line: length of the dead line, from the crown to its anchor [m]
    damping: damping between drum and block [N s/m]
    sheave_efficiency: efficiency of one sheave [-]; it acts on the dead-line tension only
    max_speed: largest speed of the block [m/s]
    tare: true: hook_load_sensor leaves out the weight of the block
    heave: motion of the floor of a floating rig
    """
    def __init__(
        self,
        *,
        block_mass: Value,
        lines: int | None = None,
        line: DrillingLine | dict[str, Any] | None = None,
        height: Value | None = None,
        crown_height: Value | None = None,
        fast_line: Value | None = None,
        dead_line: Value | None = None,
        damping: Value | None = None,
        sheave_efficiency: float | None = None,
        max_speed: Value | None = None,
        tare: bool | None = None,
        heave: FloorHeave | dict[str, Any] | None = None,
    ) -> None: ...

class HookloadSensor(PythonBlock):
    """Place of the hook-load sensor, and the sheaves between it and the hook.

    at: at the hook, or in the dead line, whose force times the lines is read
    lines: lines strung between crown and travelling block
    sheave_efficiency: force of the line behind a turning sheave over the force before it, 0.98 for roller bearings [-]
    dead_sheave: whether the sheave of the dead line turns
    """
    def __init__(
        self,
        *,
        at: Literal['hook', 'dead_line'] | None = None,
        lines: int | None = None,
        sheave_efficiency: float | None = None,
        dead_sheave: Literal['still', 'turning'] | None = None,
    ) -> None: ...

class Indices(PythonBlock):
    """Indices of drilling dynamics in windows of time.

    window: length of a window [s]
    every: time between the ends of two successive windows [s]
    """
    def __init__(
        self,
        *,
        window: Value | None = None,
        every: Value | None = None,
    ) -> None: ...

class Inertia(PythonBlock):
    """Moments of inertia of a rigid item about its centre of gravity; a hollow cylinder's when not given.

    axial: about the string's axis [kg m2]
    transverse: about an axis across the string through the centre of gravity [kg m2]
    """
    def __init__(
        self,
        *,
        axial: Value | None = None,
        transverse: Value | None = None,
    ) -> None: ...

class Initial(PythonBlock):
    """The state at time 0.

    from_: statics: the static equilibrium; rest: along the hole's axis, without strain from loads; straight: straight and without strain; or a run folder, whose end is the start; time begins at 0
    wob: weight on bit that the static start meets by the top's axial position [N]
    inclination: inclination of a string without a well [rad]
    azimuth: azimuth of a string without a well [rad]
    imperfection: lateral load as a fraction of the weight, so that the string leaves an unstable equilibrium [-]; a start from rest or straight has none unless it is given
    """
    def __init__(
        self,
        *,
        from_: str | None = None,
        wob: Value | None = None,
        inclination: Value | None = None,
        azimuth: Value | None = None,
        imperfection: float | None = None,
    ) -> None: ...

class ItemInitial(PythonBlock):
    """Imperfection of one item.

    imperfection: lateral load as a fraction of the item's weight, instead of the case's initial.imperfection [-]
    """
    def __init__(
        self,
        *,
        imperfection: float,
    ) -> None: ...

class Jar(PythonBlock):
    """A jar: a latch that holds the load, then sets the parts free to hit a stop.

    length: length [m]
    od: outer diameter [m]
    jar: latch, stroke and seals
    name: name in reports; the kind when not given
    friction: friction coefficient of this item, instead of the hole section's [-]
    weight: weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area [kg/m]; mud displaces the ring between od and id
    pressure_loss: pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or {curve: loss.csv, density: 10 ppg}
    element_length: target length of an element, rounded so that elements fit the item [m]; auto: chosen from the physics along the string and graded
    eccentricity: offset of the mass centre from the axis [m]
    eccentricity_angle: direction of the eccentricity in the section [rad]
    curvature: stress-free curvature [1/m]
    curvature_angle: direction in which the item bends downward [rad]: 0 is the high side, 90 deg to the right looking down the hole; measured from north if the inclination is below 5 deg; at spin angle zero
    bend: bent sub: kink at the item's upper end
    initial: imperfection of this item
    id: inner diameter [m]
    material: material of this item; keys left out are the case's
    bore_volume: volume of the mud inside the item [m3]; the volume of a bore of its id when not given
    annulus_od: outer diameter that the mud outside flows past and that displaces it [m]; od when not given
    mass: mass [kg]; when not given, the mass of a tube with this od, id, length and density
    joint_at: distance of the slider below the item's upper end [m]; half the length when not given
    """
    def __init__(
        self,
        *,
        length: Value,
        od: Value,
        jar: JarSection | dict[str, Any],
        name: str | None = None,
        friction: float | None = None,
        weight: Value | None = None,
        pressure_loss: PressureLoss | dict[str, Any] | None = None,
        element_length: Value | None = None,
        eccentricity: Value | None = None,
        eccentricity_angle: Value | None = None,
        curvature: Value | None = None,
        curvature_angle: Value | None = None,
        bend: Bend | dict[str, Any] | None = None,
        initial: ItemInitial | dict[str, Any] | None = None,
        id: Value | None = None,
        material: Material | dict[str, Any] | None = None,
        bore_volume: Value | None = None,
        annulus_od: Value | None = None,
        mass: Value | None = None,
        joint_at: Value | None = None,
    ) -> None: ...

class JarSection(PythonBlock):
    """Law of a jar.

    stroke: travel from the cocked position to the stop [m]
    action: hydraulic: above threshold the jar meters over metering_stroke, then it is free; mechanical: it is free above trigger
    direction: load that fires it: tension, compression, or either
    threshold: load that the latch of a hydraulic jar holds [N]
    metering_stroke: travel over which a hydraulic jar meters [m]; 0: it is free at the threshold
    metering_resistance: load above the threshold over the speed of metering [N s/m]
    trigger: load at which a mechanical jar fires [N]
    seal_area: area inside the seals, on which the pressure difference between string and annulus pushes the parts apart (pump-open force) [m2]
    stop_stiffness: stiffness of the stops at the ends of the stroke [N/m]
    """
    def __init__(
        self,
        *,
        stroke: Value,
        action: Literal['hydraulic', 'mechanical'] | None = None,
        direction: Literal['up', 'down', 'both'] | None = None,
        threshold: Value | None = None,
        metering_stroke: Value | None = None,
        metering_resistance: Value | None = None,
        trigger: Value | None = None,
        seal_area: Value | None = None,
        stop_stiffness: Value | None = None,
    ) -> None: ...

class Joint(PythonBlock):
    """A joint at one measured depth, without length and mass; add both by rigid items (`{kind: body}`).

    kind: fixed: rigid connection; revolute: a hinge about one axis; universal: bends in two planes and transmits torque (Hooke joint); slider: telescopes along the string only (bumper sub, slip joint)
    at: measured depth on the string [m]; 0: between the top and the string
    axis: axis of a revolute joint, or of a universal joint's pin in the part above [-]: components along the string and in two directions across it (the first towards the high side, or north, at the start)
    constraint: position: constraint on positions (index 3); stabilised: also on velocities (Gear, Gupta and Leimkuhler; index 2)
    spring: stiffness along a slider (shock sub) [N/m]
    damping: damping along a slider [N s/m]
    stroke: [least, largest] travel of a slider between its stops, 0 in the undeformed string [m]; no stops when not given
    stop_stiffness: stiffness of a slider's stops [N/m]
    seal_area: area inside the seals of a slider. The pressure difference between string and annulus pushes its parts apart on this area (pump-open force) [m2]; mud fills the swept volume
    """
    def __init__(
        self,
        *,
        kind: Literal['fixed', 'revolute', 'universal', 'slider'],
        at: Value,
        axis: Sequence[float] | None = None,
        constraint: Literal['position', 'stabilised'] | None = None,
        spring: Value | None = None,
        damping: Value | None = None,
        stroke: Sequence[Value] | None = None,
        stop_stiffness: Value | None = None,
        seal_area: Value | None = None,
    ) -> None: ...

class Layer(PythonBlock):
    """An interval of other rock. Keys left out have the values of the formation.

    from_: measured depth of the upper end [m]
    to: measured depth of the lower end, equal to the next layer's from. When not given [m]: the next layer's from, and no end for the last layer. Below the last layer the formation's values hold again.
    drillability: rate of penetration over force, at reference_speed and reference_weight [m/(s N)]; 0 cannot be drilled
    bit_anisotropy: drillability sideways over drillability ahead of the bit [-]
    rock_anisotropy: bedding of the rock; keys left out are the formation's
    rotary_exponent: exponent of the rotation speed over reference_speed [-]
    weight_exponent: exponent of the weight on bit over reference_weight in the rate of penetration [-]
    threshold: weight on bit below which the bit does not cut [N]
    """
    def __init__(
        self,
        *,
        from_: Value,
        to: Value | None = None,
        drillability: Value | None = None,
        bit_anisotropy: float | None = None,
        rock_anisotropy: RockAnisotropy | dict[str, Any] | None = None,
        rotary_exponent: float | None = None,
        weight_exponent: float | None = None,
        threshold: Value | None = None,
    ) -> None: ...

class LineLoad(PythonBlock):
    """A force and a moment per length between two measured depths.

    from_: measured depth of the upper end [m]
    to: measured depth of the lower end [m]
    frame: global: north, east, down; section: along the string, then two directions across it, which turn with the string
    value_over: factor over time on force and moment [-]
    force: force per length [N/m]
    moment: moment per length [N m/m]
    """
    def __init__(
        self,
        *,
        from_: Value,
        to: Value,
        frame: Literal['global', 'section'] | None = None,
        value_over: float | dict[str, Any] | None = None,
        force: Sequence[Value] | None = None,
        moment: Sequence[Value] | None = None,
    ) -> None: ...

class LossCurve(PythonBlock):
    """Measured losses of a tool, one value of each list a point; without flow there is no loss.

    flow_rate: flow rates, rising [m3/s]
    loss: pressure loss at each flow rate, not falling [Pa]
    """
    def __init__(
        self,
        *,
        flow_rate: Sequence[Value],
        loss: Sequence[Value],
    ) -> None: ...

class Material(PythonBlock):
    """Elastic constants and density; steel when not given. In a string item, keys left out are the case's.

    young: Young's modulus [Pa]
    poisson: Poisson's ratio [-]
    density: density [kg/m3]
    damping: damping of the string
    """
    def __init__(
        self,
        *,
        young: Value | None = None,
        poisson: float | None = None,
        density: Value | None = None,
        damping: Damping | dict[str, Any] | None = None,
    ) -> None: ...

class MeasuredPoint(PythonBlock):
    """One reading of the rig.

    bit_depth: measured depth of the bit [m]
    operation: what the string did
    hook_load: hook load as read [N]
    torque: surface torque as read [N m]
    wob: weight on bit, instead of the operation's [N]
    tob: torque on bit, instead of the operation's [N m]
    rpm: rotation, instead of the operation's [rad/s]
    speed: speed of the block, instead of the operation's [m/s]
    flow_rate: flow rate of the pump, instead of the operation's (used by calibrate) [m3/s]
    sigma: standard error of the hook load [N]; 2 % and at least 10 kN when not given
    """
    def __init__(
        self,
        *,
        bit_depth: Value,
        operation: str,
        hook_load: Value | None = None,
        torque: Value | None = None,
        wob: Value | None = None,
        tob: Value | None = None,
        rpm: Value | None = None,
        speed: Value | None = None,
        flow_rate: Value | None = None,
        sigma: Value | None = None,
    ) -> None: ...

class MeshSettings(PythonBlock):
    """Elements of automatic length; items that name their `element_length` are not concerned.

    refinement: automatic elements are shorter by this factor [-]; 2 halves them
    frequency: highest frequency of interest [1/s]: automatic elements resolve bending, torsional and axial waves up to it. When not given: bending waves at the rotation speed of a run with inertia
    """
    def __init__(
        self,
        *,
        refinement: float | None = None,
        frequency: Value | None = None,
    ) -> None: ...

class MotorCurve(PythonBlock):
    """Measured points of a motor: one value of each list a point.

    flow_rate: flow rate [m3/s]; points with the same one are a curve of rising torque
    differential_pressure: pressure that the mud loses [Pa]
    torque: torque of the motor [N m]; the first of a curve is 0
    speed: speed of the rotor in the stator, not rising along a curve [rad/s]
    """
    def __init__(
        self,
        *,
        flow_rate: Sequence[Value],
        differential_pressure: Sequence[Value],
        torque: Sequence[Value],
        speed: Sequence[Value],
    ) -> None: ...

class MotorSection(PythonBlock):
    """Power section of a positive displacement motor: law, rotor and flow.

    rev_per_volume: turns of the rotor per volume of mud, `0.29 rev/gal` [rad/m3]
    efficiency: torque over the torque of a motor that turns all its pressure into torque [-]
    no_load_pressure: differential pressure of the motor without torque [Pa]
    stall_torque: torque at which the rotor stops and all mud leaks past it [N m]
    droop: exponent of the loss of speed [-]: speed over free speed is 1 - (torque/stall_torque)^droop
    curve: measured performance instead of a law: the name of a CSV file with the columns flow, differential_pressure, torque and speed, each with its unit in brackets; curves that end before the rotor stops are extended to stall_torque
    lobes: lobes of rotor and stator, `[7, 8]`; needed with an eccentricity
    rotor_mass: mass of the rotor, a part of the item's mass [kg]
    eccentricity: radius of the rotor's orbit in the stator [m]
    rotor_inertia: moment of inertia of rotor and drive shaft about their axis [kg m2]
    bypass: flow rate through the nozzle of the rotor, which gives no torque [m3/s]
    flow_rate: flow rate over time if the case has no fluid [m3/s]; otherwise the flow in the bore turns the motor
    seal_diameter: diameter on which the differential pressure pushes the rotor down [m]; the item's bore when not given
    """
    def __init__(
        self,
        *,
        rev_per_volume: Value | None = None,
        efficiency: float | None = None,
        no_load_pressure: Value | None = None,
        stall_torque: Value | None = None,
        droop: float | None = None,
        curve: str | MotorCurve | dict[str, Any] | None = None,
        lobes: Sequence[int] | None = None,
        rotor_mass: Value | None = None,
        eccentricity: Value | None = None,
        rotor_inertia: Value | None = None,
        bypass: Value | None = None,
        flow_rate: Value | dict[str, Any] | None = None,
        seal_diameter: Value | None = None,
    ) -> None: ...

class Newtonian(PythonBlock):
    """Water, oil, brine.

    viscosity: viscosity [Pa s]; 0 is a fluid without friction
    law: friction in pipe and annulus. blend: one smooth formula from laminar to turbulent flow. api: API form with Metzner-Reed Reynolds number and straight transition. exact: laminar profile integrated
    shear_rate: shear rate below which stresses go smoothly to zero [1/s]
    dial: readings of a viscometer in degrees by its speed in rpm, {600: 64, 300: 41}; the model's constants are fitted to them unless given
    fit: fit to the readings: api: rules of API RP 13D (default with two readings and with law api); least_squares: in stress
    """
    def __init__(
        self,
        *,
        viscosity: Value,
        law: Literal['blend', 'api', 'exact'] | None = None,
        shear_rate: Value | None = None,
        dial: dict[str, Any] | None = None,
        fit: Literal['api', 'least_squares'] | None = None,
    ) -> None: ...

class Output(PythonBlock):
    """Contents of the run folder. Intervals are simulated time.

    history_every: interval of history.csv and probes.csv [s]; end/1000, between 1 ms and 0.1 s (quasi_static: without limit), when not given
    field_every: interval of the snapshots of the string [s]; end/100, not below history_every, when not given
    probes: measured depths along the string, each with columns in probes.csv [m]
    item_forces: true: side force, its components, couple and contact force sum of every rigid item are written to history.csv
    sensors: downhole sensors, each with a file in the folder sensors
    indices: indices of drilling dynamics in indices.csv and in the summary: stick-slip, vibration, energy, whirl; true for the defaults
    checkpoint_every: interval of checkpoint.h5 [s]; end/10 when not given
    units: units of printed and plotted figures (files stay in SI); the case's units when not given
    """
    def __init__(
        self,
        *,
        history_every: Value | None = None,
        field_every: Value | None = None,
        probes: Sequence[Value] | None = None,
        item_forces: bool | None = None,
        sensors: Sensor | dict[str, Any] | Sequence[Sensor | dict[str, Any]] | None = None,
        indices: bool | Indices | dict[str, Any] | None = None,
        checkpoint_every: Value | None = None,
        units: Literal['field', 'metric', 'metric_t', 'SI'] | None = None,
    ) -> None: ...

class OwnBitLaw(PythonBlock):
    """A law of the user that gives the torque on bit, and if it likes the rate of penetration, from the state of the bit.

    function: file.py:function, beside the case file, or module:function; from Python also the function itself
    kind: python: a function in Python; compiled: a law in a C++ file, file.cpp:law, whose folder is a plug-in
    source: SHA-256 of the file with the function, filled in; a case that gives it does not run with another file
    parameters: numbers that the function takes by name, in SI units
    stiffness: contact stiffness of bit on rock [N/m]; bottom.stiffness is set to this value
    """
    def __init__(
        self,
        *,
        function: str,
        kind: Literal['python', 'compiled'],
        source: str | None = None,
        parameters: dict[str, Any] | None = None,
        stiffness: Value | None = None,
    ) -> None: ...

class OwnComponent(PythonBlock):
    """A component of the user: a function that builds it from the string and its hole.

    function: file.py:function, beside the case file, or module:function; from Python also the function itself
    source: SHA-256 of the file with the function, filled in; a case that gives it does not run with another file
    parameters: what the function takes by name, in SI units
    """
    def __init__(
        self,
        *,
        function: str,
        source: str | None = None,
        parameters: dict[str, Any] | None = None,
    ) -> None: ...

class OwnFriction(PythonBlock):
    """A law of the user that gives the friction coefficient from the state at a contact point.

    function: file.py:function, beside the case file, or module:function; from Python also the function itself
    kind: python: a function in Python; compiled: a law in a C++ file, file.cpp:law, whose folder is a plug-in
    source: SHA-256 of the file with the function, filled in; a case that gives it does not run with another file
    parameters: numbers that the function takes by name, in SI units
    """
    def __init__(
        self,
        *,
        function: str,
        kind: Literal['python', 'compiled'],
        source: str | None = None,
        parameters: dict[str, Any] | None = None,
    ) -> None: ...

class OwnRheology(PythonBlock):
    """A function that gives the shear stress. Turbulence is computed for the power law between 300 and 600 rpm of a viscometer.

    function: file.py:function, beside the case file, or module:function; from Python also the function itself
    law: friction in pipe and annulus: laminar profile integrated
    shear_rate: shear rate below which stresses go smoothly to zero [1/s]
    dial: readings of a viscometer in degrees by its speed in rpm, {600: 64, 300: 41}; the model's constants are fitted to them unless given
    fit: fit to the readings: api: rules of API RP 13D (default with two readings and with law api); least_squares: in stress
    source: SHA-256 of the file with the function, filled in; a case that gives it does not run with another file
    parameters: numbers that the function takes by name, in SI units
    """
    def __init__(
        self,
        *,
        function: str,
        law: Literal['exact'] | None = None,
        shear_rate: Value | None = None,
        dial: dict[str, Any] | None = None,
        fit: Literal['api', 'least_squares'] | None = None,
        source: str | None = None,
        parameters: dict[str, Any] | None = None,
    ) -> None: ...

class OwnRockLaw(PythonBlock):
    """A law of the user that gives the strength of the rock from the depth.

    function: file.py:function, beside the case file, or module:function; from Python also the function itself
    kind: python: a function in Python; compiled: a law in a C++ file, file.cpp:law, whose folder is a plug-in
    source: SHA-256 of the file with the function, filled in; a case that gives it does not run with another file
    parameters: numbers that the function takes by name, in SI units
    """
    def __init__(
        self,
        *,
        function: str,
        kind: Literal['python', 'compiled'],
        source: str | None = None,
        parameters: dict[str, Any] | None = None,
    ) -> None: ...

class PatternOrder(PythonBlock):
    """A wave of the bottom's surface under a roller cone.

    order: waves per turn of the bit [-]
    amplitude: half the height from valley to crest [m]
    phase: phase at the start [rad]: at 0 the bit is half-way up, at 90 deg on a crest
    """
    def __init__(
        self,
        *,
        order: float,
        amplitude: Value,
        phase: Value | None = None,
    ) -> None: ...

class PiController(PythonBlock):
    """Torque p e + i times the integral of e, with e the set point minus the speed.

    p: proportional gain [N m s/rad]
    i: integral gain [N m/rad]
    from_: time from which it acts [s]
    delay: delay of the controller's output [s]
    sample: time between two samples of a controller that holds its torque in between [s]; 0: continuous. With it, delay is a multiple of it
    """
    def __init__(
        self,
        *,
        p: Value,
        i: Value,
        from_: Value | None = None,
        delay: Value | None = None,
        sample: Value | None = None,
    ) -> None: ...

class Pipe(PythonBlock):
    """A plain round tube, without tool joints.

    length: length [m]; fill for the topmost pipe: bit_depth, or the end of the survey, less all other items
    od: outer diameter [m]
    name: name in reports; the kind when not given
    friction: friction coefficient of this item, instead of the hole section's [-]
    weight: weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area [kg/m]; mud displaces the ring between od and id
    pressure_loss: pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or {curve: loss.csv, density: 10 ppg}
    element_length: target length of an element, rounded so that elements fit the item [m]; auto: chosen from the physics along the string and graded
    eccentricity: offset of the mass centre from the axis [m]
    eccentricity_angle: direction of the eccentricity in the section [rad]
    curvature: stress-free curvature [1/m]
    curvature_angle: direction in which the item bends downward [rad]: 0 is the high side, 90 deg to the right looking down the hole; measured from north if the inclination is below 5 deg; at spin angle zero
    bend: bent sub: kink at the item's upper end
    initial: imperfection of this item
    id: inner diameter [m]
    material: material of this item; keys left out are the case's
    bore_volume: volume of the mud inside the item [m3]; the volume of a bore of its id when not given
    annulus_od: outer diameter that the mud outside flows past and that displaces it [m]; od when not given
    """
    def __init__(
        self,
        *,
        length: Value,
        od: Value,
        name: str | None = None,
        friction: float | None = None,
        weight: Value | None = None,
        pressure_loss: PressureLoss | dict[str, Any] | None = None,
        element_length: Value | None = None,
        eccentricity: Value | None = None,
        eccentricity_angle: Value | None = None,
        curvature: Value | None = None,
        curvature_angle: Value | None = None,
        bend: Bend | dict[str, Any] | None = None,
        initial: ItemInitial | dict[str, Any] | None = None,
        id: Value | None = None,
        material: Material | dict[str, Any] | None = None,
        bore_volume: Value | None = None,
        annulus_od: Value | None = None,
    ) -> None: ...

class PointLoad(PythonBlock):
    """A force and a moment at one measured depth.

    at: measured depth [m]
    frame: global: north, east, down; section: along the string, then two directions across it, which turn with the string
    value_over: factor over time on force and moment [-]
    force: force [N]
    moment: moment [N m]
    """
    def __init__(
        self,
        *,
        at: Value,
        frame: Literal['global', 'section'] | None = None,
        value_over: float | dict[str, Any] | None = None,
        force: Sequence[Value] | None = None,
        moment: Sequence[Value] | None = None,
    ) -> None: ...

class PointSteering(PythonBlock):
    """The shaft below is tilted towards the tool face while it turns.

    tilt: angle of the tilt at ratio 1 [rad]
    steer: command over time
    """
    def __init__(
        self,
        *,
        tilt: Value,
        steer: Steer | dict[str, Any] | None = None,
    ) -> None: ...

class MudMotor(PythonBlock):
    """A downhole motor: its housing is pipe of the string, its rotor turns what hangs below its joint.

    length: length [m]
    od: outer diameter [m]
    pdm: power section: law of the motor, its rotor, its flow
    name: name in reports; the kind when not given
    friction: friction coefficient of this item, instead of the hole section's [-]
    weight: weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area [kg/m]; mud displaces the ring between od and id
    pressure_loss: pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or {curve: loss.csv, density: 10 ppg}
    element_length: target length of an element, rounded so that elements fit the item [m]; auto: chosen from the physics along the string and graded
    eccentricity: offset of the mass centre from the axis [m]
    eccentricity_angle: direction of the eccentricity in the section [rad]
    curvature: stress-free curvature [1/m]
    curvature_angle: direction in which the item bends downward [rad]: 0 is the high side, 90 deg to the right looking down the hole; measured from north if the inclination is below 5 deg; at spin angle zero
    bend: bent sub: kink at the item's upper end
    initial: imperfection of this item
    id: inner diameter [m]
    material: material of this item; keys left out are the case's
    bore_volume: volume of the mud inside the item [m3]; the volume of a bore of its id when not given
    annulus_od: outer diameter that the mud outside flows past and that displaces it [m]; od when not given
    mass: mass of the whole item [kg]; when not given, the mass of a tube with this od, id and density
    joint_at: start of the rotating part below the item's upper end [m]; half the length, or half-way between a bend and the lower end, when not given
    """
    def __init__(
        self,
        *,
        length: Value,
        od: Value,
        pdm: MotorSection | dict[str, Any],
        name: str | None = None,
        friction: float | None = None,
        weight: Value | None = None,
        pressure_loss: PressureLoss | dict[str, Any] | None = None,
        element_length: Value | None = None,
        eccentricity: Value | None = None,
        eccentricity_angle: Value | None = None,
        curvature: Value | None = None,
        curvature_angle: Value | None = None,
        bend: Bend | dict[str, Any] | None = None,
        initial: ItemInitial | dict[str, Any] | None = None,
        id: Value | None = None,
        material: Material | dict[str, Any] | None = None,
        bore_volume: Value | None = None,
        annulus_od: Value | None = None,
        mass: Value | None = None,
        joint_at: Value | None = None,
    ) -> None: ...

class PowerLaw(PythonBlock):
    """Shear thinning (index below 1) or thickening, without a yield stress.

    consistency: consistency [Pa s^n]
    index: flow index n, 1 for a Newtonian fluid [-]
    law: friction in pipe and annulus. blend: one smooth formula from laminar to turbulent flow. api: API form with Metzner-Reed Reynolds number and straight transition. exact: laminar profile integrated
    shear_rate: shear rate below which stresses go smoothly to zero [1/s]
    dial: readings of a viscometer in degrees by its speed in rpm, {600: 64, 300: 41}; the model's constants are fitted to them unless given
    fit: fit to the readings: api: rules of API RP 13D (default with two readings and with law api); least_squares: in stress
    """
    def __init__(
        self,
        *,
        consistency: Value,
        index: float,
        law: Literal['blend', 'api', 'exact'] | None = None,
        shear_rate: Value | None = None,
        dial: dict[str, Any] | None = None,
        fit: Literal['api', 'least_squares'] | None = None,
    ) -> None: ...

class PressureLoss(PythonBlock):
    """Pressure loss of a tool in the string, such as an MWD or a filter. It scales with the density of the mud.

    A measured value with its flow rate and density scales with the flow rate squared. So does a loss coefficient K: loss
    = K density velocity^2/2
    with the velocity in the item's bore. A curve gives the losses at several flow rates.

    value: pressure loss [Pa]; or a coefficient, or a curve
    at: flow rate of the value [m3/s]
    density: density of the fluid of the value, or of the curve [kg/m3]
    coefficient: loss over half the density times the squared velocity in the item's bore, instead of a value [-]
    curve: losses at several flow rates instead of a value: {flow_rate: [..], loss: [..]}, or a CSV file with the columns flow and loss, each with its unit in brackets
    """
    def __init__(
        self,
        *,
        value: Value | None = None,
        at: Value | None = None,
        density: Value | None = None,
        coefficient: float | None = None,
        curve: str | LossCurve | dict[str, Any] | None = None,
    ) -> None: ...

class PushSteering(PythonBlock):
    """Pads push on the wall, and the wall pushes the string towards the tool face.

    force: force on the string at ratio 1, its mean over a turn [N]
    pad_offset: height of the pads above the item's lower end [m]
    pads: sleeve: on a sleeve that does not turn, a steady force; rotating: three pads turn with the string, each acts over 120 deg
    steer: command over time
    """
    def __init__(
        self,
        *,
        force: Value,
        pad_offset: Value,
        pads: Literal['sleeve', 'rotating'] | None = None,
        steer: Steer | dict[str, Any] | None = None,
    ) -> None: ...

class PythonController(PythonBlock):
    """A function of the user that gives the torque at every sample; between two samples the torque is held.

    function: file.py:function or module:function, of the time [s], of what is measured (a dictionary) and of a memory; returns the torque [N m]
    sample: time between two samples [s]
    source: SHA-256 of the file with the function, filled in; a case that gives it does not run with another file
    """
    def __init__(
        self,
        *,
        function: str,
        sample: Value,
        source: str | None = None,
    ) -> None: ...

class Reamer(PythonBlock):
    """A reamer: its blades cut the ring around the pilot hole of the bit, and touch the reamed hole above.

    length: length [m]
    name: name in reports; the kind when not given
    friction: friction coefficient of this item, instead of the hole section's [-]
    weight: weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area [kg/m]; mud displaces the ring between od and id
    pressure_loss: pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or {curve: loss.csv, density: 10 ppg}
    od: outer diameter over the blades [m]; or give blade_od, or gauge
    id: inner diameter [m]
    mass: mass [kg]; when not given, the mass of a tube with this od, id, length and density
    unbalance: mass times offset of the mass centre from the axis [kg m]
    unbalance_angle: direction of the unbalance in the section [rad]
    inertia: moments of inertia about the centre of gravity
    center_of_gravity: distance below the item's upper end along the axis, or [distance, two offsets across the axis] [m]; half the length when not given
    material: material of this item (for its density); keys left out are the case's
    bore_volume: volume of the mud inside the item [m3]; the volume of a bore of its id when not given
    annulus_od: diameter of a cylinder of the item's length that displaces as much mud [m]; by its metal, mass over density, when not given
    blade_od: outer diameter over the blades, sets od [m]
    gauge: outer diameter over the blades relative to the bit: full, or 1/8 in under; sets od
    blade_length: length of the blades, which touch the hole [m]; the whole item when not given
    blade_position: height of the middle of the blades above the item's lower end [m]; the middle of the item when not given
    body_od: outer diameter between the blades [m]; for mass and the flow past the item
    bypass_area: flow area past the blades [m2]; when not given, the hole minus body and blades, which fill 45 % of the ring between body_od and od
    stiff: true: a rigid item; false: its body bends, its blades do not
    bend: bent sub: kink at the item's upper end
    nozzle_area: total flow area of nozzles in the side of the item, from the bore to the annulus [m2]; none when not given
    nozzles: diameters of nozzles in the side of the item, `2 x 14/32 in` or [14, 14] in 32nds of an inch [m]; sets nozzle_area
    pilot: diameter of the pilot hole [m]; the bit's diameter, which is also the default
    blades: number of blades
    specific_energy: intrinsic specific energy [Pa]: work of cutting per volume of rock, 1 J/m3 = 1 Pa
    inclination_ratio: vertical over horizontal force of a cutter [-]
    """
    def __init__(
        self,
        *,
        length: Value,
        name: str | None = None,
        friction: float | None = None,
        weight: Value | None = None,
        pressure_loss: PressureLoss | dict[str, Any] | None = None,
        od: Value | None = None,
        id: Value | None = None,
        mass: Value | None = None,
        unbalance: Value | None = None,
        unbalance_angle: Value | None = None,
        inertia: Inertia | dict[str, Any] | None = None,
        center_of_gravity: Value | Sequence[Value] | None = None,
        material: Material | dict[str, Any] | None = None,
        bore_volume: Value | None = None,
        annulus_od: Value | None = None,
        blade_od: Value | None = None,
        gauge: str | None = None,
        blade_length: Value | None = None,
        blade_position: Value | None = None,
        body_od: Value | None = None,
        bypass_area: Value | None = None,
        stiff: bool | None = None,
        bend: Bend | dict[str, Any] | None = None,
        nozzle_area: Value | None = None,
        nozzles: str | Sequence[Value] | None = None,
        pilot: Value | None = None,
        blades: int | None = None,
        specific_energy: Value | None = None,
        inclination_ratio: float | None = None,
    ) -> None: ...

class Rig(PythonBlock):
    """The rig: weight on the hook in addition to the string, and the limits of the rig.

    datum: point that measured depths count from, such as RKB; shown in reports
    elevation: height of the datum above elevation_ref, for depths of reports below it [m]
    elevation_ref: what elevation counts from; default MSL, mean sea level
    block_weight: weight of block and top drive, a force or a mass [N]; hook_load_total is reported with it
    hookload_sensor: where the hook load is read; at the hook when not given
    wob_zero: zero of the weights on bit of measured points: off_bottom (default), zeroed before each reading, or the depth and flow rate of one zeroing, {bit_depth: 1935 m, flow_rate: 3517 l/min}
    running_drag: true: mud that a running or pulled string displaces drags it, in roadmaps and beside measured points
    max_hookload: largest total hook load, with the block [N]
    max_surface_torque: largest torque of the drive [N m]
    max_spp: largest standpipe pressure [Pa]
    """
    def __init__(
        self,
        *,
        datum: str | None = None,
        elevation: Value | None = None,
        elevation_ref: str | None = None,
        block_weight: Value | None = None,
        hookload_sensor: HookloadSensor | dict[str, Any] | None = None,
        wob_zero: Literal['off_bottom'] | WobZero | dict[str, Any] | None = None,
        running_drag: bool | None = None,
        max_hookload: Value | None = None,
        max_surface_torque: Value | None = None,
        max_spp: Value | None = None,
    ) -> None: ...

class Roadmap(PythonBlock):
    """A torque-and-drag roadmap: what `drillpetsc roadmap` computes.

    operations: operations, each once; slackoff, pickup and rob are also accepted
    bit_depth: measured depths of the bit, or {from, to, step} [m]; by default 30 depths from 10 % of the hole to its end, and the casing shoes
    friction_factor: friction factors; 0.75, 1 and 1.25 times the sections' own when not given
    trip_speed: speed of tripping in and out [m/s]
    rpm: rotation off bottom and while drilling [rad/s]
    drilling: drilling with rotation
    sliding: drilling without rotation
    backreaming: pulling out with rotation
    measured: measured points, or the name of a file with them: CSV, xlsx or LAS
    hookload_excludes_block: true: measured hook loads do not include the block
    hole_grows: true: the open hole ends at the bit; false: the hole of the case is there below it. Both give the same rows, since nothing below the bit touches the string or moves its mud
    """
    def __init__(
        self,
        *,
        operations: Sequence[str] | None = None,
        bit_depth: Value | Sequence[Value] | DepthRange | dict[str, Any] | None = None,
        friction_factor: FrictionFactors | dict[str, Any] | None = None,
        trip_speed: Value | None = None,
        rpm: Value | None = None,
        drilling: Drilling | dict[str, Any] | None = None,
        sliding: Sliding | dict[str, Any] | None = None,
        backreaming: Backreaming | dict[str, Any] | None = None,
        measured: str | Sequence[MeasuredPoint | dict[str, Any]] | None = None,
        hookload_excludes_block: bool | None = None,
        hole_grows: bool | None = None,
    ) -> None: ...

class RockAnisotropy(PythonBlock):
    """Bedded rock: M_r = n n^T + index_dip d d^T + index_strike s s^T, n across the bedding, d down dip, s
    along strike.

    dip: angle of the bedding from the horizontal [rad]
    dip_azimuth: azimuth of the down-dip direction, from north over east [rad]
    index_dip: drillability down dip over drillability across the bedding [-]
    index_strike: drillability along strike over drillability across the bedding [-]
    """
    def __init__(
        self,
        *,
        dip: Value | None = None,
        dip_azimuth: Value | None = None,
        index_dip: float | None = None,
        index_strike: float | None = None,
    ) -> None: ...

class RollerCone(PythonBlock):
    """Cones that roll on lobes of the bottom: its surface moves the turning bit up and down. The bit can lift off.

    lobes: lobes of the bottom, waves per turn; 3 when not given
    amplitude: half the height of the lobes, from valley to crest [m]
    phase: phase of the lobes at the start [rad]: at 0 the bit is half-way up, at 90 deg on a crest; 0 when not given
    pattern: several waves, [{order: 3, amplitude: 3 mm}, ...], instead of lobes and amplitude
    base: law of torque and rate of penetration: rop, velocity_weakening, or python
    stiffness: contact stiffness of bit on rock [N/m]; bottom.stiffness is set to this value
    """
    def __init__(
        self,
        *,
        lobes: int | None = None,
        amplitude: Value | None = None,
        phase: Value | None = None,
        pattern: Sequence[PatternOrder | dict[str, Any]] | None = None,
        base: Literal['rop'] | RopLaw | dict[str, Any] | VelocityWeakening | OwnBitLaw | None = None,
        stiffness: Value | None = None,
    ) -> None: ...

class RopLaw(PythonBlock):
    """Rate of penetration from force and rotation speed. The torque comes from friction (bottom.friction).

    stiffness: contact stiffness of bit on rock [N/m]; bottom.stiffness is set to this value
    """
    def __init__(
        self,
        *,
        stiffness: Value | None = None,
    ) -> None: ...

class RotarySteerable(PythonBlock):
    """A rotary steerable tool in a plain round tube, which bends.

    length: length [m]
    od: outer diameter [m]
    rss: how it steers
    name: name in reports; the kind when not given
    friction: friction coefficient of this item, instead of the hole section's [-]
    weight: weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area [kg/m]; mud displaces the ring between od and id
    pressure_loss: pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or {curve: loss.csv, density: 10 ppg}
    element_length: target length of an element, rounded so that elements fit the item [m]; auto: chosen from the physics along the string and graded
    eccentricity: offset of the mass centre from the axis [m]
    eccentricity_angle: direction of the eccentricity in the section [rad]
    curvature: stress-free curvature [1/m]
    curvature_angle: direction in which the item bends downward [rad]: 0 is the high side, 90 deg to the right looking down the hole; measured from north if the inclination is below 5 deg; at spin angle zero
    bend: bent sub: kink at the item's upper end
    initial: imperfection of this item
    id: inner diameter [m]
    material: material of this item; keys left out are the case's
    bore_volume: volume of the mud inside the item [m3]; the volume of a bore of its id when not given
    annulus_od: outer diameter that the mud outside flows past and that displaces it [m]; od when not given
    joint_at: height of the tilt above the item's lower end, with rss.kind point [m]; the middle when not given
    mass: mass, instead of the mass of a tube with the density of the material [kg]
    """
    def __init__(
        self,
        *,
        length: Value,
        od: Value,
        rss: PushSteering | dict[str, Any] | PointSteering,
        name: str | None = None,
        friction: float | None = None,
        weight: Value | None = None,
        pressure_loss: PressureLoss | dict[str, Any] | None = None,
        element_length: Value | None = None,
        eccentricity: Value | None = None,
        eccentricity_angle: Value | None = None,
        curvature: Value | None = None,
        curvature_angle: Value | None = None,
        bend: Bend | dict[str, Any] | None = None,
        initial: ItemInitial | dict[str, Any] | None = None,
        id: Value | None = None,
        material: Material | dict[str, Any] | None = None,
        bore_volume: Value | None = None,
        annulus_od: Value | None = None,
        joint_at: Value | None = None,
        mass: Value | None = None,
    ) -> None: ...

class Section(PythonBlock):
    """An interval of the hole with one diameter.

    kind: cased hole, riser between rig and seabed, or open hole
    diameter: inner diameter [m]
    to: measured depth of the lower end [m]; for the last section `end`, or nothing: the last station of the survey
    friction: friction coefficient [-]; 0.2 in casing and riser, 0.3 in open hole when not given
    ff_group: group whose friction factor `roadmap` and `calibrate` change together; cased or open hole by its kind when not given
    compliance: elasticity of the wall (used by a fluid in the annulus); rigid when not given
    """
    def __init__(
        self,
        *,
        kind: Literal['casing', 'riser', 'open_hole'],
        diameter: Value,
        to: Value | None = None,
        friction: float | None = None,
        ff_group: str | None = None,
        compliance: Compliance | dict[str, Any] | None = None,
    ) -> None: ...

class Sensor(PythonBlock):
    """A downhole sensor: channels at one place of the string, sampled at a given rate.

    name: name of its file, such as mwd; letters, digits, - and _
    at: measured depth, or the name of a string item, in whose middle it is [m]
    rate: samples in a second, in Hz [1/s]
    channels: ax, ay, az: acceleration along the string, towards `angle` and to its right; rpm: rotation, true and by a magnetometer; torque, wob, bending: loads of the section; pressure: of the mud
    radius: distance of the accelerometers from the axis [m]
    angle: direction of the accelerometers in the section, clockwise looking down [rad]
    gravity: true: accelerations less gravity, as a real accelerometer; false: of the motion alone
    filter: anti-alias filter; without it the motion is sampled unfiltered
    range: largest acceleration that the accelerometers show, such as 100 g [m/s2]
    magnetic_dip: dip of the magnetic field of the magnetometer below the horizontal [rad]; its declination is 0
    """
    def __init__(
        self,
        *,
        name: str,
        at: Value,
        rate: Value,
        channels: Sequence[Literal['ax', 'ay', 'az', 'rpm', 'torque', 'wob', 'bending', 'pressure']] | None = None,
        radius: Value | None = None,
        angle: Value | None = None,
        gravity: bool | None = None,
        filter: SensorFilter | dict[str, Any] | None = None,
        range: Value | None = None,
        magnetic_dip: Value | None = None,
    ) -> None: ...

class SensorFilter(PythonBlock):
    """Low-pass filter before the samples are taken.

    cutoff: frequency at which the gain is 1/sqrt(2), in Hz [1/s]; below half the rate
    order: number of poles
    """
    def __init__(
        self,
        *,
        cutoff: Value,
        order: int | None = None,
    ) -> None: ...

class ShockSub(PythonBlock):
    """A shock sub: a spring and a damper between two parts that telescope.

    length: length [m]
    od: outer diameter [m]
    stiffness: stiffness of the spring [N/m]
    name: name in reports; the kind when not given
    friction: friction coefficient of this item, instead of the hole section's [-]
    weight: weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area [kg/m]; mud displaces the ring between od and id
    pressure_loss: pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or {curve: loss.csv, density: 10 ppg}
    element_length: target length of an element, rounded so that elements fit the item [m]; auto: chosen from the physics along the string and graded
    eccentricity: offset of the mass centre from the axis [m]
    eccentricity_angle: direction of the eccentricity in the section [rad]
    curvature: stress-free curvature [1/m]
    curvature_angle: direction in which the item bends downward [rad]: 0 is the high side, 90 deg to the right looking down the hole; measured from north if the inclination is below 5 deg; at spin angle zero
    bend: bent sub: kink at the item's upper end
    initial: imperfection of this item
    id: inner diameter [m]
    material: material of this item; keys left out are the case's
    bore_volume: volume of the mud inside the item [m3]; the volume of a bore of its id when not given
    annulus_od: outer diameter that the mud outside flows past and that displaces it [m]; od when not given
    mass: mass [kg]; when not given, the mass of a tube with this od, id, length and density
    joint_at: distance of the slider below the item's upper end [m]; half the length when not given
    seal_area: area inside the seals, on which the pressure difference between string and annulus pushes the parts apart (pump-open force) [m2]
    stop_stiffness: stiffness of the stops at the ends of the stroke [N/m]
    damping: force over the speed at which the parts telescope [N s/m]
    preload: force with which the spring pushes the parts apart at zero travel [N]; negative: pulls them together
    stroke: [least, largest] travel between the stops, negative as the tool closes [m]; no stops when not given
    torsion_stiffness: torsional stiffness between the parts [N m/rad]; they do not turn when not given
    """
    def __init__(
        self,
        *,
        length: Value,
        od: Value,
        stiffness: Value,
        name: str | None = None,
        friction: float | None = None,
        weight: Value | None = None,
        pressure_loss: PressureLoss | dict[str, Any] | None = None,
        element_length: Value | None = None,
        eccentricity: Value | None = None,
        eccentricity_angle: Value | None = None,
        curvature: Value | None = None,
        curvature_angle: Value | None = None,
        bend: Bend | dict[str, Any] | None = None,
        initial: ItemInitial | dict[str, Any] | None = None,
        id: Value | None = None,
        material: Material | dict[str, Any] | None = None,
        bore_volume: Value | None = None,
        annulus_od: Value | None = None,
        mass: Value | None = None,
        joint_at: Value | None = None,
        seal_area: Value | None = None,
        stop_stiffness: Value | None = None,
        damping: Value | None = None,
        preload: Value | None = None,
        stroke: Sequence[Value] | None = None,
        torsion_stiffness: Value | None = None,
    ) -> None: ...

class Sliding(PythonBlock):
    """Drilling without rotation of the string.

    wob: weight on bit [N]; initial.wob when not given, else 15 klbf
    tob: torque of the rock on the bit [N m]
    flow_rate: flow rate of the pump, which drags and lifts the string [m3/s]; 0: the mud is at rest; fluid.flow_rate at time 0 when not given
    """
    def __init__(
        self,
        *,
        wob: Value | None = None,
        tob: Value | None = None,
        flow_rate: Value | None = None,
    ) -> None: ...

class SoftTorqueController(PythonBlock):
    """Impedance control: the drive absorbs torsional waves about one frequency.

    kind: impedance control (soft torque)
    from_: time from which it acts [s]
    delay: delay of the controller's output [s]
    sample: time between two samples of a controller that holds its torque in between [s]; 0: continuous. With it, delay is a multiple of it
    damping: proportional gain, times the impedance of the uppermost pipe [-]; a wave of the tuned frequency is reflected by (damping - 1)/(damping + 1)
    frequency: tuned frequency [1/s]; auto: the lowest torsional frequency of the string with its top held
    inertia_compensation: share of the drive's inertia compensated by a torque proportional to the acceleration [-]
    """
    def __init__(
        self,
        *,
        kind: Literal['soft_torque', 'soft_speed'],
        from_: Value | None = None,
        delay: Value | None = None,
        sample: Value | None = None,
        damping: float | None = None,
        frequency: Value | None = None,
        inertia_compensation: float | None = None,
    ) -> None: ...

class Spread(PythonBlock):
    """Distribution of a number of the case, in its units.

    normal: mean and standard deviation of a normal distribution
    lognormal: mean and standard deviation of a number whose logarithm is normal: it is never negative
    uniform: lowest and highest value, between which all are equally likely
    triangular: lowest, most likely and highest value
    path: for the key `well.survey` only: error of the survey
    correlated: correlation coefficients with other keys of `uncertain`, by key
    """
    def __init__(
        self,
        *,
        normal: Sequence[Value] | None = None,
        lognormal: Sequence[Value] | None = None,
        uniform: Sequence[Value] | None = None,
        triangular: Sequence[Value] | None = None,
        path: SurveyError | dict[str, Any] | None = None,
        correlated: dict[str, Any] | None = None,
    ) -> None: ...

class Stabilizer(PythonBlock):
    """A stabilizer: contact with the hole over its blades, or over its length when blade_length is not given.

    length: length [m]
    name: name in reports; the kind when not given
    friction: friction coefficient of this item, instead of the hole section's [-]
    weight: weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area [kg/m]; mud displaces the ring between od and id
    pressure_loss: pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or {curve: loss.csv, density: 10 ppg}
    od: outer diameter over the blades [m]; or give blade_od, or gauge
    id: inner diameter [m]
    mass: mass [kg]; when not given, the mass of a tube with this od, id, length and density
    unbalance: mass times offset of the mass centre from the axis [kg m]
    unbalance_angle: direction of the unbalance in the section [rad]
    inertia: moments of inertia about the centre of gravity
    center_of_gravity: distance below the item's upper end along the axis, or [distance, two offsets across the axis] [m]; half the length when not given
    material: material of this item (for its density); keys left out are the case's
    bore_volume: volume of the mud inside the item [m3]; the volume of a bore of its id when not given
    annulus_od: diameter of a cylinder of the item's length that displaces as much mud [m]; by its metal, mass over density, when not given
    blade_od: outer diameter over the blades, sets od [m]
    gauge: outer diameter over the blades relative to the bit: full, or 1/8 in under; sets od
    blade_length: length of the blades, which touch the hole [m]; the whole item when not given
    blade_position: height of the middle of the blades above the item's lower end [m]; the middle of the item when not given
    body_od: outer diameter between the blades [m]; for mass and the flow past the item
    bypass_area: flow area past the blades [m2]; when not given, the hole minus body and blades, which fill 45 % of the ring between body_od and od
    stiff: true: a rigid item; false: its body bends, its blades do not
    bend: bent sub: kink at the item's upper end
    nozzle_area: total flow area of nozzles in the side of the item, from the bore to the annulus [m2]; none when not given
    nozzles: diameters of nozzles in the side of the item, `2 x 14/32 in` or [14, 14] in 32nds of an inch [m]; sets nozzle_area
    """
    def __init__(
        self,
        *,
        length: Value,
        name: str | None = None,
        friction: float | None = None,
        weight: Value | None = None,
        pressure_loss: PressureLoss | dict[str, Any] | None = None,
        od: Value | None = None,
        id: Value | None = None,
        mass: Value | None = None,
        unbalance: Value | None = None,
        unbalance_angle: Value | None = None,
        inertia: Inertia | dict[str, Any] | None = None,
        center_of_gravity: Value | Sequence[Value] | None = None,
        material: Material | dict[str, Any] | None = None,
        bore_volume: Value | None = None,
        annulus_od: Value | None = None,
        blade_od: Value | None = None,
        gauge: str | None = None,
        blade_length: Value | None = None,
        blade_position: Value | None = None,
        body_od: Value | None = None,
        bypass_area: Value | None = None,
        stiff: bool | None = None,
        bend: Bend | dict[str, Any] | None = None,
        nozzle_area: Value | None = None,
        nozzles: str | Sequence[Value] | None = None,
    ) -> None: ...

class Steer(PythonBlock):
    """Command of a rotary steerable tool over time.

    ratio: share of the force or the tilt, 0 to 1, over time [-]
    tool_face: direction in which the tool steers, fixed in space, over time [rad]: 0 is the high side, 90 deg to the right looking down the hole; measured from north if the inclination is below 5 deg
    """
    def __init__(
        self,
        *,
        ratio: float | dict[str, Any] | None = None,
        tool_face: Value | dict[str, Any] | None = None,
    ) -> None: ...

class StiffController(PythonBlock):
    """PI control with gains that follow from the pipe and the inertia of the drive.

    from_: time from which it acts [s]
    delay: delay of the controller's output [s]
    sample: time between two samples of a controller that holds its torque in between [s]; 0: continuous. With it, delay is a multiple of it
    p: proportional gain, times the impedance of the uppermost pipe [-]
    i: integral gain, times the inertia of the drive [1/s2]
    """
    def __init__(
        self,
        *,
        from_: Value | None = None,
        delay: Value | None = None,
        sample: Value | None = None,
        p: float | None = None,
        i: Value | None = None,
    ) -> None: ...

class Stribeck(PythonBlock):
    """Friction coefficient that falls with the slip speed v: mu_k + (mu_s - mu_k) exp(-(v/speed)^2).

    static: static friction coefficient [-]
    speed: slip speed over which the friction coefficient falls [m/s]
    """
    def __init__(
        self,
        *,
        static: float,
        speed: Value,
    ) -> None: ...

class SurfaceLine(PythonBlock):
    """Standpipe, hose, swivel and kelly. Their loss is added to the pump pressure and to nothing else.

    case: equipment of API RP 13D: 2600, 946, 610 or 424 ft of 3.826 in bore with the string's friction law
    length: length of an equivalent pipe, with id, instead of a case [m]
    id: inner diameter of that pipe [m]
    loss: measured loss, with the flow rate `at`, instead of a case [Pa]; it goes with the flow rate squared
    at: flow rate of the loss [m3/s]
    """
    def __init__(
        self,
        *,
        case: Literal[1, 2, 3, 4] | None = None,
        length: Value | None = None,
        id: Value | None = None,
        loss: Value | None = None,
        at: Value | None = None,
    ) -> None: ...

class Survey(PythonBlock):
    """Stations of the hole, from the rotary table down: lists of the same length.

    md: measured depths, rising from 0 [m]
    inclination: inclinations from the vertical [rad]
    azimuth: azimuths from north over east [rad]
    north: what azimuths are measured from; for reports, without azimuth_from
    convergence: grid convergence [rad]: grid north east of true north is positive; for reports, without azimuth_from
    declination: magnetic declination [rad]: magnetic north east of true north is positive; for reports, without azimuth_from
    azimuth_from: true: azimuths are turned from their north by declination and convergence, to grid north, or to true north without convergence
    """
    def __init__(
        self,
        *,
        md: Sequence[Value],
        inclination: Sequence[Value],
        azimuth: Sequence[Value],
        north: Literal['grid', 'true', 'magnetic'] | None = None,
        convergence: Value | None = None,
        declination: Value | None = None,
        azimuth_from: bool | None = None,
    ) -> None: ...

class SurveyError(PythonBlock):
    """Error of a survey that changes smoothly along the hole.

    inclination: standard deviation of the inclination [rad]
    lateral: standard deviation of the direction across it [rad]: the sine of the inclination times the standard deviation of the azimuth
    length: length over which errors are alike, usually 100 to 300 m [m]
    """
    def __init__(
        self,
        *,
        inclination: Value,
        lateral: Value,
        length: Value | None = None,
    ) -> None: ...

class SurveyFile(PythonBlock):
    """A survey in a file of another program.

    file: CSV and other text tables, xlsx (`well.xlsx#Sheet2`), LAS, WITSML trajectory; or a run folder
    columns: titles of columns that the reader does not know: {md: MD_ft, inclination: Neigung, azimuth: Azimut}
    tie_in: station above the first one of the file
    allow_dogleg: true: accept bends above 30 deg/30 m
    north: what azimuths are measured from; for reports, without azimuth_from
    convergence: grid convergence [rad]: grid north east of true north is positive; for reports, without azimuth_from
    declination: magnetic declination [rad]: magnetic north east of true north is positive; for reports, without azimuth_from
    azimuth_from: true: azimuths are turned from their north by declination and convergence, to grid north, or to true north without convergence
    """
    def __init__(
        self,
        *,
        file: str,
        columns: dict[str, Any] | None = None,
        tie_in: TieIn | dict[str, Any] | None = None,
        allow_dogleg: bool | None = None,
        north: Literal['grid', 'true', 'magnetic'] | None = None,
        convergence: Value | None = None,
        declination: Value | None = None,
        azimuth_from: bool | None = None,
    ) -> None: ...

class TieIn(PythonBlock):
    """The station that a survey continues.

    md: measured depth [m]
    inclination: inclination from the vertical [rad]
    azimuth: azimuth from north over east [rad]
    """
    def __init__(
        self,
        *,
        md: Value | None = None,
        inclination: Value | None = None,
        azimuth: Value | None = None,
    ) -> None: ...

class Time(PythonBlock):
    """Simulated time, with or without inertia.

    end: simulated time [s]
    mode: dynamic: with inertia; quasi_static: string and fluid in equilibrium at every moment, while the hole grows
    step: first and largest step of a quasi-static run [s]; the solver's choice when not given
    integrator: bdf: backward differences; generalized_alpha: keeps the energy of vibrations that the steps resolve; auto: generalized_alpha if the string may turn in a hole, with steps short enough to resolve whirl, else bdf
    spectral_radius: of generalized_alpha [-]: 1 keeps fast vibrations, 0 damps them within one step; when not given 0.8, and 0.5 with the bit law velocity_weakening
    """
    def __init__(
        self,
        *,
        end: Value,
        mode: Literal['dynamic', 'quasi_static'] | None = None,
        step: Value | None = None,
        integrator: Literal['auto', 'bdf', 'generalized_alpha'] | None = None,
        spectral_radius: float | None = None,
    ) -> None: ...

class Tool(PythonBlock):
    """A tool of which a string sheet has diameters and weight, such as an MWD: a tube whose stiffnesses may be given.

    length: length [m]
    od: outer diameter [m]
    name: name in reports; the kind when not given
    friction: friction coefficient of this item, instead of the hole section's [-]
    weight: weight per length in air as weighed, 1824 N/m or 125 lb/ft, instead of density times area [kg/m]; mud displaces the ring between od and id
    pressure_loss: pressure loss in this item besides friction, {value: 350 psi, at: 600 gpm, density: 10 ppg}, {coefficient: 2.5} or {curve: loss.csv, density: 10 ppg}
    element_length: target length of an element, rounded so that elements fit the item [m]; auto: chosen from the physics along the string and graded
    eccentricity: offset of the mass centre from the axis [m]
    eccentricity_angle: direction of the eccentricity in the section [rad]
    curvature: stress-free curvature [1/m]
    curvature_angle: direction in which the item bends downward [rad]: 0 is the high side, 90 deg to the right looking down the hole; measured from north if the inclination is below 5 deg; at spin angle zero
    bend: bent sub: kink at the item's upper end
    initial: imperfection of this item
    id: inner diameter [m]
    material: material of this item; keys left out are the case's
    bore_volume: volume of the mud inside the item [m3]; the volume of a bore of its id when not given
    annulus_od: outer diameter that the mud outside flows past and that displaces it [m]; od when not given
    axial_stiffness: axial stiffness EA [N]; of the tube when not given
    bending_stiffness: bending stiffness EI [N m2]; of the tube when not given
    torsional_stiffness: torsional stiffness GJ [N m2]; of the tube when not given
    """
    def __init__(
        self,
        *,
        length: Value,
        od: Value,
        name: str | None = None,
        friction: float | None = None,
        weight: Value | None = None,
        pressure_loss: PressureLoss | dict[str, Any] | None = None,
        element_length: Value | None = None,
        eccentricity: Value | None = None,
        eccentricity_angle: Value | None = None,
        curvature: Value | None = None,
        curvature_angle: Value | None = None,
        bend: Bend | dict[str, Any] | None = None,
        initial: ItemInitial | dict[str, Any] | None = None,
        id: Value | None = None,
        material: Material | dict[str, Any] | None = None,
        bore_volume: Value | None = None,
        annulus_od: Value | None = None,
        axial_stiffness: Value | None = None,
        bending_stiffness: Value | None = None,
        torsional_stiffness: Value | None = None,
    ) -> None: ...

class ToolJoint(PythonBlock):
    """Tool joint at each end of a joint of pipe. Missing keys are taken from the catalogue.

    connection: name of the connection, such as NC50
    od: outer diameter [m]
    id: inner diameter [m]
    length: pin tong and box tong of one joint, together [m]
    make_up_torque: torque with which the connection is made up, for limits [N m]; default: the catalogue's, else 60 % of the torque at which the tool joint yields (API RP 7G)
    """
    def __init__(
        self,
        *,
        connection: str | None = None,
        od: Value | None = None,
        id: Value | None = None,
        length: Value | None = None,
        make_up_torque: Value | None = None,
    ) -> None: ...

class TopDrive(PythonBlock):
    """A top drive: rotation that is prescribed, or that a motor and its control follow; lowering, or an axial force.

    rotation: rotation speed over time, positive clockwise seen from above [rad/s]
    lowering: speed of the top over time, positive downward [m/s]
    force: axial force at the top over time, positive in pull, instead of a lowering [N]
    hinged: true: the direction of the string at the top is free; false: it is held
    guided: false: with a force, the top also moves freely across the hole; true: its position across is held
    motor: motor with inertia and limits; without it the rotation is prescribed
    control: speed controller of the motor, whose set point is the rotation; or a list of controllers, each from a time on
    torque: torque of the motor over time, instead of a control [N m]
    hoist: block and drilling line; without it the lowering moves the top itself
    autodriller: control of the drum of a hoist with a line
    """
    def __init__(
        self,
        *,
        rotation: Value | dict[str, Any] | None = None,
        lowering: Value | dict[str, Any] | None = None,
        force: Value | dict[str, Any] | None = None,
        hinged: bool | None = None,
        guided: bool | None = None,
        motor: TopMotor | dict[str, Any] | None = None,
        control: Literal['stiff', 'soft_torque', 'soft_speed', 'z_torque'] | PiController | dict[str, Any] | StiffController | SoftTorqueController | ZTorqueController | PythonController | Sequence[Literal['stiff', 'soft_torque', 'soft_speed', 'z_torque'] | PiController | dict[str, Any] | StiffController | SoftTorqueController | ZTorqueController | PythonController] | None = None,
        torque: Value | dict[str, Any] | None = None,
        hoist: Hoist | dict[str, Any] | None = None,
        autodriller: Autodriller | dict[str, Any] | None = None,
    ) -> None: ...

class TopMotor(PythonBlock):
    """The motor of a top drive at the quill: inertia and limits. Without it the speed is prescribed.

    inertia: inertia at the quill [kg m2]: of the motors times the squared gear ratio, and of the quill
    max_torque: largest torque [N m]; without it the torque has no limits
    min_torque: torque of the strongest braking, at most 0 [N m]; a drive that cannot brake has 0; default -max_torque
    power: largest power [W]: above base_speed the torque is at most power/speed
    base_speed: speed above which the power limits the torque [rad/s]; default power/max_torque
    torque_rate: largest rate of the torque [N m/s]; without it there is no such limit
    time_constant: time constant with which the torque follows the controller [s]; 0: at once (5 ms with a torque_rate)
    """
    def __init__(
        self,
        *,
        inertia: Value,
        max_torque: Value | None = None,
        min_torque: Value | None = None,
        power: Value | None = None,
        base_speed: Value | None = None,
        torque_rate: Value | None = None,
        time_constant: Value | None = None,
    ) -> None: ...

class VelocityWeakening(PythonBlock):
    """A torque that falls from a static to a dynamic value with the rotation speed, a cause of stick-slip.

    speed: rotation speed over which the torque falls [rad/s]
    static: torque at which the bit breaks loose [N m]
    dynamic: torque at high speed [N m]
    static_friction: static torque over weight on bit times 2/3 of the bit's radius, instead of static [-]
    dynamic_friction: dynamic torque over weight on bit times 2/3 of the bit's radius, instead of dynamic [-]
    stiffness: contact stiffness of bit on rock [N/m]; bottom.stiffness is set to this value
    """
    def __init__(
        self,
        *,
        speed: Value,
        static: Value | None = None,
        dynamic: Value | None = None,
        static_friction: float | None = None,
        dynamic_friction: float | None = None,
        stiffness: Value | None = None,
    ) -> None: ...

class Well(PythonBlock):
    """The hole.

    survey: stations md, inclination, azimuth; or the name of a file with these columns; or {file, columns, tie_in, allow_dogleg, north, convergence, declination, azimuth_from} for such a file; or the folder of a run that drilled this hole
    sections: riser, casing and open hole, from the surface down
    """
    def __init__(
        self,
        *,
        survey: str | SurveyFile | dict[str, Any] | Survey,
        sections: Sequence[Section | dict[str, Any]],
    ) -> None: ...

class Window(PythonBlock):
    """Pressures between which the open hole holds, as equivalent densities: one pair, or a table over the depth.

    pore: lower limit (pore pressure or stability) as the density of a column from the flow line [kg/m3]
    frac: upper limit (fracture or loss) as the density of a column from the flow line [kg/m3]
    tvd: vertical depths below the rotary table, rising [m]; linear between them; when not given, pore and frac are one value each for all depths
    """
    def __init__(
        self,
        *,
        pore: Value | Sequence[Value],
        frac: Value | Sequence[Value],
        tvd: Sequence[Value] | None = None,
    ) -> None: ...

class WobZero(PythonBlock):
    """Where the indicator of the weight on bit was set to zero, off bottom.

    bit_depth: measured depth of the bit at zeroing [m]
    flow_rate: flow rate of the pump at zeroing [m3/s]
    """
    def __init__(
        self,
        *,
        bit_depth: Value,
        flow_rate: Value | None = None,
    ) -> None: ...

class ZTorqueController(PythonBlock):
    """Stiff control whose set point follows the high-passed torque of the pipe.

    from_: time from which it acts [s]
    delay: delay of the controller's output [s]
    sample: time between two samples of a controller that holds its torque in between [s]; 0: continuous. With it, delay is a multiple of it
    factor: share of the matched impedance [-]; 1: waves are absorbed
    high_pass: period of the high-pass filter of the pipe's torque [s]
    low_pass: period of the low-pass filter of the pipe's torque [s]; 0: none
    p: proportional gain, times the impedance of the uppermost pipe [-]
    i: integral gain, times the inertia of the drive [1/s2]
    estimate: torque of the pipe: sensor, as measured; motor, from the motor's torque and the filtered acceleration
    """
    def __init__(
        self,
        *,
        from_: Value | None = None,
        delay: Value | None = None,
        sample: Value | None = None,
        factor: float | None = None,
        high_pass: Value | None = None,
        low_pass: Value | None = None,
        p: float | None = None,
        i: Value | None = None,
        estimate: Literal['sensor', 'motor'] | None = None,
    ) -> None: ...

class Case(_Case):
    """A case: the string, the hole, the drive, the fluid, the rock and the simulated time. A block that is
    absent is absent physics.

    Built from the keys of a case file: `Case(string=[{"kind": "pipe", "length": "9 m", "od": "5 in"}],
    top="clamped")`. Numbers are SI, text carries a unit, and `units="field"` gives bare numbers field units; after construction everything is SI and every
    default is filled in. Wrong input is a `CaseError`.

    string: from the top down; the last item ends at the bit
    title: title of the case
    units: units of numbers without one: field (ft, in, klbf, ft-lbf, psi, ppg, gpm), metric (m, mm, kN, kN m, bar, sg, l/min) or SI; reports use them too
    force_unit: unit of forces in the metric system: kN, or t for tonnes-force
    rig: weight of the block, and limits of the rig
    catalogue: a folder with CSV files, or one CSV file, beside the case: rows of the catalogue before the built-in ones
    well: the hole; without it the string is in free space
    bit_depth: measured depth of the bit [m]: the hole ends there, and the length of the topmost pipe follows. When not given, the length of the string, or the end of the survey with length: fill
    joints: joints in the string, at measured depths
    material: material of all items that name no other; steel when not given
    beam: unknowns of the string
    mesh: elements of automatic length
    hold_string: the string does not move and has no unknowns (hydraulics only); top may be left out, and there is no contact
    top: what holds or drives the upper end; needed unless hold_string is true
    bottom: what the lower end meets
    contact: contact with the hole, or none; with a well and without this key, contact with all defaults
    fluid: the drilling fluid; without it the hole and the string are dry
    window: limits of the pressure in the open hole (used by hydraulics and surge), or the name of a CSV file with the columns tvd, pore, frac
    roadmap: operations, depths and friction factors of a torque-and-drag roadmap
    uncertain: distributions of numbers of the case, by the path of each (used by uncertain)
    formation: the rock that the bit cuts; without it the bit does not drill
    components: components of the user: functions that build them, file.py:function, module:function, or the name of an installed one (entry point drillpetsc.components)
    loads: point and distributed loads on the string
    gravity: acceleration of gravity, downward [m/s2]; or [north, east, down]
    initial: the state at time 0
    time: simulated time; needed to run, not for statics
    output: contents of the run folder
    petsc: PETSc options, without the leading dash
    """
    def __init__(
        self,
        *,
        string: Sequence[Pipe | dict[str, Any] | Tool | Beam | DrillPipe | HWDP | DrillCollar | Casing | CoiledTubing | ShockSub | BumperSub | Jar | Stabilizer | Body | Bit | RotarySteerable | MudMotor | Agitator | Reamer],
        title: str | None = None,
        units: Literal['field', 'metric', 'SI'] | None = None,
        force_unit: Literal['kN', 't'] | None = None,
        rig: Rig | dict[str, Any] | None = None,
        catalogue: str | None = None,
        well: Well | dict[str, Any] | None = None,
        bit_depth: Value | None = None,
        joints: Sequence[Joint | dict[str, Any]] | None = None,
        material: Material | dict[str, Any] | None = None,
        beam: BeamTheory | dict[str, Any] | None = None,
        mesh: MeshSettings | dict[str, Any] | None = None,
        hold_string: bool | None = None,
        top: Literal['clamped', 'pinned', 'free'] | HeldTop | dict[str, Any] | DrivenTop | TopDrive | None = None,
        bottom: Literal['free', 'pinned', 'clamped', 'bit'] | HeldBottom | dict[str, Any] | ForcedBottom | BitBottom | None = None,
        contact: Literal['none'] | Contact | dict[str, Any] | None = None,
        fluid: Fluid | dict[str, Any] | None = None,
        window: str | Window | dict[str, Any] | None = None,
        roadmap: Roadmap | dict[str, Any] | None = None,
        uncertain: dict[str, Any] | None = None,
        formation: Formation | dict[str, Any] | None = None,
        components: Sequence[OwnComponent | dict[str, Any]] | None = None,
        loads: Sequence[PointLoad | dict[str, Any] | LineLoad] | None = None,
        gravity: Value | Sequence[Value] | None = None,
        initial: Initial | dict[str, Any] | None = None,
        time: Time | dict[str, Any] | None = None,
        output: Output | dict[str, Any] | None = None,
        petsc: dict[str, Any] | None = None,
    ) -> None: ...

def load_case(
    path: str | Path,
    changes: tuple[str, ...] | list[str] = (),
) -> _Case:
    """Read a case file.

    path: YAML file
    changes: texts `key=value` that replace values of the file, such as `top.rotation=90 rpm`, or `fluid=off`
    """
    ...

def mud_motor(
    case: _Case | str | Path,
) -> MotorLaw:
    """The law of the downhole motor of a string: speed, differential pressure and leak by torque and flow rate.

    case: a Case with an item `pdm`, or the path of a case file
    Raises CaseError for a string without a motor.
    """
    ...

def open_run(
    folder: str | Path,
) -> Result:
    """The result in a run folder: tables, pictures, summary. Nothing is computed, and neither PETSc nor MPI is started.

    folder: run folder of `run`, `statics`, `hydraulics`, `surge` or `modes`, finished or not
    Raises CaseError if the folder does not exist or holds no results.
    """
    ...

def run(
    case: _Case | str | Path,
    out: str | Path | None = None,
    *,
    restart: bool = False,
    overwrite: bool = False,
    accept_changes: bool = False,
    name: str | None = None,
    comm: Any = None,
    progress: str | Callable[[float, str], None] = 'auto',
    watch_motion: bool = False,
) -> Result:
    """Simulate a case and write its run folder (collective).

    case: a Case, or the path of a case file
    out: run folder; by default results/<case>-NNN, the next free number
    restart: True to continue from the checkpoint in the run folder
    overwrite: True to replace the results in an existing folder
    accept_changes: True to continue although the case or the PETSc options have changed
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    progress: auto, live, log or silent; or a function that is called with the share of the run that is done (0 to 1) and a
    line of text, several times a second, on the first rank
    watch_motion: True to add the classes of motion (whirl, contact, sliding, sticking) to the summary, as `motion`

    An interrupt (Ctrl-C, or the button of a notebook) ends the run after a step: the result has what was written, and its
    `status` says so. A second one raises KeyboardInterrupt.
    """
    ...

def study(
    case: _Case | str | Path,
    vary: str | None = None,
    curves: Sequence[str] | None = None,
    *,
    values: Sequence[str | float] = (),
    steps: Sequence[str | float] = (),
    tolerances: Sequence[str | float] = (),
    outputs: Sequence[str] = (),
    repeats: int = 3,
    reference: str | Path = 'auto',
    limit: float = 600.0,
    few: bool = False,
    out: str | Path | None = None,
    restart: bool = False,
    overwrite: bool = False,
    options: Mapping[str, Any] | None = None,
) -> StudyResult:
    """Measure error against run time: many runs of a case, each in a process of its own.

    PETSc is not initialised here, because the runs start MPI themselves.

    case: a Case, or the path of a case file
    vary: time-step, tolerance, order, mesh, formulation, integrator, solver or ranks
    curves: names of several curves, instead of vary; an empty list for the usual ones
    values: values along the curve, or names of curves; by default around the case's own
    steps, tolerances: of all curves that have them
    outputs: columns of history.csv and probes.csv to compare; by default up to six
    repeats: runs of each point, for the median of their times
    reference: exact, arkimex, bdf3, bdf2, or a run folder; auto: a closed form if there is one, else what works
    limit: wall seconds that one run may take, the reference three times as long
    few: True for three points a curve
    out: folder of table, pictures and runs; by default results/<case>-study-NNN
    restart: True to keep points that are done
    overwrite: True to replace the results in an existing folder
    options: PETSc options of every run by name
    """
    ...

def sweep(
    case: _Case | str | Path,
    values: Mapping[str, Iterable[Any]],
    out: str | Path | None = None,
    *,
    restart: bool = False,
    overwrite: bool = False,
    comm: Any = None,
    progress: str | Callable[[float, str], None] = 'auto',
) -> SweepResult:
    """Simulate every combination of some values of a case, the ranks shared out over them (collective).

    case: a Case, or the path of a case file
    values: key -> its values: {"fluid.flow_rate": ["20 l/s", 0.03], "fluid": ["on", "off"]}
    out: folder of the table and of the run folders; by default results/<case>-NNN
    restart: True to keep members that are done and to continue those with a checkpoint
    overwrite: True to replace the results in an existing folder
    comm: PETSc communicator; by default all ranks
    progress: auto or silent; or a function that is called with the share of members that have ended and a line of text
    """
    ...

def statics(
    case: _Case | str | Path,
    out: Any = None,
    *,
    motion: Literal['hoist', 'lower', 'rotate'] | None = None,
    operation: str | None = None,
    path: Literal['sliding', 'slack_off'] | None = None,
    units: Literal['field', 'metric', 'metric_t', 'SI'] | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
    bit_depth: str | float | None = None,
) -> Any:
    """Static equilibrium: torque and drag, contact forces, buckling state.

    Writes statics.csv and string.pvd.

    case: a Case, or the path of a case file
    out: run folder (default: results/<case>-NNN)
    motion: motion that friction opposes (default: the top's)
    operation: instead, trip_in, trip_out, rotate_off_bottom, drilling, sliding, backreaming; or slackoff, pickup, rob: whether the bit is on bottom belongs to it
    path: follow the history of a buckled string with friction: the whole string slides or turns (gives the band of states), or it is lowered onto a bit that stands
    units: units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes
    overwrite: replace the results in an existing out
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    bit_depth: measured depth of the bit, such as '2000 m' (default: bit_depth of the case)
    """
    ...

def sensitivities(
    case: _Case | str | Path,
    out: Any = None,
    *,
    to: str | Sequence[str] = '',
    of: str | Sequence[str] = '',
    analysis: Literal['statics', 'roadmap', 'hydraulics', 'run'] = 'statics',
    all: bool = False,
    check: int = 0,
    motion: Literal['hoist', 'lower', 'rotate'] | None = None,
    operation: str | None = None,
    depths: Literal['deepest', 'all'] = 'deepest',
    model: Literal['soft', 'stiff'] = 'soft',
    units: Literal['field', 'metric', 'metric_t', 'SI'] | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
    bit_depth: str | float | None = None,
) -> Result:
    """Derivatives of outputs by numbers of the case: what changes hook load, torque or pressures, and by how much.

    Solves once, and takes each derivative from the linearised equations of that solution. Writes sensitivities.csv.

    case: a Case, or the path of a case file
    out: run folder (default: results/<case>-NNN)
    to: keys of the case: 'well.sections[1].friction,string[jar].weight,fluid.density,top.rotation'
    of: outputs, such as hook_load or trip_out.hook_load, or all (default: hook load and surface torque; pump pressure and ECD)
    analysis: whose outputs are meant; a roadmap has the friction of the hole's sections; a run: surface_torque.mean[2:4] (default: statics)
    all: every continuous number of the case, instead of to
    check: compare N derivatives with differences of full solutions: the largest, the median, others at random (default: 0)
    motion: of statics: motion that friction opposes
    operation: of statics: operation, as of the command statics
    depths: of a roadmap: its bit depths (default: deepest)
    model: of a roadmap: soft string or beam (default: soft)
    units: units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes
    overwrite: replace the results in an existing out
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    bit_depth: measured depth of the bit, such as '2000 m' (default: bit_depth of the case)
    """
    ...

def uncertain(
    case: _Case | str | Path,
    out: Any = None,
    *,
    of: str | Sequence[str] = '',
    analysis: Literal['roadmap', 'hydraulics'] = 'roadmap',
    method: Literal['monte-carlo', 'linear', 'both'] = 'monte-carlo',
    samples: int = 500,
    seed: int = 1,
    calibration: str | None = None,
    quantiles: str | float | Sequence[str | float] = '10,50,90',
    units: Literal['field', 'metric', 'metric_t', 'SI'] | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
    bit_depth: str | float | None = None,
) -> Result:
    """Quantiles of outputs, such as P10, P50 and P90, from distributions of numbers of the case.

    The case's block `uncertain` has the distributions. Writes uncertain.csv and uncertain_shares.csv.

    case: a Case, or the path of a case file
    out: run folder (default: results/<case>-NNN)
    of: outputs, such as hook_load_total or trip_out.hook_load, or all (default: hook load, with the block if it is given, and surface torque; pump pressure and ECD)
    analysis: whose outputs are meant; a roadmap has the friction of the hole's sections (default: roadmap)
    method: a solution for each sample, derivatives at the case's values, or both to compare them (default: monte-carlo)
    samples: samples (default: 500)
    seed: seed of the samples: the same seed, the same numbers (default: 1)
    calibration: run folder of calibrate: its numbers and their uncertainty replace those of the case
    quantiles: percentages of the quantiles (default: 10,50,90)
    units: units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes
    overwrite: replace the results in an existing out
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    bit_depth: measured depth of the bit, such as '2000 m' (default: bit_depth of the case)
    """
    ...

def hydraulics(
    case: _Case | str | Path,
    out: Any = None,
    *,
    flow: str | float | Sequence[str | float] | None = None,
    spp: str | float | Sequence[str | float] | None = None,
    units: Literal['field', 'metric', 'metric_t', 'SI'] | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
    bit_depth: str | float | None = None,
) -> Result:
    """Steady flow of the mud: pressures, losses, equivalent densities, power at the bit, for one or more flow rates.

    Writes hydraulics.csv, pressure_profile.csv and flow_curve.csv.

    case: a Case, or the path of a case file
    out: run folder (default: results/<case>-NNN)
    flow: flow rates, such as '400,500,600 gpm' or '20..60 l/s' (default: the case's)
    spp: instead, the flow rate at this pump pressure, such as '3000 psi'
    units: units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes
    overwrite: replace the results in an existing out
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    bit_depth: measured depth of the bit, such as '2000 m' (default: bit_depth of the case)
    """
    ...

def surge(
    case: _Case | str | Path,
    out: Any = None,
    *,
    speeds: str | float | Sequence[str | float],
    operation: str | Sequence[str] = 'trip_in,trip_out',
    pipe: str | Sequence[str] = 'closed,open',
    bit_depth: str | float | Sequence[str | float] | None = None,
    window: str | float | Sequence[str | float] | None = None,
    flow: str | float | Sequence[str | float] | None = None,
    dynamic: bool = False,
    units: Literal['field', 'metric', 'metric_t', 'SI'] | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> Result:
    """Pressures of running in and pulling out, and the largest trip speed within the window of the open hole.

    Writes surge.csv and max_trip_speed.csv.

    case: a Case, or the path of a case file
    out: run folder (default: results/<case>-NNN)
    speeds: trip speeds, such as '30,60,90 ft/min' or '20..200 ft/min'
    operation: trip_in, trip_out (default: trip_in,trip_out)
    pipe: closed: no flow through the bit; open: open at the top, too; pumping: with flow (default: closed,open)
    bit_depth: measured depths of the bit (default: the case's)
    window: limits of the open hole, such as '11.2,13.8 ppg' (default: the case's window)
    flow: flow rate of pipe pumping (default: the case's)
    dynamic: for each speed also a run of string and mud from rest, with 0.3 m/s2 at the top (seconds to minutes each)
    units: units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes
    overwrite: replace the results in an existing out
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    ...

def roadmap(
    case: _Case | str | Path,
    out: Any = None,
    *,
    measured: str | None = None,
    model: Literal['soft', 'stiff'] = 'soft',
    units: Literal['field', 'metric', 'metric_t', 'SI'] | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
    **block: Any,
) -> Result:
    """Torque and drag over the bit depth: hook load and torque for six operations and several friction factors.

    The case's block `roadmap` has operations, depths and friction factors. Writes roadmap.csv and roadmap.json.

    case: a Case, or the path of a case file
    out: run folder (default: results/<case>-NNN)
    measured: measured points to plot: CSV, xlsx or LAS (default: the case's)
    model: soft: soft string; stiff: the beam in static equilibrium, about 0.1 s a row (default: soft)
    units: units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes
    overwrite: replace the results in an existing out
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    block: keys of the case's block `roadmap` in the place of those of the case, such as friction_factor={"cased": [0.2, 0.25]}
    """
    ...

def limits(
    case: _Case | str | Path,
    out: Any = None,
    *,
    operation: str | None = None,
    helical: Literal['chen', 'wu'] = 'chen',
    design_factor: float = 1.25,
    tension_fraction: float = 0.9,
    corrosive: bool = False,
    sn: str | None = None,
    units: Literal['field', 'metric', 'metric_t', 'SI'] | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
    bit_depth: str | float | None = None,
) -> Result:
    """Stresses, safety factors, buckling and fatigue limits along the string, margin of overpull, largest weight on bit.

    Writes limits.csv and contacts.csv.

    case: a Case, or the path of a case file
    out: run folder (default: results/<case>-NNN)
    operation: trip_in, trip_out, rotate_off_bottom, drilling, sliding, backreaming; or slackoff, pickup, rob (default: the case as it is, moving as its top prescribes)
    helical: law of the helical limit (default: chen)
    design_factor: least yield strength over von Mises stress, below which a warning is given (default: 1.25)
    tension_fraction: share of the pull at yield that tension_limit allows (default: 0.9)
    corrosive: corrosive mud: 0.6 of the permissible doglegs (API RP 7G)
    sn: S-N curve for Miner's damage per hour: a,b of log10 N = a - b log10(S/MPa), or a CSV file with the columns stress [MPa], cycles
    units: units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes
    overwrite: replace the results in an existing out
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    bit_depth: measured depth of the bit, such as '2000 m' (default: bit_depth of the case)
    """
    ...

def freepoint(
    case: _Case | str | Path,
    *,
    stretch: str | float | Sequence[str | float],
    pull: str | float | Sequence[str | float],
    units: Literal['field', 'metric', 'metric_t', 'SI'] | None = None,
) -> Any:
    """How much of a stuck string is free, from its stretch under a pull.

    Returns `pairs`, a FreePoint for each pair, and `slope`, that of the line through them (None for one pull).

    case: a Case, or the path of a case file
    stretch: stretch at the surface under each pull, such as '24 in' or '10,24 in'
    pull: pulls beyond the weight of the free string, such as '30 klb' or '12,30 klb'
    units: units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes
    """
    ...

def calibrate(
    case: _Case | str | Path,
    out: Any = None,
    *,
    measured: str | None = None,
    log: str | None = None,
    every: str | None = None,
    fit: str | None = None,
    model: Literal['soft', 'stiff', 'dynamic'] = 'soft',
    hold_out: str | None = None,
    errors: Literal['correlated', 'independent'] | None = None,
    prior: tuple[str, ...] = (),
    units: Literal['field', 'metric', 'metric_t', 'SI'] | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> Result:
    """Friction factors from measured hook loads and torques, with intervals.

    Writes calibration.csv.

    case: a Case, or the path of a case file
    out: run folder (default: results/<case>-NNN)
    measured: measured points, such as points.csv of import log: CSV, xlsx or LAS (default: the case's)
    log: instead, a rig's log, read as by import log
    every: length of a point of log while drilling, such as 1m or 10s (default: 10 m)
    fit: what is fitted: cased, open_hole, groups of sections by their ff_group, block_weight, weight_factor, running_drag, sheave_efficiency, and numbers of the case such as fluid.density (default: all friction factors)
    model: soft: soft string; stiff: the beam in static equilibrium, about a second for each point; dynamic: the run of the case, beside a log in time (default: soft)
    hold_out: points that are not fitted but predicted: the deepest share, as 0.5, or those below 2150m
    errors: intervals by a bootstrap of blocks along depth, or of independent errors (default: correlated from 30 bit depths)
    prior: what is known of a parameter beforehand, such as cased=0.2+-0.05; may be given several times
    units: units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes
    overwrite: replace the results in an existing out
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    ...

def follow(
    case: _Case | str | Path,
    out: Any = None,
    *,
    log: str,
    map: tuple[str, ...] = (),
    prior: tuple[str, ...] = (),
    every: str | float | Sequence[str | float] = '1 m',
    pace: float | None = None,
    wait: str | float | Sequence[str | float] = '0 s',
    until: str | None = None,
    restart: bool = False,
    model: Literal['soft', 'stiff'] = 'soft',
    units: Literal['field', 'metric', 'metric_t', 'SI'] | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> Any:
    """Follow a rig row by row: friction, weights and their uncertainty, a forecast one stand ahead, alarms.

    Writes follow.csv, state.json and live.html while the log grows.

    case: a Case, or the path of a case file
    out: run folder (default: results/<case>-NNN)
    log: the rig's log: a text table, which may grow; - for standard input; LAS, xlsx, WITSML; a server of WITS level 0, metric, or in feet and pounds with :fps; a log of a WITSML store, https://HOST/PATH?well=UID&wellbore=UID&log=UID
    map: the title of the column that holds a channel, and its unit, as in import log; may be given several times
    prior: what is known of a state beforehand, such as cased=0.2+-0.02; may be given several times
    every: length of a row while drilling (default: 1 m)
    pace: replay a log by time X times as fast as it was recorded (default: as fast as rows come)
    wait: how long to wait for new rows at the end of a file, or for a server that gives none (default: not at all) (default: 0 s)
    until: where to stop: time since the first row, as 2 h, or a depth of a log by depth
    restart: continue the folder out, or the latest, from its state.json
    model: soft: soft string; stiff: the beam as well, one state a stand, of a second or two; says where both differ (default: soft)
    units: units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes
    overwrite: replace the results in an existing out
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    ...

def import_log(
    files: tuple[str, ...],
    *,
    case: _Case | str | Path | None = None,
    out: str | None = None,
    map: tuple[str, ...] = (),
    between: str | None = None,
    every: str | None = None,
    states: tuple[str, ...] = (),
    overwrite: bool = False,
) -> Any:
    """Read a rig's log (`import log FILE`): channels in SI, quality, rig states, points for `calibrate`.

    Writes log.csv, states.csv, points.csv, quality.json and log.html.

    files: the log: CSV or another text table, LAS, WITSML 1.4.1.1 log (.xml), xlsx; several files of the same columns are joined
    case: a Case, or the path of a case file
    out: folder of the results (default: named after the log)
    map: the column of a channel, such as hook_load=HKLD:t; may be given several times
    between: a part of the log: two clock times, as 2020-12-31T01:00,2020-12-31T15:00, or two depths with units
    every: length of a point while drilling, such as 1m or 10s (default: 10 m)
    states: a figure of the rig states, such as 'edge_time=14 s'; may be given several times
    overwrite: replace an existing out
    """
    ...

def modes(
    case: _Case | str | Path,
    out: Any = None,
    *,
    count: int = 20,
    shift: float | None = None,
    kind: Literal['lateral', 'axial', 'torsional', 'fluid'] | None = None,
    about: Literal['steady', 'rest'] = 'steady',
    without_control: bool = False,
    units: Literal['field', 'metric', 'metric_t', 'SI'] | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> Any:
    """Eigenvalues about the static or steady state: frequencies, damping, stability, mode shapes.

    Writes modes.csv and the mode shapes.

    case: a Case, or the path of a case file
    out: run folder (default: results/<case>-NNN)
    count: oscillating modes, the lowest (default: 20)
    shift: the modes nearest to this frequency instead of the lowest [Hz]
    kind: modes of this kind alone (default: all)
    about: the state: moving as the top prescribes at time 0, or at rest without friction (default: steady)
    without_control: leave out motor, hoist and controllers of the top drive, and hold the top
    units: units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes
    overwrite: replace the results in an existing out
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    ...

def campbell(
    case: _Case | str | Path,
    out: Any = None,
    *,
    speeds: str | float | Sequence[str | float],
    count: int = 20,
    kind: Literal['lateral', 'axial', 'torsional', 'fluid'] | None = None,
    lines: Any = None,
    frequency: Literal['wd', 'wn'] = 'wd',
    stiffness: str | float | Sequence[str | float] = (),
    without_control: bool = False,
    units: Literal['field', 'metric', 'metric_t', 'SI'] | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> Result:
    """Modes over rotary speeds, followed by shape, and critical speeds.

    Writes campbell.csv and critical.csv, with a stiffness critical_map.csv, too.

    case: a Case, or the path of a case file
    out: run folder (default: results/<case>-NNN)
    speeds: rotary speeds: FIRST:LAST:STEP as '60:240:10 rpm', '60..240 rpm', or '60,90,120 rpm'
    count: oscillating modes, the lowest, at each speed or point (default: 20)
    kind: modes of this kind alone (default: all)
    lines: excitation lines: cycles per turn, blades (of drag bit and reamer), motor (orbit of a pdm's rotor) (default: 1,2,3 and the blades of a drag bit)
    frequency: critical speeds are where lines meet damped (wd) or natural frequencies (wn) (default: wd)
    stiffness: critical speeds without damping at these stiffnesses of the wall, too: '1e6,1e7,1e8 Pa'
    without_control: leave out motor, hoist and controllers of the top drive, and hold the top
    units: units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes
    overwrite: replace the results in an existing out
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    ...

def stability(
    case: _Case | str | Path,
    out: Any = None,
    *,
    speeds: str | float | Sequence[str | float],
    wob: str | float | Sequence[str | float],
    count: int = 20,
    method: Literal['eigen', 'time'] = 'eigen',
    duration: str | float | Sequence[str | float] = '60 s',
    kind: Literal['lateral', 'axial', 'torsional', 'fluid'] | None = None,
    without_control: bool = False,
    units: Literal['field', 'metric', 'metric_t', 'SI'] | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> Result:
    """Does steady drilling grow or decay: the fastest growing mode over rotary speed and weight on bit.

    The case has a bit on bottom. Writes stability_map.csv and stability_boundary.csv, with runs stability_runs.csv, too.

    case: a Case, or the path of a case file
    out: run folder (default: results/<case>-NNN)
    speeds: rotary speeds: FIRST:LAST:STEP as '60:240:10 rpm', '60..240 rpm', or '60,90,120 rpm'
    wob: weights on bit, such as '50,100,150 kN'
    count: oscillating modes, the lowest, at each speed or point (default: 20)
    method: eigen: growth of the modes; time: a run at each point, too (default: eigen)
    duration: of each run of method time (default: 60 s)
    kind: modes of this kind alone (default: all)
    without_control: leave out motor, hoist and controllers of the top drive, and hold the top
    units: units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes
    overwrite: replace the results in an existing out
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    ...

def response(
    case: _Case | str | Path,
    out: Any = None,
    *,
    excite: str,
    speeds: str | float | Sequence[str | float],
    amplitude: str | None = None,
    order: float | None = None,
    stress: bool = False,
    without_control: bool = False,
    units: Literal['field', 'metric', 'metric_t', 'SI'] | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> Result:
    """Forced harmonic response to unbalance or to the bit, over rotary speeds.

    Writes response.csv.

    case: a Case, or the path of a case file
    out: run folder (default: results/<case>-NNN)
    excite: unbalance: unbalances, eccentricities, bends and curvatures of the case; bit: a motion, force or torque of the lower end; motor: the orbit of a motor's rotor; the name of a string item, or a measured depth ('120 m'): a motion, force or torque there
    speeds: rotary speeds: FIRST:LAST:STEP as '60:240:10 rpm', '60..240 rpm', or '60,90,120 rpm'
    amplitude: of the bit or the place: a motion along the string ('3 mm'), a force ('5 kN') or a torque ('1 kN m')
    order: cycles per turn (default: 3 of the bit, 1 of a place)
    stress: add the alternating stresses of the pipe, which turns, for its fatigue
    without_control: leave out motor, hoist and controllers of the top drive, and hold the top
    units: units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes
    overwrite: replace the results in an existing out
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    ...

def linearise(
    case: _Case | str | Path,
    inputs: str | Sequence[str],
    outputs: str | Sequence[str],
    out: Any = None,
    *,
    reduce: Literal['balanced', 'modal'] | None = None,
    order: int | None = None,
    units: Literal['field', 'metric', 'metric_t', 'SI'] | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> Any:
    """State space x' = A x + B u, y = C x + D u about the steady state, in full and with fewer states.

    Writes linear.npz and linear.mat. The result has `system` and `reduced`, with the matrices A, B, C, D and F, and `to_control()` for
    python-control.

    case: a Case, or the path of a case file
    inputs: keys that may vary over time, such as top.torque,top.lowering
    outputs: columns of history.csv, such as bit_speed,surface_torque
    out: run folder (default: results/<case>-NNN)
    reduce: write a model with fewer states, too: by balanced truncation, or by the dominant modes
    order: states of the reduced model (default: 20); only with reduce
    units: units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes
    overwrite: replace the results in an existing out
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    ...

def fmu(
    case: _Case | str | Path,
    out: Any,
    *,
    overwrite: bool = False,
    inputs: str | Sequence[str] | None = None,
    outputs: str | Sequence[str] | None = None,
    interpolate: Literal['held', 'linear'] = 'held',
    name: str | None = None,
    units: Literal['field', 'metric', 'metric_t', 'SI'] | None = None,
) -> Any:
    """The case as a co-simulation unit (FMI 2.0) for Simulink, OpenModelica and others; needs pythonfmu.

    One process. Returns the path of the file.

    case: a Case, or the path of a case file
    out: file to write
    overwrite: replace an existing file
    inputs: keys that the host sets, such as top.rotation (default: all)
    outputs: columns of history.csv (default: all)
    interpolate: an input that the host changes: held from then on, or on a straight line over the next step (default: held)
    name: of the model
    units: units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes
    """
    ...

def top_drive(
    case: _Case | str | Path,
    out: Any = None,
    *,
    units: Literal['field', 'metric', 'metric_t', 'SI'] | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> Any:
    """Gains of a top drive's controllers, and how much of a torsional wave the top reflects.

    The case has `top.motor` and `top.control`. Writes reflection.csv.

    case: a Case, or the path of a case file
    out: run folder (default: results/<case>-NNN)
    units: units of what is printed and plotted (default: the case's; files stay in SI); metric_t: forces in tonnes
    overwrite: replace the results in an existing out
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    ...
