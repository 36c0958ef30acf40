"""Taylor series of the equations of motion in the six coordinates, by recurrence.

Between two jumps every law of `gearmesh.model.motion` is analytic along the motion: products become
Cauchy products, the sine and cosine of the rotations a pair of coupled recurrences, and the
prescribed functions of time (Fourier stiffness, profile deviation) have known derivatives. The
coefficient of order k of the forces gives that of order k + 2 of the coordinates (Jorba and Zou,
Experimental Mathematics 14, 2005).
"""

import numpy as np

from gearmesh.model.contact import CONTACT_LOSS, INVERSE_MESH
from gearmesh.model.friction import holding_force
from gearmesh.model.motion import WHEEL_INERTIA, Y_2, Y_3, Z_2, Z_3
from gearmesh.solvers.compilation import inner
from gearmesh.solvers.full.roots import MAX_DEGREE

CASE = np.dtype(
    [
        ("nu", np.float64),
        ("stiffness_mean", np.float64),
        ("period", np.float64),
        ("initial_phase", np.float64),
        ("rotation_speed", np.float64),
        ("teeth", np.int64),
        ("material", np.float64, 3),
        ("lubricant", np.float64, 3),
        ("backlash", np.float64),
        ("body_mass", np.float64),
        ("bearing_stiffness", np.float64),
        ("bearing_damping", np.float64),
        ("friction", np.float64),
        ("middle_arm", np.float64),
        ("base_pitch", np.float64),
        ("base_radius", np.float64),
        ("eccentricity_3", np.float64),
        ("eccentricity_2", np.float64),
        ("eccentricity_angle", np.float64),
        ("has_run_out", np.bool_),
        ("follows_run_out", np.bool_),
        ("start_period", np.int64),
        ("periods", np.int64),
        ("first_kept", np.int64),
        ("tolerance", np.float64),
        ("longest_step", np.float64),
        ("order", np.int64),
        ("farthest", np.float64),
        ("most_steps", np.float64),
    ]
)
"""One run as the kernel takes it: `gearmesh.model.problem.Problem` and the settings of the solver.

`middle_arm` (tan alpha) and `base_pitch` are in R_b.
"""

SEGMENT = np.dtype(
    [
        ("end", np.float64),
        ("stiffness", np.float64),
        ("gamma", np.float64),
        ("sigma", np.float64),
    ]
)
"""A segment of the mesh period (`gearmesh.model.segments`).

`end` is its end in tau_s from the boundary of the period, `gamma` is summed over the pairs (0: two
pairs), and `sigma` is where the boundary of the period lies on the path of a single pair, in base
pitches from the pitch point.
"""

MODE = np.dtype(
    [
        ("stage", np.int64),
        ("period", np.int64),
        ("segment", np.int64),
        ("time", np.float64),
        ("regime", np.int64),
        ("direction", np.float64),
        ("run_out_sign", np.float64),
        ("slip_sign", np.float64),
        ("level", np.float64),
        ("turns", np.bool_),
        ("on_level", np.bool_),
        ("on_bracket", np.bool_),
        ("released", np.bool_),
    ]
)
"""State of a run within its period: `time` since its boundary, and the branch of every law.

`stage` states whether the run is new, is continued with known branches, or is under way.
`direction` is the sign of y' (0 before the first motion) and `level` the value of y passed last.
`turns`, `on_level` and `on_bracket` state that y', y - `level` and the bracket of eq. (6) are
exactly 0, whatever rounding has left of them in the coordinates. `released` states that sticking
has just ended.
"""

NEW, CONTINUED, UNDER_WAY = range(3)
"""Stages of a run."""

Y, V, SQUARE, ELASTIC, NORMAL, STIFFNESS, FRICTION, BRACKET = range(6, 14)
SINE_3, COSINE_3, ANGLE_3, SINE_2, COSINE_2, ANGLE_2, DEVIATION = range(14, 21)
N_ROWS = 21
"""Rows of the series; the first six are those of the coordinates.

ANGLE_3 is Phi_3, ANGLE_2 is Delta - Phi_2.
"""

_holding_force = inner(holding_force)

SERIES_SHAPE = (N_ROWS, MAX_DEGREE + 1)


