"""The results as a small file: written by the identification, read by report and notebook."""

from pathlib import Path
from typing import Any

import yaml

from gearmesh.data.writing import write_text
from gearmesh.errors import InputError
from gearmesh.identification.layout import IDENTIFIED
from gearmesh.study.reading import yamlfile

HEADER = """\
# The parameters that the paper does not print, inferred from its claims by the method of
# docs/identification.md. Made by `make identify` from config/identify.yaml and config/claims.yaml:
# do not edit. Shares are of the plausible space, regions have probability 0.95.
"""

_SHORT = 90

Findings = dict[str, Any]
"""See `gearmesh.identification.estimation.findings.findings`."""


class _Dumper(yaml.SafeDumper):
    """Dumper that writes short values in one line and uses no anchors."""

    def represent_mapping(
        self, tag: str, mapping: Any, flow_style: bool | None = None
    ) -> yaml.MappingNode:
        return super().represent_mapping(tag, mapping, len(str(mapping)) <= _SHORT)

    def represent_sequence(
        self, tag: str, sequence: Any, flow_style: bool | None = None
    ) -> yaml.SequenceNode:
        return super().represent_sequence(tag, sequence, len(str(sequence)) <= _SHORT)

    def ignore_aliases(self, data: object) -> bool:
        return True


def write(path: Path, findings: Findings) -> None:
    """Write findings, the same bytes for the same findings."""
    text = yaml.dump(findings, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=100)
    write_text(path, HEADER + text)


def read(path: Path = IDENTIFIED) -> Findings:
    """Read findings.

    Raises
    ------
    InputError
        If the file is missing, or not one of findings.
    """
    found = yamlfile.read_mapping(path)
    for section in ("samples", "claims", "joint", "regions", "sensitivity", "recovery"):
        if not isinstance(found.get(section), dict):
            raise InputError(f"{path}: {section}: missing; run make identify")
    return found
