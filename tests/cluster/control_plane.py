"""Kubernetes' own control plane without a node: its API, its admission and its controllers.

What a cluster makes of a release is decided here; containers run nowhere, so a pod is never ready
unless a test says so. Programs come from `CLUSTER_TOOLS` or the PATH, ports are free ones, and all
that is written is in one folder.
"""

import json
import os
import shutil
import socket
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from waiting import wait_until

PROGRAMS = ("etcd", "kube-apiserver", "kube-controller-manager", "kubectl", "helm", "openssl")
STOP_S = 30.0
NODE = "n1"
USERS = {
    "admin": "/O=system:masters/CN=admin",
    "controllers": "/CN=system:kube-controller-manager",
    "scheduler": "/CN=system:kube-scheduler",
    "node": f"/O=system:nodes/CN=system:node:{NODE}",
}


def tools(programs: Sequence[str] = PROGRAMS) -> dict[str, str]:
    """Where each program is. Fails by name for those that are nowhere."""
    path = os.pathsep.join([os.environ.get("CLUSTER_TOOLS", ""), os.environ["PATH"]])
    found = {name: shutil.which(name, path=path) for name in programs}
    missing = [name for name, where in found.items() if where is None]
    assert not missing, f"not here: {', '.join(missing)}; tests/cluster/get_tools says from where"
    return {name: str(where) for name, where in found.items()}


class Cluster:
    """The cluster as an administrator has it. `place` goes before each command."""

    def __init__(
        self, programs: Mapping[str, str], config: Path, place: Sequence[str] = ()
    ) -> None:
        self._programs = programs
        self._config = config
        self._place = place
        self.folder = config.parent

    def run(
        self, program: str, *arguments: str, check: bool = True
    ) -> subprocess.CompletedProcess[str]:
        """Run kubectl or helm; what they say is in the result, and in the failure."""
        ran = subprocess.run(
            [*self._place, self._programs[program], *arguments],
            env=os.environ | {"KUBECONFIG": str(self._config)},
            capture_output=True,
            text=True,
        )
        assert ran.returncode == 0 or not check, f"{program} {arguments}: {ran.stderr}"
        return ran

    def get(self, namespace: str, kinds: str, selector: str = "") -> list[dict[str, Any]]:
        """The objects of these kinds."""
        chosen = ["--selector", selector] if selector else []
        found = self.run("kubectl", "-n", namespace, "get", kinds, *chosen, "-o", "json").stdout
        return list(json.loads(found)["items"])


@contextmanager
def control_plane(folder: Path, place: Sequence[str] = ()) -> Iterator[Cluster]:
    """Up until the block ends; the logs of its programs stay in the folder."""
    programs = tools()
    etcd, peer, api = _free_ports(3)
    _certificates(programs["openssl"], folder)
    for user in USERS:
        (folder / f"{user}.json").write_text(json.dumps(_config(folder, user, api)))
    cluster = Cluster(programs, folder / "admin.json", place)
    with ExitStack() as running:
        for name, arguments in (
            ("etcd", _etcd(folder, etcd, peer)),
            ("kube-apiserver", _api(folder, etcd, api)),
        ):
            command = [*place, programs[name], *arguments]
            running.enter_context(runs(command, folder / f"{name}.log"))
        ready = lambda: cluster.run("kubectl", "get", "--raw", "/readyz", check=False)  # noqa: E731
        wait_until(lambda: ready().returncode == 0, "Kubernetes")
        name = "kube-controller-manager"
        command = [*place, programs[name], *_controllers(folder)]
        running.enter_context(runs(command, folder / f"{name}.log"))
        yield cluster


@contextmanager
def runs(command: Sequence[str], log: Path) -> Iterator[None]:
    """A program until the block ends, and what it says in the log."""
    with (
        log.open("wb") as output,
        subprocess.Popen(command, stdout=output, stderr=output) as process,
    ):
        try:
            yield
            assert process.poll() is None, f"{command} ended: {log.read_text('utf-8')[-2000:]}"
        finally:
            process.kill()
            process.wait(STOP_S)


def _free_ports(count: int) -> list[int]:
    with ExitStack() as held:
        sockets = [held.enter_context(socket.socket()) for _ in range(count)]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        return [int(one.getsockname()[1]) for one in sockets]


def _certificates(openssl: str, folder: Path) -> None:
    """An authority, and what it signed for the API and its users."""
    new = ["req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2"]
    authority = ["-CA", str(folder / "ca.crt"), "-CAkey", str(folder / "ca.key")]
    names = "subjectAltName=IP:127.0.0.1"
    for name, subject, more in (
        ("ca", "/CN=ca", []),
        ("api", "/CN=kube-apiserver", [*authority, "-addext", names]),
        *((user, subject, authority) for user, subject in USERS.items()),
    ):
        files = ["-keyout", str(folder / f"{name}.key"), "-out", str(folder / f"{name}.crt")]
        made = [openssl, *new, *files, "-subj", subject, *more]
        subprocess.run(made, check=True, capture_output=True)


def _config(folder: Path, user: str, port: int) -> dict[str, Any]:
    key = {
        "client-certificate": str(folder / f"{user}.crt"),
        "client-key": str(folder / f"{user}.key"),
    }
    server = {
        "server": f"https://127.0.0.1:{port}",
        "certificate-authority": str(folder / "ca.crt"),
    }
    return {
        "apiVersion": "v1",
        "kind": "Config",
        "clusters": [{"name": "c", "cluster": server}],
        "users": [{"name": "u", "user": key}],
        "contexts": [{"name": "x", "context": {"cluster": "c", "user": "u"}}],
        "current-context": "x",
    }


def _etcd(folder: Path, port: int, peer: int) -> list[str]:
    clients, peers = f"http://127.0.0.1:{port}", f"http://127.0.0.1:{peer}"
    return [
        f"--data-dir={folder / 'etcd'}",
        "--unsafe-no-fsync",
        f"--listen-client-urls={clients}",
        f"--advertise-client-urls={clients}",
        f"--listen-peer-urls={peers}",
        f"--initial-advertise-peer-urls={peers}",
        f"--initial-cluster=default={peers}",
    ]


def _api(folder: Path, etcd: int, port: int) -> list[str]:
    return [
        f"--etcd-servers=http://127.0.0.1:{etcd}",
        "--authorization-mode=Node,RBAC",
        "--service-cluster-ip-range=10.222.0.0/24",
        "--endpoint-reconciler-type=none",
        "--advertise-address=127.0.0.1",
        "--bind-address=127.0.0.1",
        f"--secure-port={port}",
        f"--client-ca-file={folder / 'ca.crt'}",
        f"--tls-cert-file={folder / 'api.crt'}",
        f"--tls-private-key-file={folder / 'api.key'}",
        f"--service-account-key-file={folder / 'api.key'}",
        f"--service-account-signing-key-file={folder / 'api.key'}",
        "--service-account-issuer=https://localhost",
        "--kubelet-preferred-address-types=InternalIP",
        f"--kubelet-client-certificate={folder / 'admin.crt'}",
        f"--kubelet-client-key={folder / 'admin.key'}",
    ]


def _controllers(folder: Path) -> list[str]:
    return [
        f"--kubeconfig={folder / 'controllers.json'}",
        f"--service-account-private-key-file={folder / 'api.key'}",
        f"--root-ca-file={folder / 'ca.crt'}",
        "--use-service-account-credentials",
        "--leader-elect=false",
        "--secure-port=0",
    ]