@inner
def level(case, regime, direction):
    """Return the value of y at which motion in `direction` leaves the regime."""
    if direction > 0.0:
        if regime == INVERSE_MESH:
            return -case.backlash
        return 0.0 if regime == CONTACT_LOSS else np.inf
    if regime == INVERSE_MESH:
        return -np.inf
    return -case.backlash if regime == CONTACT_LOSS else 0.0


@inner
def _fill_harmonics(row, order, nu, angle, amplitudes):
    """Fill a row with the series of the sum of a_n cos(n nu t) + b_n sin(n nu t) at `angle`."""
    row[: order + 1] = 0.0
    for i in range(amplitudes.shape[0]):
        n = i + 1.0
        cosine, sine = np.cos(n * angle), np.sin(n * angle)
        value = amplitudes[i, 0] * cosine + amplitudes[i, 1] * sine
        other = amplitudes[i, 1] * cosine - amplitudes[i, 0] * sine
        for k in range(order + 1):
            row[k] += value
            scale = n * nu / (k + 1.0)
            value, other = other * scale, -value * scale


@inner
def _product(a, b, k):
    """Return the k-th coefficient of the product of two series."""
    total = 0.0
    for j in range(k + 1):
        total += a[j] * b[k - j]
    return total


@inner
def _extend_angle(sine, cosine, angle, k):
    """Add the k-th coefficients of the sine and cosine of an angle whose k-th is there."""
    if k == 0:
        sine[0], cosine[0] = np.sin(angle[0]), np.cos(angle[0])
        return
    s = c = 0.0
    for j in range(1, k + 1):
        s += j * angle[j] * cosine[k - j]
        c += j * angle[j] * sine[k - j]
    sine[k], cosine[k] = s / k, -c / k


@inner
def _extend_relative_motion(case, series, k, mean_angle):
    """Add the k-th coefficient of y, eq. (3), and of the angles that it takes.

    `mean_angle`, omega_i t, is needed for k = 0 only.
    """
    y = series[0, k] + series[1, k] + series[Y_3, k] - series[Y_2, k] + series[DEVIATION, k]
    if case.has_run_out:
        turned = case.rotation_speed if k == 1 else 0.0
        series[ANGLE_3, k] = turned + series[0, k] / case.base_radius
        series[ANGLE_2, k] = -turned - series[1, k] / case.base_radius
        if k == 0:
            series[ANGLE_3, 0] += mean_angle
            series[ANGLE_2, 0] += case.eccentricity_angle - mean_angle
        _extend_angle(series[SINE_3], series[COSINE_3], series[ANGLE_3], k)
        _extend_angle(series[SINE_2], series[COSINE_2], series[ANGLE_2], k)
        y += case.eccentricity_3 * series[SINE_3, k] - case.eccentricity_2 * series[SINE_2, k]
        if k > 0:
            # The bracket is the rate of -(e_3 cos Phi_3 + e_2 cos(Delta - Phi_2)).
            series[BRACKET, k - 1] = -k * (
                case.eccentricity_3 * series[COSINE_3, k]
                + case.eccentricity_2 * series[COSINE_2, k]
            )
    series[Y, k] = y
    if k > 0:
        series[V, k - 1] = k * y


@inner
def begin(case, mode, state, waves, deviation, series):
    """Write the first terms of the series: the state, y and y', and the prescribed functions."""
    angle = 2.0 * np.pi * (mode.time / case.period + case.initial_phase)
    series[DEVIATION] = 0.0
    if deviation.shape[0]:
        _fill_harmonics(series[DEVIATION], case.order, case.nu, angle, deviation)
    if waves.shape[0]:
        _fill_harmonics(series[STIFFNESS], case.order, case.nu, angle, waves)
        series[STIFFNESS, 0] += case.stiffness_mean
    for i in range(6):
        series[i, 0], series[i, 1] = state[i], state[6 + i]
    mean_angle = (angle + 2.0 * np.pi * (case.start_period + mode.period)) / case.teeth
    _extend_relative_motion(case, series, 0, mean_angle)
    _extend_relative_motion(case, series, 1, mean_angle)
    if mode.on_level:
        series[Y, 0] = mode.level
    if mode.turns:
        series[V, 0] = 0.0
    if mode.on_bracket:
        series[BRACKET, 0] = 0.0


