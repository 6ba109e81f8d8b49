"""The examples of the documentation, each run as a program against a live robot."""

import queue
import signal
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from guards import HUNG_S, run_program
from peer import RELIABLE, SENSOR, STATE
from std_msgs.msg import String
from waiting import wait_until

sys.path.insert(0, str(Path(__file__).parents[1] / "unit"))

from llm_server import good, serving

from edgevox.agent.llm.protocol import SAY

pytestmark = pytest.mark.long

EXAMPLES = Path(__file__).resolve().parent.parent.parent / "examples" / "ros2"


def command(name: str, *arguments: str, namespace: str = "/edgevox") -> list[str]:
    return [sys.executable, EXAMPLES / f"{name}.py", *arguments, f"--namespace={namespace}"]


class Listening:
    """An example that listens until it is interrupted; its lines as they are printed."""

    def __init__(self, *words: str) -> None:
        self._process = subprocess.Popen(
            command(*words),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self._lines: queue.Queue[str] = queue.Queue()
        self._reader = threading.Thread(target=self._read, name="example-output")
        self._reader.start()

    def line(self, timeout_s: float = 60.0) -> str | None:
        """The next line; None if none came in time."""
        try:
            return self._lines.get(timeout=timeout_s)
        except queue.Empty:
            return None

    def rest(self) -> list[str]:
        """The lines that nobody has asked for."""
        return list(self._lines.queue)

    def leave(self) -> int:
        """Press Ctrl-C; the exit code."""
        self._process.send_signal(signal.SIGINT)
        try:
            return self._process.wait(HUNG_S)
        finally:
            self._process.kill()
            self._reader.join()

    def _read(self) -> None:
        for line in self._process.stdout:
            self._lines.put(line.rstrip("\n"))


@pytest.fixture(autouse=True)
def _same_domain(domain, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))


@pytest.fixture
def listening():
    """Starts examples that listen; each must leave cleanly on Ctrl-C."""
    started: list[Listening] = []

    def start(*words: str) -> Listening:
        started.append(Listening(*words))
        return started[-1]

    yield start
    for one in started:
        assert one.leave() == 0, one.rest()


@pytest.fixture
def robot(agent, peer):
    agent()
    return peer()


def run(name: str, *arguments: str, namespace: str = "/edgevox") -> tuple[int, str, str]:
    """An example that does one thing: its exit code, output and errors."""
    done = run_program(command(name, *arguments, namespace=namespace))
    return done.returncode, done.stdout, done.stderr


def matched(robot, topic: str) -> None:
    wait_until(lambda: robot.node.count_subscribers(robot.name(topic)) > 0, topic)


def first_line(listener: Listening, again, tries: int = 10) -> str:
    """The first line; `again` makes the robot say it anew, since nobody keeps what was missed."""
    for _ in range(tries):
        again()
        line = listener.line(3.0)
        if line is not None:
            return line
    raise AssertionError("the example printed nothing")


def test_listen_prints_what_was_said(robot, listening):
    listener = listening("listen", "transcription")
    matched(robot, "transcription")
    line = first_line(listener, lambda: robot.send("text_input", "where are you"))
    assert line == "where are you"


def test_what_is_published_to_be_said_is_said_by_the_robot(robot):
    sentence = robot.listen("bot_sentence")
    assert run("publish", "tts_request", "Dinner is ready.") == (0, "", "")
    sentence.wait_for(lambda m: m == "Dinner is ready.")


def test_send_text_prints_the_answer(robot):
    code, output, _ = run("send_text", "where are you")
    assert code == 0
    assert output.startswith("I am in the")


def test_interrupt_stops_what_the_robot_does(robot):
    event = robot.listen("agent_event")
    state = robot.listen("state", STATE)
    robot.send("text_input", "go to the bedroom")
    event.wait_for(lambda m: '"accepted"' in m)
    assert run("publish", "interrupt", "now") == (0, "", "")
    state.wait_for(lambda m: m == "interrupted")
    event.wait_for(lambda m: '"skill_cancelled"' in m)


