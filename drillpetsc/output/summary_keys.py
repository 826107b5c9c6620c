"""Keys of summary.json that are not quantities of the model: counts, times, balances, settings.

Plain descriptions, like ``drillpetsc.output.quantities``.  ``tests/unit/output/test_catalogue.py`` compares them with
the files that the commands write.
"""

from __future__ import annotations

from dataclasses import dataclass

from drillpetsc.output.conditions import (
    AUTODRILLER,
    BLOCK,
    CONTACT,
    CUTTINGS,
    DRILLS,
    FOLLOWS,
    HOIST,
    INDICES,
    INERTIA,
    MOTOR,
    MUD,
    SENSOR,
    STRING,
)


@dataclass(frozen=True)
class SummaryKey:
    """One key of summary.json.

    name: path of the key, ``energy.error`` for ``error`` in the block ``energy``; a path may name a whole block.
    unit: as in ``Quantity``; empty for text, blocks and truth values.
    doc: one sentence.
    condition: what the case or the run must contain for the key to exist; empty: always.
    """

    name: str
    unit: str
    doc: str
    condition: str = ""


STATIC_START = "static start"
STATIC_PATH = "path of a buckled string"
STATIC_BAND = "buckled string that slides"
MESH_ERROR = "run --mesh-error"
TOLERANCE_CHECK = "run --check-tolerance"
WHIRLS = "run in which a part that may whirl limits a step"
ACCEPTED_CHANGES = "run --accept-changes"
_RIGID_ITEMS = (
    "List of every rigid item with an outer diameter: name, md [m] of the middle, side_force [N], its components with friction "
    "side_high [N] and side_right [N], side_couple [N m], contact_force_sum [N], couple_high [N m] and couple_right [N m] "
    "(they turn the lower end to the high side and to the right); for the bit bit_force_on_rock_high [N], positive if it builds"
)

