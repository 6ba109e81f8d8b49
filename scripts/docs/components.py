"""The components, and what a level of each means: a table of docs/monitoring.md."""

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
        "it drops audio frames",
        "a device is gone (EdgeVox retries a microphone every 3 s, a loudspeaker with the next"
        " sentence), the listening or speaking thread has ended, or an error lost some input",
        "plug the device in; `edgevox doctor --only sound` lists the devices",
    ),
    ComponentRow(
        ComponentName.STT,
        "speech to text",
        "it is slower than speech, more speech arrives than it can transcribe, or its server fails"
        " and the model on board hears",
        "it failed on an utterance",
        "read the log; run `edgevox doctor --only models`",
    ),
    ComponentRow(
        ComponentName.LLM,
        "the language model",
        "its server is gone, and the model on board answers",
        "its server is gone and nothing answers, or an answer failed",
        "start the server; EdgeVox asks it again by itself",
    ),
    ComponentRow(
        ComponentName.TTS,
        "text to speech",
        "espeak-ng speaks instead of the selected voice, a voice failed, or its server fails and"
        " the voice on board speaks",
        "",
        "run `edgevox doctor --only models`",
    ),
    ComponentRow(
        ComponentName.SIM,
        "the robot, simulated or not",
        "its world runs below 90 % of its pace or has stalled for 1 s, its battery is below 15 %,"
        " or EdgeVox cannot read its remembered places",
        "its world has stalled for 6 s, its numbers are invalid, its odometry is silent, or its"
        " battery is empty",
        "reduce the load on the machine; check the robot",
    ),
    ComponentRow(
        ComponentName.EXECUTOR,
        "the thread that serves ROS 2",
        "a callback takes longer than 1 s, or one failed",
        "a callback takes longer than 6 s, or rclpy is missing",
        "read the log for the failed callback; `/live` fails for a process that hangs",
    ),
    ComponentRow(
        ComponentName.PRESENCE,
        "other agents on the same namespace and domain; `group` names the robots of its"
        " `answer_group`",
        "another one is here",
        "another one is here and in charge; this one refuses to move the robot",
        "end one of them, or publish the id of the one that should move the robot on `take_over`",
    ),
    ComponentRow(
        ComponentName.INTERLOCK,
        "the reason why all motion is forbidden, if it is",
        "motion is forbidden: the software stop is pressed, another agent is in charge, or a drain"
        " has begun; or a stop has just ended a stream of velocities that went on",
        "",
        "check that the way is clear, then resume where the stop was pressed; `presence` lists the"
        " other agents",
    ),
    ComponentRow(
        ComponentName.CONSOLE,
        "the web page: its address, its open pages, the session in control",
        "one of its files was damaged and kept aside, or the pairing code could not be saved",
        "its folder cannot be read or written, or its thread has ended",
        "if its thread has ended, health names `console`; nothing else depends on it",
    ),
    ComponentRow(
        ComponentName.RECORDINGS,
        "the recordings that are started on the console's page",
        "the last recording failed, or there is no room for one",
        "",
        "make room; [the recorder](operations.md#the-recorder)",
    ),
    ComponentRow(
        ComponentName.RECORDER,
        "a recorder that is a program of its own, as it says on `/diagnostics` itself, where the"
        " agent hears it",
        "its uploads fail or have been behind for 2 hours, it has lost messages, or it is silent"
        " and has not said that it ended",
        "it cannot write",
        "make room; read the uploader's log; start it; [the recorder](operations.md#the-recorder)",
    ),
    ComponentRow(
        ComponentName.POLICY,
        "the rules of the policy file; its values give the number of refusals and the last one",
        "the file cannot be used and the previous policy stays in force, or it names a skill or a"
        " place that this robot does not have; the message suggests the nearest name",
        "",
        "`edgevox doctor --only policy` names the line; a corrected file takes effect at once",
    ),
    ComponentRow(
        ComponentName.DISK,
        "the disks that EdgeVox writes to",
        "less than 1 GiB is free, or less than 10 % of a small file system; or the folder of the"
        " places, of the console or of its recordings is not writable, and nothing in it is kept",
        "less than 100 MiB is free, or less than 2 % of a small file system",
        "remove old logs, recordings, or models; give the folder to the user who runs EdgeVox",
    ),
    ComponentRow(
        ComponentName.CLOCK,
        "whether the machine's clock is set and synchronised, as the kernel knows it",
        "it is not synchronised: the stamps of this robot and of other machines disagree",
        "it was never set",
        "`sudo timedatectl set-ntp true`, or chrony with `rtcsync`",
    ),
    ComponentRow(
        ComponentName.PROCESS,
        "the answers of `/live` and `/ready`, memory, threads",
        "not ready: a part still loads, or is missing",
        "not alive: a part that must advance does not",
        "wait while it starts; a container engine restarts a process that is not alive",
    ),
)
"""In the order in which they are listed."""
