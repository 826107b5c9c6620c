"""The `uncertain` command: quantiles of the outputs of roadmap or hydraulics from distributions of numbers of the case."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.analysis.sensitivities.command import USUAL, chosen_outputs
from drillpetsc.analysis.sensitivities.solution import Output
from drillpetsc.analysis.uncertain.beside_points import inside_band
from drillpetsc.analysis.uncertain.doubts import Drawn
from drillpetsc.analysis.uncertain.draws import correlation_of, draw
from drillpetsc.analysis.uncertain.limits import limits_of, passed
from drillpetsc.analysis.uncertain.linear import slopes_of
from drillpetsc.analysis.uncertain.responses import HydraulicsResponse, Response, RoadmapResponse
from drillpetsc.analysis.uncertain.spread import Spreads, spreads_of
from drillpetsc.analysis.uncertain.uncertain_keys import Uncertain, uncertain_keys
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.doubts import doubts_at
from drillpetsc.errors import CaseError
from drillpetsc.output.files.run_folder import UNCERTAIN_LIMITS_TABLE, UNCERTAIN_SHARES_TABLE, UNCERTAIN_TABLE
from drillpetsc.output.job import Job, RunResult
from drillpetsc.output.progress import counted
from drillpetsc.output.shown_units import shown_unit

SHOWN_EACH = 10  # samples of a part, after which progress is shown
LINEAR, MONTE_CARLO, BOTH = "linear", "monte-carlo", "both"


@dataclass(frozen=True)
class Question:
    """What is sampled.

    analysis: roadmap or hydraulics; outputs: names, none: the usual ones; method: linear, monte-carlo or both.
    samples: of each number; seed: of the samples; levels: probabilities of the quantiles, ascending.
    """

    analysis: str
    outputs: Sequence[str]
    method: str = MONTE_CARLO
    samples: int = 500
    seed: int = 1
    levels: tuple[float, ...] = (0.1, 0.5, 0.9)


def run_uncertain(job: Job, question: Question, notes: Sequence[str] = ()) -> RunResult:
    """Sample, compute all outputs, write uncertain.csv, uncertain_limits.csv, uncertain_shares.csv and summary.json (collective).

    notes: what was left out before.  Raises CaseError for a distribution that cannot be, and for an output that the case does not have.
    """
    case = job.case
    keys = uncertain_keys(case)
    names = [key.name for key in keys]
    draws = _draws(keys, question)
    with options_of(case):
        kind = HydraulicsResponse if question.analysis == "hydraulics" else RoadmapResponse
        response = kind(case, keys)
        usual = _usual(response, question.analysis)
        chosen = chosen_outputs(response.outputs, response.base, question.outputs, usual)
        found, kinks, limits = _found(job, question, response, keys, draws)
    outputs, base = [response.outputs[i] for i in chosen], response.base[chosen]
    named = list(dict.fromkeys(names))
    found = [_summed(spread.of(chosen), names) for spread in found]
    band = len(question.levels) > 1
    points = inside_band(case, outputs, found[0].quantiles) if band else []
    drawn = Drawn(case, question.levels, outputs, found, kinks, question.samples)
    rows = [
        row
        for spread in found
        for i, output in enumerate(outputs)
        for row in _rows(output, float(base[i]), spread, i, question.levels)
    ]
    shares = [
        _head(output, spread) | {"key": name, "share": float(spread.shares[i, k])}
        for spread in found
        for i, output in enumerate(outputs)
        for k, name in enumerate(named)
    ]
    summary = {
        "title": case.title,
        "analysis": question.analysis,
        "method": question.method,
        "samples": question.samples,
        "seed": question.seed,
        "levels": list(question.levels),
        "keys": [_described(case, key) for key in {key.name: key for key in keys}.values()],
        "failed": max((int(spread.failed.max()) for spread in found if spread.failed.size), default=0),
        "measured": points,
        "units": case.shown_units,
        "warnings": doubts_at(drawn, "warning"),
        "notes": [*notes, *response.notes, *doubts_at(drawn, "remark")],
    }
    tables = {UNCERTAIN_TABLE: rows, UNCERTAIN_LIMITS_TABLE: limits, UNCERTAIN_SHARES_TABLE: shares}
    lines = _lines(case, named, outputs, found, question, summary, limits)
    return job.result(job.make_folder(), summary, lines, tables)


def _draws(keys: Sequence[Uncertain], question: Question) -> FloatArray:
    """(n, k) samples of the numbers; CaseError for correlations that cannot be, and for too few samples."""
    names, spreads = [key.name for key in keys], [key.spread for key in keys]
    try:
        correlation = correlation_of(names, spreads)
    except ValueError as error:
        raise CaseError(at="uncertain", want=f"one correlation of each pair of keys: {error}") from None
    if question.samples < 2 * len(keys):  # fewer cannot be freed of correlations of their own
        want = f"at least {2 * len(keys)}, twice the count of uncertain numbers"
        count = sum(key.path is not None for key in keys)
        want += f", of which the path of the survey has {count}" if count else ""
        raise CaseError(at="--samples", got=question.samples, want=want)
    return draw(spreads, correlation, question.samples, question.seed)


def _usual(response: Response, analysis: str) -> tuple[str, ...]:
    """Names of the outputs by default: measured hook loads include the block if its weight is given."""
    names = {output.quantity.name for output in response.outputs}
    usual = USUAL[analysis]
    return tuple("hook_load_total" if q == "hook_load" and "hook_load_total" in names else q for q in usual)


def _found(
    job: Job, question: Question, response: Response, keys: Sequence[Uncertain], draws: FloatArray
) -> tuple[list[Spreads], list[str], list[dict[str, Any]]]:
    """Statistics of all outputs by each method that is wanted, the keys with a kink beside their value, and the limits passed (collective)."""
    out: list[Spreads] = []
    kinks: list[str] = []
    limits, rows = limits_of(job.case, response.outputs), list[dict[str, Any]]()
    if question.method in (MONTE_CARLO, BOTH):
        values = _shared_out(job.comm, response, draws)
        out.append(spreads_of(MONTE_CARLO, draws, values, question.levels))
        rows += passed(limits, response.outputs, values, MONTE_CARLO)
    if question.method in (LINEAR, BOTH):
        slopes, kinks = slopes_of(job.case, question.analysis, response, keys, job.comm)
        here = np.array([key.value for key in keys])
        values = response.base + (draws - here) @ slopes.T
        out.append(spreads_of(LINEAR, draws, values, question.levels, slopes))
        rows += passed(limits, response.outputs, values, LINEAR)
    return out, kinks, rows


def _shared_out(comm: Any, response: Response, draws: FloatArray) -> FloatArray:
    """(n, m) outputs at all samples, which the ranks share out; the same on any number of ranks (collective)."""
    own = draws[comm.rank :: comm.size]
    parts = counted(np.array_split(own, max(len(own) // SHOWN_EACH, 1)), "parts of the samples", comm.rank)
    mine = np.concatenate([response.values(part) for part in parts])
    out = np.empty((len(draws), mine.shape[1]))
    for rank, part in enumerate(comm.tompi4py().allgather(mine)):
        out[rank :: comm.size] = part
    return out


def _summed(spread: Spreads, names: Sequence[str]) -> Spreads:
    """With the shares of each key: a path has several numbers."""
    mine = [[q == name for q in names] for name in dict.fromkeys(names)]
    return replace(spread, shares=np.stack([spread.shares[:, q].sum(axis=1) for q in mine], axis=1))


def _head(output: Output, spread: Spreads) -> dict[str, Any]:
    return {"output": output.name, "bit_depth": output.bit_depth, "method": spread.method}


def _rows(
    output: Output, value: float, spread: Spreads, i: int, levels: Sequence[float]
) -> list[dict[str, Any]]:
    """Rows of uncertain.csv of an output, one for each quantile."""
    head = _head(output, spread) | {
        "output_unit": output.quantity.unit,
        "value": value,
        "mean": float(spread.mean[i]),
        "deviation": float(spread.deviation[i]),
        "failed": int(spread.failed[i]),
    }
    return [
        head | {"probability": level, "quantile": float(q)}
        for level, q in zip(levels, spread.quantiles[i], strict=True)
    ]


def _described(case: Case, key: Uncertain) -> dict[str, Any]:
    spread = key.spread
    if key.path is not None:
        error = (case.uncertain or {})[key.name].path
        return {"key": key.name, "path": {} if error is None else error.model_dump()}
    return {"key": key.name, "unit": key.unit, "value": key.value, spread.form: list(spread.numbers)}


# ---------------------------------------------------------------------- screen
def _lines(
    case: Case,
    names: Sequence[str],
    outputs: Sequence[Output],
    found: Sequence[Spreads],
    question: Question,
    summary: dict[str, Any],
    limits: Sequence[dict[str, Any]],
) -> list[str]:
    system = case.shown_units
    lines = [f"{case.title or 'case'}: uncertain {question.analysis}, {question.samples} samples"]
    deepest = max((o.bit_depth for o in outputs), default=np.nan)
    words = "".join(f"{f'P{100 * level:.4g}':>11}" for level in question.levels)
    lines.append(f"  {'':<42}{'method':<12}{words}   share of the variance")
    for i, output in enumerate(outputs):
        elsewhere = output.bit_depth == output.bit_depth and output.bit_depth != deepest
        if elsewhere or not any(np.isfinite(spread.shares[i]).any() for spread in found):
            continue  # of outputs that vary
        size, unit = shown_unit(output.quantity.name, output.quantity.unit, system)
        for spread in found:
            numbers = "".join(f"{q / size:>11.5g}" for q in spread.quantiles[i])
            order = np.argsort(-np.nan_to_num(spread.shares[i], nan=-np.inf))
            named = [
                f"{names[k]} {100 * spread.shares[i, k]:.0f} %"
                for k in order[:3]
                if spread.shares[i, k] > 0.005
            ]
            name = f"{output.name} [{unit or '-'}]"
            lines.append(f"  {name:<42}{spread.method:<12}{numbers}   {', '.join(named)}".rstrip())
    likely = [q for q in limits if q["beyond"] > 0 and q["method"] == limits[0]["method"]]
    for row in [q for q in likely if q["bit_depth"] != q["bit_depth"] or q["bit_depth"] == deepest]:
        name, _, _ = row["output"].rpartition(".")
        lines.append(
            f"  {': '.join(filter(None, [name, row['meaning']]))} in {row['beyond']:.1%} of the samples"
        )
    measured = [point["inside"] for point in summary["measured"]]
    if measured:
        low, high = (f"P{100 * question.levels[i]:.4g}" for i in (0, -1))
        lines.append(f"  {sum(measured)} of {len(measured)} measured values lie between {low} and {high}")
    return lines
