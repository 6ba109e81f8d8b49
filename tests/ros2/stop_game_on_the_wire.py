"""The stop game with a real agent: orders by every way in, in any order, and stops in between.

It has the rule of `stop_game.py`: nothing moves after a stop unless something that was sent after
it asked for it. A seed decides what is sent. How far each of it has come when the stop does is the
machine's business.
"""

import random
from collections.abc import Callable, Mapping

from interop_rig import Stream
from watched_robot import BUTTON, LET_GO_S, STOPS, WatchedRobot, resume, stop

LATER = {"en": "in two seconds {}", "de": "in zwei Sekunden {}"}
TWICE = {"en": "{0} and then {0} again", "de": "{0} und dann {0}"}
PATROL = {
    "en": "patrol between the kitchen and the office until I say stop",
    "de": "patrouilliere zwischen der Küche und dem Büro bis ich stopp sage",
}
WORDS = {"en": ("stop", "halt", "freeze"), "de": ("stopp", "halt", "stop")}
YES = {"en": "yes", "de": "ja"}
WATCHED_S = 3.5
"""What is due in two seconds would move it by then."""


class StopGameOnTheWire:
    """Plays rounds with one robot; `trace` is what was sent in this round."""

    def __init__(self, robot: WatchedRobot, seed: int) -> None:
        self.trace: list[str] = []
        self._robot, self._seed = robot, seed
        self._dice = random.Random(seed)
        self._language = "en"
        self._streams: dict[str, Stream] = {}
        self._orders: Mapping[str, Callable[[], object]] = {
            "text_input": lambda: self._write(self._sentence()),
            "for later": lambda: self._write(LATER[self._language].format(self._sentence())),
            "two drives": lambda: self._write(TWICE[self._language].format(self._sentence())),
            "a patrol": lambda: self._write(PATROL[self._language]),
            "standard input": lambda: robot.type(self._sentence()),
            "3 goals": lambda: robot.send_goals(3),
            "12 goals": lambda: robot.send_goals(12),
            "goal_pose": robot.send_pose,
            "a point on the page": self._point,
            "8 points on the page": lambda: [self._point() for _ in range(8)],
            "text on the page": lambda: robot.page.send(type="text", text=self._sentence()),
            "a skill on the page": self._skill,
            "the stick": lambda: self._hold("the stick", robot.stick),
            "cmd_vel": lambda: self._hold("cmd_vel", robot.joystick),
            "what it asks about": self._be_asked,
            "a long answer": lambda: self._write("why is the sky blue"),
            "a cancel": lambda: robot.client.cancel_without_waiting(robot.goes()),
            "cancel_programs": lambda: robot.peer.send("command", "cancel_programs"),
        }
        self._counts: Mapping[str, Callable[[], object]] = {
            one: self._orders[one]
            for one in ("text_input", "standard input", "goal_pose", "the stick", "cmd_vel")
        } | {
            "a goal": robot.goes,
            "a point on the page": lambda: robot.page.ask(type="goto", **robot.target()),
            "text on the page": lambda: robot.page.ask(type="text", text=self._sentence()),
        }

    def play_round(self) -> None:
        """Some orders, a stop, nothing moves; then an order that counts."""
        self.trace.clear()
        try:
            self._play_round()
        except AssertionError as error:
            raise AssertionError(f"seed {self._seed}, sent {self.trace}: {error}") from error
        finally:
            self._let_go()

    def _play_round(self) -> None:
        robot, dice = self._robot, self._dice
        robot.page.send(type="lease", action="take")
        if dice.random() < 0.3:
            self._speak(dice.choice(["en", "de"]))
        self._send(dice.randint(1, 6))
        since = len(robot.state.messages)
        self._stop()
        try:
            robot.stays(WATCHED_S)
        except AssertionError:
            if robot.was_steady(since) or not self._streams:
                raise
        self._let_go()
        robot.page.ask(type="set", name="confirm", value="unsure")
        after = dice.choice(list(self._counts))
        self.trace.append(f"after it: {after}")
        self._counts[after]()
        robot.moves()

    def _send(self, number: int) -> None:
        for order in self._dice.choices(list(self._orders), k=number):
            self.trace.append(order)
            self._orders[order]()
            if self._dice.random() < 0.3:
                self.trace.append("...")
                self._robot.has_looked()

    def _stop(self) -> None:
        """By any way, perhaps twice. A yes that comes after it answers nothing."""
        robot, dice = self._robot, self._dice
        for _ in range(dice.choice([1, 1, 2])):
            way = dice.choice(list(STOPS))
            word = dice.choice(WORDS[self._language])
            self.trace.append(f"stop: {way}, {word}")
            stop(robot, way, word)
            if way == BUTTON:
                self._send(dice.randint(0, 3))
                self.trace.append("resume")
                resume(robot)
        self._write(YES[self._language])

    def _speak(self, language: str) -> None:
        self.trace.append(language)
        self._language = language
        self._robot.page.ask(type="set", name="language", value=language)

    def _sentence(self) -> str:
        return self._robot.sentence_to(self._language)

    def _write(self, text: str) -> None:
        self._robot.peer.send("text_input", text)

    def _point(self) -> None:
        self._robot.page.send(type="goto", **self._robot.target())

    def _skill(self) -> None:
        self._robot.page.send(type="skill", name="navigate_xy", arguments=self._robot.target())

    def _be_asked(self) -> None:
        self._robot.page.send(type="set", name="confirm", value="always")
        self._robot.page.send(type="text", text=self._sentence())

    def _hold(self, name: str, begin: Callable[[], Stream]) -> None:
        if name not in self._streams:
            self._streams[name] = begin()

    def _let_go(self) -> None:
        """End the streams, and wait until another one counts."""
        if not self._streams:
            return
        for stream in self._streams.values():
            stream.end()
        self._streams.clear()
        self._robot.passes(LET_GO_S)
