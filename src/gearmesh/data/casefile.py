"""One case in one NetCDF file: how it is laid out, written and read.

`FIELDS` is the layout. A `Record` holds a case as its file does: variable name -> array, so what
is read from a file is written again with the same bytes. A file states in its attributes how it
was made (`attributes`). Manifests show whether it is still as it was written
(`gearmesh.data.manifest`).
"""

import functools
import hashlib
import itertools
from collections.abc import Container, Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.data import classic, provenance
from gearmesh.data.classic import Variable
from gearmesh.model.problem import Problem
from gearmesh.solvers.loads import loads
from gearmesh.solvers.ramps import by_speed
from gearmesh.solvers.response import STATUSES, Response
from gearmesh.study.cases import Case
from gearmesh.study.pair import Pair

REGIMES = {1: "normal_mesh", 0: "contact_loss", -1: "inverse_mesh"}
NO_EXTREMUM = 0
EXTREMUM_KINDS = {1: "maximum", -1: "minimum", NO_EXTREMUM: "none"}

Record = dict[str, np.ndarray]
"""A case as its file holds it: variable name -> array."""

MISSING = -1
"""Value of an integer that does not exist."""


@dataclass(frozen=True, slots=True)
class Field:
    """One variable of a case file; one in mm has a twin in y_st, with ``_rel`` in its name.

    Attributes
    ----------
    name : str
        Name; also that of the attribute of `Response` (or of its samples) that it holds.
    dimension : str
        ``"extremum"``, ``"boundary"``, ``"sample"``, or empty for a scalar.
    unit : str
        Unit in the file.
    long_name : str
        What it is.
    kind : str
        NumPy type.
    flags : mapping of int to str
        Values and meanings of a CF flag variable.
    fill : float
        Value of an integer that does not exist; a float is then not-a-number.
    """

    name: str
    dimension: str
    unit: str
    long_name: str
    kind: str = "f8"
    flags: Mapping[int, str] | None = None
    fill: float | None = None

    @property
    def relative(self) -> str | None:
        """Name of the twin in static deflections."""
        return f"{self.name}_rel" if self.unit == "mm" else None


_V = "dy/dtau_s (tau_s = Omega_s t)"

FIELDS = (
    Field("extremum_time", "extremum", "s", "time of a local extremum of y, from the start"),
    Field("extremum_y", "extremum", "mm", "relative motion y at its local extremum"),
    Field("extremum_kind", "extremum", "1", "kind of a local extremum", "i1", EXTREMUM_KINDS),
    Field("strobe_y", "boundary", "mm", "relative motion y after n mesh periods"),
    Field("strobe_v", "boundary", "mm", f"relative velocity {_V} after n mesh periods"),
    Field("y_max", "", "mm", "maximum of y over the kept revolutions"),
    Field("y_min", "", "mm", "minimum of y over the kept revolutions"),
    Field("y_rms", "", "mm", "root mean square of y over the kept revolutions"),
    Field("y_max_error", "", "mm", "estimated integration error of y_max"),
    Field("y_min_error", "", "mm", "estimated integration error of y_min"),
    Field("contact_loss_fraction", "", "1", "share of the kept time with contact loss"),
    Field("inverse_mesh_fraction", "", "1", "share of the kept time in inverse mesh"),
    Field("n_contact_losses", "", "1", "number of contact losses in the kept revolutions", "i4",
          fill=MISSING),
    Field("turning_points_per_period", "", "1", "mean number of extrema of y in a mesh period"),
    Field("mesh_period", "", "s", "mesh period"),
    Field("sensitive", "", "1", "whether the orbit amplifies integration errors", "i1",
          {0: "no", 1: "yes"}, MISSING),
    Field("status", "", "1", "status of the integration", "i1", dict(enumerate(STATUSES))),
)  # fmt: skip
"""The variables of every case."""

SAMPLE_FIELDS = (
    Field("time", "sample", "s", "time, from the start"),
    Field("y", "sample", "mm", "relative motion in the mesh"),
    Field("v", "sample", "mm", f"relative velocity {_V}"),
    Field("a", "sample", "mm", "relative acceleration d2y/dtau_s2 (tau_s = Omega_s t)"),
    Field("stiffness", "sample", "N/mm", "mesh stiffness C"),
    Field("modified_stiffness", "sample", "N/mm", "modified mesh stiffness C (H1 + H2)"),
    Field("force_dynamic", "sample", "N", "dynamic force C y, eq. (2)"),
    Field("force_friction", "sample", "N", "friction force, eq. (6)"),
    Field("regime", "sample", "1", "regime of the mesh", "i1", REGIMES),
)
"""The variables of a time course."""

