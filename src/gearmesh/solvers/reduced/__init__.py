"""The fast solver: runs without run-out, many at a time in the lanes of SIMD vectors.

`runs` prepares them, `sweep` integrates them by Taylor series (`taylor`) from event to event
(`events`, `transitions`) and records them (`records`, `measures`) in one `workspace`. `ensembles`
moves many states on together. `derivatives` follows one motion with its exact derivatives. The
package may import `gearmesh.model` and the modules of `gearmesh.solvers` beside it, but not `full`.
"""
