"""A recording in place of a microphone: what is said in it is heard while the robot speaks, too."""

from types import SimpleNamespace

from listener_rig import loud, says_espeak, silence
from support.recordings import write_wav

from edgevox.agent.policy import Guard
from edgevox.apps.agent.voice import build_listener
from edgevox.core.bus import Bus
from edgevox.core.commands import Heard
from edgevox.core.settings import Settings
from edgevox.core.speech import Ending
from edgevox.voice.sources.open_source import WavFiles
from edgevox.voice.stt.speech_to_text import Transcript


def test_a_quiet_voice_is_heard_while_the_robot_speaks_loudly(tmp_path):
    file, said = tmp_path / "said.wav", []
    quiet = loud(says_espeak("go to the bedroom"), 0.05)
    write_wav(file, silence(0.5), quiet, silence(2.0))
    voice = SimpleNamespace(
        source=WavFiles([file], paced=False),
        stt=SimpleNamespace(transcribe=lambda *_: Transcript("go to the bedroom")),
        sink=SimpleNamespace(audible=lambda: 0.5),
        speech_output=SimpleNamespace(saying=lambda: ""),
        hearing=SimpleNamespace(stop_for=lambda _: None, stop_stt=None),
        wakeword=None,
        played=None,
    )

    listener = build_listener(
        voice,
        Settings(stop_spotter=False),
        Bus(),
        SimpleNamespace(language="en", muted=False),
        submit=said.append,
        is_stop=lambda _: False,
        follow_up=SimpleNamespace(awaits=lambda *_: False, begins=lambda *_: None),
        ending=lambda _: Ending.OPEN,
        guard=Guard(),
    )
    listener.start()
    assert listener.wait_over()
    listener.close()

    assert [one.text for one in said if isinstance(one, Heard)] == ["go to the bedroom"]
