"""The recorder as a process beside a robot: what it keeps, also when it is killed, and judges."""

import json
import os
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import threading
from collections import Counter
from contextlib import suppress
from functools import partial
from pathlib import Path

import phrases
import pytest
import yaml
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from guards import HUNG_S
from mcap.exceptions import EndOfFile
from mcap.reader import make_reader
from mcap.records import Chunk
from mcap.stream_reader import StreamReader
from peer import RELIABLE, STATE
from recordings import texts_of, until_recorded
from robot_states import far_room
from rosbags.highlevel import AnyReader
from waiting import Heard, wait_until

from edgevox.ros2.recorder.disk import FLUSH_S
from edgevox.ros2.recordings import UPLOAD_FAILED, file_number, finished, opened

RECORDER = str(Path(sys.executable).with_name("edgevox-recorder"))
SCENARIOS = Path(__file__).parents[2] / "scenarios"
ROOM_FOR_EVENTS = 60.0


class Recorder:
    """A running edgevox-recorder and what it printed."""

    def __init__(self, output, domain, *arguments, within=(), **options):
        self.output = output
        self.process = subprocess.Popen(
            [*within, RECORDER, "--output", str(output), *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            env={**os.environ, "ROS_DOMAIN_ID": str(domain)},
            **options,
        )
        self._printed = Heard()
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    def wait_until_it_records(self):
        self.wait_until_it_says("recording ")
        return self

    def wait_until_it_says(self, text):
        self._printed.wait_for(lambda line: text in line)

    @property
    def lines(self):
        return self._printed.messages

    @property
    def folder(self):
        *_, folder = sorted(self.output.iterdir())
        return folder

    def files(self):
        """Those that are whole, and the one that is written, in their order."""
        return [*finished(self.folder), *opened(self.folder)]

    def end(self, number=signal.SIGTERM):
        if self.process.poll() is None:
            self.process.send_signal(number)
        return self.wait()

    def wait(self, timeout_s=HUNG_S):
        code = self.process.wait(timeout_s)
        self._reader.join()
        return code

    def _read(self):
        for line in self.process.stdout:
            self._printed.add(line.rstrip("\n"))
        self._printed.over()


@pytest.fixture
def recorder_of(tmp_path):
    started = []

    def start(domain, *arguments, **options):
        started.append(Recorder(tmp_path / f"r{len(started)}", domain, *arguments, **options))
        return started[-1]

    yield start
    for one in started:
        if one.process.poll() is None:
            one.process.kill()
            one.wait()


@pytest.fixture
def recorder(recorder_of, resident):
    """Starts recorders beside the shared agent."""
    return partial(recorder_of, resident.domain)


@pytest.fixture
def far(robot):
    """A room that the robot needs a while to drive to."""
    return far_room(robot.listen("robot_state", STATE).wait_for(lambda _: True))


def count_in(folder):
    """How many messages there are of each topic, read by a library that did not write them."""
    with AnyReader([folder]) as bag:
        found = Counter()
        for connection, _, raw in bag.messages():
            assert bag.deserialize(raw, connection.msgtype)
            found[connection.topic] += 1
        return found


def arrived(message):
    data = json.loads(message)
    return data.get("skill") == "navigate_to" and data.get("status") == "succeeded"


def test_a_drive_is_recorded_as_a_peer_saw_it(robot, recorder, far):
    one = recorder().wait_until_it_records()
    topics = ("response", "agent_event", "bot_sentence", "transcription")
    until_recorded(robot, one.files, topics)
    heard = {topic: robot.listen(topic) for topic in topics}
    state = robot.listen("robot_state", STATE)
    before = len(state.messages)
    robot.send("text_input", f"go to the {far}")
    heard["agent_event"].wait_for(arrived, ROOM_FOR_EVENTS)
    heard["response"].wait_for(lambda m: m == phrases.done("navigate_to", room=far))
    state.wait_for(lambda m: json.loads(m)["goal"] is None, since=len(state.messages))
    seen = state.messages[before:]

    def in_file():
        rows = texts_of(one.files()[0]).items()
        return {name: [text for _, text in texts] for name, texts in rows}

    def recorded():
        texts = in_file()
        mine = {f"/edgevox/{topic}": heard[topic].messages for topic in topics}
        return set(seen) <= set(texts["/edgevox/robot_state"]) and all(
            texts[name][-len(said) :] == said for name, said in mine.items()
        )

    wait_until(recorded, "all that was heard, in the file")
    assert one.end() == 0, one.lines
    texts = in_file()
    assert texts["/edgevox/text_input"][-1] == f"go to the {far}"
    counted = count_in(one.folder)
    assert {name: len(rows) for name, rows in texts.items()} == counted
    assert counted["/tf"] > 30
    assert counted["/edgevox/scan"] > 10
    assert counted["/tf_static"] == 1
    about = yaml.safe_load((one.folder / "metadata.yaml").read_text())
    assert about["rosbag2_bagfile_information"]["message_count"] == counted.total()


def test_it_says_how_it_is_and_the_agent_passes_that_on(robot, recorder):
    heard = Heard()
    robot.node.create_subscription(DiagnosticArray, "/diagnostics", heard.add, RELIABLE)

    def told(level, message):
        since = len(heard.messages)
        for node in ("edgevox_recorder", "edgevox"):
            name = f"/edgevox/{node}: recorder"
            expected = {(name, level, message)}
            heard.wait_for(
                lambda array, expected=expected: (
                    expected & {(one.name, one.level, one.message) for one in array.status}
                ),
                since=since,
            )

    one = recorder().wait_until_it_records()
    told(DiagnosticStatus.OK, "records")
    (one.output / UPLOAD_FAILED).touch()
    told(DiagnosticStatus.WARN, "the upload fails: see the uploader's log")
    (one.output / UPLOAD_FAILED).unlink()
    told(DiagnosticStatus.OK, "records")
    ended = threading.Thread(target=one.end)
    ended.start()
    told(DiagnosticStatus.OK, "has ended")
    ended.join()


def test_what_is_lost_by_a_kill_is_less_than_a_second():
    assert FLUSH_S < 1.0


def _time(message):
    return json.loads(message)["time"]


def states_in(files):
    """The robot's times of the states in these files, in their order."""
    rows = [row for file in files for row in texts_of(file).get("/edgevox/robot_state", [])]
    return [_time(text) for _, text in rows]


@pytest.mark.long
def test_when_it_is_killed_all_that_it_flushed_is_there_and_a_full_file_is_followed_by_another(
    robot, recorder, far
):
    one = recorder("--max-size", "0.03", "--topics", "scan", "robot_state", "pose", "/tf")
    one.wait_until_it_records()
    state = robot.listen("robot_state", STATE)
    wait_until(lambda: states_in(one.files()), "a state in a file")
    since, before = len(state.messages), len(one.files())
    robot.send("text_input", f"go to the {far}")
    wait_until(lambda: len(one.files()) > before + 1, "two more files", ROOM_FOR_EVENTS)
    last_s = _time(state.messages[-1])
    wait_until(lambda: states_in(one.files())[-1] >= last_s, "a state of the drive, in a file")
    assert one.end(signal.SIGKILL) == -signal.SIGKILL
    kept = states_in(one.files())
    wanted = [t for t in map(_time, state.messages[since:]) if t < kept[-1]]
    assert sum(not set(wanted).isdisjoint(states_in([file])) for file in one.files()) > 1
    assert len(wanted) >= 20
    assert set(wanted) <= set(kept)
    texts = {topic for file in one.files() for topic in texts_of(file)}
    assert texts == {"/edgevox/scan", "/edgevox/robot_state", "/edgevox/pose", "/tf"}

    folder, there = one.folder, flushed(one.files())
    next_one = recorder("--output", str(one.output)).wait_until_it_records()
    wait_until((folder / "metadata.yaml").exists, "the mended recording")
    assert next_one.end() == 0, next_one.lines
    assert not opened(folder)
    assert count_in(folder) == flushed(finished(folder)) == there


def flushed(files):
    """How many messages there are of each topic in these files, which may have no end."""
    found = Counter()
    for file in files:
        found.update({topic: len(rows) for topic, rows in texts_of(file).items()})
    return found


def test_a_file_that_was_cut_inside_a_chunk_is_mended_by_the_next_recorder(recorder):
    one = recorder().wait_until_it_records()
    wait_until(lambda: len(chunk_ends(one.files())) > 2, "three chunks")
    assert one.end(signal.SIGKILL) == -signal.SIGKILL
    folder, (file,) = one.folder, one.files()
    os.truncate(file, chunk_ends([file])[-1] - 10)  # as a power cut may leave it
    there = texts_of(file)
    mending = recorder("--output", str(one.output), "--mend")
    assert mending.wait() == 0
    assert any("recording_mended" in line for line in mending.lines)
    (whole,) = finished(folder)
    with whole.open("rb") as stream:
        read = Counter(channel.topic for _, channel, _ in make_reader(stream).iter_messages())
    assert read == {topic: len(rows) for topic, rows in there.items()} == count_in(folder)


def chunk_ends(files):
    """Where the chunks of a file end."""
    ends = []
    for file in files:
        with file.open("rb") as stream, suppress(EndOfFile, struct.error):
            chunks = StreamReader(stream, emit_chunks=True).records
            ends.extend(stream.tell() for one in chunks if isinstance(one, Chunk))
    return ends


@pytest.mark.long
def test_a_ring_goes_on_for_ever_in_the_room_that_it_has(robot, recorder, far):
    room = ("--most", "0.08", "--max-size", "0.03", "--spare", "0", "--when-full", "ring")
    one = recorder(*room, "--topics", "scan", "robot_state", "pose", "/tf").wait_until_it_records()
    robot.send("text_input", f"go to the {far}")

    def first():
        return min((file_number(file.name) for file in one.files()), default=0)

    wait_until(lambda: first() >= 2, "that two files went", ROOM_FOR_EVENTS)
    assert one.end() == 0, one.lines
    assert first() >= 2
    assert count_in(one.folder) == flushed(finished(one.folder))


@pytest.mark.long
def test_a_disk_that_takes_no_more_is_said_and_costs_no_more_than_the_exit_code(robot, recorder):
    def small_files():
        resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, 60_000))

    heard = Heard()
    robot.node.create_subscription(DiagnosticArray, "/diagnostics", heard.add, RELIABLE)
    one = recorder(preexec_fn=small_files)
    one.wait_until_it_says("recording_stopped")
    for level, said in (
        (DiagnosticStatus.ERROR, "File too large"),
        (DiagnosticStatus.ERROR, "lost by now: the log has the reason (messages_not_recorded)"),
    ):
        heard.wait_for(
            lambda array, level=level, said=said: any(
                one.name == "/edgevox/edgevox: recorder"
                and (one.level, said in one.message) == (level, True)
                for one in array.status
            )
        )
    assert one.end() == 74
    assert any("recording_stopped" in line and "File too large" in line for line in one.lines)
    assert one.lines[-1].startswith("edgevox-recorder: not all was recorded: ")
    assert any("/edgevox/robot_state" in texts_of(file) for file in one.files())


