"""What the datasets say in numbers: the answers of the report, and the mechanisms of claims."""

import math
from collections import Counter, defaultdict
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from gearmesh.errors import NoOrbit
from gearmesh.reproduction.mechanisms.bands import NEAR_FIRST_JUMP, band
from gearmesh.reproduction.mechanisms.bands import VARIANTS as BANDED
from gearmesh.reproduction.mechanisms.long_runs import shares
from gearmesh.reproduction.mechanisms.starts import JUMPED, VARIANT
from gearmesh.reproduction.mechanisms.sweeps import DIRECTIONS, SEPARATE
from gearmesh.reproduction.mechanisms.tables import Row
from gearmesh.study.pair import Pair

KINDS = ("switching", "flip", "grazing_front", "grazing_back", "fold", "torus", "branch_point")
"""Kinds of special points in the order of the table."""

_CLOSE = 2e-3  # in ν_s, to an end of a stable piece of a branch
_HALF = 0.5  # of the starting phases


class Points:
    """The special points of a study, by variant, kind and place along the branch."""

    def __init__(self, rows: Sequence[Row]) -> None:
        self._rows = [row for row in rows if "parameters" not in row]

    def of(self, variant: str, kind: str, periods: int = 1) -> list[float]:
        """Return the ν_s of the points of one kind, ascending."""
        chosen = {"variant": variant, "kind": kind, "periods": periods}
        return sorted(
            row["nu"] for row in self._rows if all(row[k] == v for k, v in chosen.items())
        )

    def first(self, variant: str, kind: str) -> float:
        """Return the lowest ν_s of a kind; not-a-number if there is none."""
        return next(iter(self.of(variant, kind)), np.nan)

    def last(self, variant: str, kind: str) -> float:
        """Return the highest ν_s of a kind; not-a-number if there is none."""
        return next(reversed(self.of(variant, kind)), np.nan)


def special_table(rows: Sequence[Row]) -> list[tuple[str, str, int, list[str], list[str]]]:
    """Return the special points as rows of a table.

    Returns
    -------
    list of tuple
        Variant, kind, period, and the ν_s to ten digits: with the parameters of the study, and
        without friction on rigid supports. Points that agree in ten digits are listed once.
    """
    order = {name: i for i, name in enumerate(dict.fromkeys(row["variant"] for row in rows))}
    found: dict[tuple[str, str, int], tuple[list[str], list[str]]] = {}
    for row in rows:
        key = row["variant"], row["kind"], row["periods"]
        columns = found.setdefault(key, ([], []))
        columns["parameters" in row].append(f"{row['nu']:.10f}")
    ordered = sorted(found, key=lambda key: (order[key[0]], key[2], KINDS.index(key[1])))
    return [(*key, sorted(set(found[key][0])), sorted(set(found[key][1]))) for key in ordered]


def answers(
    rows: Sequence[Row],
    datasets: Mapping[str, xr.Dataset],
    thresholds: Mapping[str, Any],
    pair: Pair,
) -> dict[str, Any]:
    """Return the numbers of the eight questions, by name; not-a-number where a study has none.

    Parameters
    ----------
    rows : sequence of dict
        `special_points.json`.
    datasets : mapping
        `branches` and the datasets of `gearmesh.data.paths.MECHANISMS`, by name.
    thresholds : mapping
        `thresholds.json`: what five revolutions make of it.
    pair : Pair
        The pair of the study.
    """
    points = Points(rows)
    return {
        "points": points,
        "five_of": lambda observable, name: _threshold(thresholds, observable, name),
        "five_of_jump": lambda name: _first_jump(thresholds, name),
        "doubled": _doubled(datasets["branches"], points),
        "windows": windows(datasets["phases"], datasets["branches"]),
        "basins": _shares(datasets["basins"]),
        "sweep": _sweep_jumps(datasets["sweeps"]),
        "decay": lambda nu: time_constant(pair, VARIANT, nu),
        "bands": _bands(datasets["bands"], thresholds),
        "changes": _changes(datasets["bands"]),
        "cusps": _cusps(datasets["special_curves"]),
        "switching": lambda ratio: _on_curve(datasets["special_curves"], "switching", ratio),
        "chaos": _chaos(datasets["lyapunov"]),
        "contact_up_to": _contact_up_to(datasets["special_curves"]),
        "map": _map(datasets["design_map"]),
        "ends": shares(datasets["attractors"], pair.revolutions * pair.teeth_3),
        "ended": datasets["attractors"].attrs,
    }


def _threshold(thresholds: Mapping[str, Any], observable: str, name: str) -> float:
    found = thresholds.get(observable, {}).get(name)
    return found if isinstance(found, float) else np.nan


def _first_jump(thresholds: Mapping[str, Any], name: str) -> float:
    """Return where five revolutions of a variant with □ or × jump first."""
    found = thresholds.get("jumps", {}).get(name)
    return float(found[0]["nu"]) if isinstance(found, list) and found else np.nan


