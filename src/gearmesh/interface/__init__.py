"""The public functions: they take a pair, a variant and ν_s, and return datasets with units.

``import gearmesh as gm`` provides them. They may import the model, the solvers, the dynamics, the
study and the data, but nothing that needs Snakemake or matplotlib.
"""
