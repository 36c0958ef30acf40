"""Files that are written here, read by the NetCDF library and by SciPy."""

import netCDF4
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from gearmesh.data import classic
from gearmesh.data.classic import Variable

KINDS = ("i1", "i2", "i4", "f4", "f8")
TEXTS = st.text("aZ0_ ,{}°", min_size=1, max_size=9)
VALUES = st.integers(-100, 100)


@st.composite
def variables(draw) -> dict[str, Variable]:
    lengths = draw(st.lists(st.integers(1, 5), min_size=3, max_size=3))
    sizes = dict(zip("abc", lengths, strict=True))
    found = {}
    for i in range(draw(st.integers(1, 4))):
        dimensions = tuple(draw(st.permutations("abc"))[: draw(st.integers(0, 3))])
        shape = tuple(sizes[name] for name in dimensions)
        cells = draw(st.lists(VALUES, min_size=int(np.prod(shape)), max_size=int(np.prod(shape))))
        kind = draw(st.sampled_from(KINDS))
        values = np.array(cells, kind).reshape(shape)
        stated = {
            "units": draw(TEXTS),
            "flag_values": np.array(draw(st.lists(VALUES, min_size=1)), kind),
        }
        found[f"v{i}"] = Variable(values, dimensions, stated)
    return found


@settings(max_examples=60, deadline=None)
@given(variables(), st.dictionaries(st.sampled_from(["one", "b", "long_name"]), TEXTS))
def test_others_read_what_is_written(tmp_path_factory, written, attributes):
    path = tmp_path_factory.mktemp("classic") / "file.nc"
    classic.write(path, attributes | {"nu_s": 0.66}, written)
    with netCDF4.Dataset(path) as file, classic.opened(path) as ours:
        assert {name: file.getncattr(name) for name in file.ncattrs()} == attributes | {
            "nu_s": 0.66
        }
        assert classic.attributes(ours) == attributes | {"nu_s": 0.66}
        assert list(file.variables) == list(written)
        for name, variable in written.items():
            found = file[name]
            assert found.dimensions == variable.dimensions
            assert found.units == variable.attributes["units"]
            np.testing.assert_array_equal(found.flag_values, variable.attributes["flag_values"])
            for values in (found[...].data, classic.values(ours.variables[name])):
                np.testing.assert_array_equal(values, variable.values, strict=True)
