"""The stop game: orders by every way in, at any moment, and stops in between.

The rule that it holds: no motion lasts or begins after a stop unless something that was *sent after
it* asked for it. `StopGame` plays it in one process, with a body that says of each motion which
order it is for. An order is sent when it leaves whoever gives it; it may be received much later, as
what waits in a queue of ROS 2 or in a page's socket is, or come as words that are still being
transcribed.
"""

import threading
from collections.abc import Callable
from typing import Any

from guards import HUNG_S
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, precondition, rule
from support.body import FakeBody
from support.clock import HeldClock

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.known import Known
from edgevox.agent.policy import Guard
from edgevox.agent.skills import Call, GoalHandle, SkillFailed, SkillSet, skill
from edgevox.agent.text.reasons import because
from edgevox.core.agent_events import AgentEvent, Confirmation, ConfirmationStatus
from edgevox.core.bus import Bus
from edgevox.core.commands import (
    CancelProgram,
    Heard,
    Interrupt,
    Reset,
    RunSkill,
    Speak,
    StopSpotted,
    TextInput,
    Transcribing,
    Way,
)
from edgevox.core.errors import EdgeVoxError
from edgevox.core.events import Cause, Responded
from edgevox.core.motion.interlock import Interlock, StreamStopped
from edgevox.core.motion.software_stop import SoftwareStop
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.command_mux import WATCHDOG_S
from edgevox.robots.limits import Steering

HELD = st.booleans()
"""Whether an order is received later than it is sent."""
NEVER = -1
"""An order of which nothing may come: it was sent while all motion was forbidden."""


class Witness(FakeBody):
    """Drives to points whose x is the number of an order, and says which one moves it.

    `finished` are the stops that have returned. A drive that a stop had ended before it began is
    none, as the body never moved for it.
    """

    def __init__(self) -> None:
        super().__init__()
        self.finished = 0
        self.drives_for: int | None = None
        self.velocity = 0.0
        self.begun: list[tuple[int, int]] = []
        """Of each motion the number of its order, and how many stops had finished before."""
        self._lock = threading.Lock()

    def halt(self, reason: str) -> bool:
        with self._lock:
            moved = self.drives_for is not None or bool(self.velocity)
            self.drives_for, self.velocity = None, 0.0
        return super().halt(reason) or moved

    def set_velocity(self, twist: Twist2D) -> None:
        with self._lock:
            self.velocity = twist.linear_m_s

    def drive(self, goal: GoalHandle, where: Any) -> None:
        finished, order = self.finished, int(where)
        with self._lock:
            self.drives_for = order
        forget = goal.token.on_cancel(lambda: self._leave(order))
        if not goal.token.cancelled:
            self.begun.append((order, finished))
        try:
            super().drive(goal, order)
        finally:
            forget()
            self._leave(order)

    def _leave(self, order: int) -> None:
        with self._lock:
            if self.drives_for == order:
                self.drives_for = None

    def known_skills(self) -> SkillSet:
        """What it can be asked for."""

        @skill(says="Going to x {x:g}, y {y:g}.", done="I am there.")
        def navigate_xy(goal: GoalHandle, x: float, y: float):
            """Drive to a point."""
            self.drive(goal, x)

        @skill(templates=["(wait|stand) here"], says="Stopping.")
        def stop(goal: GoalHandle):
            """Stop."""

        @skill(templates=["where are you"], done="I am here.", moves=False)
        def get_pose(goal: GoalHandle):
            """Say where the robot is."""

        return SkillSet([navigate_xy, stop, get_pose])


