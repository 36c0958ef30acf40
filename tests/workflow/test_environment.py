"""What surrounds a run: another folder, interpreter, package, kernel, user or network."""

import os
import shutil
import subprocess
import sys
import venv
from pathlib import Path

import nbformat
import pytest
from project import ROOT, Project

from gearmesh.pipeline import notebooks
from gearmesh.pipeline.notebooks import run_notebook


@pytest.fixture
def place(tmp_path):
    """A folder with an environment that counts as made there."""
    folder = tmp_path / "place"
    (folder / ".ci").mkdir(parents=True)
    shutil.copy(ROOT / ".ci" / "stale_environment", folder / ".ci")
    for name in ("requirements.lock", "pyproject.toml"):
        shutil.copy(ROOT / name, folder)
    venv.create(folder / ".venv", symlinks=True, with_pip=False)
    (folder / ".venv" / ".installed").write_text(stale(folder, "--state") + "\n")
    assert stale(folder) == ""
    return folder


def stale(folder: Path, *arguments: str | Path) -> str:
    command = ["sh", ".ci/stale_environment", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True).stdout.strip()


def test_a_moved_environment_is_made_again(place):
    assert stale(place.rename(place.parent / "elsewhere")) == "another folder or lock"


def test_a_copied_environment_is_made_again(place):
    assert stale(Path(shutil.copytree(place, f"{place}-copy", symlinks=True))) != ""


def test_an_environment_without_interpreter_is_made_again(place):
    for name in ("python", "python3", f"python{sys.version_info[0]}.{sys.version_info[1]}"):
        (place / ".venv" / "bin" / name).unlink(missing_ok=True)
    (place / ".venv" / "bin" / "python").symlink_to(place / "gone")
    assert stale(place) == "no interpreter"


def test_another_lock_makes_the_environment_again(place):
    with (place / "requirements.lock").open("a") as lock:
        lock.write("# more\n")
    assert stale(place) == "another folder or lock"


def test_another_interpreter_makes_the_environment_again(place):
    assert stale(place, sys.executable) == ""
    other = place / "other"
    other.write_text("#!/bin/sh\necho /other 3.99\n")
    other.chmod(0o755)
    assert stale(place, other) == "another interpreter"


def test_make_shields_its_commands_from_settings_of_the_caller():
    foreign = {
        name: "/foreign"
        for name in (
            *("PYTHONPATH", "PYTHONHOME", "PYTHONUSERBASE", "JUPYTER_PATH"),
            *("PIP_USER", "PIP_PREFIX", "PIP_TARGET", "PIP_ROOT"),
        )
    }
    command = ["make", "--silent", "--eval", "probe: ; @env", "probe"]
    shown = subprocess.run(
        command, cwd=ROOT, env=os.environ | foreign, capture_output=True, text=True, check=True
    )
    assert "/foreign" not in shown.stdout


def test_make_brings_a_home_where_there_is_none():
    without = {name: value for name, value in os.environ.items() if name != "HOME"}
    command = ["make", "--silent", "--eval", "probe: ; @echo $$HOME", "probe"]
    shown = subprocess.run(
        command, cwd=ROOT, env=without, capture_output=True, text=True, check=True
    )
    assert shown.stdout.strip() == str(ROOT / ".venv")


def test_a_copied_checkout_that_would_run_other_code_is_refused(tmp_path):
    copy = Project.create(tmp_path / "copy", "config/tiny.yaml")
    copy.environment["PYTHONPATH"] = str(ROOT / "src")
    finished = copy.run("data")
    assert finished.returncode == 2
    assert finished.stdout.count("the code would come from") == 1
    assert "Traceback" not in finished.stdout
    assert not copy.study.exists()


NOBODY = """
import pwd
def unknown(*_):
    raise KeyError("getpwuid(): uid not found")
pwd.getpwuid = pwd.getpwnam = unknown
"""


def test_a_user_whom_the_system_does_not_know_can_plan_a_run(tmp_path):
    copy = Project.create(tmp_path / "copy", "config/tiny.yaml")
    (tmp_path / "sitecustomize.py").write_text(NOBODY)
    copy.environment["PYTHONPATH"] += f":{tmp_path}"
    for name in ("USER", "LOGNAME"):
        copy.environment.pop(name, None)
    copy.environment["HOME"] = "/nowhere"  # as `docker run --user 12345` has it
    finished = copy.execute("--dry-run", *copy.command("data"))
    assert finished.returncode == 0, finished.stdout
    assert "Traceback" not in finished.stdout


def test_imports_that_cannot_be_followed_are_refused():
    code = '"""Extra."""\n\nimport importlib\n\nfound = importlib.import_module("x")\n'
    command = [sys.executable, "-m", "ruff", "check", "--quiet"]
    checked = subprocess.run(
        [*command, "--stdin-filename", "src/gearmesh/extra.py", "-"],
        input=code,
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert "TID251" in checked.stdout
    for source in (ROOT / "src").rglob("*.py"):  # ruff cannot refuse a built-in function
        assert "__import__(" not in source.read_text(encoding="utf-8"), source


@pytest.fixture
def notebook(tmp_path):
    """A notebook that prints its interpreter, and a function that executes it and returns that."""
    cells = [nbformat.v4.new_code_cell("import sys\nprint(sys.executable)")]
    found = nbformat.v4.new_notebook(cells=cells)
    found.metadata.kernelspec = {"name": "python3", "display_name": "Python", "language": "python"}
    nbformat.write(found, tmp_path / "asks.ipynb")
    return tmp_path / "asks.ipynb"


def test_a_foreign_kernel_of_the_same_name_is_not_used(notebook, tmp_path, monkeypatch):
    kernel = tmp_path / "jupyter" / "kernels" / "python3"
    kernel.mkdir(parents=True)
    (kernel / "kernel.json").write_text('{"argv": ["false"], "display_name": "foreign"}')
    monkeypatch.setenv("JUPYTER_PATH", str(tmp_path / "jupyter"))
    for name in ("DATA_DIR", "CONFIG_DIR", "RUNTIME_DIR", "PLATFORM_DIRS"):
        monkeypatch.setenv(f"JUPYTER_{name}", "")
    monkeypatch.setenv("IPYTHONDIR", "")
    run_notebook(notebook, tmp_path / "out.ipynb", {}, tmp_path / "scratch")
    [cell] = nbformat.read(tmp_path / "out.ipynb", as_version=4).cells
    assert cell.outputs[0].text.strip() == sys.executable


def test_a_notebook_needs_no_loopback_interface(notebook, tmp_path):
    code = (
        "import sys\nfrom pathlib import Path\n"
        "from gearmesh.pipeline.notebooks import run_notebook\n"
        "run_notebook(*map(Path, sys.argv[1:3]), {}, Path(sys.argv[3]))"
    )
    alone = ["unshare", "--net", "--map-root-user"]
    if subprocess.run([*alone, "true"], capture_output=True).returncode:
        pytest.skip("this machine lets nobody cut a process from the network")
    arguments = (notebook, tmp_path / "out.ipynb", tmp_path / "scratch")
    command = [*alone, sys.executable, "-c", code, *arguments]
    environment = os.environ | {"PYTHONPATH": str(ROOT / "src")}
    subprocess.run(command, env=environment, check=True, timeout=100)
    [cell] = nbformat.read(tmp_path / "out.ipynb", as_version=4).cells
    assert cell.outputs[0].text.strip() == sys.executable


def test_a_long_temporary_folder_makes_kernels_use_the_network():
    assert notebooks._local("x" * 60)["KernelManager"]["transport"] == "ipc"
    assert notebooks._local("x" * 100) == {}
