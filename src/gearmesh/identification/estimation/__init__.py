"""The values of the open parameters that are compatible with the claims of the paper.

`wording` compares measured values with the words of the paper. `inference` finds the values that
fit, `analysis` applies it to the samples, and `sensitivity` shows which parameters influence a
threshold. `prediction` and `synthetic` test the method. `findings` unites all results.
"""
