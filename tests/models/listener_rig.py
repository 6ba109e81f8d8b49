"""Sound for the tests of the listener, made here: two voices, noises, and rooms."""

import functools
import itertools
import shutil
from collections.abc import Iterator
from tempfile import TemporaryDirectory

import espeakng_loader
import numpy as np
import pytest
from piper import PiperVoice
from steady_piper import STEADY

from edgevox.core.cancel import CancelToken
from edgevox.models import locate
from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, RATE_HZ, Frame, Samples
from edgevox.voice.tts.espeak import EspeakLibrary
from edgevox.voice.vad import open_vad
from edgevox.voice.wav import resampled
from edgevox.voice.word_detection import WakeDetector

CHATTER = """
The weather was lovely when we walked along the river this morning.
Did you remember to buy bread, milk and a jar of honey at the market?
Have you seen my keys? I left them on the kitchen table.
My brother plays the violin, but he never practises as much as he should.
The harvest was late this year because of all the rain in the summer.
Could somebody please open the window? It is far too warm in here.
Hey Marvin, the service at that restaurant was really terrible.
I am reading a book about the history of lighthouses on the northern coast.
They are driving to the airport at seven, so dinner has to be early tonight.
Okay, now let us look at the next item on the list and then take a break.
A car is parked in front of the gate and nobody knows whose it is.
Programmers are happy: the new version has been released after two years.
She said that Travis would arrive on Tuesday with his sister and the dog.
There are three apples, two pears and a basket of nuts on the shelf.
"""
"""Made up for this test, with words that sound like a wake word."""
FOREIGN_CHATTER = {
    "fr": """
Ce matin nous sommes allés au marché pour acheter du pain et des pommes.
Est-ce que tu as vu mes clés ? Je crois que je les ai laissées dans la voiture.
Il va pleuvoir demain, alors il vaut mieux rester à la maison.
Ma sœur joue du piano tous les soirs avant le dîner.
""",
    "de": """
Heute Morgen sind wir am Fluss entlang zum Bahnhof gelaufen.
Hast du meine Schlüssel gesehen? Ich habe sie auf dem Tisch liegen lassen.
Morgen soll es regnen, deshalb bleiben wir lieber zu Hause.
Meine Schwester spielt jeden Abend vor dem Essen Klavier.
""",
    "es": """
Esta mañana fuimos al mercado a comprar pan, leche y unas manzanas.
¿Has visto mis llaves? Creo que las dejé encima de la mesa.
Mañana va a llover, así que es mejor quedarse en casa.
Mi hermana toca el piano todas las noches antes de cenar.
""",
    "it": """
Stamattina siamo andati al mercato a comprare il pane e le mele.
Hai visto le mie chiavi? Credo di averle lasciate sul tavolo.
Domani pioverà, quindi è meglio restare a casa.
Mia sorella suona il pianoforte ogni sera prima di cena.
""",
    "pt": """
Hoje de manhã fomos ao mercado comprar pão e algumas maçãs.
Você viu as minhas chaves? Acho que as deixei em cima da mesa.
Amanhã vai chover, por isso é melhor ficar em casa.
A minha irmã toca piano todas as noites antes do jantar.
""",
    "nl": """
Vanmorgen zijn we naar de markt gegaan om brood en appels te kopen.
Heb je mijn sleutels gezien? Ik heb ze op de tafel laten liggen.
Morgen gaat het regenen, dus we blijven liever thuis.
Mijn zus speelt elke avond voor het eten piano.
""",
}


@functools.cache
def piper():
    return PiperVoice.load(locate("piper-en_US-joe-medium"))


@functools.cache
def says_espeak(text: str, language: str = "en") -> Samples:
    """Spoken by espeak-ng, at 16 kHz, by a copy of its library that has said nothing before.

    What it has said changes how it says the next: so each run hears the same.
    """
    with TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        copy = shutil.copy(espeakng_loader.get_library_path(), folder)
        patch.setattr(espeakng_loader, "get_library_path", lambda: copy)
        chunk = EspeakLibrary().speak(text, language, CancelToken())
    return resampled(chunk.samples, chunk.rate_hz, RATE_HZ)


