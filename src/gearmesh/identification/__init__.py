"""The parameters that the paper does not print, inferred from its claims.

`factors` lists the open parameters, and `settings` reads their ranges. `sampling` draws samples of
them and measures every claim of the ledger on each. `estimation` finds the values that are
compatible with the claims, and the parameters that influence a threshold.
"""
