"""What an agent says of a recorder of its namespace, by what that says on /diagnostics."""

from types import SimpleNamespace

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.serialization import serialize_message
from support.clock import HeldClock

from edgevox.core.status import LATELY_S, Finding, Level, Status
from edgevox.ros2.bridge import MOST_SAID, HeardRecorder, as_message

OK, WARN, ERROR = Level.OK, Level.WARN, Level.ERROR
OF_US = "/robot1/edgevox_recorder"


def said(*findings, node=OF_US, name="recorder", **values):
    status = Status.judged(name, findings, well="records", **values)
    return serialize_message(DiagnosticArray(status=[as_message(node, status)]))


@pytest.fixture
def rig():
    node = SimpleNamespace(
        get_namespace=lambda: "/robot1", create_subscription=lambda *_, **__: None
    )
    clock = HeldClock(100.0)
    return SimpleNamespace(clock=clock, heard=HeardRecorder(node, clock))


@pytest.mark.parametrize(
    ("findings", "level", "records"),
    [
        ([], OK, True),
        ([Finding(WARN, "the upload fails")], WARN, True),
        ([Finding(ERROR, "the disk is full")], ERROR, False),
        ([Finding(WARN, "x" * 1000)], WARN, True),
    ],
)
def test_it_passes_on_what_the_recorder_says(rig, findings, level, records):
    rig.heard.hear(said(*findings, ended=False))
    told = rig.heard.status()
    text = findings[0].text if findings else "records"
    assert (told.level, told.message) == (level, text[:MOST_SAID])
    assert told.values == {"recording": records}


def test_what_others_say_is_not_the_recorders(rig):
    for other in ("/robot1/edgevox", "/robot2/edgevox_recorder", "/robot1/edgevox_recorder2"):
        rig.heard.hear(said(Finding(ERROR, "broken"), node=other))
    rig.heard.hear(said(Finding(ERROR, "broken"), name="recorder of others"))
    assert (rig.heard.status().level, rig.heard.status().message) == (OK, "off: none was heard")


def test_one_that_falls_silent_is_told_unless_it_said_that_it_ends(rig):
    rig.heard.hear(said(ended=False))
    rig.clock.advance(LATELY_S + 1)
    told = rig.heard.status()
    assert (told.level, told.message) == (WARN, "silent for 11 s: it was killed, or hangs")
    assert told.values == {"recording": False}
    rig.heard.hear(said(ended=True))
    rig.clock.advance(LATELY_S + 1)
    assert rig.heard.status().level is OK
    assert rig.heard.status().values == {"recording": False}
