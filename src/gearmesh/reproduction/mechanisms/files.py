"""Write the datasets about what lies behind the curves."""

from pathlib import Path

import xarray as xr

from gearmesh.data import casefile
from gearmesh.data.writing import replacing
from gearmesh.study.cases import Study


def write(path: Path, dataset: xr.Dataset, study: Study, title: str) -> None:
    """Write a dataset with the attributes of its study; the same input gives the same bytes."""
    stated = {
        "Conventions": "CF-1.11",
        "title": f"{study.title}: {title}",
        **casefile.common_attributes(study.pair),
        "history": f"gearmesh: computed for the study {study.name}",
    }
    packed = {
        name: {"zlib": True, "complevel": 1}
        for name, variable in dataset.variables.items()
        if variable.dtype.kind in "fi" and variable.dims
    }
    with replacing(path) as temporary:
        made = dataset.assign_attrs({**dataset.attrs, **stated})
        made.to_netcdf(temporary, engine="netcdf4", format="NETCDF4", encoding=packed)
