"""Kinds of special points. Code that only reads results needs these names, but no solver."""

BIFURCATIONS = ("fold", "branch_point", "flip", "torus")
"""Points where a multiplier reaches the unit circle."""

GRAZINGS = ("grazing_front", "grazing_back")
"""Points where flanks begin to touch or to part."""

KINDS = (*BIFURCATIONS, *GRAZINGS, "switching")
"""All kinds."""
