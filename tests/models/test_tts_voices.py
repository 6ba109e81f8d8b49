"""What the voices say is understood by a recogniser that knows nothing of it."""

import subprocess
import sys

import numpy as np
import pytest
from voice_engines import hear, speak, voice, words, wrong_words

from edgevox.core.cancel import CancelToken
from edgevox.core.languages import LANGUAGES
from edgevox.models import locate
from edgevox.voice.tts.espeak import EspeakCommand, EspeakSynthesiser, open_espeak
from edgevox.voice.tts.kokoro import load_style
from edgevox.voice.tts.synthesiser import SynthesisFailed
from edgevox.voice.tts.voices import VoicePool

pytestmark = pytest.mark.long

KITCHEN = {
    "en": "The robot drives to the kitchen and picks up the red cup.",
    "es": "El robot va a la cocina y abre la puerta blanca.",
    "fr": "Le robot va dans la cuisine et prend la tasse rouge.",
    "it": "Il robot va in cucina e prende la tazza rossa.",
    "pt": "O robô está na cozinha e abre a porta azul.",
}
HELLO = {
    "vi": "Xin chào.",
    "ar": "مرحبا.",
    "ru": "Привет.",
    "hi": "नमस्ते।",
    "zh": "你好。",
    "ja": "こんにちは。",
}


@pytest.fixture(scope="module")
def pool() -> VoicePool:
    return VoicePool()


@pytest.mark.parametrize("name", ["en_US-joe-medium", "espeak-en"])
def test_an_english_voice_is_understood_word_for_word(name: str, pool: VoicePool):
    chunks = speak(voice("en", name), KITCHEN["en"], pool)
    assert wrong_words(words(KITCHEN["en"]), hear(chunks, "en")) <= 1


@pytest.mark.parametrize("language", ["en", "es", "fr", "it", "pt"])
def test_kokoro_is_understood_in_its_languages(language: str, pool: VoicePool):
    name = next(v.name for v in LANGUAGES[language].voices if v.backend == "kokoro")
    chunks = speak(voice(language, name), KITCHEN[language], pool)
    assert wrong_words(words(KITCHEN[language]), hear(chunks, language)) <= 1


@pytest.mark.parametrize("language", LANGUAGES)
def test_espeak_speaks_every_language(language: str, pool: VoicePool):
    (chunk,) = speak(voice(language, f"espeak-{language}"), HELLO.get(language, "Hello."), pool)
    assert 0.3 < len(chunk.samples) / chunk.rate_hz < 4.0
    assert np.abs(chunk.samples.astype(int)).max() > 3000


def test_espeak_as_a_command_says_the_same_as_the_library():
    engine = EspeakSynthesiser(EspeakCommand("espeak-ng"), "en-us")
    (chunk,) = engine.synthesise(KITCHEN["en"], CancelToken())
    assert wrong_words(words(KITCHEN["en"]), hear([chunk], "en")) <= 1


def test_espeak_refuses_a_language_that_it_does_not_have():
    for engine in (open_espeak(), EspeakCommand("espeak-ng")):
        with pytest.raises(SynthesisFailed):
            engine.speak("Hello.", "xx-none", CancelToken())


OPENED_AT_ONCE = """
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier
from edgevox.voice.tts.espeak import espeak_library

together = Barrier(8)

def opened():
    together.wait()
    return espeak_library()

with ThreadPoolExecutor(8) as threads:
    futures = [threads.submit(opened) for _ in range(8)]
print(len({id(one.result()) for one in futures}))
"""


def test_threads_that_open_espeak_at_once_share_the_one_there_is():
    command = [sys.executable, "-c", OPENED_AT_ONCE]  # nothing is open yet in a new process
    ran = subprocess.run(command, capture_output=True, text=True, check=True)
    assert ran.stdout.split() == ["1"]


@pytest.mark.parametrize("name", ["en_US-joe-medium", "espeak-en"])
def test_a_cancelled_token_ends_a_voice_within_one_chunk(name: str, pool: VoicePool):
    token = CancelToken()
    pieces = pool.get(voice("en", name)).synthesise("One. Two. Three. Four.", token)
    next(pieces)
    token.cancel()
    assert list(pieces) == []


def test_kokoro_speaks_as_fast_as_it_is_told(pool: VoicePool):
    name = next(v.name for v in LANGUAGES["en"].voices if v.backend == "kokoro")
    model, style = pool.get(voice("en", name)).model, load_style(locate("kokoro-voices"), "af_nova")
    tokens = model.phonemes.tokens("The robot drives to the kitchen.", style.name)

    slow, usual, fast = (model.run(tokens, style, speed).size for speed in (0.8, 1.0, 1.25))

    assert slow > 1.1 * usual
    assert fast < 0.9 * usual