LOAD_FIELDS = (
    Field("transmission_error_rms", "", "mm", "rms of the dynamic transmission error about its "
          "mean"),
    Field("transmission_error_range", "", "mm", "dynamic transmission error, peak to peak"),
    Field("force_max", "", "N", "greatest tooth force"),
    Field("force_min", "", "N", "least tooth force; negative: on rear flanks, or pulling"),
    Field("least_contact_force", "", "N", "least force on touching flanks; negative: they pull"),
    Field("dynamic_factor", "", "1", "dynamic factor K_v, greatest tooth force over static force"),
    Field("force_bearing_3_max", "", "N", "greatest force on the bearing of wheel 3 along y"),
    Field("force_bearing_2_max", "", "N", "greatest force on the bearing of wheel 2 along y"),
    Field("force_bearing_3_z_max", "", "N", "greatest force on the bearing of wheel 3 along z"),
    Field("force_bearing_2_z_max", "", "N", "greatest force on the bearing of wheel 2 along z"),
)  # fmt: skip
"""Loads that engineers report. A record contains them if they are asked for."""

LOAD_SAMPLE_FIELDS = (
    Field("force_normal", "sample", "N", "tooth force: elastic and damping force"),
    Field("force_bearing_3", "sample", "N", "force on the bearing of wheel 3 along y"),
    Field("force_bearing_2", "sample", "N", "force on the bearing of wheel 2 along y"),
    Field("force_bearing_3_z", "sample", "N", "force on the bearing of wheel 3 along z"),
    Field("force_bearing_2_z", "sample", "N", "force on the bearing of wheel 2 along z"),
    Field("transmission_error", "sample", "mm",
          "dynamic transmission error R_b3 phi_3 + R_b2 phi_2"),
)  # fmt: skip
"""The loads over time."""

RAMP_FIELDS = (
    Field("nu", "sample", "1", "mesh frequency nu_s"),
    Field("speed", "sample", "rpm", "speed of wheel 3"),
    Field("strobe_nu", "boundary", "1", "mesh frequency nu_s after n mesh periods"),
    Field("strobe_speed", "boundary", "rpm", "speed of wheel 3 after n mesh periods"),
    Field("period_nu", "period", "1", "mesh frequency nu_s in the middle of a mesh period"),
    Field("period_speed", "period", "rpm", "speed of wheel 3 in the middle of a mesh period"),
    Field("period_y_max", "period", "mm", "maximum of y over a kept mesh period"),
    Field("period_y_min", "period", "mm", "minimum of y over a kept mesh period"),
)
"""The speed, and the response to it, of a run whose speed changes."""

ALL_FIELDS = (*FIELDS, *LOAD_FIELDS, *SAMPLE_FIELDS, *LOAD_SAMPLE_FIELDS, *RAMP_FIELDS)
"""All variables, in the order of a file."""


def record(response: Response, pair: Pair, problem: Problem | None = None) -> Record:
    """Convert a response into the units of a file.

    Parameters
    ----------
    response : Response
        Dimensionless, with or without samples.
    pair : Pair
        They set the scales of length, time and force.
    problem : Problem, optional
        The run, if the record is to hold its loads, and its speed where it changes; its response
        must have samples.
    """
    scales = {
        "mm": pair.static_deflection,
        "s": 1.0 / pair.natural_frequency,
        "N/mm": pair.stiffness_mean,
        "N": pair.static_force,
        "rpm": pair.resonance_speed,
    }
    columns: Record = {}
    further = (_loads(response, problem), _ramp(response, problem)) if problem else ()
    for field, value in itertools.chain(_values(response), *further):
        array = np.asarray(field.fill if value is None else value, field.kind)
        if field.dimension and array.size == 0:  # of a run that failed
            # The format has no dimension of length 0, so a value that is absent stands for none.
            size = boundaries(pair) if field.dimension == "boundary" else 1
            array = np.full(size, absent(field), field.kind)
        if field.relative:
            columns[field.relative] = array
        columns[field.name] = array * scales[field.unit] if field.unit in scales else array
    return columns


def without_time_course(columns: Record) -> Record:
    """Return a record without the variables over samples."""
    fields = (*SAMPLE_FIELDS, *LOAD_SAMPLE_FIELDS, *RAMP_FIELDS)
    sampled = {name for field in fields for name in (field.name, field.relative)}
    return {name: values for name, values in columns.items() if name not in sampled}


def fields_in(names: Container[str]) -> list[Field]:
    """Return the fields of every case that are among the names of variables."""
    return [field for field in (*FIELDS, *LOAD_FIELDS) if (field.relative or field.name) in names]


def absent(field: Field) -> float:
    """Return the value of a field where there is none."""
    if field.kind == "f8":
        return np.nan
    return NO_EXTREMUM if field.name == "extremum_kind" else MISSING


def boundaries(pair: Pair) -> int:
    """Return the number of boundaries of mesh periods in a run."""
    return pair.revolutions * pair.teeth_3 + 1


def _values(response: Response) -> Iterator[tuple[Field, object]]:
    for field in FIELDS:
        if field.name == "status":
            yield field, STATUSES.index(response.status)
        elif response.status != "ok" and not field.dimension:
            yield field, np.nan if field.fill is None else field.fill
        elif field.name == "mesh_period":
            yield field, response.period
        else:
            yield field, getattr(response, field.name)
    if response.samples is not None:
        for field in SAMPLE_FIELDS:
            yield field, getattr(response.samples, field.name)


