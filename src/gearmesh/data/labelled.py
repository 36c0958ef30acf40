"""Responses as xarray datasets with units, as the public functions return them."""

import functools
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict

import numpy as np
import xarray as xr
from pydantic import TypeAdapter

from gearmesh.data.casefile import (
    ALL_FIELDS,
    FIELDS,
    LOAD_FIELDS,
    RAMP_FIELDS,
    Field,
    Record,
    absent,
    attributes,
    record,
    variable_attributes,
)
from gearmesh.errors import InputError
from gearmesh.model.problem import Problem, State
from gearmesh.solvers.response import Response
from gearmesh.study.cases import Case
from gearmesh.study.pair import Pair

_FINAL_STATE = "final_state"


def run_dataset(response: Response, pair: Pair, case: Case) -> xr.Dataset:
    """Return one run as a dataset, with the variables and attributes of its case file.

    The samples have the dimension and coordinate ``time``, so ``ds.y.plot()`` works. A speed
    that changes is a coordinate too: ``ds.period_y_max.plot(x="period_nu")``.
    """
    columns = record(response, pair, pair.problem(case.variant, case.nu))
    stated = attributes(pair, case) | {_FINAL_STATE: _written(response.final_state)}
    dataset = xr.Dataset(attrs=stated)
    for field in ALL_FIELDS:
        if field.name in columns:
            dimension = "time" if field.dimension == "sample" else field.dimension
            for name, values, described in _twins(field, columns):
                dataset[name] = ((dimension,) if dimension else (), values, described)
    coordinates = ["time", *(one.name for one in RAMP_FIELDS if one.unit in ("1", "rpm"))]
    return dataset.set_coords([name for name in coordinates if name in dataset])


def _written(state: State | None) -> str:
    """Write the state at the end of a run as JSON, which holds every bit of a float."""
    return json.dumps(None if state is None else asdict(state))


def final_state(dataset: xr.Dataset) -> State:
    """Return the state at the end of the run that a dataset holds.

    Raises
    ------
    InputError
        If the dataset holds no run, or one that failed.
    """
    found = json.loads(dataset.attrs.get(_FINAL_STATE, "null"))
    if found is None:
        raise InputError("start: the dataset holds no completed run")
    return _states().validate_python(found)


@functools.cache
def _states() -> TypeAdapter[State]:
    """Return what makes a state, with all that it is made of, from the lists of JSON."""
    return TypeAdapter(State)


def _twins(field: Field, columns: Record) -> list[tuple[str, np.ndarray, dict[str, object]]]:
    """Return name, values and attributes of a variable and of its twin."""
    found = [(field.name, columns[field.name], variable_attributes(field))]
    if field.relative:
        found.append((field.relative, columns[field.relative], variable_attributes(field, True)))
    return found


def grid_dataset(
    responses: Sequence[Response],
    pairs: Sequence[Pair],
    axes: Mapping[str, Sequence[object]],
    problems: Sequence[Problem] | None = None,
) -> xr.Dataset:
    """Return runs on a grid as a dataset.

    Parameters
    ----------
    responses : sequence of Response
        In the order of the grid, the last axis running fastest.
    pairs : sequence of Pair
        The pair of each run; it sets the scales.
    axes : mapping of str to sequence
        Names and values of the axes, in their order.
    problems : sequence of Problem, optional
        The runs, if the dataset is to hold their loads; their responses must have samples.

    Returns
    -------
    xarray.Dataset
        The scalars over the axes, and extrema and stroboscopic points over one more axis. The
        rows of extrema are filled with not-a-number.
    """
    shape = tuple(len(values) for values in axes.values())
    runs: Sequence[Problem | None] = problems or [None] * len(pairs)
    records = [record(*run) for run in zip(responses, pairs, runs, strict=True)]
    dataset = xr.Dataset(coords={name: (name, list(values)) for name, values in axes.items()})
    for field in (*FIELDS, *(LOAD_FIELDS if problems else ())):
        dimensions = (*axes, field.dimension) if field.dimension else tuple(axes)
        for name, _, stated in _twins(field, records[0]):
            cells = _stacked(field, [columns[name] for columns in records])
            dataset[name] = (dimensions, cells.reshape(*shape, *cells.shape[1:]), stated)
    return dataset


def _stacked(field: Field, rows: Sequence[np.ndarray]) -> np.ndarray:
    """Stack rows of unequal length. Short rows are filled with the value that marks no value."""
    if not field.dimension:
        return np.array(rows)
    longest = max(row.size for row in rows)
    cells = np.full((len(rows), longest), absent(field), field.kind)
    for cell, row in zip(cells, rows, strict=True):
        cell[: row.size] = row
    return cells
