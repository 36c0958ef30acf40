"""The ``gearmesh`` command: runs, tables and pictures without the pipeline.

`main` reads the command line; each other module holds commands of one kind. Modules that take
long to import are imported where they are needed, so ``gearmesh --help`` answers at once.
"""
