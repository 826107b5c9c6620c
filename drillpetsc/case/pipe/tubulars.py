"""Figures of pipe that a case leaves out: from the catalogue, defaults and formulas."""

from __future__ import annotations

from typing import Any

from drillpetsc.case.block import overlaid
from drillpetsc.case.blocks.items.string import Item, Material
from drillpetsc.case.blocks.items.tubulars import (
    Casing,
    CenterUpset,
    CoiledTubing,
    DrillCollar,
    DrillPipe,
    HeavyPipe,
    Jointed,
    ToolJoint,
    Tubular,
)
from drillpetsc.case.catalogue import formulas
from drillpetsc.case.catalogue.reference import (
    PipeChoice,
    Reference,
    ReferenceProblem,
    find_grade,
    find_heavy_pipe,
    find_pipe,
    find_threads,
    find_tube,
)
from drillpetsc.case.catalogue.sizes import FT_LBF, INCH, KSI, LB_PER_FT
from drillpetsc.case.catalogue.tables import Row
from drillpetsc.case.pipe.completion import Completion
from drillpetsc.case.pipe.section import ring
from drillpetsc.case.pipe.weighed import checked_weight, with_weight
from drillpetsc.case.quantities import said

FOOT = 0.3048  # [m]
AGREES = 0.01  # relative difference from the catalogue that is not a contradiction
JOINT_LENGTHS = {2: 31.0 * FOOT, 3: 44.0 * FOOT}  # by range [m]
CATALOGUE_STEEL = 7850.0  # density that weights of the catalogue belong to [kg/m3]
NONMAGNETIC = Material(density=7860.0, young=193e9)
HEAVY_YIELD = 55 * KSI
COLLAR_YIELD = ((6.9375, 110 * KSI), (float("inf"), 100 * KSI))  # below this od [in]: yield strength [Pa]
RADIUS_UNDER_BORE = INCH / 8  # by which a tool joint's bore may exceed the tube's [m]

FORMULA = "formula of API RP 7G for drill pipe with tool joints"


