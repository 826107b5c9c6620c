"""A fragment of a case from files of other programs: survey, string and sections of the hole."""

from __future__ import annotations

import os
from collections.abc import Sequence
from io import StringIO
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from drillpetsc.case.blocks.items.tubulars import StringItem
from drillpetsc.case.files.survey_file import read_survey
from drillpetsc.case.importers.edm import Wanted, import_edm
from drillpetsc.case.importers.stations import Rules
from drillpetsc.case.importers.tally import import_tally, is_tally
from drillpetsc.case.importers.witsml import EDM_ROOT, Imported, import_witsml, read_witsml
from drillpetsc.case.importers.xml_tree import first_element
from drillpetsc.case.messages import case_error
from drillpetsc.errors import CaseError

SAME_END = 1.0  # [m] between the last section and the last station
ONE_JOINT = 10.0  # [m] by which a tally may be short of its hole
TODO = ("string", "well.survey", "well.sections", "top", "bottom", "fluid", "time")


def fragment(
    files: Sequence[str | Path], folder: Path, wanted: Wanted | None = None
) -> tuple[str, list[str]]:
    """(YAML text, remarks) of survey files, tallies, WITSML documents and EDM exports.

    files: at most one of each kind: survey, tubular, geometry of the wellbore; an EDM export may have all three
    folder: of the case file, in which the survey is named relative to it
    wanted: choices for an EDM export
    """
    found: dict[str, tuple[Path, Imported]] = {}
    remarks: list[str] = []
    chosen = False
    for name in files:
        path = Path(name)
        if not path.is_file():
            raise CaseError(at="FILE", got=path, want="a file that exists")
        content, has_several = _read(path, folder, wanted or Wanted())
        chosen |= has_several
        parts = {"survey": content.survey, "tubular": content.string, "geometry": content.sections}
        for kind in (kind for kind, part in parts.items() if part):
            if kind in found:
                raise CaseError(
                    at="FILE", got=path, want=f"one file with a {kind}; {found[kind][0]} has one too"
                )
            found[kind] = path, content
        remarks += [f"{path.name}: {text}" for text in content.remarks]
    if wanted is not None and not chosen:
        for option, value in (
            ("--wellbore", wanted.wellbore),
            ("--assembly", wanted.assembly),
            ("--hole", wanted.hole),
        ):
            if value is not None:
                raise CaseError(at=option, got=value, want="an EDM export or a tally among the files")
    nothing = (Path(), Imported())
    survey, hole, string = (found.get(kind, nothing)[1] for kind in ("survey", "geometry", "tubular"))
    titles = [content.title for _, content in found.values() if content.title]
    data: dict[str, Any] = {"title": titles[0]} if titles else {}
    if survey.survey and hole.sections:
        remarks += _fitted(hole.sections, survey.end)
    well = {key: part for key, part in (("survey", survey.survey), ("sections", hole.sections)) if part}
    if well:
        data["well"] = well
    if string.string:
        data["string"] = string.string
        if survey.survey:
            remarks += _short_string(string.string, survey.end)
    here = {"string": "string" in data, "well.survey": "survey" in well, "well.sections": "sections" in well}
    missing = [key for key in TODO if not here.get(key)]
    return _text(data, files, remarks, missing), remarks


def _read(path: Path, folder: Path, wanted: Wanted) -> tuple[Imported, bool]:
    """(contribution of a file, whether it may have several strings)."""
    has_several, kind = True, ""
    if path.suffix.casefold() == ".xml" and first_element(path) != EDM_ROOT:
        _, kind = read_witsml(path)
    if kind in ("tubular", "wbGeometry"):
        content, has_several = import_witsml(path), False
    elif path.suffix.casefold() == ".xml" and not kind:
        content = import_edm(path, wanted)
    elif is_tally(path):
        content = import_tally(path, wanted.assembly)
    else:
        try:
            stations = read_survey(str(path), Rules())
        except CaseError:
            raise
        except Exception as error:  # PydanticCustomError, outside a case
            raise CaseError(at="FILE", got=path, want="a survey that can be read", hint=str(error)) from None
        name = os.path.relpath(path, folder)
        return Imported(survey=name, end=stations.md[-1], remarks=stations.remarks), False
    _check_items(path, content)
    return content, has_several


def _check_items(path: Path, content: Imported) -> None:
    """Raise if a case would refuse an item of the file."""
    if not content.string:
        return
    try:
        TypeAdapter(tuple[StringItem, ...]).validate_python(tuple(content.string))
    except ValidationError as error:
        wrong = case_error(error, {str(i): item for i, item in enumerate(content.string)})
        for each in (wrong, *wrong.also):
            each.file, each.line, each.at = str(path), 1, f"string{each.at}"
        raise wrong from None


def _short_string(string: list[dict[str, Any]], end: float) -> list[str]:
    """A remark on a string that does not reach from the rig to the end of the survey [m]."""
    length = sum(float(str(item["length"]).split()[0]) for item in string)
    if length > end - ONE_JOINT:
        return []
    return [
        f"the string is {length:.6g} m long, the survey ends at {end:.6g} m: bit_depth is where the bit is, and length: fill lets "
        "the topmost pipe reach the rig"
    ]


def _fitted(sections: list[dict[str, Any]], end: float) -> list[str]:
    """Let the last section end with the survey if the two agree; otherwise add a remark."""
    last = float(str(sections[-1]["to"]).split()[0])
    if abs(last - end) <= SAME_END:
        sections[-1]["to"] = "end"
        return []
    return [f"WARNING: the hole's sections end at {last:g} m, the survey at {end:g} m: lengthen one of them"]


def _text(
    data: dict[str, Any], files: Sequence[str | Path], remarks: Sequence[str], missing: Sequence[str]
) -> str:
    from ruamel.yaml import YAML

    yaml = YAML(typ="safe", pure=True)
    yaml.default_flow_style = None
    yaml.sort_base_mapping_type_on_output = False  # type: ignore[assignment]
    yaml.width = 4096
    stream = StringIO()
    yaml.dump(data, stream)
    head = [f"from {', '.join(Path(name).name for name in files)}"]
    head += [f"left to do: {', '.join(missing)}", *remarks]
    lines = [f"# {' '.join(line.split())}" for line in head]
    return "\n".join(lines) + "\n" + stream.getvalue()