def _doubled(branches: xr.Dataset, points: Points) -> dict[str, float]:
    """Return down to which ν_s the orbit of period 2 from the upper flip is stable, by variant.

    That is the fold or the flip at which the stable piece of its branch ends; not-a-number if it
    reaches beyond the range.
    """
    found = {}
    double = branches.isel(point=np.flatnonzero(branches["periods"] == 2))
    for name in dict.fromkeys(map(str, double["variant"].values)):
        own = double.isel(point=np.flatnonzero(double["variant"] == name)).sortby("nu")
        nu, number = own["nu"].values, own["branch"].values
        born = [
            i
            for i in set(number)
            if abs(nu[number == i].max() - points.last(name, "flip")) < _CLOSE
        ]
        own = own.isel(point=np.flatnonzero(np.isin(number, born)))
        if not born:
            continue
        stable = own["nu"].values[own["stability"].values == 1]
        ends = points.of(name, "fold", 2) + points.of(name, "flip", 2)
        passed = [end for end in ends if stable.size and end < stable.max()]
        # The stable piece that holds the greatest ν_s ends where no stable orbit is just below.
        found[name] = max(
            (end for end in passed if not ((stable < end) & (stable > end - _CLOSE)).any()),
            default=np.nan,
        )
    return found


def windows(phases: xr.Dataset, branches: xr.Dataset) -> list[dict[str, Any]]:
    """Return the ranges of ν_s in which at least half of all starting phases lose contact.

    Returns
    -------
    list of dict
        `from` and `to` (ends of the range), `all` (the values of ν_s at which every phase does),
        `last` (whether the range reaches the end of what was computed), and `periods`, the period
        of the stable orbit that is nearest to most of these runs after the longest time.
    """
    first, late = phases.isel(revolutions=0), phases.isel(revolutions=-1)
    nu, share = first["nu"].values, first["share"].values
    inside = np.concatenate([[False], share >= _HALF, [False]])
    ends = np.flatnonzero(np.diff(inside)).reshape(-1, 2)
    found = []
    for low, high in ((low, high - 1) for low, high in ends):
        reached = [
            _nearest_period(branches, late.isel(nu=i))
            for i in range(low, high + 1)
            if late["share"].values[i] > 0.0
        ]
        held = nu[low : high + 1]
        whole = held[share[low : high + 1] == 1.0]
        found.append(
            {
                "from": float(held[0]),
                "to": float(held[-1]),
                "all": (float(whole[0]), float(whole[-1])) if whole.size else None,
                "last": bool(high == nu.size - 1),
                "periods": Counter(reached).most_common(1)[0][0] if reached else 0,
            }
        )
    return found


def _nearest_period(branches: xr.Dataset, runs: xr.Dataset) -> int:
    """Return the period of the stable orbit whose y_max is nearest to that of most runs."""
    lost = runs["contact_loss_fraction"].values >= JUMPED
    middle = float(np.median(runs["y_max_rel"].values[lost]))
    stable = (branches["variant"] == VARIANT) & (branches["stability"] == 1)
    points = branches.isel(point=np.flatnonzero(stable))
    number = points["branch"].values
    at, nearest, period = float(runs["nu"]), math.inf, 0
    for branch in np.unique(number):
        own = points.isel(point=np.flatnonzero(number == branch)).sortby("nu")
        y_max = np.interp(at, own["nu"], own["y_max_rel"], left=math.inf, right=math.inf)
        if abs(y_max - middle) < nearest:
            nearest, period = abs(y_max - middle), int(own["periods"][0])
    return period


def _shares(basins: xr.Dataset) -> list[tuple[float, list[float]]]:
    """Return ν_s and the share of the starts of each basin that lead to each motion, in %."""
    reached = basins["reached"].values.reshape(basins.sizes["nu"], -1)
    return [
        (float(nu), [100.0 * float((row == kind).mean()) for kind in range(3)])
        for nu, row in zip(basins["nu"].values, reached, strict=True)
    ]


def _sweep_jumps(sweeps: xr.Dataset) -> dict[str, dict[str, float]]:
    """Return where each sweep makes its greatest step of y_max; not-a-number without a jump.

    With • only the second jump is looked for: what is above the first one.
    """
    found: dict[str, dict[str, float]] = defaultdict(lambda: dict.fromkeys(DIRECTIONS, np.nan))
    for name in map(str, sweeps["variant"].values):
        for direction in map(str, sweeps["direction"].values):
            low = NEAR_FIRST_JUMP[1] if name.endswith("lubricant") else 0.0
            curve = sweeps["y_max_rel"].sel(variant=name, direction=direction)
            curve = curve.isel(nu=np.flatnonzero(curve["nu"] > low))
            nu, steps = curve["nu"].values, np.abs(np.diff(curve.values))
            at = int(np.nanargmax(steps))
            jump = float(0.5 * (nu[at] + nu[at + 1])) if steps[at] > SEPARATE else np.nan
            found[name][direction] = jump
    return found


