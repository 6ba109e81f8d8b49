"""Programs as another process sees them: told of, listed and ended over ROS 2."""

import json

import phrases
import pytest
from agent_process import READY, Agent
from peer import Peer


@pytest.fixture(scope="module")
def live(domain):
    """A peer of an agent; both stay for the whole module."""
    agent = Agent("robot-apartment", "--text-mode", "--ros2", "--llm=none", domain=domain)
    agent.wait_for_line(READY)
    peer = Peer(domain)
    yield peer
    peer.close()
    agent.terminate()


def program(events, status, program_id=None):
    """The next event of this kind that tells of this status."""

    def is_it(message):
        event = json.loads(message)
        known = program_id in (None, event.get("program_id"))
        return event["kind"] == "program" and event["status"] == status and known

    return json.loads(events.wait_for(is_it))


def listed(live):
    info = live.listen("info")
    live.send("command", "list_programs")
    return json.loads(info.wait_for(lambda m: json.loads(m)["query"] == "list_programs"))


def test_an_order_for_later_is_told_listed_and_cancelled_by_its_id(live):
    events = live.listen("agent_event")
    live.send("text_input", "in five minutes, go to the office")
    told = program(events, "waiting")
    assert told["text"] == phrases.said(
        "program_after", duration=phrases.said("minutes", count=5), order="going to the office."
    )
    assert told["due_in_s"] == pytest.approx(300.0, abs=1.0)
    (one,) = listed(live)["programs"]
    assert one["program_id"] == told["program_id"]
    assert one["due_in_s"] <= 300.0
    live.send("command", f"cancel_program {told['program_id']}")
    assert program(events, "cancelled", told["program_id"])
    assert listed(live)["programs"] == []


@pytest.mark.parametrize("way", ["cancel_programs", "interrupt", "stop"])
def test_whatever_ends_all_of_them_is_seen(live, way):
    events = live.listen("agent_event")
    live.send("text_input", "if the battery is below five percent, go to the kitchen")
    waiting = program(events, "waiting")["program_id"]
    live.send("text_input", "patrol between the kitchen and the office until I say stop")
    patrol = program(events, "running")["program_id"]
    if way == "interrupt":
        live.send("interrupt", "now")
    else:
        live.send("text_input" if way == "stop" else "command", way)
    assert program(events, "cancelled", waiting)
    assert program(events, "cancelled", patrol)
    assert listed(live)["programs"] == []
