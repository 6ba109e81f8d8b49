"""Everything that the contract promises, between an agent and tools in enclaves: `make secured`.

The tests are those of the open contract; only who is alive is another.
"""

import json

import pytest
from action_rig import Client
from agent_process import READY
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParametersAtomically
from secured_rig import AGENT, ROBOT, new_keystore, secured_peer, secured_process
from std_srvs.srv import Trigger
from test_conformance import *  # noqa: F403
from test_conformance import CONTRACT
from waiting import wait_until


@pytest.fixture(scope="module")
def live(domain, tmp_path_factory):
    """An operator's tools beside an agent; both in enclaves of one keystore."""
    keystore = new_keystore(tmp_path_factory.mktemp("secured") / "keystore", domain)
    agent = secured_process(domain, keystore, AGENT, *ROBOT)
    agent.wait_for_line(READY)
    peer = secured_peer(domain, keystore, "/tools")
    name = (CONTRACT["node"], CONTRACT["default_namespace"])
    wait_until(lambda: name in peer.node.get_node_names_and_namespaces(), "the node's name")
    yield peer
    peer.close()
    agent.terminate()


@pytest.mark.parametrize("query", CONTRACT["queries"])
def test_a_service_answers(live, query):
    answer = live.call(Trigger, live.name(query), Trigger.Request())
    assert set(json.loads(answer.message)) == {"query", *CONTRACT["queries"][query]}


def test_a_parameter_is_set_and_is_what_it_was_set_to(live):
    value = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value="always")
    request = SetParametersAtomically.Request(parameters=[Parameter(name="confirm", value=value)])
    answer = live.call(SetParametersAtomically, f"{AGENT}/set_parameters_atomically", request)
    assert answer.result.successful, answer.result.reason
    request = GetParameters.Request(names=["confirm"])
    assert live.call(GetParameters, f"{AGENT}/get_parameters", request).values == [value]


def test_a_goal_is_done(live):
    client = Client(live)
    end, result = client.end_of(client.send("get_pose"))
    assert (end, result.ok) == ("succeeded", True)
    assert client.feedback


def test_a_goal_that_moves_is_cancelled(live):
    client = Client(live)
    goal = client.send("navigate_to", room="kitchen")
    assert client.cancel(goal) == 1
    assert client.end_of(goal)[0] == "canceled"
