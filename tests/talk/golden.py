"""All that robots say, written out: `python tests/talk/golden.py write` renews the files.

`golden/CODE.toml` has each sentence of one language with values in it, as people hear it: better
words are a diff there. Read what has changed, best with somebody whose language it is.
"""

import json
import sys
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))  # as pytest does

from support.bodies import SKILLS

from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import Skill, skill
from edgevox.agent.text.reasons import because
from edgevox.agent.text.words import bare, continued, fields
from edgevox.core.languages import CODES, language_file
from edgevox.core.reason import Reason
from edgevox.robots.navigation import LOCATION, navigation_skills
from edgevox.ros2.clients import interface_reason

FOLDER = Path(__file__).with_name("golden")
ARGUMENTS: Mapping[str, Any] = {
    "room": "kitchen",
    "x": 1.5,
    "y": 2.0,
    "z": 0.25,
    "distance": 0.5,
    "degrees": 90.0,
    "object": "red_cube",
    "target": "left_bin",
    "name": "wine_cellar",
}
RESULTS: Mapping[str, Any] = {
    "room": "living room",
    "x": 2.0,
    "y": -0.25,
    "z": 0.3,
    "yaw_deg": 90.0,
    "percent": 87,
    "walked": 1.02,
    "driven": 1.02,
    "turned": 89.6,
    "held": "red_cube",
    "released": "blue_cube",
    "name": "wine_cellar",
    "names": ["kitchen", "office"],
    "objects": {"red_cube": {"x": 0.5, "on": "table"}, "blue_cube": {"x": 0.5, "on": "hand"}},
    "count": 2,
}
ABOUT: Mapping[str, Any] = {
    **dict.fromkeys(("x", "y", "z", "x_min", "y_min"), "2"),
    **dict.fromkeys(("x_max", "y_max", "count", "limit", "most", "hours", "seconds"), "8"),
    **dict.fromkeys(("distance", "left"), "0.5"),
    "argument": "distance",
    "choices": ("kitchen", "office", "bedroom"),
    "degrees": "90",
    "driven": "1.2",
    "expected": "Twist or TwistStamped",
    "frame": "map",
    "how": because("nav2_gave_up"),
    "name": "wine_cellar",
    "nearest": "x 1, y 2",
    "part": "hand",
    "place": "kitchen",
    "point": "x 3, y 4",
    "said": "120",
    "skill": "navigate_to",
    "status": "failed",
    "thing": "red_cube",
    "topic": "/odom",
    "type": "String",
    "upper": "blue_cube",
    "value": "garage",
    "was": "odom",
    "why": because("too_far"),
    "word": "stop",
}
"""What reasons are about, by the names in their sentences."""

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
    "panda.get_pose": (({}, {**HAND, "empty": True}), ({}, {**HAND, "held": "red_cube"})),
    "panda.place": (
        ({"object": "it", "target": "left_bin"}, {**HAND, "object": "red_cube"}),
        ({"object": "red_cube", "target": "table"}, {**HAND, "object": "red_cube"}),
    ),
    "panda.release": (({}, {"released": "red_cube"}), ({}, {"released": None})),
    "panda.list_objects": (({}, {"objects": THINGS, "count": 3}),),
    "apartment.battery": (({}, {"percent": 87}), ({}, {"percent": 87, "lasts_s": 4500}), ({}, {})),
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


LASTS = {"takes", "left", "lasts", "took"}
FACT: Mapping[str, Any] = {
    **dict.fromkeys(LASTS, 75),
    **dict.fromkeys(
        ("distance", "farthest_m", "straight", "metres", "speed", "limit", "x", "y"), 2.25
    ),
    "count": 3,
    "day": 9,
    "done": "…",
    "farthest": "bedroom",
    "free": 10.0,
    "here": "office",
    "month": 5,
    "names": ["kitchen", "office"],
    "object": "red_cube",
    "objects": THINGS,
    "place": "left_bin",
    "room": "kitchen",
    "side": "to_my_left",
    "target": "right_bin",
    "time": "17:30",
    "weekday": 2,
    "what": "stapler",
    "year": 2026,
}
"""What facts are about; a value that is not here is a flag."""


class Depot:
    """A body whose places are locations."""

    places: Mapping[str, tuple[float, float]] = {"shelf_b": (1.0, 2.0)}


@skill(says="Dancing for {seconds:g} seconds.")
def dance(goal, seconds: float):
    """Dance."""


@skill(moves=False)
def fact(goal):
    """Tell something."""


DEPOT = navigation_skills(Depot(), word=LOCATION)
KNOWN: Mapping[str, Skill] = {**SKILLS, **{f"depot.{one.name}": one for one in DEPOT}}


