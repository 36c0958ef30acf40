"""Samples of the open parameters, and every claim measured on each of them.

`design` draws samples over plausible ranges, and `boxes` weighs those that were drawn in a part of
them. `survey` measures the claims on the response curves of `curves`. `store` keeps the results.
"""
