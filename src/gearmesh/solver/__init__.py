"""The two solvers behind `gearmesh.integrator`.

`sweep`, with `events`, `taylor` and `lanes` under it, integrates the reduced system, many runs at
a time; `general`, with `general_kernel`, `general_series` and `general_roots`, one run in the six
coordinates. `compilation` keeps compiled code on disk.
"""
