"""The general solver: one run at a time in the six coordinates, with every term of eq. (1).

`runs` prepares it, `tape` records its equations, and `recurrences` makes machine code of them.
`kernel` integrates it by Taylor series (`series`) from event to event (`roots`, `signs`) and
records it (`measures`). The package may import `gearmesh.model` and the modules of
`gearmesh.solvers` beside it, but not `reduced`.
"""