@inner
def elastic_coefficient(case, segment, mode, series, fourier, k):
    """Return the k-th coefficient of the elastic force."""
    if mode.regime == CONTACT_LOSS:
        return 0.0
    if k == 0:
        offset = -case.backlash if mode.regime == INVERSE_MESH else 0.0
        penetration = 0.0 if mode.on_level else series[Y, 0] - offset
        return (series[STIFFNESS, 0] if fourier else segment.stiffness) * penetration
    if not fourier:
        return segment.stiffness * series[Y, k]
    total = _product(series[STIFFNESS], series[Y], k)
    if mode.regime == INVERSE_MESH:
        total += case.backlash * series[STIFFNESS, k]
    return total


@inner
def _damping(law, direction, series, k):
    """Return the k-th coefficient of the damping force of eq. (7)."""
    force = law[0] * series[V, k]
    if law[1] != 0.0 or law[2] != 0.0:
        series[SQUARE, k] = _product(series[V], series[V], k)
        force += law[1] * direction * series[SQUARE, k]
        if law[2] != 0.0:
            force += law[2] * _product(series[SQUARE], series[V], k)
    return force


@inner
def _friction(case, segment, mode, series, k):
    """Return the k-th coefficients of F_T and of the moments on both wheels over R_b."""
    if segment.gamma == 0.0:
        # Two pairs half the load each; the arms differ by a base pitch.
        signs = mode.run_out_sign * mode.slip_sign
        couple = 0.5 * case.base_pitch * case.friction * signs * series[ELASTIC, k]
        series[FRICTION, k] = 0.0
        return 0.0, -couple, couple
    if mode.slip_sign == 0.0:
        pull = case.bearing_stiffness * (series[Z_3, k] - series[Z_2, k])
        rate = (k + 1.0) * (series[Z_3, k + 1] - series[Z_2, k + 1])
        force = _holding_force(pull + case.bearing_damping * rate)
    else:
        signs = mode.run_out_sign * mode.slip_sign
        force = -case.friction * segment.gamma * signs * series[ELASTIC, k]
    series[FRICTION, k] = force
    shift = case.base_pitch * (segment.sigma + mode.time / case.period) * force
    if k > 0:
        shift += case.base_pitch / case.period * series[FRICTION, k - 1]
    return force, -(case.middle_arm * force + shift), -(case.middle_arm * force - shift)


@inner
def _lever(case, series, wheel, k):
    """Return the k-th coefficient of N dy/dphi over R_b for wheel 3 or 2."""
    force = series[NORMAL, k]
    if case.has_run_out:
        if wheel == 3:
            share = _product(series[NORMAL], series[COSINE_3], k)
            force += case.eccentricity_3 / case.base_radius * share
        else:
            share = _product(series[NORMAL], series[COSINE_2], k)
            force += case.eccentricity_2 / case.base_radius * share
    return force


@inner
def expand(case, segment, mode, fourier, series, order):
    """Fill the series up to `order`, from what `begin` wrote."""
    law = case.lubricant if mode.regime == CONTACT_LOSS else case.material
    for k in range(order - 1):
        series[ELASTIC, k] = elastic_coefficient(case, segment, mode, series, fourier, k)
        normal = series[ELASTIC, k] + _damping(law, mode.direction, series, k)
        series[NORMAL, k] = normal
        force = moment_3 = moment_2 = 0.0
        if case.friction != 0.0:
            force, moment_3, moment_2 = _friction(case, segment, mode, series, k)
        load = 1.0 if k == 0 else 0.0
        over = 1.0 / ((k + 1.0) * (k + 2.0))
        series[0, k + 2] = (load - _lever(case, series, 3, k) + moment_3) / WHEEL_INERTIA * over
        series[1, k + 2] = (load - _lever(case, series, 2, k) + moment_2) / WHEEL_INERTIA * over
        over /= case.body_mass
        for i in range(2, 6):
            pull = case.bearing_stiffness * series[i, k]
            pull += case.bearing_damping * (k + 1.0) * series[i, k + 1]
            series[i, k + 2] = -pull * over
        series[Y_3, k + 2] -= normal * over
        series[Y_2, k + 2] += normal * over
        series[Z_3, k + 2] += force * over
        series[Z_2, k + 2] -= force * over
        _extend_relative_motion(case, series, k + 2, 0.0)