SMALL_DISK = 'mount -t tmpfs -o size=400k none "$0" && exec "$@"'
NAMESPACES = (("unshare", "--mount"), ("unshare", "--mount", "--map-root-user"))
"""Ways to mount a disk that only the recorder sees: as root, as whoever may."""


@pytest.mark.long
def test_a_disk_that_was_full_has_whole_files_of_before_and_after(recorder, tmp_path):
    at = tmp_path / "disk"
    at.mkdir()
    may = [way for way in NAMESPACES if not subprocess.run([*way, "true"]).returncode]
    assert may, "nobody here may make a mount namespace"
    one = recorder(
        *("--output", str(at), "--spare", "0", "--topics", "robot_state"),
        within=[*may[0], "sh", "-c", SMALL_DISK, str(at)],
    ).wait_until_it_records()
    number = os.open(f"/proc/{one.process.pid}/root{at}", os.O_PATH)  # it outlives the recorder
    try:
        one.output = Path(f"/proc/self/fd/{number}")
        wait_until(lambda: states_in(one.files()), "a state in a file")
        fill(one.output / ".filler")
        one.wait_until_it_says("recording_stopped")
        before = states_in(one.files())
        (one.output / ".filler").unlink()
        one.wait_until_it_says("recording_goes_on")
        wait_until(lambda: len(states_in(one.files())) > len(before) + 5, "later states in a file")
        assert one.end() == 74, one.lines
        shutil.copytree(one.output, tmp_path / "kept")
    finally:
        os.close(number)
    assert any("recording_stopped" in line and "No space left" in line for line in one.lines)
    (folder,) = (tmp_path / "kept").iterdir()
    assert not opened(folder)
    kept = states_in(finished(folder))
    assert kept[: len(before)] == before
    assert len(kept) > len(before) + 5
    assert kept == sorted(set(kept))
    assert count_in(folder) == flushed(finished(folder)) == {"/edgevox/robot_state": len(kept)}


