"""What the paper does not print, inferred from what it says.

The open parameters are sampled over plausible ranges (`design`), every claim of the ledger is
measured on each sample (`survey`), and the measures are weighed against the paper's words
(`wording`) to tell which values fit (`inference`), which claims hold whatever the values are and
which parameter moves which threshold (`sensitivity`). `synthetic` checks all of it on papers whose
parameters are known.
"""
