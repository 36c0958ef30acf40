"""Benchmarks of orbits and basins, beside what a user would write with other packages."""