def _loads(response: Response, problem: Problem) -> Iterator[tuple[Field, object]]:
    if response.samples is None:  # the run failed
        yield from ((field, np.nan) for field in LOAD_FIELDS)
        return
    found = asdict(loads(problem, response.samples))
    found["dynamic_factor"] = found["force_max"]
    found["least_contact_force"] = response.least_contact_force
    for field in LOAD_FIELDS:
        yield field, found[field.name]
    for field in LOAD_SAMPLE_FIELDS:
        values = getattr(response.samples, field.name)
        if values is not None:
            yield field, values


def _ramp(response: Response, problem: Problem) -> Iterator[tuple[Field, object]]:
    if problem.final_nu is None or response.samples is None:
        return
    found = by_speed(problem, response)
    for field in RAMP_FIELDS:
        name = field.name.replace("speed", "nu")
        yield field, found[name]


@functools.lru_cache(maxsize=2**13)
def case_digest(pair: Pair, case: Case) -> str:
    """Return the SHA-256 of all that decides the numbers of a case.

    Parameters without effect on this case do not count: a conservative run has the same digest
    whatever the damping.
    """
    scales = (
        pair.static_deflection,
        pair.natural_frequency,
        pair.stiffness_mean,
    )
    samples = pair.samples_per_period if case.time_course else 0
    problem = pair.problem(case.variant, case.nu)
    stated = repr((problem, scales, samples, pair.tolerance))
    held = " with loads" if case.loads else ""
    return hashlib.sha256(f"{stated}{held} {_common_digest()}".encode()).hexdigest()


@functools.cache
def _common_digest() -> str:
    layout = provenance.digest([Path(__file__), Path(classic.__file__)])
    return f"{layout} {provenance.physics_digest()} {provenance.versions()}"


def attributes(pair: Pair, case: Case) -> dict[str, str | float]:
    """Return the global attributes of a case file: what it is, and how it was made."""
    sweep = {"sweep_direction": case.direction} if case.direction else {}
    return {
        "Conventions": "CF-1.11",
        "title": f"gear mesh, variant {case.variant.name}, nu_s = {case.nu!r}",
        "variant": case.variant.name,
        "nu_s": case.nu,
        **sweep,
        "case_sha256": case_digest(pair, case),
        **common_attributes(pair),
    }


@functools.lru_cache(maxsize=4)
def common_attributes(pair: Pair) -> dict[str, str | float]:
    """Return the attributes that all files of a study share."""
    return {
        "parameters": pair.canonical(),
        "parameters_sha256": pair.digest(),
        "history": "gearmesh: integrated with the solver and the parameters stated here",
        "solver": "adaptive Taylor series with located events",
        "solver_tolerance": pair.tolerance,
        **{f"{name}_version": number for name, number in provenance.versions().items()},
        "physics_sources_sha256": provenance.physics_digest(),
    }


def write_case(path: Path | str, attributes: Mapping[str, str | float], columns: Record) -> None:
    """Write a case file, whole or not at all; the same input gives the same bytes.

    Parameters
    ----------
    path : Path or str
        File; its folder is made if it is missing.
    attributes : mapping
        See `attributes`.
    columns : Record
        See `record`.
    """
    variables = {
        name: variable(field, name, columns[name], (field.dimension,) if field.dimension else ())
        for field in ALL_FIELDS
        if field.name in columns
        for name in (field.name, field.relative)
        if name
    }
    classic.write(Path(path), attributes, variables)


def variable(field: Field, name: str, values: np.ndarray, dimensions: tuple[str, ...]) -> Variable:
    """Return the variable of a field, or of its twin, for a file."""
    fill = {} if field.fill is None else {"_FillValue": np.asarray(field.fill, field.kind)}
    stated = fill | variable_attributes(field, relative=name != field.name)
    return Variable(np.asarray(values, field.kind), dimensions, stated)


def variable_attributes(field: Field, relative: bool = False) -> dict[str, Any]:
    """Return the CF attributes of a field, or of its twin in static deflections."""
    stated: dict[str, Any] = {
        "units": "1" if relative else field.unit,
        "long_name": field.long_name + (", in static deflections y_st" if relative else ""),
    }
    if field.flags:
        stated["flag_values"] = np.array(list(field.flags), field.kind)
        stated["flag_meanings"] = " ".join(field.flags.values())
    return stated


def read_case(path: Path | str) -> tuple[dict[str, str | float], Record]:
    """Read a case file.

    Returns
    -------
    tuple of dict and Record
        The global attributes, and the variables.

    Raises
    ------
    InputError
        If there is no such file, or it is damaged.
    """
    with classic.opened(path) as file:
        columns = {name: classic.values(found) for name, found in file.variables.items()}
        return classic.attributes(file), columns
