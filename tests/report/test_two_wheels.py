"""Reports of pairs with two different wheels and with terms that have a structure."""

from gearmesh.commands.tables import _text
from gearmesh.report.explorer import controls
from gearmesh.report.presentation import quantity

GENERAL = {
    "teeth": [20, 40],
    "body_mass": ["2 kg", "5 kg"],
    "tooth_factors": [{"wheel": 2, "tooth": 3, "factor": 0.5}],
    "torque_harmonics": [{"shaft": 1, "sin": 0.25}],
    "non_adhesive": True,
    "damping_follows_stiffness": "sqrt",
    "pitch_errors": [[f"{tooth % 2} um" for tooth in range(20)], []],
}


def test_every_parameter_is_written_in_the_table_and_in_the_report(pair):
    general = pair.replace(**GENERAL)
    errors = _text(general.pitch_errors)
    assert errors == "20 values from 0 to 0.001, none"
    assert quantity((3.0, 4.0, 3.0), "mm") == "3 mm, 4 mm, 3 mm"
    assert quantity((3.0, 3.0), "mm") == "3 mm"
    for write in (lambda row: _text(row.value), lambda row: quantity(row.value, row.unit)):
        written = {row.name: write(row) for row in general.parameters if row.value is not None}
        assert written["teeth"] == "20, 40"
        assert written["tooth_factors"] == "wheel 2 tooth 3 factor 0.5"
        assert written["torque_harmonics"] == "wheel 3 shaft 1.0 cos 0.0 sin 0.25"
        assert (written["non_adhesive"], written["damping_follows_stiffness"]) == ("yes", "sqrt")


def test_the_explorer_has_single_numbers_for_its_solver(pair):
    values = controls.of_one_wheel(pair.replace(**GENERAL))
    assert (values["teeth"], values["body_mass"], values["eccentricity"]) == (20, 2.0, 0.0)
