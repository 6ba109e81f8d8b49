"""Skills that misbehave in every way a program can: it is spoken of, and all else goes on."""

import json
import sys
import threading
import time

import phrases
import pytest
from guards import HUNG_S, run_program
from support.conversation import Talk

from edgevox.agent.goals import executor, lane
from edgevox.agent.goals.lane import GRACE_S
from edgevox.agent.skills import SkillSet, skill
from edgevox.core.agent_events import GoalCancelled, GoalChanged, as_json
from edgevox.core.clock import SystemClock
from edgevox.core.commands import TextInput
from edgevox.core.errors import InvalidValue


class Skills:
    """What misbehaves, and one that does not; `free` lets go of what hangs."""

    def __init__(self):
        self.free = threading.Event()
        self.hangs = threading.Event()

    def all(self):
        def breaking(name, error, *, moves):
            def function(goal):
                """Break."""
                raise error

            function.__name__ = name
            return skill(templates=[name.replace("_", " ")], moves=moves)(function)

        @skill(templates=["return nonsense"])
        def nonsense(goal):
            """Return what is no JSON."""
            return {"when": threading.Lock()}

        @skill(templates=["return a number"])
        def seven(goal):
            """Return what is no mapping."""
            return 7

        @skill(templates=["mumble"])
        def mumble(goal):
            """Report what is no JSON."""
            goal.report(where=object())

        @skill(templates=["walk"], says="Walking.", done="I have walked.")
        def walk(goal):
            """Do as it should."""

        @skill(templates=["wander"], says="Wandering.")
        def wander(goal):
            """Never look at the token."""
            self.wanderer = threading.current_thread()
            self.hangs.set()
            self.free.wait(60)

        @skill(templates=["ponder"], moves=False)
        def ponder(goal):
            """Never answer."""
            self.hangs.set()
            self.free.wait(60)

        return SkillSet(
            [
                breaking("fall_apart", ZeroDivisionError("by zero"), moves=True),
                breaking("refuse_a_value", InvalidValue("speed", -1, "above 0"), moves=True),
                breaking("leave_us", SystemExit(3), moves=True),
                breaking("leave_now", SystemExit(3), moves=False),
                breaking("get_nervous", KeyboardInterrupt(), moves=True),
                nonsense,
                seven,
                mumble,
                walk,
                wander,
                ponder,
            ]
        )


class Rig(Talk):
    """A conversation with a robot that has these skills."""

    def __init__(self):
        self.misbehaving = Skills()
        super().__init__(skills=self.misbehaving.all(), clock=SystemClock())

    def say(self, text):
        self.conversation.submit(TextInput(text))

    def hear(self, wanted):
        self.until(lambda: any(wanted in said for said in self.said))

    @property
    def ends(self):
        return [as_json(one) for one in self.of(GoalChanged, GoalCancelled)]


@pytest.fixture
def rig():
    one = Rig()
    one.conversation.start()
    yield one
    one.misbehaving.free.set()
    one.conversation.close()


@pytest.mark.parametrize(
    ("said", "skill", "raised"),
    [
        ("fall apart", "fall_apart", "by zero"),
        ("refuse a value", "refuse_a_value", "got -1, expected above 0"),
        ("leave us", "leave_us", "3"),
        ("leave now", "leave_now", "3"),
        ("get nervous", "get_nervous", "KeyboardInterrupt"),
        ("return nonsense", "nonsense", "its result is not JSON"),
        ("return a number", "seven", "its result is 7, not a mapping"),
        ("mumble", "mumble", "Object of type object is not JSON"),
    ],
)
@pytest.mark.parametrize(
    ("language", "told"), [("en", "there was an error in"), ("de", "ist ein Fehler aufgetreten")]
)
def test_whatever_a_skill_raises_people_hear_of_an_error_and_the_next_one_runs(
    rig, said, skill, raised, language, told
):
    rig.conversation.set_language(language)
    rig.say(said)
    rig.hear(told)

    rig.say("walk")
    rig.hear("I have walked.")

    assert not [one for one in rig.said if raised in one]
    assert rig.conversation.alive
    json.dumps(rig.ends)
    (failed,) = [end for end in rig.ends if end["status"] == "failed"]
    assert (failed["code"], failed["skill"]) == ("skill_broke", skill)
    assert raised in failed["error"], "programs are told"


@pytest.fixture
def little_grace(monkeypatch):
    """Nobody waits the usual two seconds for what never returns."""
    monkeypatch.setattr(lane, "GRACE_S", 0.1)


@pytest.mark.parametrize("said", ["wander", "ponder"])
def test_a_skill_that_never_ends_is_left_alone_when_it_is_stopped(rig, little_grace, said):
    rig.say(said)
    assert rig.misbehaving.hangs.wait(HUNG_S)

    rig.say("stop")
    rig.hear(phrases.said("stopped"))
    rig.say("walk")
    rig.hear("I have walked.")

    assert [e["status"] for e in rig.ends if e["skill"] == said][-1] == "cancelled"


def test_an_answer_that_does_not_come_does_not_hold_up_the_next_for_ever(rig, monkeypatch):
    monkeypatch.setattr(executor, "ANSWER_S", 0.2)
    rig.say("ponder")

    rig.hear(phrases.opening("failed") + phrases.why("took_too_long", skill="ponder", seconds="0"))
    rig.say("walk")
    rig.hear("I have walked.")


def test_what_it_says_when_it_comes_back_after_all_is_not_heard(rig, little_grace):
    rig.say("wander")
    assert rig.misbehaving.hangs.wait(HUNG_S)
    rig.say("stop")
    rig.hear(phrases.said("stopped"))
    assert rig.conversation.wait_idle(HUNG_S)

    rig.misbehaving.free.set()
    rig.misbehaving.wanderer.join(HUNG_S)
    assert not rig.misbehaving.wanderer.is_alive()

    assert [e["status"] for e in rig.ends if e["skill"] == "wander"][-1] == "cancelled"


def test_a_skill_that_never_ends_does_not_keep_the_process():
    program = """
import threading
from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.skills import SkillSet, skill
from edgevox.core.bus import Bus
from edgevox.core.commands import TextInput
from edgevox.core.errors import InvalidValue

hangs = threading.Event()

@skill(templates=["wander"])
def wander(goal):
    "Never look at the token."
    hangs.set()
    threading.Event().wait()

one = Conversation([Agent("robot", "", SkillSet([wander]))], Bus(), halt=lambda _: False)
one.start()
one.submit(TextInput("wander"))
hangs.wait()
one.close()
print("closed", flush=True)
"""
    began_s = time.monotonic()
    done = run_program([sys.executable, "-c", program])

    assert (done.returncode, done.stdout) == (0, "closed\n"), done.stderr
    assert time.monotonic() - began_s >= GRACE_S
