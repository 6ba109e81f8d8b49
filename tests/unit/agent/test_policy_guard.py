"""The guard holds the policy in force: read again when its file has changed, never half of one."""

import logging
import os
import threading

import pytest
from support.body import FakeBody
from support.clock import HeldClock

from edgevox.agent.policy import CheckedCall, Denied, Guard, NeedsConfirmation, PolicyContext
from edgevox.agent.policy.guard import NO_FILE, TELL_EVERY_S, PolicyComponent, asked_instead
from edgevox.apps.agent.policy import build_guard, known_names, policy_context
from edgevox.core.agent_events import GoalRejected, as_json
from edgevox.core.bus import Bus
from edgevox.core.commands import Way
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import check_settings
from edgevox.core.status import Level
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.flat.apartment import ApartmentRobot

DENY, ALLOW, CONFIRM = (f"rules: {{voice: {word}}}" for word in ("deny", "allow", "confirm"))
GO = [CheckedCall("navigate_to", {"room": "kitchen"})]


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "policy.yaml"
    path.write_text(DENY)
    return path


def code(guard, way=Way.VOICE, calls=GO):
    """What this is refused with; empty if it is done."""
    try:
        guard.permit(way, calls)
    except Denied as denied:
        return denied.reason.code
    return ""


def policy_status(guard):
    return PolicyComponent(guard, lambda: known_names(())).status()


def test_a_file_that_is_written_again_counts_for_what_is_asked_next(file):
    guard = Guard(file)
    assert code(guard) == "policy_denied"
    file.write_text(ALLOW)
    assert code(guard) == ""
    file.write_text(CONFIRM)
    assert code(guard) == "needs_confirmation"


