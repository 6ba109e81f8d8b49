"""What the hearing adapter is worth: commands in noise, what is long or short, noise alone."""

import numpy as np
import pytest
from listener_rig import says_espeak, says_piper, silence
from voice_engines import words, wrong_words

from edgevox.models import locate
from edgevox.voice.audio import RATE_HZ
from edgevox.voice.stt import whisper
from edgevox.voice.stt.whisper import SHORT_S, Whisper

pytestmark = pytest.mark.long

COMMANDS = (
    "Go to the kitchen.", "Where are you?", "Turn left.", "Open your hand.",
    "Take me to the office.", "Pick up the red cube.", "The bedroom, please.",
    "What is your battery level?",
)  # fmt: skip
PROMPT = f"{' '.join(COMMANDS)} Go to the bedroom. Go to the office. Turn right. Kitchen, please."
NOISE_DB = -6.0
"""Of hiss, beside the voice."""


def opened():
    model = locate("whisper-tiny.en")
    stt = Whisper(lambda _: model, prompt_of=lambda _: PROMPT, threads=2)
    stt.warm_up("en")
    return stt


@pytest.fixture(scope="module")
def adapted():
    stt = opened()
    yield stt
    stt.close()


@pytest.fixture
def plain(monkeypatch):
    """The same model without the adapter."""
    monkeypatch.setattr(whisper, "adapter_for", lambda _: {})
    stt = opened()
    yield stt
    stt.close()


def as_it_comes(sound):
    """As the listener hands it on: with what was around it."""
    return np.concatenate([silence(0.5), sound, silence(0.5)])


def among_hiss(sound, seed):
    """With half a second of it before and after."""
    whole = as_it_comes(sound).astype(float)
    loud = np.sqrt(np.mean(sound.astype(float) ** 2))
    hiss = np.random.default_rng(seed).normal(0, loud * 10 ** (NOISE_DB / 20), whole.size)
    return np.clip(whole + hiss, -32768, 32767).astype(np.int16)


def wrong(stt, sounds):
    """How many words of the commands are not heard, or are others."""
    return sum(
        wrong_words(words(said), words(stt.transcribe(sound, "en").text)) for said, sound in sounds
    )


def test_in_noise_more_of_what_is_said_is_heard(adapted, plain):
    spoken = [(said, says) for said in COMMANDS for says in (says_espeak, says_piper)]
    sounds = [(said, among_hiss(says(said), seed)) for seed, (said, says) in enumerate(spoken)]

    assert 3 * wrong(adapted, sounds) <= wrong(plain, sounds) > 0


@pytest.mark.parametrize("word", ["Yeah.", "Wait."])
def test_a_lone_word_of_less_than_half_a_second_is_heard(adapted, word):
    sound = np.concatenate([silence(0.3), says_piper(word), silence(0.2)])

    assert adapted.transcribe(sound, "en").text == word


@pytest.mark.parametrize("says", [says_espeak, says_piper])
def test_in_quiet_it_is_heard_word_for_word(adapted, says):
    # The model's sums are in 8 bits, and come out otherwise on another processor.
    assert wrong(adapted, [(said, as_it_comes(says(said))) for said in COMMANDS]) <= 1


def test_what_is_longer_than_it_learnt_is_heard_to_its_end(adapted):
    said = (
        "When you are done in the kitchen, please come back to the door and wait for me there. "
        "We were at the market in the morning and bought apples, bread and a little cheese. "
        "Tomorrow the children will be at school, so it will be much quieter in the house."
    )
    sound = says_piper(said)
    assert sound.size > SHORT_S * RATE_HZ

    heard = adapted.transcribe(sound, "en").text

    assert wrong_words(words(said), words(heard)) <= 3


def test_of_noise_alone_it_makes_no_command(adapted):
    heard = [adapted.transcribe(among_hiss(silence(2.0) + 300, seed), "en") for seed in range(6)]

    assert [one.text for one in heard if one.text and one.confidence > 0.6] == []


def test_by_its_sound_a_command_is_told_from_others_that_sound_alike(adapted):
    several = ["Go to the kitchen.", "Go to the chicken.", "Go to the kitten."]
    said = adapted.transcribe(as_it_comes(says_piper(several[0])), "en")

    right, *others = said.rate(several)

    assert right > max(others) + 1.0
