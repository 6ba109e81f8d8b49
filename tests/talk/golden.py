"""What robots say, word for word: a file a language, for whoever makes the words better.

`python tests/talk/golden.py write` renews `golden/*.yaml` after a change of a language's file.
Read what has changed there, best with somebody whose language it is, and commit it.
"""

import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

sys.path.insert(0, str(Path(__file__).parents[1]))  # as pytest does

from support.bodies import SKILLS

from edgevox.agent.phrase_file import phrasebook
from edgevox.agent.phrasebook import Phrasebook
from edgevox.agent.reasons import because
from edgevox.agent.skills import Skill, skill
from edgevox.core.languages import LANGUAGES
from edgevox.core.reason import Reason
from edgevox.robots.navigation import LOCATION, navigation_skills

FOLDER = Path(__file__).with_name("golden")
ARGUMENTS = {"room": "living_room", "x": 1.5, "y": 2.0, "z": 0.25, "distance": 0.5, "degrees": 90.0}
ARGUMENTS |= {"object": "red_cube", "target": "left_bin", "name": "wine_cellar"}
POINT = {"x": 1.0, "y": -0.25, "yaw_deg": 90.0}
HAND = {"x": 0.5, "y": 0.0, "z": 0.251, "held": None}
THINGS = {
    "red_cube": {"on": "table"},
    "green_cube": {"on": "right_bin"},
    "blue_cube": {"on": "hand"},
}
ENDS: Mapping[str, tuple[tuple[Mapping[str, Any], Mapping[str, Any]], ...]] = {
    "apartment.navigate_to": (({"room": "living_room"}, {}), ({"room": "wine_cellar"}, {})),
    "depot.navigate_to": (({"location": "shelf_b"}, {}),),
    "apartment.navigate_xy": (({}, POINT),),
    "apartment.get_pose": (({}, {**POINT, "room": "living room"}), ({}, {**POINT, "room": None})),
    "depot.get_pose": (({}, {**POINT, "location": "shelf b"}), ({}, {**POINT, "location": None})),
    "humanoid.get_pose": (
        ({}, {**POINT, "fallen": False, "upright": True}),
        ({}, {**POINT, "fallen": True, "upright": False}),
    ),
    "humanoid.stand": (({}, {"got_up": False}), ({}, {"got_up": True})),
    "humanoid.walk_forward": (({}, {"walked": 1.02}),),
    "humanoid.turn_left": (({}, {"turned": 89.6}),),
    "panda.get_pose": (({}, HAND), ({}, {**HAND, "held": "red_cube"})),
    "panda.place": (
        ({"object": "it", "target": "left_bin"}, {**HAND, "object": "red_cube"}),
        ({"object": "red_cube", "target": "table"}, {**HAND, "object": "red_cube"}),
    ),
    "panda.release": (({}, {"released": "red_cube"}), ({}, {"released": None})),
    "panda.list_objects": (({}, {"objects": THINGS}),),
    "apartment.battery": (({}, {"percent": 87}),),
    "apartment.list_places": (
        ({}, {"names": ["kitchen", "living_room", "charger"]}),
        ({}, {"names": []}),
    ),
    "apartment.forget_place": (({"room": "charger"}, {}),),
}
"""What robots say at the end of a skill, for arguments and results."""
WALKED = (0.5, 1.0, 2.5)
FAILURES = {
    "no_way": because("no_way"),
    "outside": because("outside", place="flat", x_min="0", x_max="9.5", y_min="0", y_max="10"),
    "hand_full": because("hand_full", thing="red cube"),
    "a stranger's": Reason("The moon is in the way."),
}


class Depot:
    """A body whose places are locations."""

    places: Mapping[str, tuple[float, float]] = {"shelf_b": (1.0, 2.0)}


@skill(says="Dancing for {seconds:g} seconds.")
def dance(goal, seconds: float):
    """Dance."""


DEPOT = navigation_skills(Depot(), word=LOCATION)
KNOWN: Mapping[str, Skill] = {**SKILLS, **{f"depot.{one.name}": one for one in DEPOT}}


def spoken(code: str) -> dict[str, str]:
    """What is said in a language, each sentence by what it is about."""
    return dict(_sentences(phrasebook(code)))


def recorded(code: str) -> dict[str, str]:
    """The same as it was last read by a person."""
    return yaml.safe_load((FOLDER / f"{code}.yaml").read_text("utf-8"))


def _sentences(book: Phrasebook) -> Iterator[tuple[str, str]]:
    for name, one in SKILLS.items():
        arguments = {a: ARGUMENTS[a] for a in one.arguments_model.model_fields}
        if one.drives:
            yield f"{name} asked", book.question([(one, arguments)])
        if begun := book.acknowledge(one, arguments):
            yield f"{name} begun", begun
    for name, ends in ENDS.items():
        for number, (arguments, result) in enumerate(ends, 1):
            yield f"{name} done {number}", book.report(KNOWN[name], arguments, result)
    for distance in WALKED:
        begun = book.acknowledge(SKILLS["humanoid.walk_forward"], {"distance": distance})
        yield f"humanoid.walk_forward {distance:g} begun", begun
    cellar = {"room": "wine_cellar"}
    yield "an unknown room begun", book.acknowledge(SKILLS["apartment.navigate_to"], cellar)
    yield "a stranger's asked", book.question([(dance, {"seconds": 3.0})])
    yield "a stranger's begun", book.acknowledge(dance, {"seconds": 3.0})
    for name, why in FAILURES.items():
        yield f"failed {name}", book.failure(why)


def write() -> None:
    """Record what all languages say now."""
    FOLDER.mkdir(exist_ok=True)
    for code in LANGUAGES:
        lines = yaml.safe_dump(spoken(code), allow_unicode=True, width=1000, sort_keys=False)
        (FOLDER / f"{code}.yaml").write_text(lines, "utf-8")


if __name__ == "__main__":
    if sys.argv[1:] != ["write"]:
        sys.exit("usage: python tests/talk/golden.py write")
    write()