def test_the_language_is_switched_by_topic_and_by_parameter(robot):
    info = robot.listen("info")
    assert run("publish", "set_language", "fr") == (0, "", "")
    robot.send("command", "list_voices")
    info.wait_for(lambda m: '"language": "fr"' in m)

    assert run("switch_language_parameter", "de") == (0, "The language is de now.\n", "")
    robot.send("command", "list_voices")
    info.wait_for(lambda m: '"language": "de"' in m)


def test_a_language_that_is_not_there_is_refused_with_the_reason(robot):
    code, output, error = run("switch_language_parameter", "tlh")
    assert (code, output) == (1, "")
    assert error.startswith("Refused: ")
    assert "'tlh'" in error


def test_a_voice_that_query_voices_lists_can_be_switched_to(robot):
    code, output, _ = run("query_voices")
    assert code == 0
    first, *voices = output.splitlines()
    assert first == "language en, voice ''"
    assert voices, "no voice is here: edgevox-models fetch small"

    assert run("publish", "set_voice", voices[0]) == (0, "", "")
    code, output, _ = run("query_voices")
    assert output.splitlines()[0] == f"language en, voice '{voices[0]}'"


def test_show_tokens_shows_an_answer_as_it_is_generated(agent, peer, listening):
    with serving(good(SAY.strip(), " Ice is", " light.")) as model:
        agent("--llm-endpoint", model.url)
        robot = peer()
        listener = listening("show_tokens")
        matched(robot, "bot_token")
        matched(robot, "response")
        tokens = robot.listen("bot_token", SENSOR)

        def ask():
            robot.send("text_input", "Why does ice float?")

        def shown_whole():
            return first_line(listener, ask).strip() == "Ice is light."

        # Tokens, and the ends of lines, come best effort: what is not yet matched misses some.
        wait_until(shown_whole, "a whole answer in a line of its own")
        wait_until(lambda: " light." in tokens.messages or ask(), "the pieces of an answer")
        assert "Ice is light." not in tokens.messages


def test_listen_prints_a_wake_word(peer, listening):
    robot = peer()  # stands in for a robot that hears: nothing but a test publishes it yet
    listener = listening("listen", "wakeword")
    publisher = robot.node.create_publisher(String, robot.name("wakeword"), RELIABLE)
    wait_until(lambda: publisher.get_subscription_count() > 0, "wakeword")
    line = first_line(listener, lambda: publisher.publish(String(data="hey jarvis")))
    assert line == "hey jarvis"


def test_an_example_speaks_to_the_namespace_it_is_given(agent, peer):
    agent("--ros2-namespace", "/robot1")
    sentence = peer("/robot1").listen("bot_sentence")
    assert run("publish", "tts_request", "Hello.", namespace="/robot1")[0] == 0
    sentence.wait_for(lambda m: m == "Hello.")


def test_where_no_robot_is_an_example_says_so_and_fails():
    reasons = {
        ("publish", "tts_request", "hello"): "Nobody listens on /nowhere/tts_request.\n",
        ("send_text", "hello"): "Nobody listens on /nowhere/text_input.\n",
        ("query_voices",): "Nobody offers /nowhere/list_voices.\n",
        ("switch_language_parameter", "fr"): "There is no node edgevox in /nowhere.\n",
    }
    with ThreadPoolExecutor(len(reasons)) as pool:  # each is patient for a while
        ends = pool.map(lambda words: run(*words, namespace="/nowhere"), reasons)
    assert list(ends) == [(1, "", reason) for reason in reasons.values()]


def test_every_example_is_short_and_knows_nothing_of_edgevox():
    for file in EXAMPLES.glob("*.py"):
        source = file.read_text()
        assert source.count("\n") <= 60, file.name
        assert "import edgevox" not in source
        assert "from edgevox" not in source