def fill(path):
    """Write until the disk takes no byte more."""
    with path.open("wb", buffering=0) as file, suppress(OSError):
        while file.write(bytes(1024)):
            pass


def test_a_scenario_that_comes_true_ends_with_0_and_is_recorded(agent, recorder_of, domain):
    one = recorder_of(domain, "--scenario", str(SCENARIOS / "smoke.yaml"))  # it waits for the robot
    agent()
    assert one.wait() == 0, one.lines
    report = "\n".join(one.lines)
    assert re.search(r"PASSED 4 steps, \d", report)
    assert "smoke.yaml on robot-apartment: To the kitchen" in report
    said = [text for _, text in texts_of(one.files()[0])["/edgevox/text_input"]]
    assert said == ["go to the kitchen"]


EVERY_KIND = """\
never: [{state: {collisions: {above: 0}}}]
steps:
  - run: navigate_to
    with: {room: ROOM}
  - wait: 1.5
  - expect: {state: {velocity.linear: {above: 0.2}}, event: {skill: navigate_to, status: running}}
    within: 5
  - interrupt: true
  - expect: {state: {velocity.linear: {near: 0, by: 0.02}}, event: {kind: skill_cancelled}}
    within: 5
  - drive: {linear: 0.3, seconds: 0.8}
  - expect: {state: {velocity.linear: {above: 0.2}}}
  - run: navigate_to
    with: {room: ROOM}
  - expect: {state: {velocity.linear: {above: 0.2}}}
    within: 5
  - say: stop
  - expect: {answer: Stopped, state: {velocity.linear: {near: 0, by: 0.02}}}
    within: 5
"""