def test_another_file_in_its_place_counts_also_with_the_size_and_time_of_the_one_before(file):
    guard = Guard(file)
    other = file.with_name("new.yaml")
    other.write_text("rules: {typed: deny}"[: len(DENY)])
    before = file.stat()
    os.utime(other, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert other.stat().st_size == before.st_size
    other.replace(file)
    assert code(guard) == ""


def test_a_folder_that_is_swapped_as_kubernetes_does_counts(tmp_path):
    for name, text in (("one", DENY), ("two", ALLOW)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "policy.yaml").write_text(text)
    data = tmp_path / "..data"
    data.symlink_to("one")
    (tmp_path / "policy.yaml").symlink_to("..data/policy.yaml")
    guard = Guard(tmp_path / "policy.yaml")
    assert code(guard) == "policy_denied"
    (tmp_path / "..tmp").symlink_to("two")
    (tmp_path / "..tmp").replace(data)
    assert code(guard) == ""


@pytest.mark.parametrize("broken", ["rules: {voice: maybe}", "rules: [", "", "\0", None])
def test_a_broken_file_leaves_the_old_policy_in_force_until_it_is_mended(file, broken):
    guard = Guard(file)
    if broken is None:
        file.unlink()
    else:
        file.write_text(broken)
    assert code(guard) == "policy_denied"
    status = policy_status(guard)
    assert (status.level, status.values["broken"]) == (Level.WARN, True)
    assert "the policy before it is in force" in status.message
    assert "policy" in guard.fault
    file.write_text(ALLOW)
    assert code(guard) == ""
    status = policy_status(guard)
    assert (status.level, status.values["broken"]) == (Level.OK, False)


def test_a_broken_file_is_said_in_the_log_once_for_each_time_it_changes(file, caplog):
    guard = Guard(file)
    with caplog.at_level(logging.INFO):
        for text in ("rules: [", "rules: {voice: maybe}"):
            file.write_text(text)
            for _ in range(3):
                code(guard)
        file.write_text(ALLOW)
        code(guard)
    assert caplog.text.count("policy_broken") == 2
    assert caplog.text.count("policy_changed") == 1


@pytest.mark.parametrize("broken", ["rules: {voice: maybe}", None])
def test_with_a_broken_file_nothing_starts(tmp_path, broken):
    path = tmp_path / "policy.yaml"
    if broken:
        path.write_text(broken)
    with pytest.raises(InvalidValue, match="policy"):
        build_guard(check_settings({"policy": str(path)}), Bus(), None)


def test_nobody_ever_sees_half_a_policy(file):
    """Both policies refuse a drive, for one reason each; a mixture would let one through."""
    one = "rules: {voice: deny, typed: allow}"
    two = "rules: {voice: allow, typed: deny}"
    file.write_text(one)
    guard = Guard(file)
    seen, done = [], threading.Event()

    def look():
        while not done.is_set():
            policy = guard.look()
            seen.append(tuple(policy.judge(way, "go", {}).rule for way in (Way.VOICE, Way.TYPED)))

    threads = [threading.Thread(target=look) for _ in range(3)]
    for thread in threads:
        thread.start()
    for number in range(40):
        other = file.with_name("new.yaml")
        other.write_text((one, two)[number % 2])
        other.replace(file)
        guard.look()
    done.set()
    for thread in threads:
        thread.join()
    assert set(seen) <= {("deny", "allow"), ("allow", "deny")}


def test_of_several_calls_a_denied_one_counts_before_one_that_needs_a_yes(file):
    file.write_text("rules: {voice: {grasp: confirm, place: deny}}")
    guard = Guard(file)
    with pytest.raises(NeedsConfirmation) as unsure:
        guard.check(Way.VOICE, [CheckedCall("look"), CheckedCall("grasp"), CheckedCall("look")])
    assert unsure.value.skill == "grasp"
    with pytest.raises(Denied) as denied:
        guard.check(Way.VOICE, [CheckedCall("grasp"), CheckedCall("place")])
    assert (denied.value.skill, denied.value.reason.code) == ("place", "policy_denied")
    guard.check(Way.VOICE, [CheckedCall("grasp")], confirmed=True)
    with pytest.raises(Denied):
        guard.check(Way.VOICE, [CheckedCall("place")], confirmed=True)


@pytest.mark.parametrize("way", Way)
def test_what_needs_a_yes_is_a_question_only_where_somebody_can_answer(file, way):
    file.write_text("rules: {'*': confirm}")
    asks = way in {
        Way.VOICE,
        Way.VOICE_GUEST,
        Way.TYPED,
        Way.TEXT_INPUT,
        Way.CONSOLE_VIEWER,
        Way.CONSOLE_OPERATOR,
    }
    assert way.attended is asks
    assert code(Guard(file), way) == ("needs_confirmation" if asks else "needs_a_person")


def test_a_call_that_needs_a_yes_is_a_refusal_where_its_caller_cannot_ask(file):
    bus, told = Bus(), []
    bus.subscribe(GoalRejected, lambda event: told.append(event.reason.code))
    file.write_text(CONFIRM)
    guard = Guard(file, bus)
    assert code(guard) == "needs_confirmation"
    assert guard.refusals == {("voice", "needs_confirmation"): 1}
    assert told == ["needs_confirmation"]


def test_a_refusal_is_counted_by_way_and_code_and_told_as_a_rejected_goal(file):
    bus, told = Bus(), []
    bus.subscribe(GoalRejected, lambda event: told.append(as_json(event)))
    guard = Guard(file, bus)
    for way in (Way.VOICE, Way.VOICE, Way.GOAL_POSE):
        code(guard, way)
    file.write_text("rules: {goal_pose: confirm}")
    code(guard, Way.GOAL_POSE)
    assert guard.refusals == {
        ("voice", "policy_denied"): 2,
        ("goal_pose", "needs_a_person"): 1,
    }
    assert told[0] == {
        "kind": "skill_goal",
        "goal_id": None,
        "skill": "navigate_to",
        "arguments_json": """'{"room": "kitchen"}'""",
        "status": "rejected",
        "error": "I am not permitted to do that.",
        "code": "policy_denied",
        "values": {"way": "voice", "skill": "navigate_to"},
        "way": "voice",
        "turn": 0,
    }
    assert told[2]["way"] == "goal_pose"
    assert len(told) == 3
    status = policy_status(guard)
    assert (status.level, status.values["refused"]) == (Level.OK, 3)
    assert status.values["last_refused"] == "goal_pose navigate_to: needs_a_person"


@pytest.mark.parametrize("word", ["deny", "confirm"])
def test_a_velocity_is_refused_as_often_as_it_comes_and_told_once_a_second(file, word):
    file.write_text(f"rules: {{cmd_vel: {word}}}")
    bus, told, clock = Bus(), [], HeldClock()
    bus.subscribe(GoalRejected, lambda event: told.append(event.reason.code))
    guard = Guard(file, bus, clock=clock)
    for _ in range(50):
        clock.now_s += 0.05
        with pytest.raises(Denied):
            guard.velocity(0.2, 0.0)
    wanted = {"deny": "policy_denied", "confirm": "needs_a_person"}[word]
    assert guard.refusals == {("cmd_vel", wanted): 50}
    assert told == [wanted] * int(2.5 / TELL_EVERY_S + 1)
    assert guard.velocity(0.0, 0.0) == (0.0, 0.0), "a stand is never refused"


def test_a_velocity_that_is_too_fast_is_slowed_and_counted(file):
    file.write_text("limits: {speed: {linear_m_s: 0.3}}")
    guard = Guard(file)
    assert guard.velocity(0.3, 1.0) == (0.3, 1.0)
    assert guard.velocity(-0.6, 1.0) == (-0.3, 0.5)
    assert (guard.slowed, guard.refusals) == (1, {})


def test_names_that_the_robot_does_not_know_are_a_warning(file):
    file.write_text("rules: {voice: {grap: deny, mute: deny}}\nlimits: {places: {never: [cellar]}}")
    around = PolicyContext(lambda: {"kitchen": (0.0, 0.0)})
    status = policy_status(Guard(file, around=around))
    assert status.level is Level.WARN
    assert status.message == (
        "names that this robot does not know: grap: no such skill; did you mean grasp?, "
        "cellar: no such place"
    )


def test_a_countdown_of_what_cannot_be_undone_is_named(file):
    file.write_text("rules: {voice: {grasp: countdown, navigate_to: countdown, '*': countdown}}")
    skills = FakeBody().skills("grasp", "navigate_to", "dance", "get_pose")
    assert asked_instead(Guard(file).policy.file, skills.values()) == [
        "grasp: cannot be undone, so that `countdown` asks for a yes"
    ]


def test_without_a_file_everything_is_permitted_and_the_status_says_so():
    guard = Guard()
    assert {code(guard, way) for way in Way} == {""}
    assert guard.velocity(9.0, 9.0) == (9.0, 9.0)
    status = policy_status(guard)
    assert (status.level, status.message) == (Level.OK, NO_FILE)


def test_a_robot_that_drives_by_itself_is_told_the_speed_that_is_permitted_now(file, monkeypatch):
    told = []
    monkeypatch.setattr(ApartmentRobot, "limit_speed", lambda _, limit: told.append(limit))
    guard = build_guard(check_settings({"policy": str(file)}), Bus(), ApartmentRobot(speed=0.0))
    assert told[0](Twist2D(0.8, 0.4)) == Twist2D(0.8, 0.4)
    file.write_text("limits: {speed: {linear_m_s: 0.4}}")
    guard.look()
    assert told[0](Twist2D(0.8, 0.4)) == Twist2D(0.4, 0.2)


def test_what_is_around_a_robot_is_its_places_and_where_it_is():
    robot = ApartmentRobot(speed=0.0)
    around = policy_context(robot)
    x_m, y_m = around.places()["kitchen"]
    assert around.place_at(x_m, y_m) == "kitchen"
    assert around.here() == robot.pose()
    assert policy_context(None).here() is None


@pytest.mark.parametrize(
    ("rules", "way", "expected"),
    [
        (ALLOW, Way.VOICE, NeedsConfirmation),
        ("rules: {'*': deny}", Way.VOICE, Denied),
        (ALLOW, Way.ACTION, Denied),
    ],
)
def test_a_skill_that_wants_a_yes_gets_one_whatever_the_policy_allows(file, rules, way, expected):
    file.write_text(rules)
    guard = Guard(file, Bus())
    asked = [CheckedCall("open_tray", confirm=True)]
    with pytest.raises(expected) as caught:
        guard.check(way, asked)
    assert type(caught.value) is expected
    if expected is NeedsConfirmation:
        guard.check(way, asked, confirmed=True)


def test_a_goal_is_judged_again_as_it_begins_and_when_another_policy_comes(file):
    file.write_text(ALLOW)
    bus, told = Bus(), []
    bus.subscribe(GoalRejected, told.append)
    guard = Guard(file, bus)
    leave = guard.leave(Way.VOICE, GO[0])
    leave.begin()
    leave.go_on()
    file.write_text(DENY)
    with pytest.raises(Denied):
        leave.go_on()
    with pytest.raises(Denied):
        guard.leave(Way.VOICE, GO[0], confirmed=True).begin()
    assert guard.refusals == {("voice", "policy_denied"): 2}
    assert told == []  # the goal tells of it as it ends


def test_a_goal_that_was_confirmed_begins_where_another_needs_a_yes(file):
    file.write_text(CONFIRM)
    guard = Guard(file)
    guard.leave(Way.VOICE, GO[0], confirmed=True).begin()
    with pytest.raises(NeedsConfirmation):
        guard.leave(Way.VOICE, GO[0]).begin()
