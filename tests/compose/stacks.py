"""Compose stacks for tests: real ones, each a project of its own, gone when the test is over."""

import json
import secrets
import subprocess
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import NamedTemporaryFile

from guards import HUNG_S
from mcap.reader import make_reader
from testcontainers.compose import DockerCompose

ROOT = Path(__file__).resolve().parents[2]
BASE = "docker-compose.ros2.yml"
ENTRYPOINT = "/opt/edgevox/entrypoint/entrypoint"
PATIENCE = "500"
"""So many seconds a probe waits for what should come."""
PROBE = (Path(__file__).parent / "probe.py").read_text()


class Stack:
    """A running project, as `docker compose` sees it."""

    def __init__(self, compose: DockerCompose, project: str) -> None:
        self._command = compose.docker_compose_command()
        self.project = project

    def call(self, *arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
        """`docker compose ...`, whatever its exit code."""
        command = [*self._command, *arguments]
        return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, **options)

    def execute(self, service: str, *command: str, stdin: str = "") -> str:
        """The output of a command in a service's container, in the sourced environment."""
        ran = self.call("exec", "-T", service, ENTRYPOINT, *command, input=stdin, timeout=HUNG_S)
        assert ran.returncode == 0, ran.stdout + ran.stderr
        return ran.stdout

    def probe(self, service: str, *arguments: str) -> dict:
        """What `probe.py` heard from inside a service's container."""
        return _last_line(self.execute(service, "python3", "-", *arguments, stdin=PROBE))

    def probe_from_beside(
        self, service: str, *arguments: str, given: Mapping[str, str] | None = None
    ) -> dict:
        """The same from a container of its own, made from the service, with more variables."""
        more = [f"--env={name}={value}" for name, value in (given or {}).items()]
        run = ("run", "--rm", "--no-deps", "-T", *more, service, "python3", "-")
        ran = self.call(*run, *arguments, input=PROBE, timeout=HUNG_S)
        assert ran.returncode == 0, ran.stdout + ran.stderr
        return _last_line(ran.stdout)

    def inspect(self, service: str) -> dict:
        """Everything that the engine knows of a service's container."""
        (identity,) = self.call("ps", "--all", "--quiet", service).stdout.split()
        return json.loads(docker("inspect", identity))[0]

    def logs(self, service: str) -> str:
        return self.call("logs", "--no-log-prefix", service).stdout


def _last_line(output: str) -> dict:
    """What the probe wrote; before it Fast DDS may complain on stdout."""
    return json.loads(output.splitlines()[-1])


def docker(*arguments: str) -> str:
    """The output of `docker ...`, which must go well."""
    ran = subprocess.run(["docker", *arguments], capture_output=True, text=True, timeout=HUNG_S)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout


@contextmanager
def stack(
    *overlays: str, services: Sequence[str] = (), start: bool = True, **environment: str
) -> Iterator[Stack]:
    """The base file with these overlays, up and healthy; with `start` false only ready to go."""
    files = [BASE, *(f"compose/{name}.yml" for name in overlays)]
    environment["COMPOSE_PROJECT_NAME"] = f"edgevox-test-{secrets.token_hex(4)}"
    with NamedTemporaryFile("w", encoding="utf-8", suffix=".env") as settings:
        settings.writelines(f"{name}={value}\n" for name, value in environment.items())
        settings.flush()
        compose = DockerCompose(ROOT, files, env_file=settings.name, services=list(services))
        one = Stack(compose, environment["COMPOSE_PROJECT_NAME"])
        try:
            if start:
                _start(compose, one)
            yield one
        finally:
            compose.services = None  # all of them, and the network
            compose.stop()


def _start(compose: DockerCompose, one: Stack) -> None:
    try:
        compose.start()
    except subprocess.CalledProcessError as error:
        said = error.stderr.decode() + one.call("logs").stdout
        raise AssertionError(f"the stack did not come up:\n{said}") from None


def count_messages(folder: Path) -> Counter[str]:
    """How many messages of each topic the recordings in a folder hold."""
    counted = Counter[str]()
    for file in folder.rglob("*.mcap"):
        with file.open("rb") as stream:
            summary = make_reader(stream).get_summary()
        for number, count in summary.statistics.channel_message_counts.items():
            counted[summary.channels[number].topic] += count
    return counted