@pytest.mark.long
def test_all_kinds_of_steps_play_on_topics(recorder, far, tmp_path):
    file = tmp_path / "every.yaml"
    file.write_text(EVERY_KIND.replace("ROOM", far))
    one = recorder("--scenario", str(file))
    assert one.wait() == 0, one.lines


def test_a_scenario_that_does_not_come_true_ends_with_1_and_what_was_seen(recorder, far, tmp_path):
    file = tmp_path / "wrong.yaml"
    file.write_text(
        "steps:\n"
        f"  - say: go to the {far}\n"
        f"  - expect: {{state: {{room: {far}}}}}\n"
        "    within: 1\n"
        "  - say: never said\n"
    )
    one = recorder("--scenario", str(file))
    assert one.wait() == 1
    report = "\n".join(one.lines)
    assert "FAIL   2" in report
    assert f"expected room = {far!r}" in report
    assert "FAILED at step 2 of 3" in report
    recorded = texts_of(one.files()[0])
    assert [text for _, text in recorded["/edgevox/text_input"]] == [f"go to the {far}"]
    assert recorded["/edgevox/interrupt"]  # the robot was not left driving


@pytest.mark.long
def test_a_skill_that_is_refused_fails_with_the_robots_own_reason(recorder, tmp_path):
    file = tmp_path / "moon.yaml"
    file.write_text("steps: [{run: navigate_to, with: {room: moon}}]\n")
    one = recorder("--scenario", str(file))
    assert one.wait() == 1
    assert "navigate_to.room: got 'moon'" in "\n".join(one.lines)


@pytest.mark.long
def test_a_scenario_for_another_robot_or_for_none_fails_and_says_so(recorder):
    nobody = recorder(
        "--scenario", str(SCENARIOS / "smoke.yaml"), "--wait", "1", "--namespace", "/nobody"
    )
    assert nobody.wait() == 1
    assert "/nobody: no publisher of state" in "\n".join(nobody.lines)
    other = recorder("--scenario", str(SCENARIOS / "panda.yaml"))
    assert other.wait() == 2
    assert "agent: got 'robot-apartment', expected one of robot-panda" in "\n".join(other.lines)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--topics", "respons"], "topics: got 'respons'"),
        pytest.param(
            ["--max-size", "0"],
            "max_size: got 0.0, expected a number of 0.01 or more",
            marks=pytest.mark.long,
        ),
        pytest.param(
            ["--namespace", "my robot"],
            "agent_namespace: got 'my robot'",
            marks=pytest.mark.long,
        ),
        (["--scenario", "nowhere.yaml"], "scenario: got 'nowhere.yaml'"),
    ],
)
def test_what_makes_no_sense_is_refused_before_anything_is_recorded(
    recorder_of, domain, arguments, said
):
    one = recorder_of(domain, *arguments)
    assert one.wait() == 2
    assert said in "\n".join(one.lines)
    assert not one.output.exists()