class StopGame(RuleBasedStateMachine):
    """Hypothesis chooses what is sent, received and stopped, in which order."""

    def __init__(self) -> None:
        super().__init__()
        self.bus, self.body, self.time, self.interlock = (
            Bus(),
            Witness(),
            HeldClock(1000.0),
            Interlock(),
        )
        self.conversation = Conversation(
            [Agent("robot", "Be brief.", self.body.known_skills())],
            self.bus,
            halt=self.body.halt,
            guard=Guard(None, self.bus),
            clock=self.time,
            interlock=self.interlock,
            timer=self.time,
            known=Known(way_back=lambda: Call("navigate_xy", {"x": 0.0, "y": 0.0})),
        )
        self.software_stop = SoftwareStop(
            self.interlock, self.bus, self.conversation.stop, because("software_stop")
        )
        self.steering = Steering(self.body, self.interlock, lambda *one: one, self.time)
        self.conversation.start()
        self.heard = threading.Condition()
        self.said: set[str] = set()
        self.bus.subscribe(Responded, lambda event: self.hear(event.text))
        self.probes = self.stops = self.orders = 0
        self.waiting: list[Callable[[], object]] = []
        """What was sent and is not received yet: calls that hand it over."""
        self.sent_after: dict[int, int] = {}
        self.spoken: set[int] = set()
        self.asked: tuple[int, int] | None = None
        """The order that is asked about, and after how many stops."""
        self.bus.subscribe(AgentEvent, self.be_asked_about)
        self.stream_after = 0
        self.steered_s = float("-inf")
        self.goals: list[Any] = []

    def teardown(self) -> None:
        self.conversation.close()
        self.check()

    def order(self) -> int:
        """The number of a new order, which is sent now."""
        self.orders += 1
        self.sent_after[self.orders] = NEVER if self.forbidden else self.stops
        return self.orders

    @property
    def forbidden(self) -> bool:
        return self.software_stop.state.engaged

    def has_begun(self, order: int) -> bool:
        """Whether anything moved for it, once all that was received is thought through."""
        self.body.arrive()
        assert self.conversation.wait_idle(HUNG_S)
        self.body.drive_on()
        return any(order == one for one, _ in self.body.begun)

    def check(self) -> None:
        """No motion began after a stop for an order that had been sent before it."""
        late = [
            (order, finished)
            for order, finished in list(self.body.begun)
            if self.sent_after.get(order, NEVER) < finished
        ]
        assert not late, f"began after a stop: {late}, sent after {self.sent_after}"

    def stopped(self, stop: Callable[[], object]) -> None:
        """Stop so, and see that nothing lasts."""
        self.stops += 1
        stop()
        self.body.finished = self.stops
        drives_for = self.body.drives_for
        assert drives_for is None, f"order {drives_for} drives on"
        assert self.body.velocity == 0.0, "the stream drives on"
        self.check()

    # Orders: sent now, and received at once or later

    def send(self, receive: Callable[[], object], *, held: bool) -> None:
        if held:
            self.waiting.append(receive)
        else:
            receive()
            self.settle()
            self.check()

    def say(self, text: str, way: Way = Way.TEXT_INPUT, *, held: bool) -> None:
        words, mark = TextInput(text, way), self.interlock.mark
        self.send(lambda: self.conversation.submit(words, mark), held=held)

    @rule(way=st.sampled_from([Way.TEXT_INPUT, Way.TYPED, Way.CONSOLE_OPERATOR]), held=HELD)
    def send_text(self, way: Way, held: bool) -> None:
        self.say(f"go to x {self.order()}, y 1", way, held=held)

    @rule(delay_s=st.sampled_from([1, 2, 5]), held=HELD)
    def send_an_order_for_later(self, delay_s: int, held: bool) -> None:
        self.say(f"in {delay_s} seconds go to x {self.order()}, y 1", held=held)

    @rule(held=HELD)
    def send_two_drives(self, held: bool) -> None:
        first, second = self.order(), self.order()
        self.say(f"go to x {first}, y 1 and then go to x {second}, y 1", held=held)

    @rule(held=HELD)
    def send_a_patrol(self, held: bool) -> None:
        self.say(f"go to x {self.order()}, y 1 three times", held=held)

    @rule(
        way=st.sampled_from([Way.ACTION, Way.GOAL_POSE]),
        checked=st.booleans(),
        held=HELD,
    )
    def send_goal(self, way: Way, checked: bool, held: bool) -> None:
        """As the action does it: a request is checked when it is taken, and begins after that."""
        arguments, mark = {"x": self.order(), "y": 1}, self.interlock.mark

        def check() -> None:
            self.conversation.check_goal("navigate_xy", arguments, way, mark)

        def receive() -> None:
            try:
                if not checked:
                    check()
                goal = self.conversation.start_goal("navigate_xy", arguments, None, way, mark)
                self.goals.append(goal)
            except EdgeVoxError:
                pass

        if checked:
            try:
                check()
            except EdgeVoxError:
                return
        self.send(receive, held=held)

    @rule(held=HELD)
    def send_a_pages_goal(self, held: bool) -> None:
        asked = RunSkill("navigate_xy", {"x": self.order(), "y": 1}, Way.CONSOLE_OPERATOR)
        mark = self.interlock.mark
        self.send(lambda: self.conversation.submit(asked, mark), held=held)

    @rule(held=HELD)
    def speak(self, held: bool) -> None:
        """The words are known later, and were begun now."""
        order, began_s = self.order(), self.time.now()
        text = f"go to x {order}, y 1"
        self.spoken.add(order)
        self.conversation.submit(Transcribing())

        def hear() -> None:
            self.time.advance(0.01)
            self.conversation.submit(Heard(text, self.time.now(), began_s=began_s))

        self.send(hear, held=held)

    @rule(held=HELD)
    def be_asked(self, held: bool) -> None:
        """Order something that is asked about; a yes may follow."""
        self.conversation.set_confirm("always")
        self.say(f"go to x {self.order()}, y 1", held=held)
        self.conversation.set_confirm("unsure")

    @rule(held=HELD)
    def say_yes(self, held: bool) -> None:
        yes, mark = TextInput("yes"), self.interlock.mark
        sent_after, counts = self.stops, not self.forbidden

        def receive() -> None:
            self.settle()
            if counts and sent_after == self.stops:
                self.yes_comes()
            self.conversation.submit(yes, mark)

        self.send(receive, held=held)

    @precondition(lambda self: self.waiting)
    @rule(which=st.integers(0, 7))
    def receive_one(self, which: int) -> None:
        self.waiting.pop(which % len(self.waiting))()

    @precondition(lambda self: self.waiting)
    @rule(seconds=st.sampled_from([0.0, 1.0, 5.0]))
    def receive_all(self, seconds: float) -> None:
        """What was on its way comes, is thought through, said yes to, and waits for its time."""
        while self.waiting:
            self.waiting.pop(0)()
        self.settle()
        self.yes_comes()
        self.conversation.submit(TextInput("yes"))
        self.settle()
        self.time_passes(seconds)

    def settle(self) -> None:
        """Wait until all that was received is thought through."""
        self.probes += 1
        text = f"probe {self.probes}"
        self.conversation.submit(Speak(text))
        with self.heard:
            assert self.heard.wait_for(lambda: text in self.said, HUNG_S)

    def be_asked_about(self, event: AgentEvent) -> None:
        """Note which order is asked about."""
        if isinstance(event, Confirmation):
            asked = event.status is ConfirmationStatus.ASKED
            self.asked = (event.calls[0].arguments["x"], self.stops) if asked else None

    def yes_comes(self) -> None:
        """A yes that was sent since the last stop orders what was asked about since then.

        Only words may be asked about that were being said when a stop came, and only where it was
        its sound that told of it: all else that was sent before a stop is void.
        """
        order, stops = self.asked or (0, 0)
        if order in self.spoken and stops == self.stops and not self.forbidden:
            self.sent_after[order] = self.stops

    def hear(self, text: str) -> None:
        with self.heard:
            self.said.add(text)
            self.heard.notify_all()

    # A stream of velocities

    @rule(pause_s=st.sampled_from([0.0, 0.1, 0.3, WATCHDOG_S, 1.0]))
    def steer(self, pause_s: float) -> None:
        self.time.advance(pause_s)
        begins = self.time.now() - self.steered_s >= WATCHDOG_S
        self.steered_s = self.time.now()
        if begins:
            self.stream_after = NEVER if self.forbidden else self.stops
        elif self.forbidden:
            self.stream_after = NEVER
        try:
            self.steering.steer(0.3, 0.0)
        except (SkillFailed, StreamStopped):
            assert self.stream_after < self.stops or self.forbidden, "a stream that may is refused"
            assert self.body.velocity == 0.0
        else:
            assert self.stream_after == self.stops, "a stream goes on after a stop"
            assert self.body.velocity == 0.3

    @rule()
    def let_go_of_the_stick(self) -> None:
        self.steering.steer(0.0, 0.0)
        self.steering.let_go()
        self.steered_s = float("-inf")
        assert self.body.velocity == 0.0

    # Stops

    def type_a_stop_word(self) -> None:
        self.conversation.submit(TextInput("no, stop"))

    def say_a_stop_word(self) -> None:
        self.time.advance(0.3)
        now_s = self.time.now()
        self.conversation.submit(Transcribing())
        self.conversation.submit(Heard("stop", now_s, began_s=now_s - 0.3))

    def say_one_that_is_known_by_its_sound(self) -> None:
        self.time.advance(0.3)
        self.conversation.submit(StopSpotted(self.time.now(), "stop"))

    def say_one_of_another_language(self) -> None:
        self.conversation.set_language("de")
        self.conversation.submit(TextInput("halt an"))
        self.conversation.set_language("en")

    def interrupt(self) -> None:
        self.conversation.submit(Interrupt(cause=Cause.TOPIC))

    def reset(self) -> None:
        self.conversation.submit(Reset())

    def call_the_skill_by_the_action(self) -> None:
        self.conversation.start_goal("stop", {})

    def call_the_skill_as_a_command(self) -> None:
        self.conversation.submit(RunSkill("stop", {}, Way.CONSOLE_OPERATOR))

    @rule(
        way=st.sampled_from(
            [
                type_a_stop_word,
                say_a_stop_word,
                say_one_that_is_known_by_its_sound,
                say_one_of_another_language,
                interrupt,
                reset,
                call_the_skill_by_the_action,
                call_the_skill_as_a_command,
            ]
        ),
        then_receive=st.booleans(),
    )
    def stop(self, way: Callable[["StopGame"], object], then_receive: bool) -> None:
        self.stopped(lambda: way(self))
        if then_receive:
            self.receive_all(5.0)

    @rule(resumes=st.booleans(), asks=st.booleans())
    def press_stop(self, resumes: bool, asks: bool) -> None:
        self.stopped(lambda: self.software_stop.stop("a phone"))
        if asks:
            self.say(f"go to x {self.order()}, y 1", held=True)
        if resumes:
            self.resume()

    @precondition(lambda self: self.forbidden)
    @rule()
    def resume(self) -> None:
        self.software_stop.resume("a phone")
        self.receive_all(1.0)

    # What else happens

    @rule(seconds=st.sampled_from([0.3, 1.0, 5.0]))
    def time_passes(self, seconds: float) -> None:
        self.time.advance(seconds)
        if self.time.now() - self.steered_s >= WATCHDOG_S:
            self.body.set_velocity(Twist2D(0.0, 0.0))  # as a body's watchdog does
        self.check()

    @rule()
    def it_arrives(self) -> None:
        """All that was received is thought through and driven to its end."""
        self.body.arrive()
        assert self.conversation.wait_idle(HUNG_S)
        self.body.drive_on()
        self.check()

    @rule(word=st.sampled_from(["halt", "stopp", "stop"]))
    def speak_another_language(self, word: str) -> None:
        self.conversation.set_language("de")
        self.stopped(lambda: self.conversation.submit(TextInput(word)))
        self.conversation.set_language("en")

    @rule()
    def cancel(self) -> None:
        for goal in self.goals:
            goal.token.cancel(because("client_asked"))
        self.goals.clear()

    @rule()
    def cancel_programs(self) -> None:
        self.conversation.submit(CancelProgram())

    @precondition(lambda self: not self.forbidden and self.waiting)
    @rule()
    def what_is_sent_after_all_stops_is_done(self) -> None:
        """The game is not won by a robot that never moves."""
        self.settle()  # what was received before takes its place no more
        order = self.order()
        self.conversation.start_goal("navigate_xy", {"x": order, "y": 1})
        self.body.starts_until_driving(order)
        self.check()
