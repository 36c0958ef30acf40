"""How periodic motions change with parameters: branches, and their special points.

`curves` corrects and predicts orbits along a curve, `tracing` with compiled code, and `walks` goes
along it. `suspects` finds the pieces of a branch that may hold special points, and `special_points`
finds them there, as `zeros` of `test_functions`. `branches` follows an orbit in one parameter, and
`special_curves` a special point in two.
"""
