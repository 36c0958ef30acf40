"""The parameters that the paper does not print, inferred from its claims.

`factors` lists the open parameters. `design` samples them over plausible ranges, and `survey`
measures every claim of the ledger on each sample. `wording` compares the measurements with the
words of the paper. `inference` finds the values that are compatible with the claims, and
`sensitivity` the parameters that influence a threshold. `synthetic` checks the method on papers
with known parameters.
"""
