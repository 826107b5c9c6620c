"""Commands on forces and stresses without a run in time: statics, sensitivities, roadmap, limits, freepoint, calibrate."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from drillpetsc.errors import CaseError
from drillpetsc.operations.fields import Names, Numbers, at_least, holds, names, number, numbers
from drillpetsc.operations.operation import AtBitDepth, CaseOperation, DrawnOperation, FolderOperation, Mark


class Statics(AtBitDepth, FolderOperation):
    """Static equilibrium: torque and drag, contact forces, buckling state.

    Writes statics.csv and string.pvd.
    """

    motion: Annotated[
        Literal["hoist", "lower", "rotate"] | None, "motion that friction opposes (default: the top's)"
    ] = None
    operation: Annotated[
        str | None,
        "WORD",
        "instead, trip_in, trip_out, rotate_off_bottom, drilling, sliding, backreaming; or slackoff, pickup, rob: "
        "whether the bit is on bottom belongs to it",
    ] = None
    path: Annotated[
        Literal["sliding", "slack_off"] | None,
        "follow the history of a buckled string with friction: the whole string slides or turns (gives the band of states), "
        "or it is lowered onto a bit that stands",
    ] = None

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.commands.statics import run_statics

        return run_statics(job, self.motion, self.path, self.operation)


class Sensitivities(AtBitDepth, DrawnOperation):
    """Derivatives of outputs by numbers of the case: what changes hook load, torque or pressures, and by how much.

    Solves once, and takes each derivative from the linearised equations of that solution. Writes sensitivities.csv.
    """

    to: Annotated[
        Names,
        names,
        "KEYS",
        "keys of the case: 'well.sections[1].friction,string[jar].weight,fluid.density,top.rotation'",
    ] = ""
    of: Annotated[
        Names,
        names,
        "A,B",
        "outputs, such as hook_load or trip_out.hook_load, or all (default: hook load and surface torque; pump pressure and ECD)",
    ] = ""
    analysis: Annotated[
        Literal["statics", "roadmap", "hydraulics", "run"],
        "whose outputs are meant; a roadmap has the friction of the hole's sections; a run: surface_torque.mean[2:4]",
    ] = "statics"
    all: Annotated[bool, "every continuous number of the case, instead of --to"] = False
    check: Annotated[
        int,
        at_least(0, "derivatives"),
        "N",
        "compare N derivatives with differences of full solutions: the largest, the median, others at random",
    ] = 0
    motion: Annotated[
        Literal["hoist", "lower", "rotate"] | None, "of statics: motion that friction opposes"
    ] = None
    operation: Annotated[str | None, "WORD", "of statics: operation, as of the command statics"] = None
    depths: Annotated[Literal["deepest", "all"], "of a roadmap: its bit depths"] = "deepest"
    model: Annotated[Literal["soft", "stiff"], "of a roadmap: soft string or beam"] = "soft"

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.sensitivities.command import Question, run_sensitivities

        if self.analysis != "statics" and (self.motion or self.operation):
            raise CaseError(at="--motion", got=self.motion or self.operation, want="--analysis statics")
        question = Question(
            self.analysis,
            self.of,
            self.to,
            self.all,
            self.check,
            self.motion,
            self.operation,
            self.depths,
            self.model,
        )
        return run_sensitivities(job, question)


class Uncertain(AtBitDepth, DrawnOperation):
    """Quantiles of outputs, such as P10, P50 and P90, from distributions of numbers of the case.

    The case's block `uncertain` has the distributions. Writes uncertain.csv and uncertain_shares.csv.
    """

    of: Annotated[
        Names,
        names,
        "A,B",
        "outputs, such as hook_load_total or trip_out.hook_load, or all (default: hook load, with the block if it is given, and "
        "surface torque; pump pressure and ECD)",
    ] = ""
    analysis: Annotated[
        Literal["roadmap", "hydraulics"],
        "whose outputs are meant; a roadmap has the friction of the hole's sections",
    ] = "roadmap"
    method: Annotated[
        Literal["monte-carlo", "linear", "both"],
        "a solution for each sample, derivatives at the case's values, or both to compare them",
    ] = "monte-carlo"
    samples: Annotated[
        int, holds(lambda q: 20 <= q <= 100_000, "a number of samples from 20 to 100000"), "N", "samples"
    ] = 500
    seed: Annotated[
        int, at_least(0, "the seed"), "N", "seed of the samples: the same seed, the same numbers"
    ] = 1
    calibration: Annotated[
        str | None,
        "RUN",
        "run folder of calibrate: its numbers and their uncertainty replace those of the case",
    ] = None
    quantiles: Annotated[
        Numbers,
        numbers("", "10,50,90", "percentages", above=0, at_most=99.999),
        "A,B",
        "percentages of the quantiles",
    ] = "10,50,90"

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.uncertain.calibrated import calibrated
        from drillpetsc.analysis.uncertain.command import Question, run_uncertain

        levels, notes = tuple(q / 100 for q in self.quantiles), list[str]()
        if self.calibration is not None:
            case, notes = calibrated(job.case, Path(self.calibration))
            job = job.of(case)
        question = Question(self.analysis, self.of, self.method, self.samples, self.seed, levels)
        return run_uncertain(job, question, notes)


class Roadmap(DrawnOperation):
    """Torque and drag over the bit depth: hook load and torque for six operations and several friction factors.

    The case's block `roadmap` has operations, depths and friction factors. Writes roadmap.csv and roadmap.json.
    """

    measured: Annotated[
        str | None, "FILE", "measured points to plot: CSV, xlsx or LAS (default: the case's)"
    ] = None
    model: Annotated[
        Literal["soft", "stiff"],
        "soft: soft string; stiff: the beam in static equilibrium, about 0.1 s a row",
    ] = "soft"
    block: Annotated[
        dict[str, Any] | None,
        Mark.PYTHON,
        'keys of the case\'s block `roadmap` in the place of those of the case, such as friction_factor={"cased": [0.2, 0.25]}',
    ] = None

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.loads.torque_drag.roadmap import run_roadmap
        from drillpetsc.case.options.measured_option import measured_option

        if self.block:
            job = job.of(job.case.replace({f"roadmap.{key}": value for key, value in self.block.items()}))
        points = None if self.measured is None else measured_option(self.measured, job.case)
        return run_roadmap(job, points, self.model)


class Limits(AtBitDepth, DrawnOperation):
    """Stresses, safety factors, buckling and fatigue limits along the string, margin of overpull, largest weight on bit.

    Writes limits.csv and contacts.csv.
    """

    operation: Annotated[
        str | None,
        "WORD",
        "trip_in, trip_out, rotate_off_bottom, drilling, sliding, backreaming; or slackoff, pickup, rob "
        "(default: the case as it is, moving as its top prescribes)",
    ] = None
    helical: Annotated[Literal["chen", "wu"], "law of the helical limit"] = "chen"
    design_factor: Annotated[
        float,
        holds(lambda q: 1 <= q <= 10, "a number from 1 to 10"),
        "least yield strength over von Mises stress, below which a warning is given",
    ] = 1.25
    tension_fraction: Annotated[
        float,
        holds(lambda q: 0 < q <= 1, "a number above 0, up to 1"),
        "share of the pull at yield that tension_limit allows",
    ] = 0.9
    corrosive: Annotated[bool, "corrosive mud: 0.6 of the permissible doglegs (API RP 7G)"] = False
    sn: Annotated[
        str | None,
        "A,B|FILE",
        "S-N curve for Miner's damage per hour: a,b of log10 N = a - b log10(S/MPa), or a CSV file with the columns "
        "stress [MPa], cycles",
    ] = None

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.loads.limits.fatigue import read_sn
        from drillpetsc.analysis.loads.limits.limits import run_limits
        from drillpetsc.analysis.loads.limits.table import Choices

        curve = None if self.sn is None else read_sn(self.sn)
        choices = Choices(
            helical=self.helical,
            design_factor=self.design_factor,
            tension_fraction=self.tension_fraction,
            corrosive=self.corrosive,
            sn=curve,
        )
        return run_limits(job, self.operation, choices)


class Freepoint(CaseOperation):
    """How much of a stuck string is free, from its stretch under a pull.

    Returns `pairs`, a FreePoint for each pair, and `slope`, that of the line through them (None for one pull).
    """

    stretch: Annotated[
        Numbers, "E1,E2", "stretch at the surface under each pull, such as '24 in' or '10,24 in'"
    ]
    pull: Annotated[
        Numbers, "F1,F2", "pulls beyond the weight of the free string, such as '30 klb' or '12,30 klb'"
    ]

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.loads.limits.free_point import free_points
        from drillpetsc.analysis.motion.run_options import options_of
        from drillpetsc.case.options.free_point_options import read_pairs

        with options_of(job.case):
            return free_points(job.case, read_pairs(self.stretch, self.pull))


class Calibrate(DrawnOperation):
    """Friction factors from measured hook loads and torques, with intervals.

    Writes calibration.csv.
    """

    measured: Annotated[
        str | None,
        "FILE",
        "measured points, such as points.csv of import log: CSV, xlsx or LAS (default: the case's)",
    ] = None
    log: Annotated[str | None, "LOG", "instead, a rig's log, read as by import log"] = None
    every: Annotated[
        str | None, "LENGTH", "length of a point of --log while drilling, such as 1m or 10s (default: 10 m)"
    ] = None
    fit: Annotated[
        str | None,
        "A,B",
        "what is fitted: cased, open_hole, groups of sections by their ff_group, block_weight, weight_factor, running_drag, "
        "sheave_efficiency, and numbers of the case such as fluid.density (default: all friction factors)",
    ] = None
    model: Annotated[
        Literal["soft", "stiff", "dynamic"],
        "soft: soft string; stiff: the beam in static equilibrium, about a second for each point; dynamic: the run of the case, beside a "
        "--log in time",
    ] = "soft"
    hold_out: Annotated[
        str | None,
        "SHARE|DEPTH",
        "points that are not fitted but predicted: the deepest share, as 0.5, or those below 2150m",
    ] = None
    errors: Annotated[
        Literal["correlated", "independent"] | None,
        "intervals by a bootstrap of blocks along depth, or of independent errors (default: correlated from 30 bit depths)",
    ] = None
    prior: Annotated[
        tuple[str, ...],
        "NAME=MEAN+-SIGMA",
        "what is known of a parameter beforehand, such as cased=0.2+-0.05; may be given several times",
    ] = ()

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.commands.import_log import points_of_log
        from drillpetsc.analysis.loads.torque_drag.readings.calibrate import Choices, run_calibrate
        from drillpetsc.case.options.measured_option import fit_option, measured_option, prior_option

        if self.log is not None and self.measured is not None:
            raise CaseError(at="--log", got=self.log, want="either --log or --measured")
        if self.model == "dynamic":
            return self._of_run(job)
        points = None if self.measured is None else measured_option(self.measured, job.case)
        if self.log is not None:
            points = points_of_log(self.log, job.case, self.every)
        choices = Choices(
            None if self.fit is None else fit_option(self.fit, job.case),
            self.hold_out,
            None if self.errors is None else self.errors == "correlated",
            prior_option(self.prior),
            self.model,
        )
        return run_calibrate(job, points, choices)

    def _of_run(self, job: Any) -> Any:
        """The run of the case beside a log in time."""
        from drillpetsc.analysis.calibration.command import run_calibrate_log
        from drillpetsc.case.options.measured_option import fit_option, prior_option

        others = {"--measured": self.measured, "--every": self.every, "--hold-out": self.hold_out}
        for option, value in others.items():
            if value is not None:
                raise CaseError(
                    at=option,
                    got=value,
                    want="--model soft or stiff: a run is compared with --log, row by row",
                )
        if self.log is None:
            raise CaseError(at="--log", want="a log by time, which --model dynamic is fitted to")
        if self.fit is None:
            raise CaseError(
                at="--fit", want="numbers of the case, such as formation.bit_law.static,string[0].od"
            )
        names = fit_option(self.fit, job.case)
        return run_calibrate_log(job, self.log, names, self.errors != "independent", prior_option(self.prior))


class Follow(FolderOperation):
    """Follow a rig row by row: friction, weights and their uncertainty, a forecast one stand ahead, alarms.

    Writes follow.csv, state.json and live.html while the log grows.
    """

    log: Annotated[
        str,
        "FILE|-|wits:HOST:PORT|witsml:URL",
        "the rig's log: a text table, which may grow; - for standard input; LAS, xlsx, WITSML; a server of WITS level 0, "
        "metric, or in feet and pounds with :fps; a log of a WITSML store, https://HOST/PATH?well=UID&wellbore=UID&log=UID",
    ]
    map: Annotated[
        tuple[str, ...],
        "CHANNEL=TITLE:UNIT",
        "the title of the column that holds a channel, and its unit, as in import log; may be given several times",
    ] = ()
    prior: Annotated[
        tuple[str, ...],
        "NAME=MEAN+-SIGMA",
        "what is known of a state beforehand, such as cased=0.2+-0.02; may be given several times",
    ] = ()
    every: Annotated[
        Numbers, number("m", "1 m", at_least=0.1, at_most=30), "LENGTH", "length of a row while drilling"
    ] = "1 m"
    pace: Annotated[
        float | None,
        holds(lambda q: q is None or 0 < q <= 1e6, "a number above 0"),
        "X",
        "replay a log by time X times as fast as it was recorded (default: as fast as rows come)",
    ] = None
    wait: Annotated[
        Numbers,
        number("s", "10 min", at_least=0, at_most=1e7),
        "TIME",
        "how long to wait for new rows at the end of a file, or for a server that gives none (default: not at all)",
    ] = "0 s"
    until: Annotated[
        str | None,
        "TIME|DEPTH",
        "where to stop: time since the first row, as 2 h, or a depth of a log by depth",
    ] = None
    restart: Annotated[bool, "continue the folder --out, or the latest, from its state.json"] = False
    model: Annotated[
        Literal["soft", "stiff"],
        "soft: soft string; stiff: the beam as well, one state a stand, of a second or two; says where both differ",
    ] = "soft"

    @property
    def continues(self) -> bool:
        return self.restart

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.follow.session import Choices, run_follow
        from drillpetsc.case.options.measured_option import prior_option
        from drillpetsc.case.options.ranges import time_or_depth

        choices = Choices(
            self.log, self.map, prior_option(self.prior), self.every, self.pace, self.wait,
            None if self.until is None else time_or_depth(self.until, "--until"), self.restart, self.model,
        )  # fmt: skip
        return run_follow(job, choices)
