"""Planning for the Snakefile, and the code of its jobs.

`plan` states what each job of a study is made of, `stages` are the jobs as plain functions, and
``python -m gearmesh.pipeline STAGE`` runs one of them. It may import everything else; nothing else
imports it.
"""
