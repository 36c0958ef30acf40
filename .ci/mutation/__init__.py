"""Mutants: small changes of sources, and the tests that notice them.

`changes` makes them, `live` puts them in place, `tests` runs the tests that should notice, and
`processes` forks a process for each. `.ci/mutants.py` says which files and which tests.
"""
