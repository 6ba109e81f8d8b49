"""What the chaos does: each method is one random thing, and returns what it was for the journal."""

import json
import math
import os
import random
import signal
import threading
import time
from collections.abc import Callable

import numpy as np
from chaos_robot import Robot
from chaos_world import Killed, ModelFiles, ModelServer
from geometry_msgs.msg import PoseStamped, Twist
from peer import RELIABLE, SENSOR, Peer
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from std_msgs.msg import String
from std_srvs.srv import Trigger

from edgevox.core.cancel import CancelToken
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.tts.espeak import open_espeak
from edgevox.voice.wav import resampled
from edgevox_msgs.msg import AudioData

COMMANDS = (
    "go to the kitchen", "go to the bedroom", "drive to x 3 y 4", "where are you", "stop",
    "what is your battery", "go to the moon", "go to the kitchen, then to the bedroom", "halt",
    "don't stop", "go to the kitchen, no, stop", "drive to x 99 y -99", "drive to x nan y inf",
)  # fmt: skip
THOUGHTS = ("tell me about whales", "could you maybe look after the place where I sleep", "why")
PIECES = (
    "go", "stop", "kitchen", "\N{RIGHT-TO-LEFT OVERRIDE}", "\0", "\n", "😀" * 9, "مرحبا",
    "\ud7ff", "{}", "%s%n", "'; --",
    "\N{COMBINING ACUTE ACCENT}" * 50, "x" * 300, "1e999", "NaN", "ﷺ", "\t", "<|im_end|>", "done",
)  # fmt: skip
TOPICS = ("text_input", "tts_request", "interrupt", "set_language", "set_voice", "command")
WORDS = {
    "text_input": ("where are you", "blah blah", "go to the office"),
    "tts_request": ("All is well.", "x"),
    "interrupt": ("", "now"),
    "set_language": ("en", "fr", "de", "xx"),
    "set_voice": ("", "nobody", "en_US-joe-medium"),
    "command": ("reset", "mute", "unmute", "list_voices", "model_info", "rm -rf"),
}
LONGEST, DEPTH = 1_000_000, 10
"""The middleware keeps as many messages as a topic is deep, each as large as the largest so far."""
LOUD, HEARD_S, HEARD_AGAIN_S = 2 / 3, 60.0, 10.0
KILLED = ("text", "interrupt", "language", "velocity", "goal_pose", "goals", "parameters")
SKILLS = (
    ("navigate_to", '{"room": "kitchen"}'), ("navigate_to", '{"room": "moon"}'),
    ("navigate_xy", '{"x": 3, "y": 4}'), ("navigate_xy", '{"x": 1e308, "y": -1e308}'),
    ("navigate_xy", '{"x": NaN}'), ("get_pose", ""), ("stop", "{}"), ("none", "{"),
    ("navigate_to", "[" * 5000), ("navigate_to", '{"room": "' + "k" * 100_000 + '"}'),
)  # fmt: skip


