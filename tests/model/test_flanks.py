"""Flanks that deviate, Hertz' power and periodic tables, checked against values by hand."""

from dataclasses import replace

import numpy as np
import pytest
from problems import problem

from gearmesh.model import motion, stiffness
from gearmesh.model.contact import INVERSE_MESH, NORMAL_MESH, elastic_force
from gearmesh.model.flanks import distances, relief_places
from gearmesh.model.functions import entry, power
from gearmesh.model.problem import GeneralTerms, Harmonic
from gearmesh.model.segments import segments

ERRORS = GeneralTerms(pitch_errors_3=(0.1, 0.2, 0.4), pitch_errors_2=(0.0, -0.01))
RELIEF = GeneralTerms(tip_relief=(0.5, 0.3), tip_relief_length=(0.4, 0.2))


def test_pitch_errors_belong_to_teeth_and_come_back_with_them():
    one = problem(contact_ratio=1.6, terms=ERRORS)
    assert distances(one, 0.5, 0.5) == pytest.approx([-0.1])  # pair 0
    assert distances(one, 1.0, 1.0) == pytest.approx([-0.2 + 0.01, -0.1])  # pairs 1 and 0
    assert distances(one, 5.5, 5.5) == pytest.approx([-0.4 + 0.01])  # pair 5: teeth 2 and 1
    # A segment stands for all periods; the pairs are those of the phase.
    assert distances(one, 5.52, 0.5) == pytest.approx([-0.4 + 0.01])
    only = problem(contact_ratio=1.6, terms=replace(ERRORS, pitch_errors_3=()))
    assert distances(only, 1.5, 1.5) == pytest.approx([0.01])
    assert distances(problem(), 0.0, 0.0) == [0.0, 0.0]


def test_tip_relief_is_linear_from_where_it_starts_to_the_tip():
    """A path of 1.6 base pitches, -0.3 to 1.3: wheel 2 is relieved up to -0.1, wheel 3 from 0.9."""
    one = problem(contact_ratio=1.6, terms=RELIEF)
    assert relief_places(one) == pytest.approx([0.9, -0.1])
    assert distances(one, 0.5, 0.5) == [0.0]
    # Pair 0 is at 1.1, halfway to the tip of wheel 3; pair 1 at 0.1, not relieved any more.
    assert distances(one, 1.1, 1.1) == pytest.approx([0.0, 0.25])
    # Pair 1 is at -0.2 and pair 0 at 0.8, not relieved yet.
    assert distances(one, 0.8, 0.8) == pytest.approx([0.15, 0.0])
    # Within a segment the line goes on, also in a later period.
    assert distances(one, 1.12, 1.1) == pytest.approx([0.0, 0.275])
    assert distances(one, 0.82, 0.8) == pytest.approx([0.12, 0.0])
    assert distances(one, 7.82, 0.8) == pytest.approx([0.12, 0.0])
    for side, place in ((0, 0.9), (1, -0.1)):
        sides = tuple(value * (i == side) for i, value in enumerate(RELIEF.tip_relief))
        alone = replace(one, terms=replace(RELIEF, tip_relief=sides))
        assert relief_places(alone) == pytest.approx([place])
        assert alone.terms.pairs_touch_singly
    assert relief_places(problem()) == []


def test_a_period_is_cut_where_relief_begins_and_where_pairs_change():
    longer = replace(RELIEF, tip_relief_length=(0.5, 0.2))
    one = problem(contact_ratio=1.6, friction_coefficient=0.0, stiffness_harmonics=2, terms=longer)
    edges = [part.start for part in segments(one)]
    assert edges == pytest.approx([0.0, 0.3, 0.7, 0.8, 0.9])  # 0.9 is -0.1 of the next path
    errors = replace(one, terms=ERRORS)
    assert [part.start for part in segments(errors)] == pytest.approx([0.0, 0.3, 0.7])


