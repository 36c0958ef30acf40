"""How periodic motions change with parameters: branches, and their special points.

`curves` corrects and predicts orbits along a curve, and `walks` goes along it. `branches` follows
an orbit in one parameter, and `special_curves` a special point in two.
"""
