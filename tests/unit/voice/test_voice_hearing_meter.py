"""What `edgevox listen` measures and shows, on sounds whose figures are known."""

from types import SimpleNamespace

import numpy as np
import pytest

from edgevox.apps.listen import ListenView, as_line
from edgevox.core.commands import Heard, Transcribing
from edgevox.core.events import WakeWordHeard
from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES
from edgevox.voice.noise_floor import SILENT_DB, WINDOW_S, HearingMeter


class Ears:
    """Takes whatever is louder than -40 dB for a voice."""

    any_voice = 0.1

    def probability(self, samples):
        self.any_voice = 0.9 if np.abs(samples).max() > 0.01 * 32768 else 0.1
        return self.any_voice

    def reset(self):
        """Nothing to forget."""


def square(level):
    """A frame whose root mean square is this share of full scale."""
    return np.full(FRAME_SAMPLES, round(level * 32767), np.int16)


@pytest.fixture
def meter():
    return HearingMeter(Ears())


def hears(meter, *levels):
    for level in levels:
        meter.probability(square(level))
    return meter.reading()


def test_before_any_sound_there_is_silence(meter):
    reading = meter.reading()
    assert (reading.level_db, reading.signal_to_noise_db) == (SILENT_DB, None)


def test_levels_are_decibels_of_full_scale(meter):
    assert hears(meter, 1.0).level_db == pytest.approx(0.0, abs=0.01)
    assert hears(meter, 0.1).level_db == pytest.approx(-20.0, abs=0.01)
    assert hears(meter, 0.0).level_db == SILENT_DB


def test_the_floor_is_what_is_there_between_the_words(meter):
    reading = hears(meter, *([0.001] * 50 + [0.1] * 100))

    assert reading.floor_db == pytest.approx(-60.0, abs=0.5)
    assert reading.signal_to_noise_db == pytest.approx(40.0, abs=0.5)


def test_without_a_voice_there_is_no_signal(meter):
    assert hears(meter, *[0.001] * 50).signal_to_noise_db is None


def test_clipping_is_the_share_of_samples_at_the_end_of_the_scale(meter):
    assert hears(meter, 0.5).clipped_share == 0.0
    assert hears(meter, 1.0).clipped_share == 0.5
    meter.probability(np.full(FRAME_SAMPLES, -32768, np.int16))
    assert meter.reading().clipped_share == pytest.approx(2 / 3)


def test_a_voice_between_two_readings_is_not_missed(meter):
    assert hears(meter, 0.001, 0.1, 0.001).voice == 0.9
    assert hears(meter, 0.001).voice == 0.1


def test_what_was_long_ago_counts_no_more(meter):
    hears(meter, *[1.0] * 10)
    reading = hears(meter, *[0.001] * (round(WINDOW_S / FRAME_S) + 1))
    assert (reading.clipped_share, reading.signal_to_noise_db) == (0.0, None)


def shown(live, seconds):
    lines = []
    view = ListenView(lines.append, live=live)
    meter = HearingMeter(Ears(), view.show)
    hears(meter, *[0.1] * round(seconds / FRAME_S))
    return lines, view


def test_into_a_file_goes_a_line_a_second():
    lines, view = shown(live=False, seconds=5.1)
    view.close()

    assert [line.split()[0] for line in lines] == ["1.0", "2.0", "3.0", "4.0", "5.0"]
    assert all(line.endswith("\n") and "\x1b" not in line for line in lines)


def test_on_a_terminal_one_line_is_drawn_anew_ten_times_a_second():
    lines, view = shown(live=True, seconds=1.05)
    view.close()

    assert len(lines) in (10, 11, 12)
    assert all(line.startswith("\r\x1b[K[#") and "\n" not in line for line in lines[:-1])
    assert lines[-1] == "\n"


def test_what_is_understood_stands_above_the_line():
    lines, view = shown(live=False, seconds=0.1)

    view.command(Transcribing())
    view.command(Heard("go to the kitchen", 1.0))
    view.command(Heard("", 2.0))
    view.woken(WakeWordHeard("hey jarvis"))

    assert lines == [
        '  heard "go to the kitchen"\n',
        "  no words in what was heard\n",
        '  wake word "hey jarvis"\n',
    ]


def test_a_line_has_every_figure(meter):
    reading = hears(meter, *([0.001] * 50 + [0.1] * 50))
    line = as_line(reading, {"stop": 0.871, "wake": 0.0})
    for part in (
        "level  -20 dB",
        "floor  -60 dB",
        "signal/noise  40 dB",
        "clipped  0.0 %",
        "speech",
        "stop 0.87  wake 0.00",
    ):
        assert part in line


def test_the_most_that_a_detector_thought_since_the_last_line_is_told():
    lines, detector = [], SimpleNamespace(likelihood=0.0)
    view = ListenView(lines.append, live=False, detectors={"stop": detector})
    meter = HearingMeter(Ears(), view.show)

    for likelihood in (0.2, 0.9, 0.1):
        detector.likelihood = likelihood
        hears(meter, *[0.1] * round(0.3 / FRAME_S))
    hears(meter, *[0.1] * round(1.2 / FRAME_S))

    assert [line.split()[-2:] for line in lines] == [["stop", "0.90"], ["stop", "0.10"]]
