"""A whole Kubernetes here: the control plane, and a node that runs containers. Needs root.

It lives in a place apart (`tests/cluster/apart`), beside the container engine and unknown to it.
That is gone, to the last mount, control group, kernel setting and process, when the block ends, or
pytest does.
"""

import hashlib
import io
import json
import os
import subprocess
import tarfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from control_plane import NODE, PROGRAMS, Cluster, control_plane, runs, tools
from waiting import wait_until

APART = Path(__file__).with_name("apart")
NODE_PROGRAMS = (
    *("kube-scheduler", "kubelet", "containerd", "containerd-shim-runc-v2", "ctr", "busybox"),
    *("runc", "nsenter", "unshare", "findmnt", "pgrep", "ip", "docker"),
)
PAUSE = "edgevox.test/pause:1"
SOCKET = "/run/containerd.sock"
ADDRESS = "10.99.0.1"


@contextmanager
def node(folder: Path, image: str) -> Iterator[Cluster]:
    """A cluster whose node has this image of the container engine, as `IMAGE-next`, too."""
    programs = tools((*PROGRAMS, *NODE_PROGRAMS))
    where = Path(programs["containerd"]).parent
    with _place() as place, control_plane(folder, place) as cluster:
        _configure(folder, where / "cni")
        path = f"PATH={where}{os.pathsep}{os.environ['PATH']}"
        engine = ["env", path, programs["containerd"], "--config", str(folder / "containerd.toml")]
        with runs([*place, *engine], folder / "containerd.log"):
            ctr = [*place, programs["ctr"], "-a", SOCKET, "-n", "k8s.io", "images"]
            wait_until(lambda: _succeeds([*ctr, "list"]), "containerd")
            _load(ctr, programs, image)
            scheduler = [programs["kube-scheduler"], *_scheduler(folder)]
            kubelet = ["env", path, programs["kubelet"], *_kubelet(folder)]
            with (
                runs([*place, *scheduler], folder / "kube-scheduler.log"),
                runs([*place, *kubelet], folder / "kubelet.log"),
            ):
                wait_until(lambda: cluster.get("default", "nodes"), "the node")
                ready = ["wait", "--for=condition=Ready", "--timeout=10m", f"node/{NODE}"]
                cluster.run("kubectl", *ready)
                yield cluster


@contextmanager
def _place() -> Iterator[list[str]]:
    """What goes before a command, so that it runs there."""
    name = f"edgevox-node-{os.getpid()}"
    opened = [str(APART), "open", name]
    # A session of its own: what interrupts pytest must not interrupt the cleaning.
    with subprocess.Popen(
        opened, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, start_new_session=True
    ) as holder:
        assert holder.stdout
        assert holder.stdin
        first = holder.stdout.readline().strip()
        assert first, "no place apart: it takes root, and a kernel with all namespaces"
        try:
            yield [str(APART), "in", name, first]
        finally:
            holder.stdin.close()
            assert holder.wait() == 0, "something of the place apart is left"


def _succeeds(command: Sequence[str]) -> bool:
    return subprocess.run(command, capture_output=True).returncode == 0


def _load(ctr: Sequence[str], programs: dict[str, str], image: str) -> None:
    taken = [*ctr, "import", "-"]
    pause = _pause(Path(programs["busybox"]).read_bytes())
    subprocess.run(taken, input=pause, check=True, capture_output=True)
    saved = [programs["docker"], "save", image]
    with subprocess.Popen(saved, stdout=subprocess.PIPE) as saving:
        subprocess.run(taken, stdin=saving.stdout, check=True, capture_output=True)
    assert saving.returncode == 0, f"the container engine has no {image}; docker/image makes it"
    name = f"docker.io/library/{image}"
    subprocess.run([*ctr, "tag", name, f"{name}-next"], check=True, capture_output=True)


