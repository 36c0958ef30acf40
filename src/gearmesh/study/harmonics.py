"""Harmonics and factors of single teeth, as a study states them."""

from typing import Literal, Self

from pydantic import model_validator

from gearmesh.model.functions import Harmonic
from gearmesh.study.reading.schema import Section, quantity


class _Wave(Section):
    """A harmonic: of the mesh frequency (`order`) or of the rotation of a wheel (`shaft`)."""

    wheel: Literal[3, 2] = 3
    order: float | None = quantity(
        "1", "n", "multiple of the mesh frequency", 0.0, 1000.0, default=None
    )
    shaft: float | None = quantity(
        "1", "n", "multiple of the rotation of the wheel", 0.0, 1e5, default=None
    )

    @model_validator(mode="after")
    def _has_one_frequency(self) -> Self:
        if (self.order is None) == (self.shaft is None):
            found = "none" if self.order is None else "both"
            raise ValueError(f"order: found {found} of order and shaft; allowed is one of them")
        return self

    def _order(self, teeth: tuple[int, int]) -> float:
        if self.order is not None:
            return self.order
        assert self.shaft is not None
        return self.shaft / teeth[0 if self.wheel == 3 else 1]


class TorqueHarmonic(_Wave):
    """A harmonic of the torque on a wheel, relative to the static torque."""

    cos: float = quantity("1", "a_n", "amplitude of the cosine", -100.0, 100.0, default=0.0)
    sin: float = quantity("1", "b_n", "amplitude of the sine", -100.0, 100.0, default=0.0)

    def harmonic(self, teeth: tuple[int, int]) -> Harmonic:
        """Return the harmonic for wheels with these numbers of teeth."""
        return Harmonic(self._order(teeth), self.cos, self.sin)


class BacklashHarmonic(_Wave):
    """A harmonic of the backlash; `wheel` is the one that `shaft` refers to."""

    cos: float = quantity("mm", "a_n", "amplitude of the cosine", -10.0, 10.0, default=0.0)
    sin: float = quantity("mm", "b_n", "amplitude of the sine", -10.0, 10.0, default=0.0)

    def harmonic(self, teeth: tuple[int, int], unit: float) -> Harmonic:
        """Return the harmonic for wheels with these numbers of teeth, in `unit` mm."""
        return Harmonic(self._order(teeth), self.cos / unit, self.sin / unit)


class ToothStiffness(Section):
    """A factor of the stiffness of one tooth.

    Tooth 0 is in single contact at half a mesh period.
    """

    wheel: Literal[3, 2] = 3
    tooth: int = quantity("1", "", "number of the tooth, from 0", 0, 999)
    factor: float = quantity("1", "", "factor of its stiffness; 0 is a missing tooth", 0.0, 10.0)
