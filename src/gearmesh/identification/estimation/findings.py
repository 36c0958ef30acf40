"""All results of the identification as one mapping: the content of `config/identified.yaml`."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from gearmesh.identification.estimation import (
    inference,
    prediction,
    sensitivity,
    synthetic,
)
from gearmesh.identification.estimation.analysis import Analysis, Family
from gearmesh.identification.estimation.inference import effective_size
from gearmesh.identification.factors import KINDS
from gearmesh.identification.sampling.store import Samples
from gearmesh.reproduction.claims import REPRODUCED

SURVEY, NATURAL, TRUTH = "survey", "natural", "truth"
"""Even designs: the plausible space, the natural reading, synthetic papers."""

BESIDE = "beside"
RUN_OUT = {"with friction": "run_out", "without friction": "run_out_alone"}
"""Designs beside the study: one parameter at a time, and run-out."""

CUTS = 50
"""Random cuts of the claims into two halves."""

THRESHOLDS = (
    "F2.3|near 0.66",
    "F2.3|near 0.8",
    "F2.5|beyond the jump",
    "F2.6",
    "F3.1|y_max",
    "F3.2|end",
    "F3.4|ratio",
    "F4.1|0.60",
    "F4.1|1.05",
    "F4.1|1.20",
    "F6.1|from",
    "F6.1|to",
    "F6.2|5k",
    "F2.1|c-material",
    "F2.2|c",
)
"""Measured values whose sensitivity is computed; each stands for all its variants."""


def findings(analysis: Analysis) -> dict[str, object]:
    """Return all findings, ready for YAML."""
    survey, natural = analysis.family(SURVEY), analysis.family(NATURAL)
    return {
        "samples": {
            name: int(np.sum(analysis.samples.design == name)) for name in analysis.settings.designs
        },
        "boxes": {name: _rounded(box.volume) for name, box in analysis.boxes.items()},
        "claims": claims_table(analysis, survey, natural),
        "joint": {
            "plausible": _joint(analysis, survey),
            "natural": _joint(analysis, natural),
        },
        "regions": {
            "plausible": regions(analysis, survey),
            "natural": regions(analysis, natural),
        },
        "sensitivity": sensitivities(analysis),
        "prediction": predictions(analysis, survey),
        "recovery": recoveries(analysis, survey),
        "beside": beside(analysis),
        "run-out": {words: run_out(analysis, name) for words, name in RUN_OUT.items()},
    }


def claims_table(analysis: Analysis, survey: Family, natural: Family) -> dict[str, object]:
    """Return the share of the plausible space in which each claim holds."""
    even = analysis.samples.of(SURVEY)
    found: dict[str, Any] = {}
    held_even, held_natural = analysis.held(even), analysis.held(natural.samples)
    held = analysis.held(survey.samples)
    evidence = analysis.evidence(survey)
    for name in analysis.claims:
        value, error = inference.share(held_even[name], np.ones(even.design.size))
        others = [other for other in evidence if other != name]
        fit = analysis.fit(survey, others)
        found[name] = {
            "share": _rounded(value),
            "error": _rounded(error),
            "standing": inference.standing(value),
            "natural": _rounded(inference.share(held_natural[name], natural.prior)[0]),
            "given the others": _rounded(inference.predictive(held[name], fit)),
        }
    return found


def _joint(analysis: Analysis, family: Family) -> dict[str, object]:
    held = analysis.held(family.samples)
    return {
        "all": _share_of(np.all(list(held.values()), axis=0), family.prior),
        "largest": [
            {"missing": list(missing)} | _share_of(meets, family.prior)
            for missing, meets in inference.joint_sets(held, family.prior)
        ],
    }


def _share_of(meets: np.ndarray, prior: np.ndarray) -> dict[str, object]:
    """Return how much of the prior some samples are, and how many they are, also in effect."""
    value, error = inference.share(meets, prior)
    return {
        "share": _rounded(value),
        "error": _rounded(error),
        "samples": int(meets.sum()),
        "in effect": _rounded(effective_size(prior * meets)),
    }


def regions(analysis: Analysis, family: Family) -> dict[str, object]:
    """Return the region of each factor that the largest set of compatible claims allows."""
    evidence = analysis.evidence(family)
    fit = analysis.fit(family, evidence)
    table: dict[str, object] = {}
    for factor in family.factors:
        places = family.samples.places[factor]
        if factor == "kind":
            values = family.samples.values[factor]
            table[factor] = {
                kind: _rounded(float(fit.weights @ (values == i))) for i, kind in enumerate(KINDS)
            }
            continue
        bounds = analysis.settings.ranges[factor]
        low, high = inference.region(places, fit.weights)
        inner = inference.region(places, fit.weights, 0.5)
        meets = places[fit.weights > 0]
        table[factor] = {
            "prior": [bounds.low, bounds.high],
            "region": [_rounded(bounds.value(low)), _rounded(bounds.value(high))],
            "half": [_rounded(bounds.value(place)) for place in inner],
            "met": [_rounded(bounds.value(float(end))) for end in (meets.min(), meets.max())],
            "of the prior": _rounded(high - low),
            "shape": [_rounded(part) for part in inference.shape(places, fit.weights)],
        }
    return {
        "without": [name for name in analysis.claims if name not in evidence],
        "forgiven": fit.forgiven,
        "samples": _rounded(fit.size),
        "factors": table,
    }


def sensitivities(analysis: Analysis) -> dict[str, object]:
    """Return the sensitivity of each threshold to each factor, over the plausible space."""
    even = analysis.samples.of(SURVEY)
    factors = analysis.settings.designs[SURVEY].vary
    found: dict[str, Any] = {}
    for column in _threshold_columns(even):
        values = even.measured[column]
        found[column] = {}
        for factor in factors:
            slices = len(KINDS) if factor == "kind" else sensitivity.SLICES
            index = sensitivity.index(even.places[factor], values, slices)
            found[column][factor] = {
                "index": _rounded(index.value),
                "low": _rounded(index.low),
                "high": _rounded(index.high),
                "chance": _rounded(index.chance),
            }
    return found


def _threshold_columns(samples: Samples) -> list[str]:
    return [
        column
        for name in THRESHOLDS
        for column in samples.measured
        if column == name or column.startswith(f"{name}|")
    ]


def predictions(analysis: Analysis, family: Family) -> dict[str, object]:
    """Return how well one half of the claims predicts the other half."""
    weight = analysis.weights(family.samples)
    evidence = analysis.evidence(family)
    cuts = prediction.halves(evidence, analysis.settings.together, CUTS, seed=1)
    made = []
    for first, second in cuts:
        for fitted, held_out in ((first, second), (second, first)):
            made.append(
                prediction.predict(
                    fitted, held_out, weight, analysis.stated, family.samples.measured, family.prior
                )
            )
    covered = [hit for p in made for hit in p.covered.values()]
    narrowed = [width for p in made for width in p.narrowed.values()]
    uncertain = [
        (p.before[name], p.after[name])
        for p in made
        for name in p.after
        if p.before[name] < inference.ROBUST_FROM
    ]
    return {
        "fits": len(made),
        "gain in bits": _rounded(_mean([p.gain for p in made])),
        "helped": _rounded(_mean([p.gain > 0 for p in made])),
        "conditional claims": {
            "before": _rounded(_mean([before for before, _ in uncertain])),
            "after": _rounded(_mean([after for _, after in uncertain])),
        },
        "numbers": {
            "level": prediction.COVERED,
            "covered": _rounded(_mean(covered)),
            "width": _rounded(_mean(narrowed)),
        },
    }


def recoveries(analysis: Analysis, family: Family) -> dict[str, object]:
    """Return how well the parameters of synthetic papers are found."""
    truths = analysis.samples.of(TRUTH)
    made = []
    for i in range(truths.design.size):
        made.append(
            synthetic.recover(
                {name: float(values[i]) for name, values in truths.measured.items()},
                {name: float(truths.places[name][i]) for name in family.factors},
                analysis.stated,
                family.samples.measured,
                family.samples.places,
                family.prior,
            )
        )
    return {
        "papers": len(made),
        "recovered": sum(one.recovered for one in made),
        "level": inference.LEVEL,
        "factors": {
            name: {
                "inside": sum(one.inside[name] for one in made),
                "width": _rounded(float(np.median([one.width[name] for one in made]))),
            }
            for name in family.factors
        },
        "samples": _rounded(float(np.median([one.found.size for one in made]))),
        "forgiven": _rounded(float(np.median([one.found.forgiven for one in made]))),
    }


def beside(analysis: Analysis) -> dict[str, object]:
    """Return how far each parameter alone may be moved from its value in the study.

    Up to there, all claims hold that the ledger expects to be reproduced.
    """
    samples = analysis.samples.of(BESIDE)
    held = analysis.held(samples)
    expected = [c.id for c in analysis.ledger if c.expected_status == REPRODUCED]
    found: dict[str, Any] = {}
    for factor in analysis.settings.designs[BESIDE].vary:
        moved = np.flatnonzero(np.isfinite(samples.places[factor]))
        values = samples.values[factor]
        others = values[np.isnan(samples.places[factor])]
        order = moved[np.argsort(values[moved])]
        below = order[values[order] <= others[0]][::-1]
        above = order[values[order] > others[0]]
        found[factor] = {
            side: _reach(values, order, held, expected)
            for side, order in (("down", below), ("up", above))
        }
    return found


def _reach(
    values: np.ndarray,
    order: np.ndarray,
    held: Mapping[str, np.ndarray],
    expected: Sequence[str],
) -> dict[str, object]:
    """Return the last value, in the order of the samples, at which all expected claims hold.

    The claims that fail at the next sample are listed too.
    """
    last = None
    for i in order:
        failing = [name for name in expected if not held[name][i]]
        if failing:
            return {"to": last, "then fail": failing}
        last = _rounded(float(values[i]))
    return {"to": last, "then fail": []}


def run_out(analysis: Analysis, design: str) -> dict[str, object]:
    """Return for each claim the larger eccentricity in y_st up to which it always holds."""
    samples = analysis.samples.of(design)
    larger = np.maximum(samples.values["eccentricity_3"], samples.values["eccentricity_2"])
    found: dict[str, Any] = {}
    for name, held in analysis.held(samples).items():
        fails = larger[~held]
        below = larger[larger < fails.min()] if fails.size else larger
        found[name] = _rounded(float(below.max())) if below.size else 0.0
    return found


def _mean(values: Sequence[float]) -> float:
    return float(np.mean(values)) if values else float("nan")


def _rounded(value: float) -> float | None:
    """Keep four significant digits, as the samples are no more accurate; None if not finite."""
    return float(f"{value:.4g}") if np.isfinite(value) else None
