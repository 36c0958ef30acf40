"""Reading what a study states: strict YAML, declared sections, units and provenance.

`yamlfile` reads the text, `schema` checks its sections against their declarations, `units` turns
quantities into floats, and `provenance` says where a value comes from.
"""