def answers(code: str) -> dict[str, dict[str, Any]]:
    """What is said in a language, by the table of its file, and by name."""
    book, english = phrasebook(code), phrasebook(ENGLISH)
    return {
        "say": {
            name: book.say(name, **_values(book, doing=name == "doing"))
            for name in english.sentences
        },
        "reasons": {
            name: book.reason(because(name, **{one: ABOUT[one] for one in _about(name, sentence)}))
            for name, sentence in english.reasons.items()
        },
        "interfaces": {
            name: book.reason(interface_reason(name, what="~/gripper"))
            for name in language_file(ENGLISH)["interfaces"]
        },
        "examples": dict(_examples(book)),
        "facts": dict(_facts(book)),
        "skills": {name: _of_skill(book, name) for name in SKILLS},
    }


def _facts(book: Phrasebook) -> Iterator[tuple[str, str]]:
    """Each sentence that tells a fact, by the values that it needs."""
    for name, phrases in book.dialogue.items():
        for number, template in enumerate(phrases.done, 1):
            known = {one: FACT.get(one, True) for one in fields(template)}
            told = {f"{one}_s" if one in LASTS else one: value for one, value in known.items()}
            yield f"{name} {number}", book.report(replace(fact, name=name), {}, told)


def _examples(book: Phrasebook) -> Iterator[tuple[str, str]]:
    """What depends on results, on numbers, or is not of a robot of ours."""
    for name, ends in ENDS.items():
        for number, (arguments, result) in enumerate(ends, 1):
            yield f"{name} {number}", book.report(KNOWN[name], arguments, result)
    for distance in WALKED:
        walk = book.acknowledge(SKILLS["humanoid.walk_forward"], {"distance": distance})
        yield f"walk {distance:g} metres", walk
    cellar = {"room": "wine_cellar"}
    yield "to an unknown room", book.acknowledge(SKILLS["apartment.navigate_to"], cellar)
    yield "a stranger's, asked", book.question([(dance, {"seconds": 3.0})])
    yield "a stranger's", book.acknowledge(dance, {"seconds": 3.0})
    for name, why in FAILURES.items():
        yield f"failed: {name}", book.failure(why)


def _about(reason: str, sentence: str) -> set[str]:
    """What a reason is given: what people hear, and what programs read beside that."""
    return fields(sentence) | fields(language_file(ENGLISH)["errors"].get(reason, ""))


def _values(book: Phrasebook, *, doing: bool) -> dict[str, Any]:
    """What the agent's own sentences are filled with; what it is doing is a whole one."""
    go, back = SKILLS["apartment.navigate_to"], SKILLS["humanoid.walk_forward"]
    going, walking = (book.acknowledge(one, ARGUMENTS) for one in (go, back))
    can = [book.can(one) for one in (go, back)]
    return {
        "action": going if doing else can[0],
        "actions": book.both(can),
        "argument": book.kind("room"),
        "condition": "abc",
        "count": 5,
        "duration": book.say("minutes", count=5),
        "first": can[0],
        "known": book.listing(["kitchen", "office"]),
        "last": can[1],
        "length": 4096,
        "limit": 2000,
        "next": continued(walking),
        "order": continued(going),
        "orders": going,
        "percent": 20,
        "place": book.word("kitchen"),
        "question": book.sentences["abilities_question"],
        "result": "204",
        "reason": bare(book.reason(because("too_far"))),
        "said": "garage",
        "second": can[1],
        "thing": book.word("red_cube"),
        "told": walking,
        "topic": "/robot1/edgevox",
        "words": "hello",
    }


def _of_skill(book: Phrasebook, name: str) -> dict[str, str]:
    one = SKILLS[name]
    arguments = {field: ARGUMENTS[field] for field in one.arguments_model.model_fields}
    said = {
        "can": book.can(one),
        "begins": book.acknowledge(one, arguments),
        "done": book.report(one, arguments, RESULTS),
        "asks": book.question([(one, arguments)]) if one.drives or one.lasting else "",
    }
    return {when: text for when, text in said.items() if text}


def text(code: str) -> str:
    """The golden file of a language."""
    lines = []
    for table, entries in answers(code).items():
        lines += ["", f"[{table}]"] if table != "skills" else []
        for name, said in entries.items():
            if table == "skills":
                lines += ["", f"[skills.{name}]"]
                lines += [f"{when} = {_quoted(one)}" for when, one in said.items()]
            else:
                key = name if name.isidentifier() else _quoted(name)
                lines += [f"{key} = {_quoted(said)}"]
    return "\n".join([f"# What a robot says in {phrasebook(code).name}.", *lines]) + "\n"


def _quoted(said: str) -> str:
    return json.dumps(said, ensure_ascii=False)


if __name__ == "__main__":
    if sys.argv[1:] != ["write"]:
        sys.exit("usage: golden.py write")
    for each in CODES:
        (FOLDER / f"{each}.toml").write_text(text(each), encoding="utf-8")
