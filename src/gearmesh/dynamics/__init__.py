"""What the motion means: orbits, their stability and branches, attractors, and response curves.

`periodic` finds orbits, `continuation` follows them, and `attraction` finds where runs end.
`response_curves` and `sweeps` join many runs. The package may import the solvers and the model.
"""
