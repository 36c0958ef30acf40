"""Results in files: NetCDF for cases, batches and datasets, with their hashes and provenance.

`casefile` says what a case file holds, and `datasets` joins cases over variants and frequencies.
`paths` names the place of every file, and `writing` puts each there whole or not at all. The
package may import `gearmesh.study`, `gearmesh.solvers` and `gearmesh.model`.
"""
