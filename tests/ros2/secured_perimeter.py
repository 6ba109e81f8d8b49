"""Who is kept out of a secured robot's ROS 2, and what who is let in may not: `make secured`.

That somebody hears nothing is told from others beside him, who hear what they should.

Known to hold with Fast DDS 2.14.5: an unsecured peer and one of another authority neither hear nor
are heard; a listener cannot make a publisher of `cmd_vel`; an agent does not start with a
certificate that has ended, or in an enclave that is missing or has another role. Fast DDS starts an
enclave of another domain, but its peers reject it, as they reject a revoked one.
`secured_contract.py` holds the whole contract between enclaves. Not run: the official image, other
middlewares and the `ros2` command.
"""

import os
import sys
from datetime import timedelta
from functools import partial
from pathlib import Path

import pytest
from agent_process import READY
from geometry_msgs.msg import Twist
from guards import HUNG_S
from peer import STATE
from recordings import until_recorded
from rosbags.highlevel import AnyReader
from secured_rig import (
    AGENT,
    ROBOT,
    add_at,
    new_keystore,
    open_peer,
    secured_peer,
    secured_process,
)
from std_msgs.msg import String
from std_srvs.srv import Trigger
from waiting import Heard, wait_until

from edgevox.apps.security_command import main
from edgevox.core.certificates import utc_now
from edgevox.core.errors import InvalidValue
from edgevox.security.startup import secured

ASKED = "where are you"
ROUNDS = 3
RECORDER = str(Path(sys.executable).with_name("edgevox-recorder"))


@pytest.fixture(scope="module")
def keystore(domain, tmp_path_factory):
    return new_keystore(tmp_path_factory.mktemp("secured") / "keystore", domain)


@pytest.fixture(scope="module")
def agent(domain, keystore):
    one = secured_process(domain, keystore, AGENT, *ROBOT)
    one.wait_for_line(READY)
    yield one
    one.terminate()


@pytest.fixture(scope="module")
def tools(domain, keystore, agent):
    one = secured_peer(domain, keystore, "/tools")
    yield one
    one.close()


@pytest.fixture
def closing():
    peers = []
    yield peers
    for one in peers:
        one.close()


def keeps_out(tools, stranger, friend):
    """The two find and hear each other, and so would the agent; it answers its tools only."""
    answers, asked = tools.listen("response"), tools.listen("transcription")
    heard = [stranger.node.create_subscription(String, stranger.name(topic), fails, 10)
             for topic in ("response", "transcription", "bot_sentence")]  # fmt: skip
    velocities, words = Heard(), Heard()
    friend.node.create_subscription(Twist, friend.name("cmd_vel"), velocities.add, 10)
    friend.node.create_subscription(String, friend.name("text_input"), words.add, 10)
    steering = stranger.node.create_publisher(Twist, stranger.name("cmd_vel"), 10)
    wait_until(steering.get_subscription_count, "the friend")
    for so_many in range(1, ROUNDS + 1):
        steering.publish(Twist())
        stranger.send("text_input", "go to the kitchen")
        tools.send("text_input", ASKED)
        for one in (velocities, words, answers):
            one.wait_until(partial(has, one, so_many))
    assert set(asked.messages) == {ASKED}
    assert steering.get_subscription_count() == 1
    assert not any(one.get_publisher_count() for one in heard)
    names = stranger.node.get_node_names
    wait_until(lambda: friend.node.get_name() in names(), "the friend's name")
    assert "edgevox" not in names()
    assert "stranger" not in tools.node.get_node_names()


def has(heard, so_many):
    return len(heard.messages) >= so_many


def fails(message):
    pytest.fail(f"heard {message.data!r}")


def test_an_unsecured_peer_hears_nothing_and_is_not_heard(domain, tools, closing):
    closing += [stranger := open_peer(domain, "stranger"), friend := open_peer(domain, "friend")]
    keeps_out(tools, stranger, friend)


def test_one_of_another_authority_hears_nothing_and_is_not_heard(domain, tools, closing, tmp_path):
    other = new_keystore(tmp_path / "other", domain)
    closing += [
        stranger := secured_peer(domain, other, "/stranger"),
        friend := secured_peer(domain, other, "/friend"),
    ]
    keeps_out(tools, stranger, friend)


def test_a_listener_hears_and_cannot_command(domain, keystore, tools, closing):
    closing.append(listener := secured_peer(domain, keystore, "/listener"))
    assert listener.listen("state", STATE).wait_for(lambda _: True)
    for kind, topic in ((Twist, "cmd_vel"), (String, "text_input"), (String, "response")):
        with pytest.raises(RuntimeError, match="could not create data writer"):
            listener.node.create_publisher(kind, listener.name(topic), 10)
    for service in (listener.name("list_voices"), f"{AGENT}/set_parameters"):
        with pytest.raises(RuntimeError, match="failed to create client"):
            listener.node.create_client(Trigger, service)
    with pytest.raises(RuntimeError, match="Failed to create subscription"):
        listener.node.create_subscription(String, listener.name("audio_in"), fails, 10)


