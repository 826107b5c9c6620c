"""Words of the trade that a driller may write for a key or a kind of the case file, and the corresponding hints."""

from __future__ import annotations

from collections.abc import Collection

from drillpetsc.case.key_paths import suggestion

#: word -> keys that may be meant; the first one that the block has is taken
KEYS: dict[str, tuple[str, ...]] = {
    "tfa": ("nozzle_area",),
    "weight": ("mass", "density"),
    "mud_weight": ("density",),
    "mw": ("density",),
    "ppf": ("nominal_weight", "adjusted_weight"),
    "flow": ("flow_rate",),
    "pump_rate": ("flow_rate",),
    "gpm": ("flow_rate",),
    "friction_factor": ("friction",),
    "ff": ("friction",),
    "toolface": ("tool_face",),
    "rpm": ("rotation",),
    "mud": ("fluid",),
    "bha": ("string",),
    "drillstring": ("string",),
    "hole": ("well",),
    "jets": ("nozzles",),
    "type": ("bit_type",),
}
#: word -> what to write, if the key is in another block or has another meaning
PLACES: dict[str, str] = {
    "wob": "weight on bit is in initial: {wob: 25 klbf}, with bottom: bit",
    "rpm": "rotation is in top: {kind: top_drive, rotation: 120 rpm}",
    "survey": "the survey is in well: {survey: survey.csv, sections: [...]}",
    "sections": "the sections are in well: {survey: survey.csv, sections: [...]}",
    "casing": "casing that is set is a section of the hole: well: {sections: [{to: .., kind: casing, diameter: ..}]}",
    "block_weight": "it is in rig: {block_weight: ...}",
    "pv": "rheology: {pv: 23 cP, yp: 18 lbf/100ft2}",
    "yp": "rheology: {pv: 23 cP, yp: 18 lbf/100ft2}",
    "dial": "rheology: {dial: {600: 64, 300: 41}}",
    "connection": "tool_joint: {connection: NC50}",
    "od": "diameter is the diameter of the hole; in casing, its inner diameter",
    "id": "diameter is the diameter of the hole; in casing, its inner diameter",
    "from": "a section begins at the end of the one above",
}
#: word -> what to write as the kind of a string item
KINDS: dict[str, str] = {
    "dp": "drill_pipe",
    "drillpipe": "drill_pipe",
    "hw": "hwdp",
    "hevi_wate": "hwdp",
    "heavy_weight": "hwdp",
    "dc": "drill_collar",
    "collar": "drill_collar",
    "nmdc": "drill_collar, with nonmagnetic: true",
    "monel": "drill_collar, with nonmagnetic: true",
    "stab": "stabilizer",
    "liner": "casing",
    "tubing": "pipe",
    "ct": "coiled_tubing",
    **dict.fromkeys(
        ("motor", "mwd", "lwd", "sub", "xo", "crossover", "jars"),
        "tool, with its od, id, length, weight and a name",
    ),
}


def key_hint(word: str, keys: Collection[str]) -> str:
    """The hint for an unknown key, from the trade's words first, else the most similar key; may be empty.

    keys: keys of the block.
    """
    found = next((key for key in KEYS.get(word, ()) if key in keys), "")
    if found:
        return f"did you mean '{found}'?"
    if word in PLACES and _fits(word, keys):
        return PLACES[word]
    return suggestion(word, keys)


def _fits(word: str, keys: Collection[str]) -> bool:
    """Whether the block is one in which the word of PLACES is meant so."""
    if word in ("od", "id", "from"):
        return "diameter" in keys and "to" in keys
    inside = {"pv": "rheology", "yp": "rheology", "dial": "rheology", "connection": "tool_joint"}
    if word in inside:
        return inside[word] in keys
    return "string" in keys and "well" in keys


def kind_hint(word: object, kinds: Collection[str]) -> str:
    """The hint for an unknown kind; may be empty. kinds: the allowed ones."""
    meant = KINDS.get(str(word).lower().replace(" ", "_").replace("-", "_"))
    if meant is not None and meant.partition(",")[0] in kinds:
        return f"did you mean '{meant}'?" if "," not in meant else f"write {meant}"
    return suggestion(word, kinds)
