"""The paper: its study, its claims and their checks, its equations and its figures.

Nothing here is part of the library. The package may import the public functions and all below
them.
"""
