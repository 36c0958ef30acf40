"""The pages that a reader opens: the report, the executed notebooks and the explorer.

`page` fills the templates with the numbers of a study, and `why` with those that explain its jumps.
`explorer` makes one page that integrates in the browser. The package may import all but the
pipeline and the commands.
"""