RUN: tuple[SummaryKey, ...] = (
    SummaryKey("title", "", "Title of the case."),
    SummaryKey("status", "", "'done', 'failed: REASON', or 'stopped by SIGNAL ...'."),
    SummaryKey("interrupted", "", "True if a signal ended the run."),
    SummaryKey("case_digest", "", "SHA-256 of the case with all defaults, in SI."),
    SummaryKey("versions", "", "Versions of drillpetsc, PETSc, numpy and Python that computed the run."),
    SummaryKey("petsc_options", "", "PETSc options in effect."),
    SummaryKey("ranks", "-", "Number of ranks."),
    SummaryKey("elements", "-", "Number of elements."),
    SummaryKey("unknowns", "-", "Number of unknowns, without their rates."),
    SummaryKey("simulated", "s", "Simulated time of this run; of a continued run, since it was continued."),
    SummaryKey("time", "s", "Simulated time at the end."),
    SummaryKey("steps", "-", "Number of accepted time steps."),
    SummaryKey("rejected_steps", "-", "Number of rejected time steps."),
    SummaryKey("newton_iterations", "-", "Number of Newton iterations."),
    SummaryKey("jacobians", "-", "Number of evaluations of the Jacobian."),
    SummaryKey("failed_solves", "-", "Number of time steps in which Newton's method failed."),
    SummaryKey("linear_iterations", "-", "Number of iterations of the linear solver."),
    SummaryKey("residuals", "-", "Number of evaluations of the residual."),
    SummaryKey("wall_seconds", "s", "Wall time of the motion."),
    SummaryKey("cpu_seconds", "s", "Processor time of the motion, all ranks together."),
    SummaryKey("start_seconds", "s", "Wall time of the start, which contains the statics."),
    SummaryKey("real_time_factor", "-", "Simulated time over wall time of the motion."),
    SummaryKey(
        "wall_by_phase",
        "s",
        "Wall time of the first rank by phase: residual, Jacobian, factorisation, solve, output; empty without PETSc's log.",
    ),
    SummaryKey("warnings", "", "Warnings for the user."),
    SummaryKey(
        "accepted_changes",
        "",
        "Changes of the case that were accepted for a continued run, each with its time.",
        ACCEPTED_CHANGES,
    ),
    SummaryKey("statics.iterations", "-", "Newton iterations of the static start.", STATIC_START),
    SummaryKey(
        "statics.negative_pivots",
        "-",
        "Negative pivots of the stiffness matrix in the static start, beyond one for each constraint.",
        STATIC_START,
    ),
    SummaryKey("statics.residual", "N", "Residual of the static start.", STATIC_START),
    SummaryKey(
        "statics.imperfection",
        "-",
        "Lateral load that was added to leave a straight unstable state, as a fraction of the weight.",
        STATIC_START,
    ),
    SummaryKey("statics.warnings", "", "Warnings of the static start.", STATIC_START),
    SummaryKey("energy.kinetic", "J", "Kinetic energy at the end.", INERTIA),
    SummaryKey("energy.strain", "J", "Strain energy at the end.", INERTIA),
    SummaryKey("energy.potential", "J", "Potential energy of gravity at the end.", INERTIA),
    SummaryKey("energy.dissipated", "J", "Energy dissipated since the start.", INERTIA),
    SummaryKey("energy.supplied", "J", "Energy supplied since the start.", INERTIA),
    SummaryKey(
        "energy.error",
        "J",
        "Stored energy gained plus dissipated less supplied energy since the start.",
        INERTIA,
    ),
    SummaryKey(
        "energy.error_share",
        "-",
        "Energy error over the larger of supplied work and peak change of stored energy.",
        INERTIA,
    ),
    SummaryKey(
        "energy.newton",
        "J",
        "Work of the residuals that Newton's method left (manual: eq-time-work).",
        INERTIA,
    ),
    SummaryKey(
        "energy.damped",
        "J",
        "Energy that the time formula's damping has removed: energy.newton minus energy.error; negative if it gained.",
        INERTIA,
    ),
    SummaryKey("energy.damped_share", "-", "Removed energy, as a share like error_share.", INERTIA),
    SummaryKey(
        "energy.followed",
        "J",
        "Energy that quasi-steady mud took up as its steady flow changed; counted as supplied (manual: eq-mud-follows).",
        FOLLOWS,
    ),
    SummaryKey("energy.gained", "J", "Largest energy error in any row of the history, at least 0.", INERTIA),
    SummaryKey("energy.gained_share", "-", "Gained energy, as a share like error_share.", INERTIA),
    SummaryKey("energy.gain_limit", "-", "Limit of gained_share (option -drillpetsc_gain_limit).", INERTIA),
    SummaryKey("energy.flag", "", "True if gained_share exceeds its limit.", INERTIA),
    SummaryKey("top_drive.impedance", "N m s/rad", "Torsional impedance of the uppermost pipe.", MOTOR),
    SummaryKey("top_drive.inertia", "kg m2", "Inertia of the drive.", MOTOR),
    SummaryKey(
        "top_drive.control",
        "",
        "List: kind, from [s], p [N m s/rad] and i [N m/rad] of each controller, and for a tuned one frequency [Hz] "
        "and reflection [-] there.",
        MOTOR,
    ),
    SummaryKey(
        "hoist.line_stiffness", "N/m", "Stiffness of the lines against the block at the start.", HOIST
    ),
    SummaryKey("hoist.stretch", "m", "Stretch of the lines at the start.", HOIST),
    SummaryKey(
        "hoist.fast_line_efficiency",
        "-",
        "Load over the tension of the fast line and the number of lines.",
        HOIST,
    ),
    SummaryKey("hoist.slack", "s", "Time from which the lines are pushed; null if never.", HOIST),
    SummaryKey(
        "hoist.autodriller",
        "",
        "from [s], least and most speed [m/s] and loops: kind, p [m/s] and i [m/s2] per unit of each.",
        AUTODRILLER,
    ),
    SummaryKey("mass.pumped", "m3", "Volume of mud pumped in since the start.", MUD),
    SummaryKey("mass.returned", "m3", "Volume of mud that came out since the start.", MUD),
    SummaryKey("mass.cuttings", "m3", "Volume of rock that the mud took up, counted as mud.", CUTTINGS),
    SummaryKey("mass.content_change", "m3", "Change of the volume of mud in string and hole.", MUD),
    SummaryKey("mass.error", "m3", "Change of content less pumped plus returned less cuttings.", MUD),
    SummaryKey(
        "mass.error_share", "-", "Error over the largest of pumped, returned and changed volume.", MUD
    ),
    SummaryKey(
        "rigid_items",
        "",
        f"{_RIGID_ITEMS}, at the end.",
        CONTACT,
    ),
    SummaryKey("new_hole.drilled", "m", "Length of the new hole.", DRILLS),
    SummaryKey("new_hole.inclination_start", "deg", "Inclination at the start of the new hole.", DRILLS),
    SummaryKey("new_hole.inclination_end", "deg", "Inclination at the end of the new hole.", DRILLS),
    SummaryKey("new_hole.azimuth_start", "deg", "Azimuth at the start of the new hole.", DRILLS),
    SummaryKey("new_hole.azimuth_end", "deg", "Azimuth at the end of the new hole.", DRILLS),
    SummaryKey(
        "new_hole.build_rate", "deg/30m", "Build rate of the new hole (manual: eq-borehole-rates).", DRILLS
    ),
    SummaryKey(
        "new_hole.turn_rate", "deg/30m", "Turn rate of the new hole (manual: eq-borehole-rates).", DRILLS
    ),
    SummaryKey("new_hole.dogleg_severity", "deg/30m", "Dogleg severity of the new hole.", DRILLS),
    SummaryKey(
        "new_hole.end_above",
        "m",
        "Offset of the end of the hole from the straight continuation of the old hole, to the high side.",
        DRILLS,
    ),
    SummaryKey("new_hole.end_right", "m", "Offset to the right of that, looking down the hole.", DRILLS),
    SummaryKey("final", "", "Last values of history.csv, by column."),
    SummaryKey(
        "error_estimate.time", "", "Local errors of the time formula by unknown, largest over the string."
    ),
    SummaryKey(
        "error_estimate.outputs",
        "",
        "Estimated time error of the main outputs: range, error at an instant and their quotient share, and pace, the relative error of size and speed of the changes; null if an output switches.",
        INERTIA,
    ),
    SummaryKey(
        "error_estimate.damped_above",
        "Hz",
        "Frequency above which the time formula takes more than 1 % of an amplitude in a period, at the median of the steps by time.",
        INERTIA,
    ),
    SummaryKey(
        "steps_limited_by.name",
        "",
        "Part whose whirl limited most of the steps (manual: sec-time-choice).",
        WHIRLS,
    ),
    SummaryKey("steps_limited_by.md", "m", "Its measured depth at the start.", WHIRLS),
    SummaryKey("steps_limited_by.share", "-", "Share of the steps that it limited.", WHIRLS),
    SummaryKey("steps_limited_by.shortest", "s", "The shortest of these steps.", WHIRLS),
    SummaryKey(
        "error_estimate.mesh",
        "",
        "Differences of the history from a run on elements twice as long.",
        MESH_ERROR,
    ),
    SummaryKey(
        "error_estimate.tolerance",
        "",
        "Differences from a run at a tenth of the tolerance: history columns, and classes of motion that changed.",
        TOLERANCE_CHECK,
    ),
    SummaryKey(
        "motion",
        "",
        "List: contact, sliding and whirl of each rigid item and probe, rotation of the lower end, in the second half of the run.",
        TOLERANCE_CHECK,
    ),
    SummaryKey(
        "sensors",
        "",
        "For every sensor: name, md [m], rate [Hz], number of samples, finest frequency [Hz] of its filter or rate, frequency up "
        "to which the time steps resolve its content [Hz], share of the time with coarser steps, points out of range.",
        SENSOR,
    ),
    SummaryKey("vibration.windows", "-", "Number of windows of the indices.", INDICES),
    SummaryKey("vibration.window", "s", "Length of a window.", INDICES),
    SummaryKey("vibration.largest", "", "Largest value of every index over the windows.", INDICES),
    SummaryKey("vibration.mean", "", "Mean value of every index over the windows.", INDICES),
    SummaryKey("vibration.whirl", "", "For every probe: shares of the windows by class of whirl.", INDICES),
    SummaryKey("memory.start", "bytes", "Peak memory at the start of the motion, all ranks together."),
    SummaryKey("memory.after_a_tenth", "bytes", "Peak memory after a tenth of the motion."),
    SummaryKey("memory.end", "bytes", "Peak memory after the last step."),
    SummaryKey("memory.peak", "bytes", "Peak memory at the end."),
)

