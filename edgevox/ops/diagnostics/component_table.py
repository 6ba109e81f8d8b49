"""Which components there are, and what a level of each means: once, for docs and tests."""

from dataclasses import dataclass

from edgevox.core.status import ComponentName


@dataclass(frozen=True, slots=True)
class ComponentRow:
    """A component: what it is about, when it is worse than OK, and what to do then."""

    name: ComponentName
    about: str
    warns: str
    errs: str
    remedy: str


COMPONENTS: tuple[ComponentRow, ...] = (
    ComponentRow(
        ComponentName.AUDIO,
        "microphone and loudspeaker",
        "frames are dropped unheard",
        "a device is gone (a microphone is tried again every 3 s, a loudspeaker with the next"
        " sentence), a thread that hears or speaks has ended, or what was heard was lost for a"
        " fault",
        "plug it in; `edgevox doctor --only sound` lists what is there",
    ),
    ComponentRow(
        ComponentName.STT,
        "speech to text",
        "it is slower than speech, or more is said than can be understood",
        "an utterance could not be understood for a fault",
        "the log says why; `edgevox doctor --only models`",
    ),
    ComponentRow(
        ComponentName.LLM,
        "the language model",
        "its server is gone, the model on board answers",
        "its server is gone and nothing answers, or an answer failed",
        "start the server; it is asked again by itself",
    ),
    ComponentRow(
        ComponentName.TTS,
        "text to speech",
        "espeak-ng speaks instead of the voice that was asked for, or a voice failed",
        "",
        "`edgevox doctor --only models`",
    ),
    ComponentRow(
        ComponentName.SIM,
        "the robot, simulated or not",
        "it keeps less than 90 % of its pace, stands still for 1 s, its battery is below 15 %, or"
        " its remembered places could not be read",
        "it stands still for 6 s, its numbers broke, its odometry is silent, its battery is empty",
        "give the machine fewer other things to do; look after the robot",
    ),
    ComponentRow(
        ComponentName.EXECUTOR,
        "the thread that serves ROS 2",
        "a callback takes longer than 1 s, or one failed",
        "a callback takes longer than 6 s, or there is no rclpy",
        "the log has the callback that failed; health ends a process that hangs",
    ),
    ComponentRow(
        ComponentName.PRESENCE,
        "other agents on the same namespace and domain",
        "another one is here",
        "another one is here and in charge: this one refuses to move",
        "end one of them, or publish the id of the one that is to move on `take_over`",
    ),
    ComponentRow(
        ComponentName.INTERLOCK,
        "who forbids all motion at the moment, if anybody does",
        "motion is forbidden: the software stop is pressed, another agent is in charge, or a drain"
        " has begun; or a stop has just ended velocities that went on",
        "",
        "look that nobody is in the way, then resume where it was stopped; `presence` says who"
        " else is there",
    ),
    ComponentRow(
        ComponentName.CONSOLE,
        "the page for browsers: where it is, how many are open, who commands",
        "a file of its own was damaged and kept aside, or no pairing code could be written",
        "its folder can be neither read nor written, or its thread has ended",
        "health says `console` where its thread has ended; nothing else depends on it",
    ),
    ComponentRow(
        ComponentName.POLICY,
        "what the policy file permits; its values say how much was refused, and what last",
        "the file cannot be used and the policy before it is in force, or it names a skill or a"
        " place that this robot does not have; it says which is the nearest",
        "",
        "`edgevox doctor --only policy` says which line; a mended file counts at once",
    ),
    ComponentRow(
        ComponentName.DISK,
        "room where EdgeVox writes",
        "less than 1 GiB, of a small file system less than 10 %",
        "less than 100 MiB, of a small file system less than 2 %",
        "remove old logs, recordings, or models",
    ),
    ComponentRow(
        ComponentName.PROCESS,
        "what `/live` and `/ready` say, memory, threads",
        "not ready: something still loads, or is missing",
        "not alive: something that must move does not",
        "wait while it starts; a container engine restarts what is not alive",
    ),
)
"""In the order in which they are listed."""
