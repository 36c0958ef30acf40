"""The paper's study, verified: every case again, by the solver of others and from the paper alone.

`python -m verification` (`make verify`) integrates all cases with heyoka, compares them with the
case files, and compares the hashes of all numbers with those that are committed for this version.
Nothing here uses the equations, the units or the variants of `gearmesh`.
"""
