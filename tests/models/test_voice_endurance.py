"""Five minutes of sound, as fast as they can be heard, leave nothing behind; the benchmark `voice`
takes an hour.

espeak-ng answers here: Piper's memory grows in steps until it has met its largest sound.
"""

import pytest
from voice_rig import VoiceRig

from benchmarks.hearing.voice.endurance import endure

pytestmark = pytest.mark.long


def test_five_minutes_of_talk_leave_no_thread_and_no_memory_and_make_it_no_slower(tmp_path):
    with (
        pytest.MonkeyPatch.context() as patch,
        VoiceRig(
            patch, tmp_path / "answers.wav", robot="robot-apartment", voice="espeak-en"
        ) as rig,
    ):
        endured = endure(rig, 5)

    assert endured.turns == 10
    assert endured.thread_growth == 0
    assert endured.memory_growth_kib < 20_000
    assert endured.last_work_s < 3 * endured.first_work_s
