"""Cases, datasets and a figure of the small study on a real Slurm: the same bytes."""

import os
import shutil
import socket
import subprocess
import tempfile
import time
from pathlib import Path

import pytest
from project import Project

PLACE = Path("/etc/slurm/slurm.conf")
"""Path where Slurm searches by default; its processes do not inherit $SLURM_CONF."""

NEEDED = ("munged", "slurmctld", "slurmd", "sbatch", "squeue")

OURS = "# of the tests of gearmesh"
"""First line of a file that a killed test leaves behind."""

CONF = """\
{ours}
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
AuthInfo=socket={folder}/munge.socket
SlurmctldPort={controller}
SlurmdPort={daemon}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory={memory} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@pytest.fixture(scope="module")
def slurm():
    """A Slurm of one node, on this machine."""
    lacking = [name for name in NEEDED if shutil.which(name) is None]
    if lacking:
        pytest.skip(f"not installed: {', '.join(lacking)}")
    if os.geteuid():
        pytest.skip("starting Slurm needs root")
    if PLACE.exists() and not PLACE.read_text().startswith(OURS):
        pytest.skip(f"{PLACE} is there: this machine has a Slurm of its own")
    folder = Path(tempfile.mkdtemp(prefix="slurm-"))
    folder.chmod(0o755)  # munged wants its socket to be within reach of all
    for name in ("state", "spool"):
        (folder / name).mkdir()
    key = folder / "munge.key"
    key.write_bytes(os.urandom(128))
    key.chmod(0o400)
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2**20
    PLACE.parent.mkdir(exist_ok=True)
    PLACE.write_text(
        CONF.format(
            ours=OURS,
            host=socket.gethostname().split(".")[0],
            folder=folder,
            controller=free_port(),
            daemon=free_port(),
            cpus=os.cpu_count(),
            memory=memory * 9 // 10,
        )
    )
    munge = [f"--{name}-file={folder}/munged.{name}" for name in ("pid", "log", "seed")]
    commands = (
        ["munged", "--foreground", f"--key-file={key}", f"--socket={folder}/munge.socket", *munge],
        ["slurmctld", "-D"],
        ["slurmd", "-D"],
    )
    daemons = []
    try:
        for command in commands:
            log = (folder / f"{command[0]}.out").open("w")
            daemons.append(subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT))
            time.sleep(1)
        wait_until_idle(folder)
        yield
    finally:
        for daemon in reversed(daemons):
            daemon.terminate()
        for daemon in daemons:
            try:
                daemon.wait(timeout=30)
            except subprocess.TimeoutExpired:
                daemon.kill()
        PLACE.unlink()
        shutil.rmtree(folder, ignore_errors=True)


def wait_until_idle(folder: Path) -> None:
    for _ in range(60):
        found = subprocess.run(
            ["sinfo", "--noheader", "--format=%T"], capture_output=True, text=True, check=False
        )
        if "idle" in found.stdout:
            return
        time.sleep(0.5)
    logs = "\n".join(path.read_text()[-500:] for path in folder.glob("*.out"))
    pytest.skip(f"Slurm does not start on this machine: {found.stdout}{found.stderr}{logs}")


@pytest.mark.timeout(900)
def test_slurm_gives_the_bytes_of_a_local_run(slurm, smoke: Project, tmp_path: Path):
    project = smoke.copy(tmp_path / "project")
    for name in ("batches/c.nc", "datasets/resonance.nc", "figures/fig2.png"):
        (project.study / name).unlink()
    for folder in project.study.glob("cases/c-*"):
        shutil.rmtree(folder)
    polled = ("--slurm-init-seconds-before-status-checks", "5")
    figure = "results/smoke/figures/fig2.png"  # needs cases, datasets and a notebook
    finished = project.run(figure, options=("--profile", "profiles/slurm", *polled))
    assert finished.returncode == 0, finished.stdout
    assert "SLURM" in finished.stdout, finished.stdout
    made, expected = project.results(), smoke.results()
    assert {"figures/fig2.png", "datasets/resonance.nc", "batches/c.nc"} <= made.keys()
    assert made == expected