def _pause(program: bytes) -> bytes:
    """The image that holds a pod's namespaces: one program that sleeps."""
    layer = _tar({"busybox": program})
    config = {
        "architecture": "amd64",
        "os": "linux",
        "config": {"Cmd": ["/busybox", "sleep", "infinity"]},
        "rootfs": {"type": "layers", "diff_ids": [f"sha256:{hashlib.sha256(layer).hexdigest()}"]},
    }
    manifest = [{"Config": "config.json", "RepoTags": [PAUSE], "Layers": ["layer.tar"]}]
    return _tar(
        {
            "config.json": json.dumps(config).encode(),
            "layer.tar": layer,
            "manifest.json": json.dumps(manifest).encode(),
        }
    )


def _tar(files: dict[str, bytes]) -> bytes:
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode="w") as archive:
        for name, content in files.items():
            entry = tarfile.TarInfo(name)
            entry.size, entry.mode = len(content), 0o755
            archive.addfile(entry, io.BytesIO(content))
    return packed.getvalue()


def _configure(folder: Path, plugins: Path) -> None:
    """All that is kept is in the place's memory, under /var/lib and /run."""
    network = folder / "cni"
    network.mkdir()
    (network / "node.conflist").write_text(json.dumps(_network()))
    (folder / "containerd.toml").write_text(_toml(network, plugins))
    (folder / "kubelet.json").write_text(json.dumps(_kubelet_configuration(folder)))


def _network() -> dict[str, Any]:
    addresses = {
        "type": "host-local",
        "ranges": [[{"subnet": "10.99.1.0/24"}]],
        "routes": [{"dst": "0.0.0.0/0"}],
    }
    bridge = {"type": "bridge", "bridge": "pods", "isGateway": True, "ipam": addresses}
    return {"cniVersion": "1.0.0", "name": "pods", "plugins": [bridge]}


def _toml(network: Path, plugins: Path) -> str:
    return f"""\
version = 3
root = "/var/lib/containerd"
state = "/run/containerd"
disabled_plugins = ["io.containerd.internal.v1.opt", "io.containerd.nri.v1.nri"]
[grpc]
address = "{SOCKET}"
[plugins."io.containerd.cri.v1.runtime"]
restrict_oom_score_adj = true
disable_apparmor = true
[plugins."io.containerd.cri.v1.runtime".cni]
bin_dir = "{plugins}"
conf_dir = "{network}"
[plugins."io.containerd.cri.v1.runtime".containerd.runtimes.runc]
runtime_type = "io.containerd.runc.v2"
[plugins."io.containerd.cri.v1.runtime".containerd.runtimes.runc.options]
SystemdCgroup = false
[plugins."io.containerd.cri.v1.images"]
snapshotter = "overlayfs"
[plugins."io.containerd.cri.v1.images".pinned_images]
sandbox = "{PAUSE}"
"""


def _kubelet_configuration(folder: Path) -> dict[str, Any]:
    return {
        "apiVersion": "kubelet.config.k8s.io/v1beta1",
        "kind": "KubeletConfiguration",
        "authentication": {
            "anonymous": {"enabled": False},
            "webhook": {"enabled": False},
            "x509": {"clientCAFile": str(folder / "ca.crt")},
        },
        "authorization": {"mode": "AlwaysAllow"},
        "containerRuntimeEndpoint": f"unix://{SOCKET}",
        "cgroupDriver": "cgroupfs",
        "cgroupsPerQOS": False,
        "enforceNodeAllocatable": [],
        "failCgroupV1": False,
        "failSwapOn": False,
        "makeIPTablesUtilChains": False,
        "evictionHard": {"memory.available": "100Mi"},
        "imageGCHighThresholdPercent": 99,
        "resolvConf": "",
        "volumePluginDir": "/var/lib/kubelet-plugins",
    }


def _kubelet(folder: Path) -> list[str]:
    return [
        f"--config={folder / 'kubelet.json'}",
        f"--kubeconfig={folder / 'node.json'}",
        f"--hostname-override={NODE}",
        f"--node-ip={ADDRESS}",
        "--root-dir=/var/lib/kubelet",
        "--cert-dir=/var/lib/kubelet/pki",
    ]


def _scheduler(folder: Path) -> list[str]:
    config = folder / "scheduler.json"
    return [f"--kubeconfig={config}", "--leader-elect=false", "--secure-port=0"]