def test_no_tools_speak_for_the_robot(tools):
    with pytest.raises(RuntimeError, match="could not create data writer"):
        tools.node.create_publisher(String, tools.name("response"), 10)


def test_a_certificate_that_has_ended_lets_nobody_in(domain, keystore):
    add_at(keystore, "/late", domain, utc_now() - timedelta(days=400), days=30)
    with pytest.raises(RuntimeError):
        secured_peer(domain, keystore, "/late")


def test_an_enclave_is_for_one_domain(domain, keystore, tools, closing):
    """Its own side lets it start, as Fast DDS does; nobody there lets it in."""
    add_at(keystore, "/elsewhere", domain + 1, utc_now(), days=30)
    closing += [
        elsewhere := secured_peer(domain, keystore, "/elsewhere"),
        listener := secured_peer(domain, keystore, "/listener"),
    ]
    only_one_hears(tools, listener, elsewhere, subscribers=2)


def only_one_hears(tools, listener, other, *, subscribers):
    """What the tools say on a topic that so many are to hear."""
    heard = Heard()
    other.node.create_subscription(String, other.name("set_voice"), fails, 10)
    listener.node.create_subscription(String, listener.name("set_voice"), heard.add, 10)
    tools.send("set_voice", "nobody", subscribers=subscribers)
    heard.wait_for(lambda _: True)
    names = tools.node.get_node_names
    wait_until(lambda: listener.node.get_name() in names(), "the listener")
    assert other.node.get_name() not in names()


def test_an_agent_without_its_enclave_ends_and_says_why(domain, keystore):
    agent = secured_process(domain, keystore, "/nobody", *ROBOT)
    line = agent.wait_for_line("ROS 2 could not be started")
    assert "/nobody" in agent.output, line
    assert agent.process.wait(HUNG_S) != 0
    agent.terminate()


def test_an_agent_in_the_enclave_of_a_listener_ends(domain, keystore):
    agent = secured_process(domain, keystore, "/laptop", *ROBOT)
    agent.wait_for_line("ROS 2 could not be started")
    assert agent.process.wait(HUNG_S) != 0
    agent.terminate()


def test_what_was_changed_after_it_was_signed_starts_nothing(domain, keystore, tmp_path):
    assert main(["export", str(keystore), AGENT, str(tmp_path / "robot")]) == 0
    given = {**os.environ, "EDGEVOX_SECURITY_KEYSTORE": str(tmp_path / "robot")}
    given |= {"ROS_DOMAIN_ID": str(domain)}
    made = secured(given, "edgevox-agent", pytest.fail)
    assert made["ROS_SECURITY_ENCLAVE_OVERRIDE"] == AGENT
    for name in ("permissions.p7s", "governance.p7s"):
        file = tmp_path / f"robot/enclaves{AGENT}" / name
        signed = file.read_bytes()
        file.write_bytes(signed.replace(b"DENY", b"ALLOW").replace(b"ENCRYPT", b"NONE"))
        with pytest.raises(InvalidValue, match="the middleware does not take it"):
            secured(given, "edgevox-agent", pytest.fail)
        file.write_bytes(signed)
    assert secured(given, "edgevox-agent", pytest.fail) == made


def test_who_is_revoked_is_kept_out_by_whoever_has_the_new_list(domain, closing, tmp_path):
    store, laptop = new_keystore(tmp_path / "keystore", domain), tmp_path / "laptop"
    assert main(["export", str(store), "/laptop", str(laptop)]) == 0
    assert main(["revoke", str(store), "/laptop"]) == 0
    closing += [
        revoked := secured_peer(domain, laptop, "/laptop"),
        listener := secured_peer(domain, store, "/listener"),
        friend := secured_peer(domain, store, "/friend"),
    ]
    only_one_hears(friend, listener, revoked, subscribers=1)


def test_a_recorder_keeps_what_it_may_hear(domain, keystore, tools, tmp_path):
    recorder = secured_process(
        domain, keystore, "/edgevox/edgevox_recorder", "--output", str(tmp_path / "bags"),
        program=RECORDER,
    )  # fmt: skip
    recorder.wait_for_line("recording ")
    files = partial((tmp_path / "bags").rglob, "*.mcap.open")
    until_recorded(tools, files, ["response", "odom"])
    assert recorder.terminate() == 0
    (folder,) = (tmp_path / "bags").iterdir()
    with AnyReader([folder]) as bag:
        heard = {connection.topic for connection, _, _ in bag.messages()}
    assert {tools.name(one) for one in ("response", "odom", "text_input")} <= heard
