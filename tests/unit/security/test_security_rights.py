"""Who may what on the wire follows from the contract, and from nothing else."""

from pathlib import Path

import pytest
import yaml

from edgevox.security.documents import Rights, is_node
from edgevox.security.roles import EnclaveRole, Graph, rights_of

ROOT = Path(__file__).parents[3]
CONTRACT = yaml.safe_load((ROOT / "tests/ros2/contract.yaml").read_text("utf-8"))
GRAPH = Graph("/robot1", "robot-apartment")
SPOKEN = {*CONTRACT["published"], "presence"}
UNDERSTOOD = {*CONTRACT["subscribed"], *CONTRACT["shared"]}
INTO = {"cmd_vel", "goal_pose"}
AUDIO = {"audio_in", "audio_out"}
ACTION = "/robot1/execute_skill/_action"


def of(role: EnclaveRole, graph: Graph = GRAPH, enclave: str = "/robot1/laptop") -> Rights:
    return rights_of(role, graph, enclave)


def own_topics(names: frozenset[str]) -> set[str]:
    """The topics of the robot's namespace, without it, but for those of its action."""
    inside = (name for name in names if name.startswith("rt/robot1/") and "_action" not in name)
    return {name.removeprefix("rt/robot1/") for name in inside}


def test_a_robot_says_what_the_contract_has_it_say_and_no_more() -> None:
    standard = {"pose", "odom", "scan", "image_raw", "camera_info", "picture"}
    assert own_topics(of(EnclaveRole.ROBOT).publish) == SPOKEN | standard | {"audio_out"}


def test_robots_of_a_group_hear_each_other_and_nobody_else_speaks_as_one() -> None:
    (topic,) = CONTRACT["group"]
    rights = {role: of(role) for role in EnclaveRole}
    assert all(f"rt{topic}" in one.subscribe for one in rights.values())
    speaking = [role for role, one in rights.items() if f"rt{topic}" in one.publish]
    assert speaking == [EnclaveRole.ROBOT]


def test_a_robot_hears_what_the_contract_has_it_hear_and_no_more() -> None:
    assert own_topics(of(EnclaveRole.ROBOT).subscribe) == UNDERSTOOD | INTO | {"audio_in"}


def test_a_robot_answers_its_services_and_does_its_action_but_calls_nobody() -> None:
    robot = of(EnclaveRole.ROBOT)
    for query in CONTRACT["queries"]:
        assert f"rq/robot1/{query}Request" in robot.subscribe
        assert f"rr/robot1/{query}Reply" in robot.publish
    for service in ("send_goal", "cancel_goal", "get_result"):
        assert f"rq{ACTION}/{service}Request" in robot.subscribe
        assert f"rr{ACTION}/{service}Reply" in robot.publish
    assert {f"rt{ACTION}/feedback", f"rt{ACTION}/status"} <= robot.publish
    assert not any(name.startswith("rq/") for name in robot.publish)


def test_a_recorder_hears_all_of_it_and_says_only_how_it_is() -> None:
    robot, recorder = of(EnclaveRole.ROBOT), of(EnclaveRole.RECORDER)
    topics = {one for one in robot.publish | robot.subscribe if one.startswith("rt/")}
    assert topics <= recorder.subscribe
    own = is_node("/robot1/edgevox_recorder").publish
    assert recorder.publish == own | {"rt/diagnostics"}


def test_a_listener_hears_no_sound_and_says_only_what_nodes_must() -> None:
    listener = of(EnclaveRole.LISTENER)
    assert own_topics(listener.subscribe) >= SPOKEN | UNDERSTOOD | INTO
    assert not own_topics(listener.subscribe) & AUDIO
    own = is_node("/robot1/laptop").publish | is_node("/_ros2cli_*").publish
    assert listener.publish == own


def test_tools_may_command_whatever_a_robot_understands() -> None:
    tools = of(EnclaveRole.TOOLS)
    assert own_topics(tools.publish) == (UNDERSTOOD - {"presence"}) | INTO | {"audio_in"}
    assert f"rq{ACTION}/send_goalRequest" in tools.publish
    assert "rq/robot1/edgevox/set_parametersRequest" in tools.publish
    assert not any(name.startswith("rr/robot1/edgevox/") for name in tools.publish)


@pytest.mark.parametrize("role", EnclaveRole)
def test_nobody_may_a_thing_of_another_robots_namespace(role: EnclaveRole) -> None:
    rights = of(role)
    assert not [one for one in rights.publish | rights.subscribe if "/edgevox/list_voices" in one]
    names = {one[2:] for one in rights.publish | rights.subscribe if one[2] == "/"}
    wide = (
        "/_ros2cli_*/",
        "/tf",
        "/clock",
        "/rosout",
        "/diagnostics",
        "/parameter_events",
        "/hearers",
    )
    assert all(name.startswith(("/robot1/", *wide)) for name in names)
    assert not any("*" in name.removeprefix("/_ros2cli_*") for name in names)


def test_only_the_agent_drives_a_robot_of_its_own() -> None:
    graph = Graph("/edgevox", "robot-external", "/robot1")
    agent, tools = of(EnclaveRole.ROBOT, graph), of(EnclaveRole.TOOLS, graph)
    external = CONTRACT["external_robot"]
    for topic, row in external.items():
        may = agent.publish if row["dir"] == "out" else agent.subscribe
        assert f"rt/robot1/{topic}" in may
    assert "rq/robot1/navigate_to_pose/_action/cancel_goalRequest" in agent.publish
    assert "rt/robot1/cmd_vel" not in tools.publish
    assert "rt/edgevox/cmd_vel" not in tools.publish
    assert "rt/edgevox/odom" not in agent.publish


def test_the_interfaces_of_a_robot_file_are_the_agents(tmp_path: Path) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text(
        "namespace: /cleaner\n"
        "topics: {odom: wheel/odometry}\n"
        "skills:\n"
        "  beep:\n"
        "    description: makes a sound\n"
        "    call: {name: beep, type: std_srvs/srv/Trigger}\n",
        "utf-8",
    )
    agent = of(EnclaveRole.ROBOT, Graph("/edgevox", "robot-external", robot_file=file))
    assert "rq/cleaner/beepRequest" in agent.publish
    assert "rt/cleaner/wheel/odometry" in agent.subscribe
