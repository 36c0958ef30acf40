"""Periodic motions: orbits of both solvers, with their multipliers and what they rest on.

`orbits` holds those of the reduced system, with exact derivatives, and `general_orbits` those of
the general solver. `shots` says what both have in common, so that branches and attractors serve
both.
"""
