"""The interface of a physics component, and the plain data that it hands to the discrete system.

A component is one physical effect: a beam, a wall contact, a bit, a mud channel.  It declares unknowns
(``Field``), groups of elements that share a compiled kernel (``ElementBlock``), prescribed motion and
energies.  ``Component`` declares every hook that the rest of the program may call, each with a harmless
default, so a component implements only what it needs.  Nothing here uses PETSc or MPI: ``fem.dof_layout`` and
``fem.assembly`` allocate the memory.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from drillpetsc.arrays import FloatArray, IntArray
from drillpetsc.fem.quantity import OneStep, Quantity
from drillpetsc.kernels.parameters import Table, parameters_of

if TYPE_CHECKING:
    from drillpetsc.geometry.well import Well

__all__ = [
    "Component",
    "ContactFlags",
    "ElementBlock",
    "Energies",
    "Field",
    "FloatArray",
    "IntArray",
    "Powers",
    "PrescribedMotion",
    "Start",
    "VelocityStabilization",
]

#: kinds of unknowns to which a field may belong
STRING, JOINT, FLUID, ROCK, DRIVE = "string", "joint", "fluid", "rock", "drive"


@dataclass(frozen=True)
class Field:
    """Unknowns that a component owns at each vertex of a region of the chain.

    name: dotted, for example ``string.position``.
    size: number of components at a vertex.
    region: name of a set of vertices; ``string`` is all of them.
    scale: usual magnitude [SI]; tolerances and error messages are relative to it.
    second_order: the field's rate is a further unknown of the time integrator (position and velocity).  Other
    fields are first-order states, or algebraic where ``differential`` is False.
    multiplier: a Lagrange multiplier: algebraic, and its rows are constraints.
    default: value used if an element refers to the field and its node does not have it.
    physics: ``string``, ``joint``, ``fluid``, ``rock`` or ``drive``; error control, line search and the steady flow
    select by it.
    """

    name: str
    size: int
    region: str = "string"
    scale: float = 1.0
    second_order: bool = True
    differential: bool = True
    multiplier: bool = False
    default: float = 0.0
    physics: str = STRING

    @property
    def does_work(self) -> bool:
        """Whether the field's rows are forces along its unknowns: no constraints, balances of mud or control laws."""
        return not self.multiplier and self.physics not in (FLUID, DRIVE)


