"""What lies behind the curves of Figs. 2 and 3: orbits, attractors, and what a start sees of them.

Each module computes one dataset of the study, `figures` draws them, and `answers` puts what they
say into numbers. The package may import the public functions and all below them.
"""
