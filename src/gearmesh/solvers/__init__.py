"""From the statement of a run to its response, for one run or thousands.

`simulation.simulate` is the entry; `reduced` is the fast solver of the two coordinates that most
runs need, `full` solves all six. The package may import `gearmesh.model`, NumPy and numba.
"""
