"""The tables of docs/talking.md: languages, wake words, ends of utterances, what a turn took."""

from docs.markdown import code, table
from docs.told import told
from edgevox.apps.agent.voice import MODELS, phrases
from edgevox.core.events import TurnMeasured
from edgevox.core.languages import LANGUAGES, Language
from edgevox.core.speech import Ending
from edgevox.models.manifest import builtin_manifest
from edgevox.voice.listener import ENDS_AFTER_S


def languages() -> str:
    """Every language with what hears, speaks and stops it."""
    usual = told(LANGUAGES, "stop_words")
    rows = (
        (
            f"`{language.code}`",
            language.name,
            f"`{language.stt_model}`",
            code(voice.name for voice in language.voices),
            ", ".join(_stopping(language, usual[language.code])),
        )
        for language in LANGUAGES.values()
    )
    return table(("code", "language", "heard by", "voices, best first", "stop words"), rows)


def _stopping(language: Language, usual: list[str]) -> list[str]:
    """These words, each of which stops the robot in this language."""
    if lost := set(usual) - set(language.stop.anywhere):
        raise ValueError(
            f"scripts/docs/told.toml [stop_words] {language.code}: {lost} stop nothing"
        )
    return usual


def wake_words() -> str:
    """The engines for wake words, the words that each knows, and their licences."""
    sets = builtin_manifest().sets
    rows = (
        (
            f"`{engine}`: {entry['name']}",
            code(phrases(engine)) + entry.get("own", ""),
            entry["licence"],
            f"`{MODELS[engine]}`, of the set {code(n for n in sets if MODELS[engine] in sets[n])}",
        )
        for engine, entry in told(MODELS, "wake_words").items()
    )
    return table(("`--wakeword-engine`", "wake words", "licence", "model"), rows)


def endings() -> str:
    """How much silence ends an utterance, by the words that were said."""
    entries = told(set(Ending) - {Ending.FINAL}, "endings")
    rows = (
        (what, *(silence or [f"{ENDS_AFTER_S[Ending(ending)]:g} s"]))
        for ending, (what, *silence) in entries.items()
    )
    return table(("what was said so far", "silence that ends it"), rows)


def turn() -> str:
    """What is measured of a turn."""
    measured = [name for name in TurnMeasured.__slots__ if name != "turn"]
    entries = told(measured, "turn")
    return "; ".join(f"`{name}`: {entries[name]}" for name in measured) + ".\n"