def time_constant(pair: Pair, variant: str, nu: float) -> float:
    """Return the mesh periods in which a deviation in the mesh from the stable orbit falls by e.

    Two of the four multipliers belong to the bodies on their bearings. Heavy bodies move alone, so
    their two have the size exp(-ζ w T), with the body's natural frequency w; they are left out.
    The result is not-a-number if there is no stable orbit of the mesh period.
    """
    # numba is loaded at the first orbit: code that only reads results imports this module, too.
    from gearmesh.interface.orbits import find_orbit

    try:
        orbit = find_orbit(pair, variant, nu)
    except NoOrbit:
        return math.nan
    if not orbit.stable:
        return math.nan
    problem = orbit.reduced.problem
    frequency = math.sqrt(problem.bearing_stiffness / problem.body_mass)
    body = math.exp(-problem.bearing_damping_ratio * frequency * 2.0 * math.pi / nu)
    sizes = sorted(np.abs(orbit.multipliers), key=lambda size: abs(size - body))
    return float(-1.0 / math.log(max(sizes[2:])))


def _bands(bands: xr.Dataset, thresholds: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return spreads and edges of the bands of each variant after 5, 50 and 500 revolutions."""
    found = []
    for name in (name for name in BANDED if name in bands["variant"].values):
        for count in bands["revolutions"].values:
            curve = bands.sel(variant=name, revolutions=count)
            names = ("nu", "y_max_rel", "y_min_rel", "spread_rel")
            nu, high, low, spread = (curve[key].values for key in names)
            end = _threshold(thresholds, "second_jump", name)
            measured = band(nu, high, low, spread, end)
            found.append({"variant": name, "revolutions": int(count), **measured})
    return found


def _changes(bands: xr.Dataset) -> list[tuple[float, float]]:
    """Return the steps in ν_s, and the change of single maxima over them, as a median."""
    if not bands.sizes["variant"]:
        return []
    median = np.median(bands["change_rel"].values, axis=0)
    return list(zip(bands["step"].values.tolist(), median.tolist(), strict=True))


def _cusps(curves: xr.Dataset) -> dict[tuple[str, str], tuple[float, float]]:
    """Return (variant, parameter) -> ν_s and the parameter at the cusp of the folds."""
    ordinates = {"damping": "damping_ratio", "damping_length": "damping_length_rel"}
    cusps = curves.isel(point=np.flatnonzero(curves["cusp"] == 1))
    return {
        (str(name), str(parameter)): (float(nu), float(cusps[ordinates[parameter]].values[i]))
        for i, (name, parameter, nu) in enumerate(
            zip(*(cusps[key].values for key in ("variant", "parameter", "nu")), strict=True)
        )
    }


def _on_curve(curves: xr.Dataset, kind: str, ratio: float) -> float:
    """Return the ν_s of the special points of c-□ at a damping ratio, along their curve."""
    own = (curves["variant"] == "c-material") & (curves["kind"] == kind)
    chosen = curves.isel(point=np.flatnonzero(own)).sortby("damping_ratio")
    if not chosen.sizes["point"]:
        return np.nan
    ratios = chosen["damping_ratio"].values
    return float(np.interp(ratio, ratios, chosen["nu"].values, left=np.nan, right=np.nan))


def _chaos(lyapunov: xr.Dataset) -> dict[str, float]:
    """Return where the motion is chaotic: its greatest exponent is above three errors and 0.005."""
    nu = lyapunov["nu"].values
    greatest, error = (lyapunov[f"{name}_rel"].values[:, 0] for name in ("exponents", "errors"))
    chaotic = greatest > np.maximum(3.0 * error, 0.005)
    top = int(np.nanargmax(greatest))
    return {
        "share": 100.0 * float(chaotic.mean()),
        "lowest": float(nu[chaotic].min()) if chaotic.any() else np.nan,
        "highest": float(nu[chaotic].max()) if chaotic.any() else np.nan,
        "greatest": float(greatest[top]),
        "at": float(nu[top]),
    }


def _contact_up_to(curves: xr.Dataset) -> dict[str, float]:
    """Return the damping ratio above which an orbit with □ never loses contact, by its letter."""
    own = (curves["kind"] == "grazing_front") & (curves["parameter"] == "damping")
    found = {}
    for letter in "bc":
        chosen = own & (curves["variant"] == f"{letter}-material")
        ratios = curves["damping_ratio"].values[chosen.values]
        found[letter] = float(ratios.max()) if ratios.size else np.nan
    return found


def _map(design_map: xr.Dataset) -> dict[str, dict[str, float]]:
    """Return the shares of the cells of the design map, in %, for each place of the damping."""
    measures: dict[str, Callable[[xr.Dataset], xr.DataArray]] = {
        "contact": lambda cells: cells["state"] == 0,
        "back_flank": lambda cells: cells["state"] == 2,
        "several": lambda cells: cells["several"] == 1,
    }
    return {
        str(place): {
            name: 100.0 * float(measure(design_map.sel(place=place)).mean())
            for name, measure in measures.items()
        }
        for place in design_map["place"].values
    }
