"""What the motion means: orbits, their stability and branches, attractors, and response curves.

`orbits`, `branches` and `special_points` find periodic orbits and follow them; `attraction` finds
where runs end. The package may import the solvers and the model.
"""
