"""The gear pair and its laws: the statement of one run, and its equations of motion.

The laws are plain functions of floats and NumPy arrays, each stated once, with its equation in the
paper. The package may import NumPy and `gearmesh.errors`, and nothing else: no I/O, no numba.
"""