STATICS: tuple[SummaryKey, ...] = (
    SummaryKey("title", "", "Title of the case."),
    SummaryKey(
        "motion", "", "Motion that friction opposes: 'hoist', 'lower', 'rotate' or 'as the top prescribes'."
    ),
    SummaryKey(
        "negative_pivots",
        "-",
        "Negative pivots of the stiffness matrix beyond one for each constraint; a stable state has none.",
        STRING,
    ),
    SummaryKey("stable", "", "True if the state is stable.", STRING),
    SummaryKey("iterations", "-", "Iterations of Newton's method.", STRING),
    SummaryKey("residual", "N", "Residual of the equilibrium.", STRING),
    SummaryKey(
        "imperfection",
        "-",
        "Lateral load that was added to leave a straight unstable state, as a fraction of the weight.",
        STRING,
    ),
    SummaryKey(
        "buckling.sinusoidal",
        "",
        "Measured depths (from, to) between which the compression exceeds the sinusoidal buckling load [m].",
        STRING,
    ),
    SummaryKey(
        "buckling.helical", "", "Measured depths (from, to) between which the string coils [m].", STRING
    ),
    SummaryKey(
        "helix_band",
        "",
        "For a buckled string that slides along an inclined hole with friction, whose load is not unique: name (hook_load, or wob under a "
        "given force at the top), low and high [N], depending on whether the pipe becomes helical late or early.",
        STATIC_BAND,
    ),
    SummaryKey(
        "path",
        "",
        "Motion followed by the path: 'sliding' or 'slack_off'.",
        STATIC_PATH,
    ),
    SummaryKey(
        "path_states",
        "",
        "List, one entry a path: start, hook_load [N], wob [N], surface_torque [N m] (of a string that turns, else 0), "
        "negative_pivots, change (of the transmitted force over the push, or of the torque over itself), slid [m], steps, "
        "iterations; the first is the state of the table.",
        STATIC_PATH,
    ),
    SummaryKey("warnings", "", "Warnings for the user."),
    SummaryKey(
        "rigid_items",
        "",
        f"{_RIGID_ITEMS}.",
        CONTACT,
    ),
    SummaryKey("soft_string.hook_load", "N", "Hook load by the soft-string model.", CONTACT),
    SummaryKey("soft_string.surface_torque", "N m", "Surface torque by the soft-string model.", CONTACT),
    SummaryKey("soft_string.stretch", "m", "Stretch by the soft-string model.", CONTACT),
)

