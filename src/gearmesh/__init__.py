"""Nonlinear damping in a six-degree-of-freedom spur gear mesh: a reproducibility study."""

__version__ = "0.1.0"
