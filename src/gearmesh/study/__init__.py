"""A study as stated in YAML: a gear pair with units and provenance, its frequencies and its cases.

`reading` turns text into checked values. `parameters` declares every parameter, and `pair` holds
their values and what follows from them. `problem` states the dimensionless run of one case, and
`loading` reads a whole study. The package may import `gearmesh.model`.
"""