MODES: tuple[SummaryKey, ...] = (
    SummaryKey("title", "", "Title of the case."),
    SummaryKey("searched", "", "Which modes were computed."),
    SummaryKey("about", "", "The state: 'rest', or its motion."),
    SummaryKey("lowering", "m/s", "Axial velocity of the state, positive down."),
    SummaryKey("rotation", "rad/s", "Rotation of the state, positive clockwise."),
    SummaryKey("modes", "-", "Number of modes found."),
    SummaryKey("stable", "", "True if all modes decay and all eigenvalues differ from zero."),
    SummaryKey("margin", "1/s", "Largest growth rate; negative if all computed modes decay."),
    SummaryKey("unstable", "-", "Number of modes that grow."),
    SummaryKey("diverging", "-", "Number of modes that grow without oscillation."),
    SummaryKey("fluttering", "-", "Number of modes that grow with oscillation."),
    SummaryKey(
        "zero_roots",
        "-",
        "Number of zero eigenvalues: free motions, or a load at which the string just buckles.",
    ),
    SummaryKey("smallest_eigenvalue", "rad/s", "Smallest magnitude of an eigenvalue."),
    SummaryKey("largest_error", "-", "Largest backward error of an eigenvalue."),
    SummaryKey("imbalance", "N", "Largest unbalanced force on a node in the state."),
    SummaryKey("frequency", "Hz", "List: frequency of each mode."),
    SummaryKey("damping_ratio", "-", "List: damping ratio of each mode."),
    SummaryKey("growth", "1/s", "List: growth rate of each mode."),
    SummaryKey("kind", "", "List: kind of each mode."),
    SummaryKey("negative_pivots", "-", "As in the summary of statics."),
    SummaryKey("warnings", "", "Warnings for the user."),
    SummaryKey("time_scales", "", "Periods and travel times of waves, as text."),
)