class TubularCompletion(Completion):
    """Completes a tubular."""

    def items(self) -> list[Item]:
        item = self.item
        assert isinstance(item, Tubular)
        self._material(item)
        if item.weight is not None and item.adjusted_weight is not None:
            raise self.refuse("weight", want="weight or adjusted_weight, not both")
        if item.weight is not None:
            self.values |= {"adjusted_weight": item.weight, "weight": None}
        if isinstance(item, DrillPipe):
            self._drill_pipe(item)
        elif isinstance(item, HeavyPipe):
            self._heavy_pipe(item)
        elif isinstance(item, DrillCollar):
            self._collar(item)
        elif isinstance(item, Casing):
            self._casing(item)
        else:
            assert isinstance(item, CoiledTubing)
            self._wall()
            self._grade("coiled_tubing")
        self._plain_weight()
        if item.weight is None:
            self._check_weight()
        self._checked_section()
        if item.weight is not None:
            self._weighed(item, item.weight)
        return self.completed()

    def _material(self, item: Tubular) -> None:
        base = self.case.material
        if isinstance(item, DrillCollar) and item.nonmagnetic:
            given = set() if item.material is None else item.material.model_fields_set
            base = overlaid(base, NONMAGNETIC)
            for key, unit in (("density", "kg/m^3"), ("young", "Pa")):
                if key not in given and not (key == "density" and item.weight is not None):
                    self.note(
                        f"material.{key}", getattr(NONMAGNETIC, key), unit, "default of nonmagnetic collars"
                    )
        self.values["material"] = overlaid(base, item.material)

    def _drill_pipe(self, item: DrillPipe) -> None:
        own = item.tool_joint or ToolJoint()
        complete = None not in (own.od, own.id, own.length)
        choice: PipeChoice | None = None
        words = {"grade": item.grade, "connection": own.connection}
        key = "pipe" if item.pipe is not None else "nominal_weight"
        if item.pipe is not None and item.nominal_weight is not None:
            raise self.refuse("nominal_weight", want="pipe or nominal_weight, not both")
        if item.pipe is not None:
            choice = self.looked_up(
                key, lambda: find_pipe(self.catalogue, item.pipe or "", words, not complete), item.pipe
            )
        elif item.nominal_weight is not None:
            if item.od is None:
                raise self.refuse("od", want="an outer diameter together with nominal_weight")
            weight = item.nominal_weight / LB_PER_FT
            reference = Reference(item.od / INCH, weight, grade=item.grade)
            choice = self.looked_up(
                key,
                lambda: find_pipe(self.catalogue, reference, words, not complete),
                f"{weight:.2f} lb/ft with od {item.od / INCH:.4g} in",
            )
        worn = None
        if choice is not None:
            self._tube(choice.tube, "id")
            worn = choice.reference.wear
        self._wall()
        self._default_grade(item, choice)
        self._joint(item, own, choice.joint if choice else None)
        self._class(item, worn)
        self._joint_length(item)
        self._pipe_weight(choice)
        self.values |= {"pipe": None, "nominal_weight": None}

    def _heavy_pipe(self, item: HeavyPipe) -> None:
        own = item.tool_joint or ToolJoint()
        row: Row | None = None
        if item.pipe is not None:
            row = self.looked_up(
                "pipe", lambda: find_heavy_pipe(self.catalogue, item.pipe or "", own.connection), item.pipe
            )
            self._tube(row, "id")
        self._wall()
        self._joint(item, own, row, "tool_joint_")
        if item.grade is not None:
            self._grade("hwdp")
        self.default(
            "yield_strength", HEAVY_YIELD, "Pa", "default of heavy-wall pipe, 55 ksi: no grade given"
        )
        self._joint_length(item)
        if (
            row is not None
            and row["center_upset_od"]
            and row["center_upset_length"]
            and item.center_upset is None
        ):
            upset = CenterUpset(od=row["center_upset_od"] * INCH, length=row["center_upset_length"] * INCH)
            self.values["center_upset"] = upset
            self.note("center_upset.od", upset.od, "m", row.place)
            self.note("center_upset.length", upset.length, "m", row.place)
        upset = self.value("center_upset")
        if upset is not None:
            joint = self.value("tool_joint")
            if not self.value("od") <= upset.od <= joint.od:
                want = f"between the tube, {said(self.value('od'), 'diameter')}, and the tool joint, {said(joint.od, 'diameter')}"
                raise self.refuse("center_upset", "od", got=upset.od, want=want)
        if row is not None:
            self._steel("adjusted_weight")
            self.default("adjusted_weight", row["weight"] * LB_PER_FT, "kg/m", row.place)
        elif self.value("adjusted_weight") is None:
            raise self.refuse(
                "adjusted_weight",
                want="a mass per length, or a pipe from the catalogue, such as 5in 49.3 NC50",
                hint="no formula gives the weight of heavy-wall pipe",
            )
        self.values["pipe"] = None

    def _collar(self, item: DrillCollar) -> None:
        self._wall()
        self._grade("drill_collar")
        limit = next(y for below, y in COLLAR_YIELD if self.value("od") / INCH < below)
        size = "up to 6 7/8 in" if limit == COLLAR_YIELD[0][1] else "from 7 in"
        text = f"default of collars {size}, {limit / KSI:.0f} ksi: no grade given"
        self.default("yield_strength", limit, "Pa", text)
        self.default("joint_length", JOINT_LENGTHS[2], "m", "default, 31.0 ft")

    def _casing(self, item: Casing) -> None:
        if item.nominal_weight is not None:
            if item.od is None:
                raise self.refuse("od", want="an outer diameter together with nominal_weight")
            size, weight = item.od / INCH, item.nominal_weight / LB_PER_FT
            row = self.looked_up(
                "nominal_weight",
                lambda: find_tube(self.catalogue, "casing", size, weight),
                f"{weight:.2f} lb/ft with od {size:.4g} in",
            )
            self._tube(row, "id")
            self.values["nominal_weight"] = None
        self._wall()
        self._grade("casing")

    # ------------------------------------------------------------------ parts
    def _tube(self, row: Row, inner: str) -> None:
        """Diameters of the tube from a row; given diameters must agree with it."""
        item = self.item
        assert isinstance(item, Tubular)
        outer, bore = row["size"] * INCH, row[inner] * INCH
        own_bore = item.id
        if item.wall is not None:
            own_bore = (item.od or outer) - 2 * item.wall
        for key, given, listed in (("od", item.od, outer), ("id", own_bore, bore)):
            if given is not None and abs(given - listed) > AGREES * listed and not item.override:
                shown = "wall" if key == "id" and item.wall is not None else key
                raise self.refuse(
                    shown,
                    got=getattr(item, shown),
                    want=f"what the catalogue has within 1 %: {key} {said(listed, 'diameter')} ({row.file} line {row.line})",
                    hint="override: true takes the pipe as given",
                )
        self.default("od", outer, "m", row.place)
        if item.wall is None:
            self.default("id", bore, "m", row.place)

    def _wall(self) -> None:
        """Inner diameter from the wall; both diameters must be known then."""
        item = self.item
        assert isinstance(item, Tubular)
        outer = self.value("od")
        if outer is None:
            pipe = " or a pipe from the catalogue" if isinstance(item, Jointed) else ""
            raise self.refuse("od", want=f"an outer diameter{pipe}")
        if item.wall is not None:
            self.values |= {"id": outer - 2 * item.wall, "wall": None}
            self.note("id", self.values["id"], "m", "od less two walls")
        inner = self.value("id")
        if inner is None:
            pipe = " or a pipe from the catalogue" if isinstance(item, Jointed) else ""
            hint = "a solid bar has id: 0"
            if isinstance(item, DrillPipe) and item.weight is not None:
                hint = "nominal_weight finds the row of the catalogue; weight is the weight of the pipe with its tool joints, as weighed"
            raise self.refuse("id", want=f"an inner diameter, a wall{pipe}", hint=hint)
        if inner < 0 or inner >= outer:
            raise self.refuse(
                "id", got=inner, want=f"an inner diameter below the outer, {said(outer, 'diameter')}"
            )

    def _joint(self, item: Jointed, own: ToolJoint, row: Row | None, prefix: str = "") -> None:
        """Tool joint: what is given, and the rest from a row of the catalogue."""
        joint: dict[str, Any] = {"connection": own.connection}
        if own.connection is None and row is not None:
            joint["connection"] = row["connection"]
            self.note("tool_joint.connection", row["connection"], "", row.place)
        for key in ("od", "id", "length"):
            joint[key] = getattr(own, key)
            if joint[key] is None and row is not None:
                joint[key] = row[prefix + key] * INCH
                self.note(f"tool_joint.{key}", joint[key], "m", row.place)
            if joint[key] is None:
                raise self.refuse(
                    "tool_joint",
                    key,
                    want="this key: {od: .., id: .., length: ..}, or a pipe from the catalogue",
                    hint="a tube without tool joints is kind: pipe",
                )
        joint["make_up_torque"] = own.make_up_torque or self._make_up(joint, own, row)
        self.values["tool_joint"] = ToolJoint(**joint)

    def _make_up(self, joint: dict[str, Any], own: ToolJoint, row: Row | None) -> float | None:
        """Make-up torque [N m]: from the row for its tool joint, otherwise by the formula for new ones; None: unknown threads."""
        key, place = "tool_joint.make_up_torque", "" if row is None else row.place
        if row is not None and row["make_up"] is not None and own.od is None and own.id is None:
            torque = row["make_up"] * FT_LBF
        else:
            threads = find_threads(self.catalogue, joint["connection"]) if joint["connection"] else None
            if threads is None:
                return None
            columns = (
                "taper",
                "threads",
                "thread_height",
                "root",
                "pitch_diameter",
                "pin_length",
                "counterbore",
            )
            yields = formulas.tool_joint_torque(
                **{column: threads[column] for column in columns},
                joint_outer=joint["od"] / INCH,
                joint_inner=joint["id"] / INCH,
            )
            if yields == 0.0:
                return None  # the wall of the tool joint is too thin for these threads
            torque = formulas.MAKE_UP * yields * FT_LBF
            place = f"{threads.place}, {formulas.MAKE_UP:.0%} of the torque at which the new tool joint yields (API RP 7G)"
        self.note(key, torque, "N m", place)
        return torque

    def _joint_length(self, item: Jointed) -> None:
        if item.range is not None and item.joint_length is not None:
            raise self.refuse("range", got=item.range, want="joint_length or range, not both")
        number = item.range or 2
        feet = JOINT_LENGTHS[number] / FOOT
        text = f"range {number}, {feet:.1f} ft" if item.range else f"default, {feet:.1f} ft"
        self.default("joint_length", JOINT_LENGTHS[number], "m", text)
        self.values["range"] = None

    def _default_grade(self, item: DrillPipe, choice: PipeChoice | None) -> None:
        """Grade and yield strength of drill pipe: key, word of the reference, E-75."""
        if item.grade is None and item.yield_strength is None:
            word = choice.reference.grade if choice else None
            self.values["grade"] = word or "E-75"
            source = "pipe, as written" if word else "default: no grade given"
            self.note("grade", self.values["grade"], "", source)
        self._grade("drill_pipe")

    def _grade(self, kind: str) -> None:
        """Yield strength of the grade."""
        grade, given = self.value("grade"), self.value("yield_strength")
        if grade is None:
            return
        if given is not None:
            try:  # both are in a case that was written out
                listed = find_grade(self.catalogue, kind, grade)["yield"] * KSI
            except ReferenceProblem:
                return
            if abs(given - listed) > 1e-9 * listed:
                raise self.refuse(
                    "yield_strength",
                    got=given,
                    want=f"grade or yield_strength, not both: {grade} has {said(listed, 'stress')}",
                )
            return
        row = self.looked_up("grade", lambda: find_grade(self.catalogue, kind, grade), grade)
        self.values |= {"grade": row["grade"], "yield_strength": row["yield"] * KSI}
        self.note("yield_strength", row["yield"] * KSI, "Pa", row.place)

    def _class(self, item: DrillPipe, worn: str | None) -> None:
        """Wall that is left."""
        word = item.class_ or worn
        if item.override and word not in (None, "new"):
            raise self.refuse(
                "class",
                got=word,
                want="new, or remaining_wall, with override: the wall is not the catalogue's",
            )
        if item.remaining_wall is not None:
            if word is not None and abs(self.catalogue.wall_fraction(word) - item.remaining_wall) > 1e-9:
                raise self.refuse(
                    "remaining_wall", got=item.remaining_wall, want="class or remaining_wall, not both"
                )
            return
        source = "pipe, as written" if item.class_ is None and worn else ""
        if word is None:
            word = "new" if item.override else "premium"
            source = "default: no class given"
        if item.class_ is None:
            self.values["class_"] = word
            self.note("class", word, "", source)
        self.values["remaining_wall"] = self.catalogue.wall_fraction(word)
        row = next(row for row in self.catalogue.rows["class"] if row["class"] == word)
        self.note("remaining_wall", self.values["remaining_wall"], "", row.place)

    # ------------------------------------------------------------------ weights
    def _steel(self, key: str) -> None:
        """Refuse a weight for steel if the material is different."""
        density = self.values["material"].density
        if self.value(key) is None and abs(density - CATALOGUE_STEEL) > 0.02 * CATALOGUE_STEEL:
            raise self.refuse(
                key,
                want="a mass per length: catalogue and formula are for steel",
                hint=f"the material has {said(density, 'density')}",
            )

    def _pipe_weight(self, choice: PipeChoice | None) -> None:
        """Average weight of drill pipe: from the row, if the tool joint is the row's; otherwise by the formula."""
        if self.value("adjusted_weight") is not None:
            return
        self._steel("adjusted_weight")
        outer, bore, joint = self.value("od") / INCH, self.value("id") / INCH, self.values["tool_joint"]
        row = choice.joint if choice else None
        same = row is not None and all(
            abs(getattr(joint, key) / INCH - row[key]) <= 1e-6 * row[key] for key in ("od", "id", "length")
        )
        same = same and choice is not None and abs(outer - choice.tube["size"]) <= 1e-6 * outer
        same = same and choice is not None and abs(bore - choice.tube["id"]) <= 1e-6 * bore
        if row is not None and same and row["adjusted"] is not None:
            self.default("adjusted_weight", row["adjusted"] * LB_PER_FT, "kg/m", row.place)
            return
        upset_od, upset_weight, without = outer, 0.0, " (no upsets known)"
        if row is not None and row["upset_od"] is not None and row["upset_weight"] is not None:
            upset_od, upset_weight = row["upset_od"], row["upset_weight"]
            without = f" (upsets of {row.place})"
        weight = formulas.adjusted_weight(
            formulas.plain_end_weight(outer, bore),
            upset_weight,
            min(upset_od, joint.od / INCH),
            joint.od / INCH,
            joint.id / INCH,
            joint.length / INCH,
        )
        self.default("adjusted_weight", weight * LB_PER_FT, "kg/m", FORMULA + without)

    def _plain_weight(self) -> None:
        """Weight of a plain tube: collars, casing, coiled tubing."""
        if self.value("adjusted_weight") is None:
            area, _ = ring(self.value("od"), self.value("id"))
            factor, text = self._spiral()
            mass = self.values["material"].density * area * factor
            self.default("adjusted_weight", mass, "kg/m", f"section times density{text}")

    def _weighed(self, item: Tubular, weight: float) -> None:
        """Check the given weight. Without tool joints the metal fills the ring between the diameters."""
        area = ring(self.value("od"), self.value("id"))[0]
        if not isinstance(item, Jointed):
            whole = item.model_copy(update={"od": self.value("od"), "id": self.value("id")})
            self.values["material"] = with_weight(whole, self.values["material"], self.refuse)["material"]
            self.note_density()
            return
        joint = self.values["tool_joint"]
        share = joint.length / self.value("joint_length")
        area = (1 - share) * area + share * ring(joint.od, joint.id)[0]
        checked_weight(weight, formulas.STEEL * area, item.length, self.refuse)

    def _spiral(self) -> tuple[float, str]:
        item = self.item
        if isinstance(item, DrillCollar) and item.spiral:
            return item.spiral_weight_factor, f", times {item.spiral_weight_factor:g} for the spiral"
        return 1.0, ""

    def _check_weight(self) -> None:
        """Refuse a weight below the plain tube's, or above the weight of a solid bar."""
        density = self.values["material"].density
        outer = self.value("od")
        tube, _ = ring(outer, self.value("id"))
        bar, _ = ring(outer, 0.0)
        if isinstance(self.item, Jointed):
            joint = self.values["tool_joint"]
            share = min(joint.length / self.value("joint_length"), 1.0)
            bar = (1 - share) * bar + share * ring(joint.od, 0.0)[0]
        least, most = 0.995 * density * tube * self._spiral()[0], 1.005 * density * bar
        got = self.value("adjusted_weight")
        if not least <= got <= most:
            want = f"{least:.4g} to {most:.4g} kg/m: from the plain tube to a solid bar"
            hint = "weights in lb/ft need their unit"
            raise self.refuse("adjusted_weight", got=got, want=want, hint=hint)

    def _checked_section(self) -> None:
        """Refuse tool joints that cannot be."""
        item = self.item
        if not isinstance(item, Jointed):
            return
        joint, outer, inner = self.values["tool_joint"], self.value("od"), self.value("id")
        if joint.od < outer:
            raise self.refuse(
                "tool_joint",
                "od",
                got=joint.od,
                want=f"at least the diameter of the tube, {said(outer, 'diameter')}",
            )
        if joint.id >= joint.od:
            raise self.refuse(
                "tool_joint",
                "id",
                got=joint.id,
                want=f"below its outer diameter, {said(joint.od, 'diameter')}",
            )
        if joint.id > inner + RADIUS_UNDER_BORE:
            want = f"at most 1/8 in above the bore of the tube, {said(inner + RADIUS_UNDER_BORE, 'diameter')}"
            raise self.refuse("tool_joint", "id", got=joint.id, want=want)
        if joint.length > self.value("joint_length") / 3:
            want = f"at most a third of a joint, {said(self.value('joint_length') / 3, 'length')}"
            raise self.refuse("tool_joint", "length", got=joint.length, want=want)
