"""Where runs end: attractors, their basins, Lyapunov exponents, and the time that it takes.

The modules may import the other modules of the dynamics, the model and the solvers.
"""
