"""What tells two runs apart in the legend of a picture."""

import json

import xarray as xr

from gearmesh.report.run_names import differing, suffixes


def run(nu=0.66, **parameters):
    stated = {"variant": "c-lubricant", "nu_s": nu, "parameters": json.dumps(parameters)}
    return xr.Dataset(attrs=stated)


def test_two_runs_are_named_by_the_parameters_in_which_they_differ():
    runs = run(damping=3.9537, teeth=[21, 21]), run(0.7, damping=8.0, teeth=[21, 21])
    assert differing(*runs) == {"nu_s": (0.66, 0.7), "damping": (3.9537, 8.0)}
    assert suffixes(runs) == [", damping = 3.9537 N s/mm", ", damping = 8 N s/mm"]
    assert suffixes(runs[:1]) == [""] and suffixes([runs[0], runs[0]]) == ["", ""]


def test_a_name_counts_the_parameters_that_it_leaves_out():
    names = "contact_ratio", "stiffness_ratio", "friction_coefficient"
    one, other = (run(**dict.fromkeys(names, value)) for value in (0.1, 0.2))
    expected = ", contact_ratio = 0.1, stiffness_ratio = 0.1, and 1 more differs"
    assert suffixes([one, other])[0] == expected
