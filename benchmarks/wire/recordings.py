"""Recordings through kills and a failing store: what is published, written, and stored.

A peer publishes numbered messages at 100 Hz, with pauses, to `edgevox-recorder`, in files of 1 MB.
The loop of compose/recordings.yml uploads them with rclone to moto, an S3 server. Every ten seconds
the recorder is killed, the uploader is killed, or the server is silent for four seconds. rosbags
and mcap's reader then read the store and check all sums; each file is compared with the recorder's.
A message may be missing only around a kill of the recorder. Needs rclone and moto's server.
"""

import hashlib
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path

import yaml
from mcap.reader import make_reader
from peer import Peer
from ports import free_port
from rosbags.highlevel import AnyReader
from waiting import wait_until

from benchmarks import ROOT
from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.core.talker import isolate
from edgevox.ros2.recorder.disk import FLUSH_S
from edgevox.ros2.recordings import METADATA, finished, folders, opened

TOPIC = "numbered"
RATE_HZ = 100.0
PAYLOAD_BYTES = 2000
"""Random, as pictures and scans are for a compressor."""
FAIL_EVERY_S, OUTAGE_S, PAUSE_S = 10.0, 4.0, 3.0
UPLOADED_S = 120.0
RESTART_S = 10.0
"""The longest from a kill until the next recorder has found the publisher."""
RECORDER = str(Path(sys.executable).with_name("edgevox-recorder"))
BUCKET = "store:recordings"
TABLE = "Recordings, kills, and a store that fails"


def measure(quick: bool = False) -> Measured:
    """Publish, fail and compare."""
    for program in ("rclone", "moto_server"):
        if shutil.which(program) is None:
            raise NotHere(f"no {program}: apt-get install rclone, pip install 'moto[server]'")
    seconds = 45.0 if quick else 180.0
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        return Measured(figures=tuple(_run(Path(folder), seconds, stack)))


def _run(folder: Path, seconds: float, stack: ExitStack) -> Iterator[Figure]:
    output, stored, config = folder / "recordings", folder / "stored", folder / "rclone.conf"
    output.mkdir()
    domain = isolate()
    port = free_port()
    config.write_text(
        f"[store]\ntype = s3\nprovider = Other\nendpoint = http://127.0.0.1:{port}\n"
        "access_key_id = benchmark\nsecret_access_key = benchmark\n",
        encoding="utf-8",
    )
    store = stack.enter_context(_running(["moto_server", "-H", "127.0.0.1", "-p", str(port)]))
    wait_until(lambda: _answers(port), "the S3 server")
    _rclone(config, "mkdir", BUCKET)
    peer = Peer(domain)
    stack.callback(peer.close)
    topics = f"/edgevox/{TOPIC}:std_msgs/msg/String"
    recorders = _Restarted(
        [RECORDER, "--output", str(output), "--max-size", "1", "--topics", topics], os.environ
    )
    uploads = _Restarted(*_uploader(folder, output, config))
    for one in (recorders, uploads):
        stack.callback(one.end)
        one.start()
    published = _publish(peer, seconds, [recorders.kill, uploads.kill, lambda: _freeze(store)])
    recorders.end()
    subprocess.run([RECORDER, "--output", str(output), "--mend"], check=True, capture_output=True)
    began = time.monotonic()
    wait_until(
        lambda: _rclone(config, "check", "--one-way", *_ONLY, str(output), BUCKET, fine=False),
        "all files in the store",
        UPLOADED_S,
    )
    late_s = time.monotonic() - began
    _rclone(config, "copy", BUCKET, str(stored))
    assert not any(opened(one) for one in folders(output))
    ours, theirs = _digests(output), _digests(stored)
    _check(stored)
    numbers = _numbers(stored)
    missing = sorted(set(published) - set(numbers))
    gaps = _gaps(missing, published)
    begins = [published[0], *recorders.kills]
    allowed = [
        (begin, end)
        for begin, end in gaps
        if any(at - FLUSH_S - 1.0 <= begin and end <= at + RESTART_S for at in begins)
    ]
    gap = max((end - begin for begin, end in gaps), default=0.0)
    rest = len(gaps) - len(allowed)
    twice = len(numbers) - len(set(numbers))
    unlike = len({name for name in ours | theirs if ours.get(name) != theirs.get(name)})
    yield Figure.of("published", TABLE, "messages published", [len(published)])
    yield Figure.of("stored", TABLE, "messages in the store", [len(set(numbers))])
    yield Figure.of("kills", TABLE, "kills of the recorder", [len(recorders.kills)])
    yield Figure.of("upload_kills", TABLE, "kills of the uploader", [len(uploads.kills)])
    what = "longest gap: from a kill of the recorder until the next one hears"
    yield Figure.of("gap", TABLE, what, [gap], "s")
    yield Figure.of("lost", TABLE, "gaps without a kill of the recorder", [rest], wanted=0)
    yield Figure.of("twice", TABLE, "messages that are in the store twice", [twice], wanted=0)
    yield Figure.of("files", TABLE, "files in the store, all readable", [len(theirs)])
    yield Figure.of("unlike", TABLE, "files that differ from the recorder's", [unlike], wanted=0)
    what = "from the end of the recording until all is in the store"
    yield Figure.of("late", TABLE, what, [late_s], "s")


_ONLY = ("--include", "*.{mcap,yaml}")