class Actions:
    """Random things to do to a robot. Every one of them is over within a few seconds."""

    def __init__(
        self,
        robot: Robot,
        rng: random.Random,
        domain: int,
        server: ModelServer,
        files: ModelFiles,
        killed: Killed,
    ) -> None:
        self._robot, self._rng, self._domain = robot, rng, domain
        self._server, self._files, self._killed = server, files, killed
        self._peer = robot.peer
        node, name = self._peer.node, self._peer.name
        self._strings = {t: node.create_publisher(String, name(t), RELIABLE) for t in TOPICS}
        self._goal_pose = node.create_publisher(PoseStamped, name("goal_pose"), RELIABLE)
        self._audio = node.create_publisher(AudioData, name("audio_in"), SENSOR)
        self._set = node.create_client(SetParameters, name("edgevox/set_parameters"))
        self._speech = spoken("where are you")
        self._query = node.create_client(Trigger, name("model_info"))

    def weighed(self) -> dict[Callable[[], str], float]:
        """What can be done, and how often."""
        return {
            self.command: 6, self.nonsense: 5, self.long_text: 2, self.thought: 2,
            self.say: 2, self.interrupt: 3, self.setting: 4, self.burst: 4, self.broken_bytes: 3,
            self.velocities: 5, self.goal_pose: 3, self.goals: 5, self.parameters: 4,
            self.queries: 2, self.sound: 5, self.joiner: 2, self.killed_peer: 3, self.freeze: 1,
            self.model_server: 3, self.model_files: 3,
        }  # fmt: skip

    def warm_up(self) -> None:
        """What else would grow: the middleware's buffers, a recogniser and what the model was told
        in each language. No model server may be there, so that the model on board answers.
        """
        for topic in TOPICS:
            for _ in range(DEPTH + 2):
                self._strings[topic].publish(String(data="x" * LONGEST))
        for language in ("fr", "de", "en"):
            self._be_heard_in(language)
            self._robot.settle()
            self._send("set_language", language)
            self._robot.think()

    def _be_heard_in(self, language: str) -> None:
        """Say it again where it was not heard, as a person does: it may have spoken itself."""
        deadline_s = time.monotonic() + HEARD_S
        while True:
            self._robot.settle()
            doing = self._robot.doing
            since = len(doing.messages)
            self._send("set_language", language)
            self._play(self._speech)
            try:
                doing.wait_for(lambda m: m == "transcribing", HEARD_AGAIN_S, since)
            except AssertionError:
                if time.monotonic() > deadline_s:
                    raise
            else:
                return

    def command(self) -> str:
        return self._send("text_input", self._rng.choice(COMMANDS))

    def thought(self) -> str:
        return self._send("text_input", self._rng.choice(THOUGHTS))

    def nonsense(self) -> str:
        pieces = self._rng.choices(PIECES, k=self._rng.randint(0, 8))
        return self._send(self._rng.choice(TOPICS), self._rng.choice(("", " ")).join(pieces))

    def long_text(self) -> str:
        size = self._rng.choice((1_999, 2_001, 50_000, LONGEST))
        piece = self._rng.choice(("where are you ", "é", "😀", "a"))
        text = piece * (size // len(piece.encode()))
        return self._send(self._rng.choice(TOPICS), text)

    def say(self) -> str:
        return self._send("tts_request", "One moment. " * self._rng.randint(1, 20))

    def interrupt(self) -> str:
        return self._send("interrupt", "")

    def setting(self) -> str:
        topic = self._rng.choice(("set_language", "set_voice", "command"))
        return self._send(topic, self._rng.choice(WORDS[topic]))

    def burst(self) -> str:
        topic, count = self._rng.choice(TOPICS), self._rng.choice((50, 500, 2000))
        for _ in range(count):
            self._strings[topic].publish(String(data=self._rng.choice(WORDS[topic])))
        return f"{count} on {topic}"

    def broken_bytes(self) -> str:
        topic = self._rng.choice(TOPICS)
        text = self._rng.randbytes(self._rng.choice((1, 7, 4000))) + b"\xff\xfe\0"
        length = self._rng.choice((len(text), len(text), 0, 2**31, 2**32 - 1))
        for _ in range(self._rng.choice((1, 100))):
            self._strings[topic].publish(b"\0\1\0\0" + length.to_bytes(4, "little") + text)
        return f"{len(text)} bytes that are no UTF-8 and say {length} on {topic}"

    def velocities(self) -> str:
        odd = self._rng.random() < 0.4
        count = self._rng.randint(1, 15)
        for _ in range(count):
            message = Twist()
            pool = (math.nan, math.inf, -math.inf, 1e300) if odd else (0.0, 0.3, -0.3, 5.0)
            message.linear.x, message.angular.z = self._rng.choice(pool), self._rng.choice(pool)
            message.linear.y = self._rng.choice(pool) if odd else 0.0
            self._robot.cmd_vel.publish(message)
            time.sleep(0.03)
        return f"{count} {'impossible ' if odd else ''}velocities, then silence"

    def goal_pose(self) -> str:
        message = PoseStamped()
        frames = ("map", "base_link", "", "moon", "/map", "x" * 999)
        message.header.frame_id = self._rng.choice(frames)
        message.header.stamp.sec = self._rng.choice((0, 0, 1, 2**31 - 1, -5))
        message.pose.position.x = self._rng.choice((2.0, 8.0, -50.0, math.nan, math.inf))
        message.pose.position.y = self._rng.choice((2.0, 8.0, 50.0))
        message.pose.orientation.w = self._rng.choice((1.0, 0.0, math.nan))
        self._goal_pose.publish(message)
        return f"{message.header.frame_id[:9]} {message.pose.position.x}"

    def goals(self) -> str:
        """Goals that pre-empt each other, some of which are cancelled."""
        asked = self._rng.choices(SKILLS, k=self._rng.choice((1, 2, 20)))
        handles, unanswered = self._robot.ask_goals(asked)
        cancelled = [one for one in handles if self._rng.random() < 0.3]
        for one in cancelled:
            one.cancel_goal_async()
        return (
            f"{len(asked)} asked, {len(handles)} accepted, {len(cancelled)} cancelled, "
            f"{unanswered} without an answer"
        )

    def parameters(self) -> str:
        wanted = self._rng.choices(
            (
                Parameter("language", value="fr"), Parameter("language", value="klingon"),
                Parameter("language", value="en"), Parameter("voice", value=3.5),
                Parameter("muted", value=self._rng.random() < 0.5), Parameter("voice", value=""),
                Parameter("frame_prefix", value="moon/"), Parameter("nowhere", value=[1, 2]),
                Parameter("voice", value="x" * 100_000),
            ),
            k=self._rng.choice((1, 3, 40)),
        )  # fmt: skip
        asked = [one.to_parameter_msg() for one in wanted]
        if self._rng.random() < 0.5:
            self._set.call_async(SetParameters.Request(parameters=asked))
        else:
            for one in asked:
                self._set.call_async(SetParameters.Request(parameters=[one]))
        return ", ".join(f"{one.name}={str(one.value)[:9]}" for one in wanted[:5])

    def queries(self) -> str:
        count = self._rng.choice((1, 100))
        for _ in range(count):
            self._query.call_async(Trigger.Request())
        return f"{count} times model_info"

    def sound(self) -> str:
        kind = self._rng.choice(("speech", "noise", "shouting", "odd", "empty", "long", "flood"))
        if kind == "speech":
            self._play(self._speech)
            return kind
        size = {"odd": 641, "empty": 0, "long": 40_000}.get(kind, 640)
        count = {"flood": 2000, "shouting": 60, "noise": 30}.get(kind, 5)
        level = 200 if kind == "noise" else 20_000
        for _ in range(count):
            data = np.frombuffer(self._rng.randbytes(size), np.int8).astype(np.int32) * level // 128
            self._audio.publish(AudioData(data=data.astype("<i2").tobytes()[:size]))
            if kind in ("noise", "shouting"):
                time.sleep(0.02)
        return f"{count} messages: {kind}"

    def joiner(self) -> str:
        """A peer that joins, listens to everything and leaves."""
        other = Peer(self._domain)
        for topic in ("response", "robot_state", "bot_token", "agent_event"):
            other.node.create_subscription(String, other.name(topic), lambda _: None, RELIABLE)
        time.sleep(self._rng.uniform(0.0, 0.5))
        other.close()
        return "a peer came and went"

    def killed_peer(self) -> str:
        what = self._rng.choice(KILLED)
        lives_s = self._rng.uniform(1.5, 6.0)
        started = self._killed.start(what, lives_s)
        return f"{what} for {lives_s:.1f} s" if started else "two flood already"

    def freeze(self) -> str:
        """The whole process stands still, as on a machine that swaps."""
        seconds = self._rng.uniform(1.0, 2.0)
        os.kill(self._robot.pid, signal.SIGSTOP)
        try:
            time.sleep(seconds)
        finally:
            os.kill(self._robot.pid, signal.SIGCONT)
        return f"{seconds:.1f} s"

    def model_server(self) -> str:
        if self._server.alive and self._rng.random() < 0.4:
            self._server.die()
            return "it dies"
        if not self._server.alive:
            self._server.live()
        self._server.mood = self._rng.choice(ModelServer.MOODS)
        return f"it is {self._server.mood}"

    def model_files(self) -> str:
        if self._rng.random() < 0.4:
            self._files.restore()
            return "all are there again"
        return f"{self._files.vanish(self._rng)} vanishes"

    def stop_in_a_flood(self) -> float:
        """Seconds from an interrupt to standing, while a thousand sentences and velocities come."""
        flooding = threading.Event()

        def flood() -> None:
            for _ in range(1000):
                self._strings["text_input"].publish(String(data="where are you"))
                self._strings["set_language"].publish(String(data="xx"))
                if flooding.wait(0.001):
                    return

        thread = threading.Thread(target=flood, name="flood")
        thread.start()
        try:
            return self._robot.stop_works()
        finally:
            flooding.set()
            thread.join()

    def _play(self, sound: Samples) -> None:
        """Into the microphone, as fast as somebody speaks."""
        size = RATE_HZ // 50
        for at in range(0, len(sound), size):
            self._audio.publish(AudioData(data=sound[at : at + size].astype("<i2").tobytes()))
            time.sleep(size / RATE_HZ)

    def _send(self, topic: str, text: str) -> str:
        self._strings[topic].publish(String(data=text))
        return f"{topic}: {json.dumps(text[:60])} ({len(text)} characters)"


def spoken(text: str) -> Samples:
    """Spoken by espeak-ng, at the listener's rate, with quiet around it."""
    chunk = open_espeak().speak(text, "en-us", CancelToken())
    sound = resampled(chunk.samples, chunk.rate_hz, RATE_HZ) * LOUD
    quiet = np.zeros(RATE_HZ, np.int16)
    return np.concatenate([quiet[: RATE_HZ // 2], sound.astype(np.int16), quiet])
