"""The table of docs/security.md: what the code takes of everything that comes in, at most."""

from docs.markdown import table
from edgevox.agent.goals import executor as skill_executor
from edgevox.agent.inbox import MAX_WAITING
from edgevox.agent.nlu import model_answer
from edgevox.apps.terminal.run_terminal import MAX_LINE_BYTES
from edgevox.core import hearers
from edgevox.core.files import text, user_file
from edgevox.core.servers import http as http_request
from edgevox.ops import http_server
from edgevox.robots.world import load as world
from edgevox.ros2 import audio, skill_action
from edgevox.ros2.contract import HEARERS
from edgevox.ros2.external.settings import MOST_LOCATIONS
from edgevox.ros2.recorder import disk as write_queue
from edgevox.scenario import format as scenario
from edgevox.voice.audio import RATE_HZ


def bounds() -> str:
    """Bounds on what comes in."""
    audio_s = audio.MAX_BYTES / audio.SAMPLE_BYTES / RATE_HZ
    limits = {
        "an utterance": f"{text.MAX_CHARACTERS:,} characters; waiting sentences: {MAX_WAITING}; "
        f"calls in one sentence: {skill_executor.MAX_CALLS}",
        "a line on standard input": f"{MAX_LINE_BYTES >> 20} MB, of which "
        f"{text.MAX_CHARACTERS:,} characters count",
        f"`{audio.TOPIC_IN}`": f"{audio_s:g} s a message",
        "arguments of `execute_skill`": f"{skill_action.MAX_ARGUMENTS_BYTES >> 10} KB",
        "a request to health or metrics": f"{http_server.MOST_BYTES >> 10} KB, "
        f"{http_server.REQUEST_S:g} s, {http_server.MOST_AT_ONCE} at once; beyond that, the "
        "oldest connection of the address with the most connections is closed",
        f"`{HEARERS.topic}`": f"{hearers.MAX_CHARACTERS:,} characters a message, "
        f"{hearers.MOST_PER_S:,} messages a second, {hearers.MOST_ROBOTS} robots, "
        f"{hearers.MOST_UTTERANCES} utterances of each, {hearers.MOST_MS // 1000} s an utterance",
        "a model server's reply": f"{http_request.MOST_BYTES >> 20} MB",
        "a language model's answer": f"{model_answer.ANSWER_TOKENS} tokens",
        "a scenario": f"{scenario.MAX_STEPS:,} steps",
        "a world file": f"{world.MOST_THINGS:,} things",
        "a locations file": f"{MOST_LOCATIONS} places",
        "a text file of a setting": f"{user_file.LARGEST_TEXT_BYTES // 1_000_000} MB; "
        "a regular file",
        "the recorder": f"{write_queue.MOST_MESSAGES:,} messages or "
        f"{write_queue.MOST_BYTES >> 20} MB waiting for the disk",
    }
    return table(("what", "bound"), limits.items())
