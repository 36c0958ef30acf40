"""What the tests of studies share: a folder with the paper's configuration, and a writer."""

import pytest

from gearmesh.data import paths
from gearmesh.errors import InputError
from gearmesh.study.loading import load_study


@pytest.fixture
def paper(root):
    return root / paths.PAPER


@pytest.fixture
def write(tmp_path, paper):
    """Return a function that writes a file beside a copy of the paper's configuration."""
    (tmp_path / "paper.yaml").write_bytes(paper.read_bytes())

    def write(text, name="study.yaml"):
        file = tmp_path / name
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        return file

    return write


@pytest.fixture
def refused(write):
    """Return a function that loads a wrong file and returns the message."""

    def refused(text):
        file = write(text)
        with pytest.raises(InputError) as caught:
            load_study(file)
        message = str(caught.value)
        assert message.startswith(f"{file}: ")
        assert "\n" not in message
        return message.removeprefix(f"{file}: ")

    return refused
