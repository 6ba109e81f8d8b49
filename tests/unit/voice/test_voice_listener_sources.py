import contextlib
import struct
import threading
import wave

import numpy as np
import pytest
from support.clock import HeldClock

from edgevox.core.errors import InvalidValue
from edgevox.voice.audio import (
    FRAME_S,
    FRAME_SAMPLES,
    RATE_HZ,
    EndOfSound,
    Framer,
    UtteranceOver,
    rms,
)
from edgevox.voice.devices import Device, DeviceMissing, choose
from edgevox.voice.sources.open_source import Nothing, SoundCard, WavFiles, open_source
from edgevox.voice.sources.pushed import MAX_FRAMES, Pushed
from edgevox.voice.wav import check_wav, stream_wav


def write_wav(path, samples, rate_hz=RATE_HZ, width=2, channels=1):
    with wave.open(str(path), "wb") as file:
        file.setnchannels(channels)
        file.setsampwidth(width)
        file.setframerate(rate_hz)
        file.writeframes(samples)
    return path


def tone(rate_hz, seconds=1.0, hz=440.0):
    """Half of full scale, floating point from -1 to 1."""
    return 0.5 * np.sin(2 * np.pi * hz * np.arange(int(rate_hz * seconds)) / rate_hz)


def encoded(sound, width, channels):
    wide = np.repeat((sound * (2 ** (8 * width - 1) - 1)).astype(np.int64), channels)
    if width == 1:
        return (wide + 128).astype(np.uint8).tobytes()
    raw = wide.astype("<i8").tobytes()
    return b"".join(raw[i : i + width] for i in range(0, len(raw), 8))


def all_frames(source):
    source.start()
    frames = []
    with contextlib.suppress(EndOfSound):
        while True:
            frame = source.read(0.0)
            if frame:
                frames.append(frame)
    return frames


@pytest.mark.parametrize("width", [1, 2, 3, 4])
@pytest.mark.parametrize(("rate_hz", "channels"), [(8000, 1), (16000, 2), (44100, 1), (48000, 2)])
def test_a_wav_file_of_any_kind_is_heard_mono_at_16_khz(tmp_path, width, rate_hz, channels):
    sound = encoded(tone(rate_hz), width, channels)
    path = write_wav(tmp_path / "a.wav", sound, rate_hz, width, channels)

    samples = np.concatenate([*stream_wav(path)])

    spectrum = np.abs(np.fft.rfft(samples))
    assert samples.size == pytest.approx(RATE_HZ, abs=4)
    assert spectrum.argmax() * RATE_HZ / samples.size == pytest.approx(440, abs=2)
    assert rms(samples) == pytest.approx(0.5 / np.sqrt(2), rel=0.03)


def test_the_files_of_a_folder_are_heard_in_the_order_of_their_names(tmp_path):
    for name, value in (("b.wav", 2), ("a.wav", 1), ("notes.txt", 0)):
        write_wav(tmp_path / name, np.full(FRAME_SAMPLES, value, np.int16).tobytes())

    frames = all_frames(open_source(str(tmp_path), paced=False))

    heard = [int(frame.samples[0]) for frame in frames if frame.samples.any()]
    assert heard == [1, 2]


def test_unpaced_time_is_counted_in_samples(tmp_path):
    path = write_wav(tmp_path / "a.wav", np.ones(10 * FRAME_SAMPLES + 1, np.int16).tobytes())
    clock = HeldClock(100.0)

    frames = all_frames(WavFiles([path], paced=False, gap_s=0.0, clock=clock))

    assert [frame.end_s for frame in frames] == pytest.approx(
        [100.0 + (n + 1) * FRAME_S for n in range(11)]
    )
    assert sum(int(frame.samples.sum()) for frame in frames) == 10 * FRAME_SAMPLES + 1


def test_a_paced_frame_is_there_when_its_time_has_come(tmp_path):
    path = write_wav(tmp_path / "a.wav", np.ones(FRAME_SAMPLES, np.int16).tobytes())
    clock = HeldClock(100.0)
    source = WavFiles([path], gap_s=0.0, clock=clock)
    source.start()

    early = source.read(0.0)
    clock.now_s += FRAME_S
    due = source.read(0.0)

    assert early is None
    assert due.end_s == clock.now_s
    with pytest.raises(EndOfSound):
        source.read(0.0)


def test_sound_that_nobody_reads_loses_its_oldest_and_counts_it():
    source = Pushed("test", HeldClock(100.0))
    for number in range(MAX_FRAMES + 3):
        source.push(np.full(FRAME_SAMPLES, number, np.int16))

    assert source.dropped == 3
    assert source.read(0.0).samples[0] == 3


@pytest.mark.parametrize("first", ["end", "abandon"])
def test_that_somebody_has_ended_is_not_lost_with_the_oldest_sound(first):
    source = Pushed("test", HeldClock(100.0))
    source.push(np.zeros(FRAME_SAMPLES, np.int16))
    getattr(source, first)()
    source.end()
    for number in range(MAX_FRAMES + 3):
        source.push(np.full(FRAME_SAMPLES, number, np.int16))

    with pytest.raises(UtteranceOver) as over:
        source.read(0.0)
    assert over.value.abandoned is (first == "abandon")
    assert source.read(0.0).samples[0] == 3


