"""Looks on the live graph for each interface that a robot file names; for the doctor's process.

What is found of one is told as plain values: as which types it is there, with which quality of
service, and what else is there that it may have been meant to be.
"""

import contextlib
import difflib
import json
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from rclpy.expand_topic_name import expand_topic_name
from rclpy.qos import QoSProfile

from edgevox.core.cancel import CancelToken
from edgevox.core.clock import SystemClock
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import Settings, check_settings
from edgevox.ros2.node import RosNode
from edgevox.ros2.qos import interface_profile, profile
from edgevox.ros2.robot_file.described_skills import SkillOff, planned_skills
from edgevox.ros2.robot_file.graph_view import (
    Offers,
    as_on_the_graph,
    look_at,
    unheard,
)
from edgevox.ros2.robot_file.load import DescribedRobot, load_robot_file
from edgevox.ros2.robot_file.waiting import TookTooLong, wait_until
from edgevox.ros2.robot_file.wanted import Wanted, wanted_by
from edgevox.ros2.standard_topics import DRIVEN

LOOK_S = 5.0
"""So long all of it may take to be discovered."""
NODE_NAME = "edgevox_doctor"
MOST_NEAR = 3
_ALIKE = 0.6


def look_for_robot(settings_json: str) -> dict[str, Any]:
    """What is there of the robot whose file these settings name.

    `wrong` is why the file cannot be used; `off` are skills whose types are not sourced; `others`
    is how many nodes there are; `found` has one entry for each interface; `elsewhere` is the
    namespace that most of them are in, and how many.
    """
    settings = check_settings(json.loads(settings_json))
    facts: dict[str, Any] = {"wrong": "", "off": [], "others": 0, "found": []}
    try:
        described = load_robot_file(Path(str(settings.robot_file)))
        planned = list(planned_skills(described.robot, described.file))
    except InvalidValue as error:
        return facts | {"wrong": str(error)}
    facts["off"] = [[one.name, one.reason] for one in planned if isinstance(one, SkillOff)]
    return facts | _on_the_graph(described, settings)


def _on_the_graph(described: DescribedRobot, settings: Settings) -> dict[str, Any]:
    namespace = described.namespace(settings)
    ros = RosNode("/", name=NODE_NAME)
    ros.start()
    try:
        wanted = [
            (one, expand_topic_name(one.name, NODE_NAME, namespace))
            for one in wanted_by(described.robot)
        ]
        offers = _until_all_are_there(ros, wanted)
        others = len(ros.node.get_node_names()) - 1
    finally:
        ros.close()
    found = [_told(one, name, offers) for one, name in wanted]
    return {"others": others, "found": found, "elsewhere": _elsewhere(wanted, offers)}


def _until_all_are_there(ros: RosNode, wanted: Sequence[tuple[Wanted, str]]) -> Offers:
    seen: list[Offers] = []

    def complete() -> bool:
        seen.append(look_at(ros.node))
        return all(seen[-1][one.role].get(name) for one, name in wanted)

    # What does not come is what is asked for.
    with contextlib.suppress(TookTooLong):
        wait_until(complete, CancelToken(), LOOK_S, SystemClock())
    return seen[-1]


def _told(wanted: Wanted, name: str, offers: Offers) -> dict[str, Any]:
    ends = offers[wanted.role].get(name, [])
    types = sorted({one.type for one in ends})
    right = [one.profile for one in ends if one.type == wanted.type and one.profile]
    unfit = _unfit(wanted, right, latched=wanted.latched)
    return {
        "whose": wanted.whose,
        "role": wanted.role,
        "name": name,
        "type": wanted.type,
        "types": types,
        "unfit": unfit,
        "latched": not wanted.latched
        if unfit and not _unfit(wanted, right, latched=not wanted.latched)
        else None,
        "instead": [role for role in offers if role != wanted.role and offers[role].get(name)],
        "near": [] if types else [list(one) for one in _near(wanted, name, offers)],
    }


def _unfit(wanted: Wanted, theirs: Sequence[QoSProfile], *, latched: bool) -> str:
    """Why none of them and EdgeVox would hear each other; empty if one would."""
    heard = wanted.role == "publisher"
    contract = profile(DRIVEN[wanted.contract].qos) if wanted.contract else None
    ours = as_on_the_graph(contract or interface_profile(latched=latched, heard=heard))
    reasons = [unheard(one, ours) if heard else unheard(ours, one) for one in theirs]
    return reasons[0] if reasons and all(reasons) else ""


def _elsewhere(wanted: Sequence[tuple[Wanted, str]], offers: Offers) -> list[Any]:
    """The namespace in which most of what is relative is there, and how much of it; or nothing."""
    found = Counter(
        name.removesuffix(f"/{one.name}")
        for one, _ in wanted
        for name in offers[one.role]
        if name.endswith(f"/{one.name}")
    )
    return [[namespace or "/", count] for namespace, count in found.most_common(1)]


def _near(wanted: Wanted, name: str, offers: Offers) -> Iterator[tuple[str, str]]:
    """What is there in this role and is called much like it, or has its type; with their types."""
    known = {
        other: sorted({end.type for end in ends}) for other, ends in offers[wanted.role].items()
    }
    alike = sorted(known, key=lambda other: -_likeness(name, other))
    alike = [other for other in alike if _likeness(name, other) >= _ALIKE]
    same_type = [other for other in sorted(known) if wanted.type in known[other]]
    for other in list(dict.fromkeys([*alike, *same_type]))[:MOST_NEAR]:
        yield other, ", ".join(known[other])


def _likeness(name: str, other: str) -> float:
    """Of the whole names, or of their last parts, where a namespace is another one."""
    pairs = ((name, other), (name.rpartition("/")[2], other.rpartition("/")[2]))
    return max(difflib.SequenceMatcher(None, *pair).ratio() for pair in pairs)
