"""All benchmarks: what each is called, which module measures it, what the README takes of it."""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Benchmark:
    """Its module has `measure(quick: bool) -> Measured`.

    `front` is the function of the module, of the same kind, that a run with `--front` calls: all of
    it or a part; empty where the README shows nothing of it.
    """

    module: str
    about: str
    front: str = ""


BENCHMARKS: Mapping[str, Benchmark] = {
    "sim": Benchmark("benchmarks.robots.sim", "steps, scans and plans of the 2D apartment"),
    "latency": Benchmark(
        "benchmarks.agent.latency", "how fast a running agent answers and stops", "measure"
    ),
    "memory": Benchmark(
        "benchmarks.agent.memory",
        "how much memory the default set takes, hearing and speaking",
        "measure",
    ),
    "spine": Benchmark(
        "benchmarks.agent.spine",
        "through how much code a sentence passes before a wheel turns",
    ),
    "stop": Benchmark("benchmarks.wire.stop", "how soon a robot stands, by every way to say so"),
    "ros2": Benchmark(
        "benchmarks.wire.ros2", "messages, round trips, an idle robot, rates, images", "measure"
    ),
    "security": Benchmark(
        "benchmarks.wire.security",
        "what DDS security costs a message; needs a Fast DDS that has it",
    ),
    "language_model": Benchmark(
        "benchmarks.agent.language_model", "the language model beside plain llama-cpp-python"
    ),
    "shared_llm": Benchmark(
        "benchmarks.agent.shared_llm",
        "one language model for 1 to 50 robots, with and without a bound on its queue",
    ),
    "shared_hearing": Benchmark(
        "benchmarks.hearing.shared_hearing",
        "one server that hears for 1 to 20 robots, and what a hanging one costs",
    ),
    "hearing": Benchmark(
        "benchmarks.hearing.speech_to_text", "speech to text beside plain faster-whisper"
    ),
    "noise": Benchmark(
        "benchmarks.hearing.noise",
        "plain commands in quiet and in noise, and what is heard out of noise alone",
        "commands_at_10_db",
    ),
    "noise_ways": Benchmark(
        "training.adapter.noise_ways",
        "noise suppression, gain control and a larger model, for commands in noise",
    ),
    "motors": Benchmark(
        "benchmarks.hearing.motors",
        "what a robot takes for a voice of its own motors, fans and steps, and speech over them",
    ),
    "stop_words": Benchmark(
        "benchmarks.hearing.stop_words.english",
        "which stop words are heard by their sound, and what else is taken for one",
    ),
    "stop_words_languages": Benchmark(
        "benchmarks.hearing.stop_words.languages",
        "English stop words by their sound where another language is spoken",
    ),
    "endings": Benchmark(
        "benchmarks.hearing.endings",
        "when an utterance counts as over, and how often within a sentence",
    ),
    "duplex": Benchmark(
        "benchmarks.hearing.duplex",
        "who is heard through the robot's own voice, and whether it hears itself",
    ),
    "spoken_over": Benchmark(
        "benchmarks.hearing.spoken_over",
        "what lets the robot go on that is spoken over, and what ends its answer",
    ),
    "follow_ups": Benchmark(
        "benchmarks.hearing.follow_ups",
        "answers and other talk without the wake word, after the robot asked or told something",
    ),
    "several": Benchmark(
        "benchmarks.hearing.several", "which of five robots answers a person whom all of them hear"
    ),
    "wake_words": Benchmark(
        "benchmarks.hearing.wake_words", "both engines of wake words: misses, false alarms, cost"
    ),
    "people": Benchmark(
        "benchmarks.hearing.people",
        "orders, a wake word and other words by real people; needs their recordings",
    ),
    "people_stops": Benchmark(
        "benchmarks.hearing.people_stops",
        "stop words by real people in English; needs their recordings",
    ),
    "people_stops_arabic": Benchmark(
        "benchmarks.hearing.people_stops_arabic",
        "the same in Arabic; needs their recordings",
    ),
    "people_busy": Benchmark(
        "benchmarks.hearing.people_busy",
        "real people's orders in real time, beside a busy process; needs their recordings",
    ),
    "robots": Benchmark("benchmarks.robots.bodies", "every body beside its simulator alone"),
    "overhead": Benchmark("benchmarks.agent.overhead", "what logs, metrics and diagnostics cost"),
    "console": Benchmark(
        "benchmarks.console.console", "a browser's stop, map and sound, and what ten of them cost"
    ),
    "voice": Benchmark(
        "benchmarks.hearing.voice.whole",
        "hearing, answering aloud, barging in, an hour of listening",
        "measure",
    ),
    "corpus": Benchmark(
        "benchmarks.agent.corpus",
        "what becomes of what strangers say, and whether anything moves that should not",
        "measure",
    ),
    "voiceprints": Benchmark(
        "benchmarks.hearing.voiceprints",
        "real people told by their voice, in quiet and in noise; needs their recordings",
    ),
    "people_words": Benchmark(
        "benchmarks.agent.people_words",
        "what people said to robots in their own words; needs their sentences",
    ),
    "home_sentences": Benchmark(
        "benchmarks.agent.home_sentences",
        "what people say to a house must not move a robot; needs Home Assistant's sentences",
    ),
    "own_words": Benchmark(
        "benchmarks.agent.own_words",
        "orders in people's own words, as a language model wrote them: done, asked about, or not",
    ),
    "strangers": Benchmark(
        "benchmarks.agent.strangers",
        "conversations of written strangers, turn by turn: answered well, poorly or wrongly",
    ),
    "restraint": Benchmark(
        "benchmarks.agent.restraint",
        "sentences that must not move a robot at once, or only so, and that must stop it",
    ),
    "questions": Benchmark(
        "benchmarks.agent.questions",
        "questions to three robots about themselves and their world, answered rightly",
    ),
    "everyday": Benchmark(
        "benchmarks.agent.everyday",
        "everyday questions and a stranger's talk, answered by both language models on board",
    ),
    "discovery_scale": Benchmark(
        "benchmarks.wire.discovery", "how soon many agents find each other, and what it costs"
    ),
    "recordings": Benchmark(
        "benchmarks.wire.recordings",
        "what of a recording is in an S3 store, through kills and failures",
    ),
    "image": Benchmark(
        "benchmarks.wire.image", "size and start of the container's image", "measure"
    ),
}
"""In the order in which they run."""
FRONT = tuple(name for name, one in BENCHMARKS.items() if one.front)
"""Those that the README's table needs."""