def test_frames_are_cut_from_pieces_of_any_size_with_the_time_of_their_last_sample():
    framer = Framer()

    first = list(framer.push(np.arange(700, dtype=np.int16), 1.0))
    second = list(framer.push(np.arange(700, 1100, dtype=np.int16), 1.0 + 400 / RATE_HZ))

    heard = np.concatenate([f.samples for f in (*first, *second)])
    assert np.array_equal(heard, np.arange(1024))
    assert first[0].end_s == pytest.approx(1.0 - 188 / RATE_HZ)
    assert second[0].end_s == pytest.approx(1.0 + 324 / RATE_HZ)


def test_closing_wakes_whoever_reads():
    source = Pushed("test")
    reader = threading.Thread(target=lambda: source.read(30.0), name="reader")
    reader.start()

    source.close()

    reader.join(60)
    assert not reader.is_alive()


class FakeStream:
    name = "a fake microphone"
    active = True


class Room:
    """Opens a microphone that is not there at first, gives sound when told, and may be lost."""

    def __init__(self, missing):
        self.missing = missing
        self.opened = threading.Semaphore(0)
        self.hear = None
        self.streams = []

    @contextlib.contextmanager
    def open(self, name, hear):
        if self.missing:
            self.missing -= 1
            raise DeviceMissing(f"no microphone {name!r} on this machine; it has none at all")
        self.hear = hear
        stream = FakeStream()
        self.streams.append(stream)
        self.opened.release()
        yield stream


@pytest.fixture
def sound_card():
    cards = []

    def start(room):
        card = SoundCard("usb", opener=room.open, retry_s=0.01, silent_s=0.04)
        cards.append(card)
        card.start()
        return card

    yield start
    for card in cards:
        card.close()


def test_a_missing_microphone_is_said_once_and_tried_until_it_is_there(sound_card, caplog):
    room = Room(missing=5)

    card = sound_card(room)
    assert room.opened.acquire(timeout=60)
    room.hear(np.full(FRAME_SAMPLES, 7, np.int16))

    assert card.read(60.0).samples[0] == 7
    said = [r.message for r in caplog.records if "no microphone 'usb'" in r.message]
    assert len(said) == 1


@pytest.mark.parametrize("why", ["it gives no sound", "PortAudio gave it up"])
def test_a_microphone_that_was_pulled_out_is_opened_again(sound_card, caplog, why):
    room = Room(missing=0)
    sound_card(room)
    assert room.opened.acquire(timeout=60)

    room.streams[0].active = why == "it gives no sound"

    assert room.opened.acquire(timeout=60)
    assert any("gives no sound any more" in record.message for record in caplog.records)


MICROPHONES = [Device(0, "HDA Intel PCH", 2, 44100), Device(3, "USB Audio Device", 1, 48000)]


def test_a_device_is_found_by_a_part_of_its_name_in_any_case():
    assert choose("usb audio", "input", MICROPHONES).index == 3


def test_a_missing_device_is_named_with_those_that_are_there():
    with pytest.raises(DeviceMissing, match="no microphone 'ReSpeaker'.*'USB Audio Device'"):
        choose("ReSpeaker", "input", MICROPHONES)


def test_none_hears_nothing():
    assert isinstance(open_source("none"), Nothing)
    assert open_source("none").read(0.0) is None


@pytest.mark.parametrize(("spec", "kind"), [("", SoundCard), ("USB", SoundCard), ("ros2", Pushed)])
def test_a_name_means_a_device_and_ros2_the_topic(spec, kind):
    assert isinstance(open_source(spec), kind)


def test_what_cannot_be_heard_is_refused_with_its_reason(tmp_path):
    (tmp_path / "empty").mkdir()
    (tmp_path / "text.wav").write_text("no sound")

    for spec, expected in (
        (tmp_path / "absent.wav", "that exists"),
        (tmp_path / "empty", "with WAV files in it"),
        (tmp_path / "text.wav", "a WAV file of PCM"),
    ):
        with pytest.raises(InvalidValue, match=expected) as refusal:
            open_source(str(spec))
        assert refusal.value.field == "audio_in"


@pytest.mark.parametrize(
    ("rate_hz", "bits"), [(0, 16), (1, 16), (4_000_000_000, 16), (16_000, 128)]
)
def test_a_wav_file_whose_header_lies_is_refused_before_memory_is_taken(tmp_path, rate_hz, bits):
    header = struct.pack("<HHIIHH", 1, 1, rate_hz, 32_000, 2, bits)
    chunks = b"WAVEfmt " + struct.pack("<I", len(header)) + header + b"data" + struct.pack("<I", 64)
    file = tmp_path / "lies.wav"
    file.write_bytes(b"RIFF" + struct.pack("<I", len(chunks) + 64) + chunks + bytes(64))
    with pytest.raises(InvalidValue, match="audio_in: got"):
        check_wav(file)
