"""SIMD lanes for numba: a vector of doubles as one value of a compiled function.

One lane holds one run, and every operation acts on all lanes at once. All of them are the IEEE
operations of a single double (and the fused multiply-add, which is exact before its one
rounding), so a lane's result depends neither on the number of lanes nor on its neighbours:
ensembles equal single runs bit for bit.

The package holds only what the solver needs, and imports numba and llvmlite alone. A compiled
function takes the number of lanes from an argument of lane type (``like``), made by
`operations.zeros8` or `operations.zeros1`.
"""