def test_which_terms_make_pairs_touch_singly_and_the_backlash_vary():
    none = GeneralTerms()
    assert (none.pairs_touch_singly, none.backlash_varies) == (False, False)
    for change in ({"pitch_errors_3": (0.1,)}, {"pitch_errors_2": (0.1,)}, {"tip_relief": (0, 1)}):
        assert replace(none, **change).pairs_touch_singly is True
    assert replace(none, backlash_harmonics=(Harmonic(1, 0.1, 0.0),)).backlash_varies is True
    assert replace(none, backlash_follows_centres=True).backlash_varies is True


def test_normal_mesh_is_where_any_pair_presses():
    one = problem(contact_ratio=1.6, friction_coefficient=0.0, terms=ERRORS)
    q, v = np.zeros(6), np.zeros(6)
    time = 1.0 * one.period  # pairs 1 and 0 touch at -0.19 and -0.1
    for y, regime, pressing in (
        (-0.05, NORMAL_MESH, (1.0, 1.0)),
        (-0.15, NORMAL_MESH, (1.0, 0.0)),
        (-0.25, 0, (0.0, 0.0)),
        (-4.5, INVERSE_MESH, (0.0, 0.0)),
    ):
        q[0] = y
        mode = motion.mode_of(one, time, q, v)
        assert (mode.regime, mode.pressing) == (regime, pressing)
        half = 0.5 * one.stiffness_max
        force = half * ((y + 0.19) * pressing[0] + (y + 0.1) * pressing[1])
        force += one.stiffness_max * (y + 4.0) * (regime == INVERSE_MESH)
        assert 2.0 * motion.accelerations(one, time, q, v)[0] == pytest.approx(1.0 - force)


@pytest.mark.parametrize("exponent", [1.5, 1.0, 2.0, 2.5])
def test_the_force_of_hertz_is_a_power_of_the_depth(exponent):
    for y, regime, depth in ((0.7, NORMAL_MESH, 0.7), (-5.3, INVERSE_MESH, 1.3)):
        force = elastic_force(y, 1.2, regime, 4.0, exponent=exponent)
        assert force == pytest.approx(regime * 1.2 * depth**exponent, rel=1e-11)
    # It starts as a line: at a depth of 1e-6 y_st the force is 2^((p - 1)/2) times the line's.
    line = 1e-6 ** (exponent - 1.0)
    tiny = elastic_force(1e-6, 1.0, NORMAL_MESH, 4.0, exponent=exponent)
    assert tiny == pytest.approx(1e-6 * line * 2.0 ** (0.5 * (exponent - 1.0)))


class Traced:
    """A number that brings its own functions."""

    def power(self, exponent):
        return f"to the {exponent}"

    def entry(self, table):
        return table


def test_powers_and_tables_of_floats_and_of_other_numbers():
    assert power(4.0, 1.5) == 8.0
    assert power(Traced(), 1.5) == "to the 1.5"
    assert [entry((1.0, 2.0, 3.0), place) for place in (0, 4.0, -1, 2.9999999)] == [1, 2, 3, 1]
    assert entry([1.0, 2.0], Traced()) == (1.0, 2.0)


@pytest.mark.parametrize("contact_ratio", [1.3, 1.6, 2.2])
def test_the_extremes_of_pairs_that_are_added_up(contact_ratio):
    values = (0.2, 0.9, 0.7, 0.3)
    places = np.linspace(-0.5, 0.5, 4) * contact_ratio
    phases = np.linspace(0.0, 1.0, 20001)
    total = np.zeros(phases.size)
    for p in range(-3, 4):
        place = phases - p - 0.5
        total += np.interp(place, places, values, left=0.0, right=0.0)
    least, greatest = stiffness.extremes_of_pairs(values, contact_ratio)
    # The sum jumps where a path ends. Its extremes lie at jumps or kinks.
    assert least == pytest.approx(total.min(), abs=2e-4)
    assert greatest == pytest.approx(total.max(), abs=2e-4)
