"""Benchmarks: the solver beside the best peers, on the same runs with the same outputs."""
