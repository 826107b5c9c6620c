"""Table of the cases of the report: the studies of each case, and notes about its orders of convergence."""

from __future__ import annotations

from dataclasses import dataclass

FIXED = ("bdf1-fixed", "bdf2-fixed", "bdf3-fixed", "alpha2-fixed")
QUATERNION = ("quaternion-bdf1-fixed", "quaternion-bdf2-fixed")
ADAPTIVE = ("bdf2", "bdf3", "alpha2")


@dataclass(frozen=True)
class ReportCase:
    """A case of the report.

    file: file below cases/verification; changes: of its keys (`key=value`).
    main: output by which the curves are compared.
    outputs: outputs that are drawn.
    curves: curves of the study.
    steps: of the curves with fixed steps [s]; empty for steps around the case's own.
    tolerances: of the other curves; empty for tolerances around the case's own.
    mesh: factors on the element lengths; empty for no study of the mesh.
    solver, ranks: whether solvers and numbers of ranks are studied.
    paper_steps: further, shorter steps of the reference paper's element and integrator, which it needs for an
        error of 1 % (manual: sec-paper) [s].
    limit: longest wall time of one run, ten times longer for ``paper_steps`` [s].
    note: remark about the observed orders.
    """

    file: str
    main: str
    outputs: tuple[str, ...]
    changes: tuple[str, ...] = ()
    curves: tuple[str, ...] = (*FIXED, *ADAPTIVE, "arkimex", *QUATERNION)
    steps: tuple[float, ...] = ()
    tolerances: tuple[float, ...] = ()
    mesh: tuple[float, ...] = ()
    solver: bool = False
    ranks: bool = False
    paper_steps: tuple[float, ...] = ()
    limit: float = 30.0
    note: str = ""


def halved(longest: float, count: int) -> tuple[float, ...]:
    return tuple(longest / 2**k for k in range(count))


CASES: dict[str, ReportCase] = {
    "pendulum": ReportCase(
        "study-pendulum.yaml",
        "x_0.5",
        ("bit_depth", "x_0.5"),
        steps=halved(5e-3, 6),
        mesh=(4, 2.6, 2, 1.6, 1),
        note="BDF3 is not stable for undamped motion: modes that the mesh has but nothing excites grow out of rounding, the faster the "
        "shorter the step.  The quaternion element's error levels off at that of its mesh.",
    ),
    "hanging-string": ReportCase(
        "study-hanging-string.yaml",
        "bit_speed",
        ("bit_speed",),
        steps=halved(0.08, 7),
        tolerances=(1e-2, 1e-3, 1e-4, 1e-5, 1e-6),
        mesh=(10, 5, 3.4, 2, 1),
        curves=(*FIXED, *ADAPTIVE, *QUATERNION),
        solver=True,
        ranks=True,
        paper_steps=halved(1e-3, 3),
        note="The second derivative of the top's speed jumps at both ends of its half cosine, which keeps the order at 2 in time for BDF3 "
        "and below 4 in space.",
    ),
    "flying-beam": ReportCase(
        "study-flying-beam.yaml",
        "x_10",
        ("bit_depth", "x_10"),
        steps=halved(0.05, 6),
        mesh=(4, 2.6, 2, 1.6, 1),
        note="BDF1 damps the free motion so much that its longer steps show no order yet.  Places are cubic in an element, spin is linear: "
        "bending converges with the fourth power of its length, torsional motion with the second, and this beam does both.",
    ),
    "water-hammer": ReportCase(
        "study-water-hammer.yaml",
        "pump_pressure",
        ("pump_pressure",),
        steps=halved(0.02, 6),
        tolerances=(1e-2, 1e-3, 1e-4, 1e-5, 1e-6),
        mesh=(10, 5, 3.4, 2, 1),
        curves=(*FIXED, *ADAPTIVE, "arkimex"),
        note="The wave goes to and fro without any loss; the second derivative of the pump's flow jumps at both ends of its half cosine, "
        "so that the order in time stays below 2: (5/2)(2/3) = 1.67 in rms for a scheme of order 2 on such data.  "
        "The wave is small (0.18 MPa for 1 l/s): the mud's own nonlinearity stays below 1e-4, and error control measures pressures by "
        "that of a wave of half the pump's flow.  The quaternion element plays no part: the string is "
        "held.",
    ),
    "flutter": ReportCase(
        "study-flutter.yaml",
        "x_10",
        ("x_10",),
        steps=halved(0.1, 6),
        mesh=(4, 2.6, 2, 1.6, 1),
        curves=(*FIXED, *ADAPTIVE, *QUATERNION),
        note="Flutter grows, and errors with it.",
    ),
    "impact": ReportCase(
        "study-impact.yaml",
        "x_5",
        ("x_5", "contact_5"),
        steps=halved(2e-3, 7),
        curves=(*FIXED, *ADAPTIVE, "arkimex", *QUATERNION),
        note="An impact lasts some milliseconds and begins with a corner of the force: no formula keeps an order above 2 over it, and the "
        "peak of the contact force is met only by steps much shorter than the impact.  Error control puts short steps only there.",
    ),
    "stick-slip": ReportCase(
        "study-stick-slip.yaml",
        "bit_speed",
        ("bit_speed", "surface_torque"),
        steps=halved(0.02, 6),
        curves=(*FIXED, *ADAPTIVE, *QUATERNION),
        note="The torque on the bit falls by half within 0.02 rad/s when it breaks loose: what remains of an error is a shift in time, "
        "by a part of the step in which it happens, so that orders below 2 are observed.  The quaternion element's error levels off at "
        "that of its mesh (0.6 rad of twist on an element).",
    ),
    "coupled": ReportCase(
        "study-coupled.yaml",
        "hook_load",
        ("hook_load", "wob", "pump_pressure"),
        steps=halved(0.032, 6),
        solver=True,
        ranks=True,
        curves=(*FIXED, *ADAPTIVE, *QUATERNION),
        tolerances=(1e-2, 3e-3, 1e-3, 3e-4, 1e-4),
        limit=25.0,
        note="The whole string in the whole hole, while the pump is turned down; with contact neighbouring motions part, so errors shrink "
        "only while the time is short and tolerances are not too small: at 3e-6 the motion is another one than at 1e-5.  On another mesh "
        "the string whirls otherwise, so there is no study of the mesh.",
    ),
    "whirl": ReportCase(
        "../vertical-2000m.yaml",
        "x_1900",
        ("x_1900", "surface_torque", "wob"),
        changes=(
            "title=Whirl in mud, 2000 m",
            "string[0].element_length=9 m",
            "string[2].element_length=8 m",
            "top.rotation=80 rpm",
            "time.end=2 s",
        ),
        curves=("bdf2-fixed", "bdf2", "alpha2"),
        steps=halved(8e-3, 4),
        tolerances=(1e-2, 1e-3, 1e-4, 1e-5, 1e-6),
        limit=15.0,
        note="The first study of the reference paper, turning from the start: the mud feeds the whirl of the collars until just before they touch the "
        "wall.  From then on neighbouring runs part, and means are compared instead: manual, *What the whirl depends on*.  Torque and weight on bit "
        "carry waves of the start; their ranges are 2 % of their means.",
    ),
}
