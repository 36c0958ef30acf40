"""The public functions: a pair, a variant and ν_s in, xarray datasets with units out.

They are what ``import gearmesh as gm`` offers. They may import the model, the solvers, the
dynamics, the study and the data, and nothing that needs Snakemake or matplotlib.
"""
