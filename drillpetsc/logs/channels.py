"""Channels of a rig's log: their words and mnemonics, and the channel and unit that the heading of a column names."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache

from drillpetsc.units import DIMENSIONS, UnitError, to_si


@dataclass(frozen=True)
class Channel:
    """A channel of a log.

    unit: SI, empty for a flag and for clock time; words: in small letters without blanks and _ . - # /.
    """

    unit: str
    words: str
    assumed: str = ""  # unit of a column whose heading has none: its name is a unit


#: mnemonics are those of WITS record 1, WITSML 1.4.1.1 curves and of the usual exports
CHANNELS: dict[str, Channel] = {
    "time": Channel(
        "s", "time timeutc utc datetime dateandtime datetimeutc timestamp etim elapsedtime timeindex rigtime"
    ),
    "date": Channel("", "date dateutc yyyymmdd"),
    "bit_depth": Channel(
        "m", "bitdepth bitmd depthbit depthbitmd dbtm dbtmd bitmeasureddepth depthofbit bitposition bdep dbit"
    ),
    "hole_depth": Channel(
        "m", "holedepth holemd depthhole dmea totaldepth holemeasureddepth depthofhole tdmd hdep dhole dptot"
    ),
    "depth": Channel("m", "depth md dept measureddepth depthmd dmd depthindex depm"),
    "hook_load": Channel(
        "N",
        "hookload hkld hkla hkldav hookloadavg hookloadaverage avghookload weightonhook woh hklda hkli hook hl",
    ),
    "wob": Channel(
        "N",
        "wob weightonbit wobsurface swob surfacewob woba wobavg wobaverage surfaceweightonbit swoba bitweight",
    ),
    "wob_downhole": Channel("N", "wobdownhole downholewob dwob dhwob mwob cwob downholeweightonbit"),
    "torque": Channel(
        "N m",
        "torque torquesurface surfacetorque stor tq tqa trq rotarytorque torqueavg torqueaverage stra topdrivetorque "
        "tdtorque tdtq torq",
    ),
    "torque_downhole": Channel(
        "N m", "torquedownhole downholetorque dtor dhtq tob torqueonbit bittorque mtor ctor"
    ),
    "rpm": Channel(
        "rad/s",
        "rpm rotation surfacerpm rpmsurface rpma srpm rotaryspeed rotaryrpm rpmavg topdriverpm tdrpm topspeed",
        assumed="rpm",
    ),
    "bit_rpm": Channel(
        "rad/s", "bitrpm rpmbit bitspeed rpmdownhole downholerpm drpm collarrpm mrpm crpm", assumed="rpm"
    ),
    "flow_rate": Channel(
        "m^3/s",
        "flow flowrate flowin flowratein pumprate mudflow mudflowin mfia mfi flwi tflo pumpflow totalpumpoutput flowinrate "
        "mudflowinavg",
    ),
    "pump_pressure": Channel(
        "Pa", "spp sppa standpipepressure pumppressure standpipe sppavg pumppress standpipepressureavg"
    ),
    "rop": Channel("m/s", "rop ropa rateofpenetration ropavg ropinst ropi ropaverage onbottomrop"),
    "block_position": Channel(
        "m", "block blockposition blockheight bpos hookheight blockpos hookposition travelingblock"
    ),
    "mud_density": Channel(
        "kg/m^3", "muddensity muddensityin mudweight mudweightin mwin mdia densityin mudin"
    ),
    "in_slips": Channel("", "inslips slips slipsflag slipstatus slipsstatus slipstat"),
}
DEPTHS = ("bit_depth", "hole_depth", "depth")
READINGS = (
    "hook_load",
    "torque",
    "wob",
    "wob_downhole",
    "torque_downhole",
    "pump_pressure",
    "rpm",
    "bit_rpm",
    "flow_rate",
)
_CHANNEL_OF = {word: name for name, channel in CHANNELS.items() for word in channel.words.split()}
_IN_BRACKETS = re.compile(r"[\[({]\s*([^\])}]*?)\s*[\])}]")
_WINDOW = re.compile(r"(?:avg|average)?(\d+)(ft|m|s|sec|min)(?:avg|average)?$")
_GAUGE = re.compile(r"[\s_]*(of[\s_]+)?gauge$", re.IGNORECASE)
#: units as logs spell them -> as `to_si` reads them; a weight in tonnes or kkgf is a force, standard gravity 9.80665 m/s2
_SPELLED = {
    "kkgf": "tf", "1000 kgf": "tf", "tonf": "tf", "mton": "tf", "metric ton": "tf", "metric tons": "tf", "mt": "tf",
    "1000 lbf": "klbf", "klbm": "klbf", "1000 lb": "klbf", "kft.lbf": "kft lbf", "kft.lb": "kft lb", "kft-lb": "kft lb",
    "1000 ft lbf": "kft lbf", "knm": "kN m", "kn.m": "kN m", "1/min": "rpm", "c/min": "rpm", "f": "ft", "usft": "ftUS",
    "m3/min": "m^3/min", "galus/min": "gal/min", "gal/mn": "gal/min", "feet": "ft", "meters": "m", "metres": "m", "ftus": "ftUS",
    "sec": "s", "seconds": "s", "mins": "min", "minutes": "min", "hours": "h", "hr": "h", "hrs": "h", "dt": "", "unitless": "",
    "euc": "", "none": "", "-": "", "datetime": "", "date time": "",
}  # fmt: skip


@dataclass(frozen=True)
class Heading:
    """What the heading of a column says.

    channel: empty for one that is not used; unit: as `to_si` reads it, empty where the heading has none.
    window: length or time of an average, such as `1ft`; empty without.
    wrong: dimension that the unit has in the place of the channel's, in words; empty where they agree.
    """

    channel: str
    unit: str = ""
    window: str = ""
    wrong: str = ""


def folded(text: str) -> str:
    """A name in small letters without blanks and marks."""
    return re.sub(r"[\s_.#/\-\"':]", "", text).casefold()


@lru_cache(maxsize=4096)
def unit_of(text: str, si: str) -> str | None:
    """A unit as a log spells it in the spelling of `to_si`; empty for none, None for one of another dimension."""
    text = _GAUGE.sub("", text.strip().strip("[](){}")).strip()
    text = text.replace("_per_", "/").replace(" per ", "/")
    for plain in dict.fromkeys((text.replace("_", " "), text.replace("_", "/"))):  # ft_lbf and ft_h
        plain = _SPELLED.get(plain.casefold(), plain)
        if not plain:
            return ""
        try:
            to_si(f"1 {plain}", si)
        except UnitError:
            continue
        return plain
    return None


@lru_cache(maxsize=4096)
def dimension_of(text: str) -> str:
    """What a unit measures, in words, such as `a pressure`; empty for a text that is not a unit."""
    text = _GAUGE.sub("", text.strip()).strip()
    if not re.match(r"[A-Za-z°%]", text):
        return ""
    if text.casefold() == "hz":
        return "a frequency"
    return next((name.split(",")[0] for si, (name, _) in DIMENSIONS.items() if si and unit_of(text, si)), "")


def heading_of(title: str, unit: str | None = None) -> Heading:
    """The channel and the unit of a heading.

    unit: that a file gives beside the name (LAS, WITSML); None: it is in brackets, after an underscore or the last word.
    """
    if len(title) > 80:
        return Heading("")
    inside = _IN_BRACKETS.findall(title)
    name = _IN_BRACKETS.sub(" ", title)
    given = unit if unit else (inside[0] if inside else None)
    channel, window = _named(name)
    if channel:
        return _with_unit(channel, window, given or "")
    if given is None:
        tokens = [q for q in re.split(r"[_\s,;]+", name) if q]
        splits = [
            (*found, "_".join(tokens[first:]))
            for first in range(1, len(tokens))  # the longest unit first: ft_per_h before h
            if (found := _named("_".join(tokens[:first])))[0]
        ]
        read = [_with_unit(*split) for split in splits]
        good = [q for q in read if q.unit]
        other = [q for q, split in zip(read, splits, strict=True) if q.wrong and dimension_of(split[2])]
        if good or other:
            return (good or other)[0]
    return Heading("")


def _named(name: str) -> tuple[str, str]:
    """(channel, window of the average) of a name without its unit; empty texts for an unknown name."""
    short = folded(name)
    if short in _CHANNEL_OF:
        return _CHANNEL_OF[short], ""
    match = _WINDOW.search(short)
    if match and short[: match.start()] in _CHANNEL_OF:
        return _CHANNEL_OF[short[: match.start()]], match.group(1) + match.group(2)
    return "", ""


def _with_unit(channel: str, window: str, text: str) -> Heading:
    si = CHANNELS[channel].unit
    if not si:
        return Heading(channel, "", window)
    unit = unit_of(text, si)
    if unit is None:
        return Heading(channel, "", window, dimension_of(text) or f"in '{text}', an unknown unit")
    return Heading(channel, unit, window)
