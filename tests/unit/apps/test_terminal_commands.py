"""Which typed lines wait for nothing, and for which nothing waits."""

import pytest

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.skills import SkillSet
from edgevox.agent.text.reasons import because
from edgevox.apps.terminal.slash_commands import SlashContext, is_slow, is_stop
from edgevox.core.bus import Bus
from edgevox.core.motion.interlock import Interlock
from edgevox.core.motion.software_stop import SoftwareStop


@pytest.fixture
def context():
    agents, bus = [Agent("nobody", "", SkillSet(()))], Bus()
    stop = SoftwareStop(Interlock(), bus, lambda _: None, because("software_stop"))
    talk = Conversation(agents, bus, halt=lambda _: False)
    return SlashContext(talk, None, software_stop=stop)


@pytest.mark.parametrize("line", ["/stop", "/STOP", "/stop ", "/reset", "stop", "Please stop!"])
def test_a_line_that_stops(context, line):
    assert is_stop(line, context)


@pytest.mark.parametrize(
    "line", ["/quit", "/restart", "/picture stop.png", "/help", "/", "where are you", ""]
)
def test_a_line_that_does_not(context, line):
    assert not is_stop(line, context)


def test_only_what_may_take_long_is_slow():
    assert is_slow("/picture")
    assert is_slow("/picture here.png")
    assert not any(is_slow(line) for line in ("/stop", "/reset", "/quit", "picture", "/"))
