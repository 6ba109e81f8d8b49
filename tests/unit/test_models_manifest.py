from importlib.resources import files

import pytest
from models_wheelhouse import MIND, entry, manifest, model, voice

from edgevox.core.settings import Settings
from edgevox.models.manifest import HubSource, WheelSource, builtin_manifest

MODELS = list(builtin_manifest().models.values())


@pytest.mark.parametrize("one", MODELS, ids=lambda model: model.id)
def test_every_licence_comes_with_its_text(one) -> None:
    text = files("edgevox.models").joinpath("licences", f"{one.licence}.txt")

    assert len(text.read_text()) > 200


@pytest.mark.parametrize("one", MODELS, ids=lambda model: model.id)
def test_every_model_can_be_had_without_a_hub_and_asks_the_publisher_first(one) -> None:
    kinds = [type(source) for source in one.sources]

    assert WheelSource in kinds
    assert kinds == sorted(kinds, key=[HubSource, WheelSource].index)


@pytest.mark.parametrize("one", MODELS, ids=lambda model: model.id)
def test_an_entry_is_one_of_the_files(one) -> None:
    assert one.entry in {"", *(file.name for file in one.files)}


def test_the_small_set_hears_speaks_wakes_and_thinks() -> None:
    small = builtin_manifest().select(["small"])

    assert [model.id.partition("-")[0] for model in small] == [
        "whisper",
        "piper",
        "wake",
        "qwen2.5",
    ]
    assert sum(model.size for model in small) < 700e6


def test_the_default_language_model_is_in_the_small_set() -> None:
    default = Settings.model_fields["llm"].default

    assert default in builtin_manifest().sets["small"]


def test_wake_words_are_declared_not_for_commercial_use() -> None:
    chosen = builtin_manifest()

    assert not chosen.licences[chosen.models["wake-words"].licence].commercial_use


def test_a_licence_that_is_not_described_is_refused() -> None:
    odd = voice().model_copy(update={"licence": "Odd-1.0"})

    with pytest.raises(ValueError, match=r"Odd-1\.0"):
        manifest(odd)


@pytest.mark.parametrize("name", ["../evil", "a/b", ".hidden", ""])
def test_a_file_name_cannot_leave_the_models_folder(name: str) -> None:
    with pytest.raises(ValueError, match="name"):
        model("mind", [entry(name, MIND)], {"kind": "hub", "repo": "us/mind"})