class _Restarted:
    """A program that starts again when it is killed, as a container engine has it."""

    def __init__(self, command: list[str], environment: Mapping[str, str]) -> None:
        self._command, self._environment = command, dict(environment)
        self.kills: list[float] = []

    def start(self) -> None:
        self._process = subprocess.Popen(
            self._command,
            env=self._environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )

    def kill(self) -> None:
        self.kills.append(time.monotonic())
        os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        self.start()

    def end(self) -> None:
        if self._process.poll() is None:
            os.killpg(self._process.pid, signal.SIGTERM)
        self._process.wait()


def _uploader(folder: Path, output: Path, config: Path) -> tuple[list[str], Mapping[str, str]]:
    """The loop of compose/recordings.yml, with the places of this benchmark."""
    service = yaml.safe_load((ROOT / "compose" / "recordings.yml").read_text("utf-8"))
    (loop,) = service["services"]["recordings"]["command"]
    for there, here in (
        ("$$", "$"),
        ("/tmp/", f"{folder}/"),  # noqa: S108 - the container's
        ("/run/secrets/recordings_config", str(config)),
        ("/recordings/", f"{output}/"),
        ("/recordings ", f"{output} "),
    ):
        assert there in loop
        loop = loop.replace(there, here)
    more = {"RECORDINGS_VERB": "copy", "RECORDINGS_TO": BUCKET, "RECORDINGS_EVERY_S": "1"}
    return ["sh", "-c", loop], {**_environment(), **more}


def _environment() -> dict[str, str]:
    """The variables of this process, without what a site has set for its own store."""
    return {name: value for name, value in os.environ.items() if not name.startswith("AWS_")}


def _publish(peer: Peer, seconds: float, faults: list[Callable[[], None]]) -> dict[int, float]:
    """When each number was published; the faults one after the other, meanwhile."""
    payload = random.Random(0)
    peer.send(TOPIC, "0 ")
    published = {0: time.monotonic()}
    over = threading.Event()

    def fail() -> None:
        rounds = 0
        while not over.wait(FAIL_EVERY_S):
            faults[rounds % len(faults)]()
            rounds += 1

    failing = threading.Thread(target=fail, name="faults")
    failing.start()
    until, pause = time.monotonic() + seconds, time.monotonic() + 2 * FAIL_EVERY_S
    while time.monotonic() < until:
        time.sleep(1 / RATE_HZ)
        if time.monotonic() > pause:
            time.sleep(PAUSE_S)
            pause = time.monotonic() + 2 * FAIL_EVERY_S + random.Random(len(published)).random()
        number = len(published)
        published[number] = time.monotonic()
        peer.send(TOPIC, f"{number} {payload.randbytes(PAYLOAD_BYTES).hex()}")
    over.set()
    failing.join()
    time.sleep(2 * FLUSH_S)
    return published


def _freeze(store: "subprocess.Popen[bytes]") -> None:
    """A store that takes connections and says nothing."""
    store.send_signal(signal.SIGSTOP)
    time.sleep(OUTAGE_S)
    store.send_signal(signal.SIGCONT)


@contextmanager
def _running(command: list[str]) -> Iterator["subprocess.Popen[bytes]"]:
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        try:
            yield process
        finally:
            process.kill()


def _answers(port: int) -> bool:
    try:
        urllib.request.urlopen(f"http://127.0.0.1:{port}/")
    except urllib.error.HTTPError:
        return True
    except OSError:
        return False
    return True


def _rclone(config: Path, *arguments: str, fine: bool = True) -> bool:
    command = ["rclone", "--config", str(config), *arguments]
    done = subprocess.run(command, check=fine, capture_output=True, env=_environment())
    return not done.returncode


def _digests(output: Path) -> dict[str, str]:
    files = (one for pattern in ("*.mcap", METADATA) for one in output.rglob(pattern))
    return {
        str(one.relative_to(output)): hashlib.sha256(one.read_bytes()).hexdigest() for one in files
    }


def _numbers(stored: Path) -> list[int]:
    """All numbers of all recordings, in their order, each as often as it is there."""
    found = []
    for folder in folders(stored):
        with AnyReader([folder]) as bag:
            for connection, _, raw in bag.messages():
                message = bag.deserialize(raw, connection.msgtype)
                found.append(int(message.data.partition(" ")[0]))
    return found


def _check(stored: Path) -> None:
    """Read each file with its sums, by its index; `metadata.yaml` tells what is in them."""
    for folder in folders(stored):
        about = yaml.safe_load((folder / METADATA).read_text(encoding="utf-8"))
        about = about["rosbag2_bagfile_information"]
        assert about["relative_file_paths"] == [one.name for one in finished(folder)]
        for told in about["files"]:
            with (folder / told["path"]).open("rb") as stream:
                messages = make_reader(stream, validate_crcs=True).iter_messages()
                assert sum(1 for _ in messages) == told["message_count"], told["path"]


def _gaps(missing: list[int], published: dict[int, float]) -> list[tuple[float, float]]:
    """When the missing numbers that follow each other were published: the first and the last."""
    gaps: list[list[int]] = []
    for number in missing:
        if gaps and gaps[-1][1] == number - 1:
            gaps[-1][1] = number
        else:
            gaps.append([number, number])
    return [(published[first], published[last]) for first, last in gaps]
