"""A robot that is killed and started again: what its file says fails meanwhile, and works again."""

import contextlib
import json

import phrases
import pytest
from lease import SHORT_LEASE
from robot_file_rig import NAMESPACE, ROBOT_FILE, Asked, Talk, interfaces
from waiting import wait_until

pytestmark = pytest.mark.long

UNANSWERED = ("no_answer", "not_there")
"""What comes of a call whose time is over: a robot that was killed stays on the graph a while."""
SERVED = (f"{NAMESPACE}/honk", f"{NAMESPACE}/dock/_action/send_goal")


class Mortal:
    """The robot's process, which may be killed and started again, and who looks at the graph."""

    def __init__(self, domain: int, peer) -> None:
        self._domain, self._peer = domain, peer
        self._running = contextlib.ExitStack()

    def start(self) -> Asked:
        """Start it; what it is asked, once it is there and no other one that was killed before."""
        with pytest.MonkeyPatch.context() as patch:
            for name, value in SHORT_LEASE.items():
                patch.setenv(name, value)
            self._process = self._running.enter_context(interfaces(self._domain))
        self._seer = self._peer(NAMESPACE)
        wait_until(lambda: self._here() == {1}, "the robot, alone")
        return Asked(self._seer)

    def kill(self) -> None:
        """It says no goodbye."""
        self._process.kill()
        self._running.close()

    def left(self) -> None:
        """Wait until somebody who saw it has given it up."""
        wait_until(lambda: self._here() == {0}, "the end of the robot")

    def _here(self) -> set[int]:
        """How often what it serves and what it hears is on the graph."""
        node = self._seer.node
        served = {node.count_services(one) for one in SERVED}
        return served | {node.count_subscribers(f"{NAMESPACE}/lamp")}


@pytest.fixture
def robot(domain, peer):
    one = Mortal(domain, peer)
    yield one
    one.kill()


@pytest.fixture
def talk(agent, robot, peer):
    """An agent that is talked to; no robot is there yet."""
    agent(f"--robot-file={ROBOT_FILE}", robot="robot-external")
    return Talk(peer())


@pytest.fixture
def codes(talk, peer):
    """Why a skill fails, or is refused, that is asked for in these words: the reason's code."""
    events = peer().listen("agent_event")

    def asked(sentence):
        since = len(events.messages)
        talk.say(sentence)
        over = ("failed", "rejected")
        ended = events.wait_for(lambda one: json.loads(one).get("status") in over, since=since)
        return json.loads(ended)["code"]

    return asked


def all_works(talk, asked):
    """Its service, topics and action do what they are asked. What was heard last stays a while."""
    asked.do("shut")
    talk.ask_until("sound the horn", "That was loud.")
    asked.wait("honk", True)
    talk.ask_until("lamp to crimson", "The lamp is red.")
    wait_until(lambda: talk.answer("lamp to red") and asked.times("lamp"), "the lamp's message")
    asked.wait("lamp", 1)
    talk.ask_until("how warm are you", "It is 41.26 degrees.")
    with asked.within("dock", ["slot 4", "{}"]):
        talk.say("dock into slot 4", "Docking.", "I am in slot 3.")
    talk.say("tell me when the door is open", "I will tell you.")
    with talk.told("The door is open."):
        asked.do("open")


def test_while_it_is_away_each_skill_fails_by_a_reason_and_then_all_works_again(talk, robot, codes):
    all_works(talk, robot.start())
    robot.kill()
    assert codes("sound the horn") in UNANSWERED
    assert codes("dock") in UNANSWERED
    robot.left()
    wait_until(lambda: codes("sound the horn") == "not_there", "the end of the horn")
    wait_until(lambda: codes("dock") == "not_there", "the end of the dock")
    talk.ask_until("lamp to red", phrases.interface("nobody_listens", "lamp"))
    talk.ask_until("how warm are you", phrases.interface("unheard", "temperature"))
    talk.say("what can you do", "I can: ")
    all_works(talk, robot.start())


def test_one_that_dies_at_its_work_and_comes_again_at_once_works_again(talk, robot, codes):
    asked = robot.start()
    asked.do("hang")
    talk.say("dock", "Docking.")
    asked.wait("dock")
    with talk.told(phrases.interface("no_answer", "dock")):
        robot.kill()
    all_works(talk, robot.start())
