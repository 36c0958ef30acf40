"""The statement of a run, from the numbers of config/paper.yaml and the equations of the paper.

Without eccentricity, deviation and cut Fourier series the six equations (1) leave two coordinates,
y = R_b (φ_3 + φ_2) + y_3 - y_2 and Y = y_3 - y_2, for wheels of the inertia 2 m_red R_b² and
bodies of the mass m. With the normal force N = C (y - d) + k_1 y' + k_2 |y'| y' + k_3 y'³, where
d is 0 in normal mesh and -s in inverse mesh, and C = 0 in contact loss,

    m_red (y'' - Y'') = F_st - N + f_T tan(α) γ C (y - d),
    m Y'' = -2 N - b_b Y' - c_b Y.

γ is 1 before and -1 behind the pitch point while one pair of teeth carries. In double contact the
moments of both pairs cancel. Lengths are in static deflections y_st, and time is in mesh periods.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import pi, sqrt, tan
from pathlib import Path
from typing import Any

import yaml

UNITS = {
    **dict.fromkeys(("N/mm", "N s/mm", "N s^2/mm", "mm"), 1.0),
    **{"um": 1e-3, "deg": pi / 180},
}
"""Sizes in N, mm, s and rad."""

RELATIVE = {"y_st": "static_deflection", "m_red": "reduced_mass"}
"""Parameters that serve as units."""

POWERS = {"a": "", "b": "L", "c": "V", "d": "U", "e": "LV", "f": "LU", "g": "LVU", "h": "VU"}
"""Tab. 1: the powers 1, 2 and 3 of the velocity that damp, L, Kv and Ku in the paper."""

AT_A_BOUNDARY = 1e-12
"""A switch this close to a boundary between mesh periods, in periods, falls on it."""


@dataclass(frozen=True)
class Piece:
    """A part of the mesh period between two switches.

    Attributes
    ----------
    start, end : float
        In mesh periods from the start of the period.
    stiffness : float
        C T² / m_red.
    gamma : int
        γ of eq. (6); 0 in double contact.
    """

    start: float
    end: float
    stiffness: float
    gamma: int


@dataclass(frozen=True)
class Run:
    """The constants of one run, in y_st and mesh periods T.

    Attributes
    ----------
    variant : str
        Its name, such as ``c-material-5x``.
    nu : float
        Mesh frequency ν_s.
    period : float
        T in s.
    deflection : float
        y_st in mm.
    stiffness_mean : float
        C_s in N/mm.
    velocity : float
        dy/dτ_s in y_st where dy/dt is 1 y_st a period.
    load : float
        F_st T² / (m_red y_st).
    friction : float
        f_T tan(α).
    friction_coefficient : float
        f_T.
    backlash : float
        s / y_st.
    contact, loss : tuple of three float
        Coefficients of y', |y'| y' and y'³ while flanks touch, and while they do not.
    mass : float
        m / m_red.
    bearing, bearing_damping : float
        c_b T² / m and b_b T / m.
    rest : float
        Y in static equilibrium.
    pieces : tuple of Piece
        The mesh period, cut at its switches.
    teeth, revolutions : int
        Z, and the revolutions that are run; the last one is measured.
    """

    variant: str
    nu: float
    period: float
    deflection: float
    stiffness_mean: float
    velocity: float
    load: float
    friction: float
    friction_coefficient: float
    backlash: float
    contact: tuple[float, float, float]
    loss: tuple[float, float, float]
    mass: float
    bearing: float
    bearing_damping: float
    rest: float
    pieces: tuple[Piece, ...]
    teeth: int
    revolutions: int

    @property
    def periods(self) -> int:
        """Mesh periods of the run."""
        return self.revolutions * self.teeth


def load(path: Path) -> dict[str, Any]:
    """Read the study; quantities become numbers in N, mm, s and rad."""
    stated = yaml.safe_load(path.read_text(encoding="utf-8"))
    read: dict[str, Any] = {}
    for name, entry in stated.items():
        if not isinstance(entry, dict) or "value" not in entry:
            read[name] = entry
        elif isinstance(entry["value"], str):
            number, unit = entry["value"].split(" ", 1)
            read[name] = float(number) * (UNITS[unit] if unit in UNITS else read[RELATIVE[unit]])
        else:
            read[name] = entry["value"]
    beyond = ("eccentricity", "profile_deviation", "stiffness_harmonics")
    if any(read[name] for name in beyond) or read["kept_revolutions"] != 1:
        raise ValueError(f"{path}: verified is a study without {', '.join(beyond)} only")
    return read


def frequencies(study: dict[str, Any]) -> dict[str, list[float]]:
    """Return the frequencies of every variant of the study: all of Tab. 1, and the strong one."""
    places = ("material", "lubricant", "both")
    names = ["a-conservative", *(f"{letter}-{place}" for letter in "bcdefgh" for place in places)]
    found = {name: _grid(study["nu"]) for name in names}
    strong = study["strong_damping"]
    found[f"{strong['variant']}-{strong['factor']:g}x"] = _grid(strong["nu"])
    return found


def _grid(stated: dict[str, float]) -> list[float]:
    count = round((stated["stop"] - stated["start"]) / stated["step"]) + 1
    return [round(stated["start"] + i * stated["step"], 10) for i in range(count)]


def run(study: dict[str, Any], variant: str, nu: float) -> Run:
    """State one run of the study."""
    p = study
    c_max, c_min = p["mesh_stiffness_max"], p["stiffness_ratio"] * p["mesh_stiffness_max"]
    duty = p["contact_ratio"] - 1.0
    c_s = c_min + (c_max - c_min) * duty
    omega = sqrt(c_s / p["reduced_mass"])
    period = 2.0 * pi / (nu * omega)
    unit = period**2 / p["reduced_mass"]
    contact, loss = _damping(p, variant, omega, period)
    mass = p["body_mass"]
    damper = 2.0 * p["bearing_damping_ratio"] * sqrt(p["bearing_stiffness"] * mass)
    return Run(
        variant=variant,
        nu=nu,
        period=period,
        deflection=p["static_deflection"],
        stiffness_mean=c_s,
        velocity=1.0 / (omega * period),
        load=c_s * unit,
        friction=p["friction_coefficient"] * tan(p["pressure_angle"]),
        friction_coefficient=p["friction_coefficient"],
        backlash=p["backlash"] / p["static_deflection"],
        contact=contact,
        loss=loss,
        mass=mass / p["reduced_mass"],
        bearing=p["bearing_stiffness"] * period**2 / mass,
        bearing_damping=damper * period / mass,
        rest=-2.0 * c_s / p["bearing_stiffness"],
        pieces=_pieces(duty, c_max * unit, c_min * unit, p["initial_phase"]),
        teeth=p["teeth"],
        revolutions=p["revolutions"],
    )


Law = tuple[float, float, float]


def _damping(p: dict[str, Any], variant: str, omega: float, period: float) -> tuple[Law, Law]:
    """Return the coefficients of eq. (7); all three terms are equal at the velocity ℓ Ω_s."""
    letter, place, *multiple = variant.split("-")
    k = p["damping"] * float(multiple[0].removesuffix("x") if multiple else 1)
    reference = p["damping_length"] * omega
    speed = p["static_deflection"] / period
    values = [k, k * speed / reference, k * (speed / reference) ** 2]
    scale = period / p["reduced_mass"]
    law = [
        value * scale * (power in POWERS[letter])
        for value, power in zip(values, "LVU", strict=True)
    ]
    acting = (law[0], law[1], law[2])
    none = (0.0, 0.0, 0.0)
    return (
        acting if place in ("material", "both") else none,
        acting if place in ("lubricant", "both") else none,
    )


def _pieces(duty: float, high: float, low: float, phase: float) -> tuple[Piece, ...]:
    half = duty / 2.0
    switches = ((place - phase) % 1.0 for place in (half, 0.5, 1.0 - half))
    inner = sorted(cut for cut in switches if AT_A_BOUNDARY < cut < 1.0 - AT_A_BOUNDARY)
    made = []
    for start, end in pairwise([0.0, *inner, 1.0]):
        middle = ((start + end) / 2.0 + phase) % 1.0
        single = half < middle < 1.0 - half
        gamma = (1 if middle < 0.5 else -1) * single
        made.append(Piece(start, end, low if single else high, gamma))
    return tuple(made)