CAMPBELL: tuple[SummaryKey, ...] = (
    SummaryKey("title", "", "Title of the case."),
    SummaryKey("speeds", "rpm", "List: rotary speeds requested."),
    SummaryKey(
        "added_speeds",
        "rpm",
        "List: speeds added between them because shapes changed too much to be followed.",
    ),
    SummaryKey("case_speed", "rpm", "Rotation of the case at time 0."),
    SummaryKey("lines", "-", "List: excitation lines in cycles per turn."),
    SummaryKey("searched", "", "Kind of the modes, or all kinds."),
    SummaryKey(
        "searched_to",
        "Hz",
        "Frequency up to which all modes are known, at each speed, speeds between included.",
    ),
    SummaryKey(
        "searched_beside",
        "Hz",
        "Distance from excitation lines above up to which modes are known, at each speed; null without a line above.",
    ),
    SummaryKey("branches", "-", "Number of modes that were followed."),
    SummaryKey("lost", "-", "Number of branches lost."),
    SummaryKey("critical_speeds", "-", "Number of crossings of branches and lines."),
    SummaryKey("growing_speeds", "rpm", "List: speeds at which a mode grows."),
    SummaryKey("static_solutions", "-", "Number of static equilibria that were solved for."),
    SummaryKey("warnings", "", "Warnings for the user."),
)

STABILITY: tuple[SummaryKey, ...] = (
    SummaryKey("title", "", "Title of the case."),
    SummaryKey("speeds", "rpm", "List: rotary speeds."),
    SummaryKey("weights", "N", "List: weights on bit."),
    SummaryKey("searched", "", "Kind of the modes, or all kinds."),
    SummaryKey("unstable", "-", "Number of points at which a mode grows."),
    SummaryKey(
        "marginal", "-", "Number of points whose largest growth is within 1e-4 of the angular frequency."
    ),
    SummaryKey("boundaries", "-", "Number of speeds found at which stability changes."),
    SummaryKey("warnings", "", "Warnings for the user."),
)

RESPONSE: tuple[SummaryKey, ...] = (
    SummaryKey("title", "", "Title of the case."),
    SummaryKey("excitation", "", "The excitation, in words."),
    SummaryKey("order", "-", "Cycles of the excitation per turn."),
    SummaryKey("speeds", "rpm", "List: rotary speeds."),
    SummaryKey("validity", "", "List: linear, touches, lifts or infinite at each speed, as in the table."),
    SummaryKey(
        "peaks",
        "",
        "List: by place its md [m] and the largest amplitude of each column with its speed [rpm].",
    ),
    SummaryKey("static_solutions", "-", "Number of static equilibria that were solved for."),
    SummaryKey("warnings", "", "Warnings for the user."),
)