@dataclass
class ElementBlock:
    """All local elements that share one compiled kernel pair (kernels/core/element.hpp).

    name: for logs and profiles.
    kernel: entry points ``<kernel>_residual`` and ``<kernel>_jacobian``.
    on: ``cell`` or ``vertex``; points: (n,) local numbers in the chain.
    slots: (field, end) in the kernel's order of unknowns; end 0 is the upper vertex, 1 the lower one.
    spins: ends whose spin angle the kernel uses, in the kernel's order.
    params: (n, p) constants of the elements (kernels.parameters.Parameters); ``named`` has them by name.
    context: address of a record that all elements share, 0 for none; keep: objects that it points to.
    constants: numbers of the record: records with equal ones are one law; none: unknown.
    linear: names of parameters in which the rows together are linear, without a term that is free of them.
    update(t): refreshes time-dependent parameters before an evaluation at time ``t`` [s].
    freezes(frozen): called where some of the system's unknowns become fixed or free, with the mask (n, k) of the fixed ones of the
    elements; None: nobody needs it.
    remembers: the parameters change after accepted steps as well.
    component: name in messages; the block's name unless given.
    elements: (n,) of a block on vertices: local cells whose distributed loads the rows are, -1: none; None: none at all.
    """

    name: str
    kernel: str
    on: str
    points: IntArray
    slots: tuple[tuple[str, int], ...]
    spins: tuple[int, ...]
    params: FloatArray
    context: int = 0
    update: Callable[[float], None] | None = None
    freezes: Callable[[np.ndarray], None] | None = None
    keep: tuple[object, ...] = field(default=(), repr=False)
    constants: tuple[Any, ...] = field(default=(), repr=False)
    linear: tuple[str, ...] = ()
    remembers: bool = False
    component: str = ""
    elements: IntArray | None = None
    _named: Table | None = field(default=None, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        self.component = self.component or self.name
        #: entry point of the kernel's results, if it has any
        self.results_kernel = f"{self.kernel}_results"

    @property
    def named(self) -> Table:
        """``params`` by the names of the kernel's parameters, as views: ``block.named["length"]``."""
        if self._named is None or self._named.array is not self.params:
            self._named = parameters_of(self.kernel, self.params)
        return self._named


@dataclass(frozen=True)
class PrescribedMotion:
    """Dirichlet condition: components of one vertex whose motion is given, ``directions @ x = value(t)``.

    directions: (m, 7) orthonormal rows over (position, slope, spin angle) of the vertex, at the start.
    value, rate: (m,) as functions of time [m, -, rad and per second].
    names: (m,) of the reactions: the residual components that the condition replaces (manual:
    eq-prescribed-rows).
    along_path(t, x, y): on a curved path, directions, value and rate at the time t and the vertex' unknowns x
    (7,) and their rates y (7,), None if unknown; None: the directions are constant.  A direction that is
    zero is free.
    advance(x): change (7,) of the vertex' unknowns x (7,) by the length of path that an end is moved down;
    None: the end does not move.
    spin_reference: direction (3,) from which the spin angle is measured, if the spin is prescribed (last) and the slope is free; a
    view into the array of its owner, who may change it.  None: the slope is also prescribed, or the spin is not (manual:
    eq-prescribed-lean).
    constant: value and rate keep their initial values.
    inputs: functions of time that the motion follows: two motions with equal ones differ by a constant; None: unknown.
    """

    vertex: int
    directions: FloatArray
    value: Callable[[float], FloatArray]
    rate: Callable[[float], FloatArray]
    names: tuple[str, ...]
    along_path: (
        Callable[[float, FloatArray, FloatArray | None], tuple[FloatArray, FloatArray, FloatArray]] | None
    ) = None
    advance: Callable[[FloatArray], FloatArray] | None = None
    spin_reference: FloatArray | None = None
    constant: bool = False
    inputs: tuple[Any, ...] | None = None


class ContactFlags(NamedTuple):
    """Data that change when contacts of a component open or close on this rank.

    values: one of them for each contact; never reallocated.
    wall: a value that is not zero is a closed contact with the wall (manual: sec-time-contact-entries).
    context: record of the block whose elements have no Jacobian entries if all of their values are zero, in the order of
    the elements; 0: there is none.
    """

    values: np.ndarray
    wall: bool = False
    context: int = 0


@dataclass(frozen=True)
class VelocityStabilization:
    """Correction of rates by multipliers, y = x' + B(x) mu (Gear, Gupta, Leimkuhler 1985; manual: eq-joint-ggl).

    field: name of mu (m components).
    points: (k,) vertices whose rates are corrected, ghosts included.
    directions(rows, x): B (k, 7, m) for the positions ``rows`` (k, 7) of (position, slope, spin angle) in x.
    """

    field: str
    points: IntArray
    directions: Callable[[IntArray, FloatArray], FloatArray]


class Energies(NamedTuple):
    """Stored energies [J] of a component on this rank; strain includes the energy in contacts and springs."""

    kinetic: float = 0.0
    strain: float = 0.0
    potential: float = 0.0


class Powers(NamedTuple):
    """Power [W] that a component dissipates, and power that it supplies, on this rank."""

    dissipated: float = 0.0
    supplied: float = 0.0


def _numbers(parts: tuple[Any, ...]) -> list[float]:
    """The numbers of one step from (1,) each or numbers."""
    return [np.asarray(part).item() for part in parts]


class Start(NamedTuple):
    """Data for a machine when a motion begins from the static state.

    hook_load: pull on the string [N]; total(values): sum of an array over all ranks, collective.
    at_rest: drives and drums do not move, whatever their set points, for the modes about rest.
    """

    hook_load: float
    total: Callable[[FloatArray], FloatArray]
    at_rest: bool = False


class Component:
    """Base class of all physics components.  A component has no public hook that is not declared here.

    ``state`` is the assembly of this rank (``fem.assembly.Assembly``): unknowns ``x``, rates ``y``,
    accelerations ``a``. ``system`` is the discrete system (``fem.discrete_system.DiscreteSystem``).
    """

    #: unique in a model; key of the component in checkpoints
    name: str = ""

    # ------------------------------------------------------------------ discretisation
    #: number of rows with Lagrange multipliers; a stable equilibrium has as many negative eigenvalues
    multipliers: int = 0
    #: constraints make the equations a DAE of index 2 or 3
    has_constraints: bool = False
    #: the component's unknowns turn with the string, so its Jacobian is renewed in every solve
    turns_with_string: bool = False
    #: number of components at a node of derived fields: quantities that are computed from the unknowns, and that
    #: other components use as fields
    derived_fields: dict[str, int] = {}

    def fields(self) -> tuple[Field, ...]:
        """Unknowns of the component."""
        return ()

    def regions(self) -> dict[str, np.ndarray]:
        """Sets of vertices by name: (n_nodes,) masks over the whole string."""
        return {}

    def blocks(self, part: Any) -> tuple[ElementBlock, ...]:
        """Element blocks on this rank's ``part`` of the chain; the same list of blocks on every rank."""
        return ()

    def prescribed(self) -> tuple[PrescribedMotion, ...]:
        """Motion that the component prescribes."""
        return ()

    def velocity_stabilization(self, part: Any) -> VelocityStabilization | None:
        """Correction of rates by multipliers; None without one."""
        return None

    def translate(self, block: ElementBlock) -> ElementBlock:
        """Rewrite another component's ``block`` from the derived fields to this component's unknowns."""
        return block

    def derive(self, state: Any) -> None:
        """Compute the derived fields from the unknowns."""

    def breaks(self) -> tuple[float, ...]:
        """Times at which an input jumps or bends [s]."""
        return ()

    def at_break(self, t: float, state: Any) -> bool:
        """Change states of this rank where an input jumps or bends at ``t`` [s]; True if any changed."""
        return False

    def begin_new_states(self, t: float, state: Any) -> bool:
        """Begin states that a changed case has and the restored state lacks, at ``t`` [s]; True if any changed,
        on the rank that has them."""
        return False

    @property
    def own_laws(self) -> tuple[Any, ...]:
        """Laws of the user that the component calls (``physics.own_law.OwnLaw``)."""
        return ()

    # ------------------------------------------------------------------ events
    #: the component's law may change at a state that is reached in time, such as a jar that fires
    has_events: bool = False

    def event_numbers(self, state: Any) -> FloatArray:
        """(k,) figures from which all ranks decide whether the law ends, summed over ranks; zero if another rank has them."""
        return np.zeros(0)

    def event_passed(self, numbers: FloatArray) -> bool:
        """Whether the law has ended at the ``event_numbers`` of all ranks."""
        return False

    def change_law(self, numbers: FloatArray) -> None:
        """Change to the next law."""

    def event_distance(self, passed: FloatArray, numbers: FloatArray, leader: Any) -> float:
        """How far ``numbers`` are beyond the limit at which ``leader``, the same component of a run, ends its law with the numbers ``passed``."""
        return 0.0

    def follow_law(self, leader: Any, numbers: FloatArray) -> None:
        """Change to the law of ``leader``, the same component of a run, with one's own ``event_numbers``."""

    # ------------------------------------------------------------------ reference frames
    def renew_reference_frames(self, system: Any) -> bool:
        """Replace reference directions that are nearly opposite to the tangent; collective.

        True if any changed.
        """
        return False

    def update_reference_frames(self) -> None:
        """Copy changed reference frames into the parameters of the blocks."""

    # ------------------------------------------------------------------ energy
    # A component with energies or powers implements them for one state or for several steps; the other form follows.
    def energies(self, t: float, state: Any) -> Energies:
        """Stored energies on this rank [J]."""
        return Energies(*_numbers(self.energies_of(OneStep(state, t))))

    def powers(self, t: float, state: Any) -> Powers:
        """Dissipated and supplied power on this rank [W]."""
        return Powers(*_numbers(self.powers_of(OneStep(state, t))))

    def energies_of(self, steps: OneStep) -> tuple[Any, Any, Any]:
        """``energies`` after each of k recorded steps (``fem.step_record.StepRecord``), (k,) each or numbers."""
        if type(self).energies is Component.energies:
            return 0.0, 0.0, 0.0
        found = steps.computed(
            lambda sample: self.energies(sample.time, sample.assembly), 3, id(self), "energies"
        )
        return tuple(found.T)

    def powers_of(self, steps: OneStep) -> tuple[Any, Any]:
        """``powers`` after each of k recorded steps, (k,) each or numbers."""
        if type(self).powers is Component.powers:
            return 0.0, 0.0
        return tuple(
            steps.computed(lambda sample: self.powers(sample.time, sample.assembly), 2, id(self), "powers").T
        )

    def reaction(self, name: str, state: Any) -> float:
        """Reaction ``name`` that a multiplier of the component represents, this rank's part [N or N m]."""
        return 0.0

    # ------------------------------------------------------------------ outputs
    def quantities(self) -> tuple[Quantity, ...]:
        """Outputs that the component declares (``physics.quantities``)."""
        return ()

    # ------------------------------------------------------------------ contact and constraints
    #: rows of the component switch when contacts open or close
    has_contact: bool = False
    #: the component restores its constraints after each solve of a step
    restores_constraints: bool = False

    def contact_flags(self) -> tuple[ContactFlags, ...]:
        """Data that change when contacts open or close on this rank."""
        return ()

    def restore_constraints(self, state: Any) -> None:
        """Project unknowns and rates onto the constraints."""

    # ------------------------------------------------------------------ history
    #: length of the vector that ``local_update`` returns, the same on every rank; 0: no update across ranks
    update_size: int = 0

    @property
    def remembers(self) -> bool:
        """Whether an accepted step changes history variables."""
        return bool(self.update_size) or type(self).accept is not Component.accept

    def accept(self, t: float, state: Any) -> None:
        """Update history variables after an accepted step that ends at time ``t`` [s]."""

    def local_update(self, state: Any) -> FloatArray:
        """(update_size,) changes known to this rank after an accepted step, zero elsewhere."""
        return np.zeros(self.update_size)

    def apply_update(self, total: FloatArray) -> None:
        """Apply the sum of ``local_update`` over all ranks."""

    #: a component beside a run whose history has left that of its leader so far that their difference says nothing
    strayed: bool = False

    @property
    def idle(self) -> bool:
        """Whether ``accept`` would change nothing after this step; the same on all ranks."""
        return False

    def follow(self, leader: Component, state: Any) -> None:
        """Renew in ``accept`` what ``leader`` has renewed after the same step, neither more nor less.

        leader: the same component of a run; this one is of a system beside it, with the assembly ``state``.
        """

    def accept_beside(self, t: float, others: Sequence[tuple[Component, Any]]) -> None:
        """Let ``others``, which follow this component, ``accept`` with their assemblies what it has accepted."""
        for other, state in others:
            other.accept(t, state)

    def get_state(self) -> dict[str, FloatArray]:
        """History variables for a checkpoint, the same on all ranks; empty without any."""
        return {}

    def set_state(self, state: dict[str, FloatArray]) -> None:
        """Continue from the history variables of a checkpoint."""

    def get_local_state(self) -> dict[str, FloatArray]:
        """History variables at the local ``vertex`` or ``cell`` points, (n, k) each; empty without any."""
        return {}

    def set_local_state(self, state: dict[str, FloatArray]) -> None:
        """Continue from the history variables at the local points."""

    def settle(self, t: float, state: Any) -> None:
        """Set history variables to their values at time ``t`` [s] when the present motion is steady."""

    # ------------------------------------------------------------------ machines
    #: angles without a restoring moment, such as a motor's rotor: each is a root zero of the linear model
    free_angles: int = 0
    #: field of a length to which nothing returns, such as the pay-out of a drum: a root zero as well; empty for none
    free_length: str = ""

    def hold(self) -> None:
        """Hold whatever the component moves by itself, for statics."""

    def begin_motion(self, state: Any, start: Start) -> None:
        """Release what ``hold`` holds; it continues with its static load.  Every rank calls it."""

    def first_cut(self, state: Any) -> None:
        """Set the rates of cutters at the start of a motion so that they carry their static weight."""

    def balance(self, state: Any) -> str:
        """Prepare a linear model about the present state: leave out excitations, close control loops inside their
        limits.  Returns a note for the user, empty without any."""
        return ""

    # ------------------------------------------------------------------ statics and quasi-static motion
    #: the loads of the component have a potential
    conservative: bool = True

    def impose_sliding_direction(
        self, axial: float, spin: float, side: float = 1.0, motor: float = 0.0
    ) -> None:
        """Let friction oppose a rigid motion of the string: ``axial`` [m/s, down], ``spin`` [rad/s].

        side: fraction of the lateral friction force that acts (0: its torque only).
        motor: contribution of a downhole motor to the spin below it [rad/s].
        """

    def release_sliding_direction(self) -> None:
        """Let friction follow the actual motion."""

    def follow_overdamped_motion(self, speed: float, slip: float) -> None:
        """Let friction follow the actual motion plus ``speed`` [m/s, down] along the hole; no damping.

        slip: velocity that rounds off Coulomb's law [m/s].
        """

    def copy_sliding_direction(self, other: Any) -> None:
        """Take over what statics imposed on the same component of another model."""

    def impose_drilling(self, axial: float, spin: float, side: float = 1.0) -> None:
        """As ``impose_sliding_direction``, while a bit that cuts advances without inertia."""
        self.impose_sliding_direction(axial, spin, side)

    def set_stiffness(self, factor: float) -> None:
        """Scale the contact stiffness by ``factor`` [-] (continuation)."""

    def constrain_positions(self, hold: bool) -> None:
        """Impose constraints at position level, whatever form they have in motion (statics has no velocities)."""

    def balance_constraints(self, state: Any, rows: FloatArray) -> None:
        """Change the multipliers so that the forces of their constraints balance ``rows`` (n,) of the local unknowns.

        rows: the residual, summed over ranks at the unknowns of this rank.
        """

    def average_over_turn(self, turning: bool) -> None:
        """While the string turns without inertia, leave out loads and mass that are fixed in its section."""

    # ------------------------------------------------------------------ borehole
    def follow_hole(self, well: Well) -> None:
        """Use the wall of a borehole that has grown."""

    def forget_hole(self) -> None:
        """Let the next ``locate_hole`` evaluate the hole everywhere, not only where the string has moved since the last."""

    def locate_hole(self, state: Any) -> None:
        """Evaluate size and direction of the hole at the string's present position."""

    # ------------------------------------------------------------------ fluid
    def missing_volume(self, state: Any) -> tuple[float, float] | None:
        """Volume [m3] and its rate [m3/s] that the steady flow must add at every node.

        None without such a level.
        """
        return None