@functools.cache
def says_piper(text: str) -> Samples:
    """Spoken by Piper's voice joe, at 16 kHz, without its randomness: each run hears the same."""
    chunks = list(piper().synthesize(text, STEADY))
    sound = np.concatenate([chunk.audio_int16_array for chunk in chunks])
    return resampled(sound, chunks[0].sample_rate, RATE_HZ)


def silence(seconds: float) -> Samples:
    """The quiet of a room: not quite nothing."""
    noise = np.random.default_rng(7).normal(0, 10, int(seconds * RATE_HZ))
    return noise.astype(np.int16)


def loud(sound: Samples, level: float) -> Samples:
    """The same at another root mean square, 0 to 1, measured over all of it."""
    wide = sound.astype(np.float64)
    return np.clip(wide * level * 32768 / np.sqrt(np.mean(wide**2)), -32767, 32767).astype(np.int16)


def noises(seconds: float) -> dict[str, Samples]:
    """Hiss, rumble, hum, bursts, a melody and clicks; each so long."""
    rng = np.random.default_rng(3)
    n = int(seconds * RATE_HZ)
    t = np.arange(n) / RATE_HZ
    white = rng.normal(0, 1, n)
    notes = 220 * 2 ** (rng.integers(0, 24, int(seconds * 4) + 1) / 12)
    made = {
        "hiss": white,
        "rumble": np.convolve(white, np.ones(200) / 200, "same"),
        "hum": sum(np.sin(2 * np.pi * 50 * k * t) / k for k in (1, 2, 3, 5, 7)),
        "bursts": white * (np.sin(2 * np.pi * 1.3 * t) > 0.3),
        "melody": np.sin(2 * np.pi * np.cumsum(notes[(t * 4).astype(int)]) / RATE_HZ),
        "clicks": (rng.random(n) < 3 / RATE_HZ) * rng.choice([-9.0, 9.0], n),
    }
    return {name: loud((1000 * sound).astype(np.int16), 0.05) for name, sound in made.items()}


def chatter() -> Iterator[Samples]:
    """Speech without a wake word: espeak-ng in seven languages, each line twice, slower and lower
    and faster and higher, and Piper in English.
    """
    lines = [(CHATTER, "en"), *((text, code) for code, text in FOREIGN_CHATTER.items())]
    for (text, language), speed in itertools.product(lines, (15400, 16600)):
        for line in text.strip().splitlines():
            yield resampled(says_espeak(line, language), speed, RATE_HZ)
    for line in CHATTER.strip().splitlines():
        yield says_piper(line)


def frames(sound: Samples) -> Iterator[Frame]:
    """In frames, timed from 0; what is not a whole frame at the end is left out."""
    for number in range(sound.size // FRAME_SAMPLES):
        start = number * FRAME_SAMPLES
        yield Frame(sound[start : start + FRAME_SAMPLES], (number + 1) * FRAME_S)


def room_echo(sound: Samples, gain_db: float, delay_s: float = 0.06) -> Samples:
    """What a microphone hears of a loudspeaker: later, weaker, with 0.2 s of reverberation."""
    rng = np.random.default_rng(1)
    n = int(0.2 * RATE_HZ)
    response = rng.normal(0, 1, n) * np.exp(-6.9 * np.arange(n) / n)
    response[0] = 3.0
    response *= 10 ** (gain_db / 20) / np.sqrt(np.sum(response**2))
    late = np.concatenate([np.zeros(int(delay_s * RATE_HZ)), sound.astype(np.float64)])[
        : sound.size
    ]
    return np.convolve(late, response)[: sound.size].astype(np.int16)


def heard_at(wakeword: WakeDetector, sound: Samples) -> list[float]:
    """Seconds into the sound at which its phrase was heard."""
    vad = open_vad()
    wakeword.reset()
    return [
        frame.end_s
        for frame in frames(sound)
        if wakeword.heard(frame.samples, vad.probability(frame.samples))
    ]


def in_a_room(said: Samples) -> Samples:
    """With quiet around it."""
    return np.concatenate([silence(1.5), said, silence(1.5)])
