"""Two robots of one name, each on a domain of its own, know nothing of each other."""

import json

import phrases
import pytest
from agent_process import READY, Agent
from peer import STATE, Peer


@pytest.fixture
def robots(domain, _domains):
    """An agent and a peer on each of two domains; both agents have one name."""
    domains = (domain, next(_domains))
    agents = [
        Agent("robot-apartment", "--text-mode", "--ros2", "--llm=none", domain=one)
        for one in domains
    ]
    peers = [Peer(one) for one in domains]
    for one in agents:
        one.wait_for_line(READY)
    yield peers
    for one in peers:
        one.close()
    for one in agents:
        one.terminate()


def test_a_command_on_one_domain_is_not_heard_on_the_other(robots):
    here, there = robots
    agent_events = [one.listen("agent_event") for one in robots]
    words = [one.listen("transcription") for one in robots]
    answers = [one.listen("response") for one in robots]
    states = [one.listen("robot_state", STATE) for one in robots]
    here.send("text_input", "go to the kitchen")
    states[0].wait_for(lambda m: json.loads(m)["goal"] is not None)
    here.send("set_language", "fr")
    here.send("interrupt", "now")
    agent_events[0].wait_for(lambda m: json.loads(m)["kind"] == "skill_cancelled")
    # what the other would have heard meanwhile, it would have told before it answers this
    info = there.listen("info")
    there.send("command", "list_languages")
    assert json.loads(info.wait_for(lambda _: True))["current"] == "en"
    there.send("text_input", "where are you")
    answers[1].wait_for(lambda m: m.startswith(phrases.stands(room="living_room")))
    assert words[1].messages == ["where are you"]
    assert {json.loads(m)["skill"] for m in agent_events[1].messages} == {"get_pose"}
    assert all(json.loads(m)["goal"] is None for m in states[1].messages)
