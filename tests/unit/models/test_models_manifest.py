from importlib.resources import files

import pytest
from models_wheelhouse import CHAT, CHAT_WHEELS, entry, manifest, model, voice

from edgevox.apps.agent.models import LARGER, SMALLER
from edgevox.core.languages import LANGUAGES
from edgevox.models.manifest import (
    GitSource,
    HubSource,
    ModelFile,
    NpmSource,
    WheelSource,
    builtin_manifest,
    parse_manifest,
)

HUB = {"kind": "hub", "repo": "us/chat"}
KINDS = [HubSource, WheelSource, NpmSource, GitSource]
WITHOUT_HUB = ("small", "quality", "smoke", "world", "robots")
MODELS = list(builtin_manifest().models.values())


@pytest.mark.parametrize("one", MODELS, ids=lambda model: model.id)
def test_every_licence_comes_with_its_text(one) -> None:
    for licence in one.licences:
        text = files("edgevox.models").joinpath("licences", f"{licence}.txt")
        assert len(text.read_text()) > 200


@pytest.mark.parametrize("one", MODELS, ids=lambda model: model.id)
def test_the_publisher_is_asked_first_and_git_last(one) -> None:
    kinds = [KINDS.index(type(source)) for source in one.sources]

    assert kinds == sorted(kinds)


@pytest.mark.parametrize("one", builtin_manifest().select(WITHOUT_HUB), ids=lambda model: model.id)
def test_every_model_but_the_standard_set_can_be_had_from_a_package(one) -> None:
    assert {WheelSource, NpmSource} & {type(source) for source in one.sources}


@pytest.mark.parametrize("one", MODELS, ids=lambda model: model.id)
def test_nothing_is_fetched_from_a_repository_that_is_not_encrypted(one) -> None:
    assert all(s.url.startswith("https://") for s in one.sources if isinstance(s, GitSource))


def test_every_model_is_in_a_set() -> None:
    chosen = builtin_manifest()

    assert {model.id for model in chosen.select(chosen.sets)} == set(chosen.models)


def test_the_robots_set_is_all_robots() -> None:
    chosen = builtin_manifest()
    robots = [name for name in chosen.sets if name.startswith("robot-")]

    assert set(chosen.select(robots)) == set(chosen.select(["robots"]))


def test_a_robot_comes_with_a_description_and_meshes_below_it() -> None:
    for robot in builtin_manifest().select(["franka-panda", "unitree-g1", "unitree-h1"]):
        assert robot.entry.endswith(".xml")
        assert any(file.name.startswith("assets/") for file in robot.files)


def test_the_models_of_a_language_are_in_the_manifest() -> None:
    hear = {language.stt_model for language in LANGUAGES.values()}
    speak = {
        m for language in LANGUAGES.values() for voice in language.voices for m in voice.models
    }

    assert hear | speak <= set(builtin_manifest().models)


def test_what_may_not_be_used_commercially_is_known() -> None:
    chosen = builtin_manifest()

    restricted = {m.id for m in chosen.models.values() if not chosen.allows_commercial_use(m)}

    assert restricted == {"wake-words", "piper-tr_TR-dfki-medium"}


def test_the_small_set_hears_speaks_wakes_and_thinks() -> None:
    small = builtin_manifest().select(["small"])

    assert [model.id.partition("-")[0] for model in small] == [
        "whisper",
        "piper",
        "micro",
        "multilingual",
        "qwen2.5",
    ]
    assert sum(model.size for model in small) < 720e6


def test_the_language_models_of_auto_are_in_the_small_set_and_in_quality() -> None:
    assert SMALLER in builtin_manifest().sets["small"]
    assert LARGER in builtin_manifest().sets["quality"]


def test_a_licence_that_is_not_described_is_refused() -> None:
    odd = voice().model_copy(update={"licence": "Odd-1.0"})

    with pytest.raises(ValueError, match=r"Odd-1\.0"):
        manifest(odd)


@pytest.mark.parametrize(
    "name",
    [
        "../evil",
        "a/../evil",
        "..",
        "/etc/passwd",
        "a//b",
        "a/",
        "./a",
        ".hidden",
        "a/.hidden",
        "a\\b",
        "C:evil",
        "a\n",
        "",
    ],
)
def test_a_file_name_cannot_leave_the_models_folder(name: str) -> None:
    with pytest.raises(ValueError, match="name"):
        model("chat", [entry(name, CHAT)], HUB)


@pytest.mark.parametrize("name", ["panda.xml", "assets/link0_0.obj", "a/b-c/d_e.STL", "x+y.onnx"])
def test_a_file_may_lie_in_a_folder_of_the_model(name: str) -> None:
    assert model("chat", [entry(name, CHAT)], HUB).files[0].name == name


@pytest.mark.parametrize(
    ("names", "reason"),
    [
        (["a.obj", "A.obj"], "twice"),
        (["licence.txt"], "LICENCE.txt"),
        (["assets", "assets/a.obj"], "a file and a folder"),
    ],
)
def test_files_do_not_get_into_each_others_way(names: list[str], reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        model("chat", [entry(name, CHAT) for name in names], HUB)


def test_the_entry_is_one_of_the_files() -> None:
    facts = voice().model_dump() | {"entry": "other.onnx"}

    with pytest.raises(ValueError, match="entry is not one of its files"):
        type(voice()).model_validate(facts)


def test_a_file_can_be_written_as_a_row() -> None:
    given = entry("chat.gguf", CHAT)

    assert ModelFile.model_validate(list(given.values())) == ModelFile.model_validate(given)


@pytest.mark.parametrize("row", [["chat.gguf", 3], ["chat.gguf", 3, "a" * 64, "more"], []])
def test_a_row_that_is_too_short_or_too_long_is_refused(row: list[object]) -> None:
    with pytest.raises(ValueError, match="ModelFile"):
        ModelFile.model_validate(row)


def test_parts_need_a_member_name_each() -> None:
    with pytest.raises(ValueError, match="member goes with parts"):
        model("chat", [entry("chat.gguf", CHAT)], {**CHAT_WHEELS, "member": ""})


def test_one_thing_cannot_be_described_in_two_texts() -> None:
    licences = '[licences.MIT]\nname = "MIT"\nurl = "https://x"\ncommercial_use = true\n'

    assert parse_manifest(licences, "[sets]").names == ()
    with pytest.raises(ValueError, match="licences: MIT described twice"):
        parse_manifest(licences, licences)
