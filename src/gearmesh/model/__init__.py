"""What the gear pair is and which laws act in it: one run stated, and its equations of motion.

The laws are plain functions of floats and NumPy arrays, each stated once, with its equation in the
paper. The package may import NumPy and `gearmesh.errors`, and nothing else: no I/O, no numba.
"""
