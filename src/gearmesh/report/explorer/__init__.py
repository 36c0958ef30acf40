"""The explorer: one page with the results of a study, and with a solver that runs in it.

`page` joins the template, the scripts and the numbers; `numbers` packs the numbers, `controls`
lists the parameters that the page can change, `views` the links that lead to a view. The package
may import what the report may.
"""
