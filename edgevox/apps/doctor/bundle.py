"""`edgevox doctor --bundle FILE`: one archive for whoever helps from elsewhere, without secrets.

Every text in it goes through `Redaction`, whatever it is. Log lines are given with `--logs`: a
program in a container cannot read what the engine keeps of it.
"""

import gzip
import http.client
import json
import os
import re
import sys
import time
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, suppress
from importlib import metadata

from edgevox import __version__
from edgevox.apps.container.environment import ENVIRONMENT
from edgevox.apps.doctor.check import Situation
from edgevox.apps.doctor.ros import NOT_WITH_SECURITY, is_secured
from edgevox.apps.health import ask, reachable
from edgevox.apps.state import STREAM, tar_of
from edgevox.core.probe import ProbeFailed, probe_apart
from edgevox.core.settings import ENV_PREFIX, Settings

REMOVED = "<removed>"
KEY_FILE = "_key_file"
"""How settings end that name the file of a key."""
GRAPH = "edgevox.ros2.doctor:graph"
MOST_LOG_BYTES = 20 * 2**20
"""Of the log; its last lines count."""
ANSWER_S = 3.0
LEAST_SECRET = 4
"""Characters; a shorter secret would be found in other words."""
_SECRETIVE = r"(?:passw|secret|token(?!s)|api_?-?key|access_?-?key|private_?-?key|credential)"
_VALUE = r"""(\\?["'])?(?(2)(?:(?!\2)(?:\\.|.))*|[^\s,;}"'\\]+)"""
"""In its quotes, also in those of JSON within JSON, or up to a blank."""
_PATTERNS = tuple(
    re.compile(pattern, re.IGNORECASE)
    for pattern in (
        r"(-----BEGIN [A-Z ]*PRIVATE KEY-----)()(?:[\w+/=\s|.:,-]|\\n)*",
        r"((?:set-)?cookie\W{1,4})()[^\r\n]+",
        rf"(authorization\\?[\"']?\s*[:=]\s*){_VALUE}(?:\s+[\w+/=.~-]+)?",
        r"(\bbearer\s+)()[\w+/=.~-]{8,}",
        rf"([\w-]*{_SECRETIVE}[\w-]*\\?[\"']?\s*[:=]\s*){_VALUE}",
        r"(://)()[^/\s@\"']+(?=@)",
        r"(#pair=)()\w+",
        r"(\bcode )()[A-Z0-9]{4}-[A-Z0-9]{4}\b",
        r"()()\b(?:AKIA|ASIA)[0-9A-Z]{16}\b",
        r"()()\beyJ[\w-]{8,}\.[\w-]+\.[\w-]*",
    )
)
"""What looks like a secret; the first two groups of each are no part of it, and stay."""
_SECRET_NAME = re.compile(_SECRETIVE, re.IGNORECASE)
_SPOKEN = ("text", "said")
"""The fields of a log line that hold what somebody said, beside a skill's arguments."""
_HIDDEN = re.compile(r"<\d+ characters>")


class Redaction:
    """Removes these secrets from a text, and all that looks like one."""

    def __init__(self, secrets: Iterable[str]) -> None:
        long_first = sorted({one for one in secrets if len(one) >= LEAST_SECRET}, key=len)[::-1]
        self._secrets = [*long_first, *(json.dumps(one)[1:-1] for one in long_first)]

    def __call__(self, text: str) -> str:
        for secret in self._secrets:
            text = text.replace(secret, REMOVED)
        for pattern in _PATTERNS:
            text = pattern.sub(rf"\1\2{REMOVED}", text)
        return text


def secrets_of(settings: Settings, environment: Mapping[str, str]) -> Iterator[str]:
    """The secrets that this process can see: of the environment, and of the files of keys."""
    for name, value in environment.items():
        if _SECRET_NAME.search(name):
            yield value
    for name, file in settings:
        if name.endswith(KEY_FILE) and file:
            with suppress(OSError):  # a file that is not there holds no key
                yield file.read_text("utf-8", "replace").strip()


