"""Every row of the contract, as a process sees it that knows nothing but the contract."""

import importlib
import json
from pathlib import Path

import pytest
import yaml
from agent_process import READY, Agent
from bodies_rig import full
from interop_rig import hear
from peer import RELIABLE, STATE, Peer
from rclpy.action.graph import get_action_names_and_types
from rclpy.qos import qos_profile_sensor_data
from waiting import wait_until

CONTRACT = yaml.safe_load((Path(__file__).parent / "contract.yaml").read_text(encoding="utf-8"))
NOT_HERE = {"image_raw"}
"""What the robot of the apartment does not have: a camera. test_conformance_senses has one."""
SILENT = {"audio_level", "wakeword", "bot_token"}
"""What needs a microphone and a language model; their messages are in test_conformance_senses."""
RATED = {
    topic: row["rate_hz"]
    for part in ("published", "robot_interop", "shared")
    for topic, row in CONTRACT[part].items()
    if "rate_hz" in row and topic not in NOT_HERE
}
PERIODS = 8


@pytest.fixture(scope="module")
def live(domain):
    """A peer of an agent; both stay for the whole module."""
    agent = Agent("robot-apartment", "--text-mode", "--ros2", "--llm=none", domain=domain)
    agent.wait_for_line(READY)
    peer = Peer(domain)
    name = (CONTRACT["node"], CONTRACT["default_namespace"])
    wait_until(lambda: name in peer.node.get_node_names_and_namespaces(), "the node's name")
    yield peer
    peer.close()
    agent.terminate()


def message_class(kind):
    package, _, name = kind.split("/")
    return getattr(importlib.import_module(f"{package}.msg"), name)


@pytest.mark.parametrize("topic", CONTRACT["published"])
def test_a_published_topic_has_its_type_and_quality_of_service(live, topic):
    row = CONTRACT["published"][topic]
    wait_until(lambda: live.node.count_publishers(full(topic)) == 1, topic)
    (endpoint,) = live.node.get_publishers_info_by_topic(full(topic))
    check(endpoint, row["type"], CONTRACT["qos"][row["qos"]])


@pytest.mark.parametrize("topic", CONTRACT["subscribed"])
def test_a_subscribed_topic_has_its_type_and_quality_of_service(live, topic):
    row = CONTRACT["subscribed"][topic]
    wait_until(lambda: live.node.count_subscribers(full(topic)) == 1, topic)
    (endpoint,) = live.node.get_subscriptions_info_by_topic(full(topic))
    check(endpoint, row["type"], CONTRACT["qos"][row["qos"]])


def check(endpoint, kind, qos):
    assert endpoint.topic_type == kind
    assert endpoint.node_name == CONTRACT["node"]
    assert endpoint.node_namespace == CONTRACT["default_namespace"]
    assert endpoint.qos_profile.reliability.name.lower() == qos["reliability"]
    assert endpoint.qos_profile.durability.name.lower() == qos["durability"]


@pytest.mark.parametrize("topic", sorted(set(CONTRACT["robot_interop"]) - NOT_HERE))
def test_a_topic_of_the_robot_has_its_type_and_direction(live, topic):
    row = CONTRACT["robot_interop"][topic]
    out = row["dir"] == "out"
    count = live.node.count_publishers if out else live.node.count_subscribers
    wait_until(lambda: count(full(topic)) == 1, topic)
    find = (
        live.node.get_publishers_info_by_topic if out else live.node.get_subscriptions_info_by_topic
    )
    assert [endpoint.topic_type for endpoint in find(full(topic))] == [row["type"]]


@pytest.mark.parametrize("topic", sorted(NOT_HERE))
def test_what_a_body_cannot_do_is_not_advertised(live, topic):
    assert live.node.count_publishers(full(topic)) == 0


@pytest.mark.parametrize("topic", CONTRACT["shared"])
def test_a_topic_that_agents_share_has_its_type_and_quality_of_service(live, topic):
    row = CONTRACT["shared"][topic]
    wait_until(lambda: live.node.count_subscribers(full(topic)) == 1, topic)
    (endpoint,) = live.node.get_subscriptions_info_by_topic(full(topic))
    check(endpoint, row["type"], CONTRACT["qos"][row["qos"]])


def test_an_agent_says_again_and_again_that_it_is_here(live):
    said = live.listen("presence", STATE)
    wait_until(lambda: len(said.messages) > 2, "three of them")
    assert list(json.loads(said.messages[-1])) == CONTRACT["shared"]["presence"]["json"]
    assert json.loads(said.messages[-1])["in_charge"] is True


@pytest.mark.parametrize("query", CONTRACT["queries"])
def test_a_query_is_answered_with_its_keys(live, query):
    info = live.listen("info")
    live.send("command", query)
    answer = json.loads(info.wait_for(lambda m: json.loads(m)["query"] == query))
    assert set(answer) == {"query", *CONTRACT["queries"][query]}


def test_the_action_is_there_with_its_type(live):
    ((name, row),) = CONTRACT["actions"].items()
    wait_until(lambda: (full(name), [row["type"]]) in get_action_names_and_types(live.node), name)


def test_a_message_comes_through_on_every_topic_that_has_a_source(live):
    heard = {
        topic: live.listen(topic, STATE if row["qos"] == "state" else RELIABLE)
        for topic, row in CONTRACT["published"].items()
        if topic not in SILENT
    }
    live.send("text_input", "where are you")
    live.send("command", "model_info")
    for topic, messages in heard.items():
        text = messages.wait_for(lambda _: True)
        if CONTRACT["published"][topic].get("json"):
            assert isinstance(json.loads(text), dict)


def test_the_keys_of_metrics_are_seconds(live):
    metrics = live.listen("metrics")
    live.send("text_input", "where are you")
    measured = json.loads(metrics.wait_for(lambda _: True))
    assert list(measured) == CONTRACT["published"]["metrics"]["json"]
    assert all(0 <= seconds < 60 for seconds in measured.values())


def test_text_is_said_as_it_is(live):
    sentence = live.listen("bot_sentence")
    live.send("tts_request", "The shop closes in ten minutes.")
    assert sentence.wait_for(lambda _: True) == "The shop closes in ten minutes."


@pytest.mark.parametrize("topic", RATED)
def test_nothing_comes_faster_than_its_rate(live, topic):
    (endpoint,) = live.node.get_publishers_info_by_topic(full(topic))
    kind = message_class(endpoint.topic_type)
    heard = hear(live, kind, full(topic), qos_profile_sensor_data)
    assert heard.wait_for_more(PERIODS).never_faster_than(RATED[topic])