HYDRAULICS: tuple[SummaryKey, ...] = (
    SummaryKey("title", "", "Title of the case."),
    SummaryKey("bit_depth", "m", "Measured depth of the string's lower end."),
    SummaryKey("hole_depth", "m", "Measured depth of the end of the hole; null without a well."),
    SummaryKey("shoe_depth", "m", "Measured depth of the last casing shoe; null without casing."),
    SummaryKey("shoe_tvd", "m", "Vertical depth of the last casing shoe; null without casing."),
    SummaryKey("outlet_pressure", "Pa", "Gauge pressure at the outlet."),
    SummaryKey(
        "window", "", "Window of the case: tvd [m] (null: one pair), pore and frac [kg/m3]; null without one."
    ),
    SummaryKey("units", "", "Units of printed and plotted figures; files are in SI."),
    SummaryKey(
        "flows",
        "",
        "List: for each flow rate the quantities of this page (null if absent), `limited_by` and `warnings`; `nozzles`, the rows of nozzles.csv, if there are nozzles above the bit.",
    ),
    SummaryKey(
        "rheology",
        "",
        "From dial readings: plastic_viscosity [Pa s], yield_point [Pa], index [-] and consistency [Pa s^n] by API in pipe and annulus; null without.",
    ),
    SummaryKey(
        "warnings",
        "",
        "Warnings on the string and its hole; warnings of a flow rate are in `flows`.",
    ),
    SummaryKey("notes", "", "Omissions of the results, and choices made."),
)

SURGE: tuple[SummaryKey, ...] = (
    SummaryKey("title", "", "Title of the case."),
    SummaryKey("window", "", "Window: tvd [m] (null: one pair), pore and frac [kg/m3]; null without one."),
    SummaryKey("window_from", "", "Source of the window: `case`, `--window`, or null."),
    SummaryKey("units", "", "Units of printed and plotted figures; files are in SI."),
    SummaryKey("surge", "", "List: the rows of surge.csv by name, each with its `warnings`."),
    SummaryKey("max_trip_speed", "", "List: the rows of max_trip_speed.csv by name."),
    SummaryKey(
        "open_pipe_by_area",
        "",
        "List: for the largest speed with an open pipe, the pressure with the handbook's split of the flow by areas, and the solver's pressure [Pa].",
    ),
    SummaryKey("notes", "", "Omissions of the results, and choices made."),
)

ROADMAP: tuple[SummaryKey, ...] = (
    SummaryKey("title", "", "Title of the case."),
    SummaryKey("units", "", "Units of printed and plotted figures; files are in SI."),
    SummaryKey("model", "", "Model of the string: soft, without bending stiffness."),
    SummaryKey("rows", "-", "Number of rows of roadmap.csv."),
    SummaryKey("rows_not_ok", "-", "Number of rows whose status is not ok."),
    SummaryKey(
        "measured",
        "",
        "Measured points beside the case, by kind of reading: number, bias, rms and largest residual (SI, and over the reading), share in the band.",
        "measured points",
    ),
    SummaryKey("warnings", "", "Unreliable rows, and limits of the rig that are exceeded."),
    SummaryKey(
        "notes", "", "Values assumed because the case did not give them, and omissions of the results."
    ),
)