def bundle(doctor: str, situation: Situation, logs: str) -> bytes:
    """The archive. `doctor` is its report as JSON, `logs` names a file; empty for none.

    Raises `OSError` where the logs cannot be read.
    """
    files = {
        "about.json": _json(_about(situation)),
        "doctor.json": doctor,
        "settings.json": _json(_settings(situation)),
        "environment.json": _json(environment_shown(situation.environment)),
        "packages.txt": "\n".join(sorted(_packages())),
        "health.json": _json(_health(situation.settings)),
        "metrics.txt": _metrics(situation.settings),
        "graph.json": _json(_graph(situation.environment)),
    }
    if logs:
        files["log.txt"] = "".join(without_speech(line) for line in _last_lines(logs))
    redacted = Redaction(secrets_of(situation.settings, situation.environment))
    return gzip.compress(tar_of((name, redacted(text).encode()) for name, text in files.items()))


def _json(content: object) -> str:
    return json.dumps(content, indent=1, ensure_ascii=False, default=str)


def _about(situation: Situation) -> Mapping[str, object]:
    return {
        "version": __version__,
        "image": situation.environment.get("EDGEVOX_IMAGE", ""),
        "agent": situation.agent,
        "made": time.strftime("%FT%TZ", time.gmtime()),
        "python": sys.version,
        "machine": list(os.uname())[2:],
    }


def _settings(situation: Situation) -> Mapping[str, object]:
    if situation.refused:
        return {"refused": situation.refused}
    return situation.settings.model_dump()


def environment_shown(environment: Mapping[str, str]) -> dict[str, str]:
    """The variables for EdgeVox and ROS 2; of one that EdgeVox does not know, only its name."""
    known = {*ENVIRONMENT, *(f"{ENV_PREFIX}{name.upper()}" for name in Settings.model_fields)}
    ours = (ENV_PREFIX, "ROS_", "RMW_", "FASTDDS_", "FASTRTPS_")
    return {
        name: value if name in known else REMOVED
        for name, value in sorted(environment.items())
        if name in known or name.startswith(ours)
    }


def _packages() -> Iterator[str]:
    return (f"{one.metadata['Name']}=={one.version}" for one in metadata.distributions())


def _health(settings: Settings) -> Mapping[str, object]:
    if not settings.health_port:
        return {"off": "no health_port"}
    pages = ("/live", "/ready", "/status")
    return {path: _read(_asked(settings.health_host, settings.health_port, path)) for path in pages}


def _read(text: str) -> object:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return text


def _metrics(settings: Settings) -> str:
    if not settings.metrics_port:
        return "off: no metrics_port\n"
    return _asked(settings.metrics_host, settings.metrics_port, "/metrics")


def _asked(host: str, port: int, path: str) -> str:
    try:
        return ask(reachable(host), port, path, timeout_s=ANSWER_S, most_bytes=1 << 22)[1]
    except (OSError, http.client.HTTPException) as error:
        return f"no answer: {error}"


def _graph(environment: Mapping[str, str]) -> Mapping[str, object]:
    if is_secured(environment):
        return {"nodes": NOT_WITH_SECURITY}
    try:
        return probe_apart(GRAPH)
    except ProbeFailed as failed:
        return {"failed": str(failed)}


def _last_lines(logs: str) -> Iterator[str]:
    """The last lines of a file, or of standard input."""
    lines: deque[bytes] = deque()
    size = 0
    with ExitStack() as stack:
        stream = sys.stdin.buffer if logs == STREAM else stack.enter_context(open(logs, "rb"))
        for line in stream:
            lines.append(line)
            size += len(line)
            while size > MOST_LOG_BYTES:
                size -= len(lines.popleft())
    return (line.decode("utf-8", "replace") for line in lines)


def without_speech(line: str) -> str:
    """A line of the log with the length of what people said, also where `log_speech` was on."""
    head, brace, rest = line.partition("{")
    try:
        fields = json.loads(brace + rest)
    except (ValueError, RecursionError):
        return line
    hidden = {name: _length(fields[name]) for name in _SPOKEN if name in fields}
    if isinstance(arguments := fields.get("arguments"), dict):
        hidden["arguments"] = {name: _length(one) for name, one in arguments.items()}
    return f"{head}{json.dumps({**fields, **hidden}, ensure_ascii=False)}\n" if hidden else line


def _length(said: object) -> object:
    text = isinstance(said, str) and not _HIDDEN.fullmatch(said)
    return f"<{len(str(said))} characters>" if text else said
