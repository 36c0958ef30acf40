"""Manifests: what sha256sum checks, and what they contain."""

import subprocess

from gearmesh.data import manifest


def test_a_manifest_names_what_was_written_and_read(tmp_path):
    for name in ("one.nc", "two.nc", "read.nc"):
        (tmp_path / name).write_text(name)
    path = tmp_path / "job.sha256"
    written = [tmp_path / "two.nc", tmp_path / "one.nc"]
    manifest.write(path, tmp_path, "0123", written, [tmp_path / "read.nc"])
    held = manifest.read(path)
    assert held.made_of == "0123"
    assert [*held.written] == ["one.nc", "two.nc"]
    assert [*held.read] == ["read.nc"]
    command = ["sha256sum", "--check", "--strict", path.name]
    assert subprocess.run(command, cwd=tmp_path, capture_output=True).returncode == 0
    (tmp_path / "two.nc").write_text("2")
    assert subprocess.run(command, cwd=tmp_path, capture_output=True).returncode != 0
    assert manifest.Hashes(tmp_path).of(["two.nc", "none.nc"])["none.nc"] is None


def test_what_is_no_manifest_is_none(tmp_path):
    for content in (b"", b"something\n", b"\xff\xfe"):
        (tmp_path / "job.sha256").write_bytes(content)
        assert manifest.read(tmp_path / "job.sha256") is None
    assert manifest.read(tmp_path / "missing.sha256") is None