LIMITS: tuple[SummaryKey, ...] = (
    SummaryKey("title", "", "Title of the case."),
    SummaryKey("operation", "", "Operation of the string, or 'as the case'."),
    SummaryKey("motion", "", "Motion that friction opposes: lowering [m/s], rotation [rad/s]."),
    SummaryKey("hook_load", "N", "Hook load of the string."),
    SummaryKey("hook_load_total", "N", "Hook load with the block.", BLOCK),
    SummaryKey("surface_torque", "N m", "Torque at the top."),
    SummaryKey("wob", "N", "Weight on bit."),
    SummaryKey("bit_torque", "N m", "Torque of the bit."),
    SummaryKey("stable", "", "True if the state is stable."),
    SummaryKey(
        "choices",
        "",
        "Law of the helical limit, design factors, share of the pull at yield, largest side force on a tool joint [N].",
    ),
    SummaryKey("helical_law", "", "Law of the helical limit in words, with its ratio to the sinusoidal one."),
    SummaryKey("units", "", "Units of printed and plotted figures; files are in SI."),
    SummaryKey(
        "neutral_point",
        "",
        "Places at which effective tension (effective) and axial force (true) change to compression: md [m], above_bit [m]; or null.",
    ),
    SummaryKey(
        "weakest",
        "",
        "For safety factor, ratios of tension, torque and dogleg, side force on tool joints: worst value, md [m], item; or null.",
    ),
    SummaryKey("contacts", "", "List: the rows of contacts.csv by name."),
    SummaryKey("rig", "", "Limits of the rig; null without them."),
    SummaryKey(
        "margin_of_overpull",
        "",
        "Smallest margin between tension limit and tension at pick-up: margin [N], ratio, md [m], item, hook_load [N]; null if unknown.",
    ),
    SummaryKey("margin_of_overpull_still", "", "The same with the mud at rest, if mud is pumped."),
    SummaryKey(
        "max_overpull_at_bit",
        "",
        "Pull at the lower end that reaches a tension limit, with friction: pull [N], md [m], item; null if unknown.",
    ),
    SummaryKey(
        "max_wob",
        "",
        "For drilling and sliding: largest weight before the string passes the sinusoidal and the helical limit: wob [N] "
        "(null: no limit found), md [m], item; null without a soft string.",
    ),
    SummaryKey(
        "available_wob",
        "",
        "For drilling and sliding: largest weight on bit that the string and the block bring down before the string becomes "
        "helical (limited_by: helical) or the hook load is zero (hook_load): wob [N], md [m], item; null without a soft string.",
    ),
    SummaryKey(
        "max_slackoff", "N", "Fall of the hook load from the free string to the helical limit when sliding."
    ),
    SummaryKey(
        "buckling", "", "Ranges of measured depth [m] that are sinusoidal or helical by the state found."
    ),
    SummaryKey(
        "warnings", "", "Limits that are passed, each with its worst place, and what statics warns of."
    ),
    SummaryKey("notes", "", "Omissions of the results."),
)

CALIBRATE: tuple[SummaryKey, ...] = (
    SummaryKey("title", "", "Title of the case."),
    SummaryKey("units", "", "Units of printed and plotted figures; files are in SI."),
    SummaryKey(
        "fit",
        "",
        "By parameter: value, 95 % interval, that of independent errors, and status: `determined`, `prior kept`, or `not determined` "
        "with the reason; block weight in N, running drag in N s/m.",
    ),
    SummaryKey("parameters", "", "Names of the parameters, in the order of `correlation`."),
    SummaryKey(
        "correlation", "-", "Matrix of correlations of the parameters; null if one is not determined."
    ),
    SummaryKey(
        "reduced_chi2", "-", "Sum of squares of the weighted residuals over their degrees of freedom."
    ),
    SummaryKey("readings", "-", "Number of hook loads and torques that were fitted."),
    SummaryKey("errors", "", "`correlated` or `independent`: how the intervals were computed."),
    SummaryKey(
        "correlation_length",
        "",
        "By operation and quantity: readings, correlation length along depth raw and detrended, effective number of readings; null if "
        "errors are independent, as are `block` and `resamples`.",
    ),
    SummaryKey("block", "m", "Length of the blocks that the bootstrap draws."),
    SummaryKey("resamples", "-", "Number of resamples of the bootstrap."),
    SummaryKey("drift", "", "Friction factor by windows of depth, its slope, whether it drifts; or null."),
    SummaryKey(
        "hold_out",
        "",
        "By quantity: readings that were predicted, bias, rms, 95th percentile and largest error over the reading, share in the band; null without --hold-out.",
    ),
    SummaryKey("warnings", "", "Why a result is unreliable."),
    SummaryKey("notes", "", "Assumptions, and omissions of the model."),
)

#: keys by file, as the catalogue names the files
SUMMARY_KEYS = {
    "summary.json of run": RUN,
    "summary.json of statics": STATICS,
    "summary.json of modes": MODES,
    "summary.json of campbell": CAMPBELL,
    "summary.json of stability": STABILITY,
    "summary.json of response": RESPONSE,
    "summary.json of hydraulics": HYDRAULICS,
    "summary.json of surge": SURGE,
    "summary.json of roadmap": ROADMAP,
    "summary.json of limits": LIMITS,
    "summary.json of calibrate": CALIBRATE,
}
