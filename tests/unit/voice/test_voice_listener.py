"""The listener with everything around it scripted: a voice is a frame whose samples are 8000."""

import math
import threading

import pytest
from voice_script import BUTTON, VOICE, WAKE, Refuses, Script, Stt, Vad, Wake, spoken

from edgevox.core.bus import Bus
from edgevox.core.commands import Heard, Interrupt, SpokenOver, Transcribing
from edgevox.core.errors import EdgeVoxError
from edgevox.core.events import AudioLevel, Cause, WakeWordHeard
from edgevox.voice.audio import FRAME_S
from edgevox.voice.listener import Listener
from edgevox.voice.utterance_end import ONSET_FRAMES


@pytest.fixture
def listen():
    running = []

    def run(
        stt,
        *steps,
        wakeword=None,
        audible=lambda: 0.0,
        muted=lambda: False,
        said=None,
        **more,
    ):
        bus, said, events = Bus(), [] if said is None else said, []
        bus.subscribe(AudioLevel, events.append)
        bus.subscribe(WakeWordHeard, events.append)
        listener = Listener(
            Script(*steps),
            Vad(),
            stt,
            submit=said.append,
            bus=bus,
            language=lambda: "fr",
            muted=muted,
            audible=audible,
            wakeword=wakeword,
            is_stop=lambda text: "stop" in text,
            lossless=True,
            **more,
        )
        running.append(listener)
        listener.start()
        assert listener.wait_over(60)
        return said, events, listener

    yield run
    for listener in running:
        listener.close()


def words(said):
    return [command.text for command in said if isinstance(command, Heard)]


def test_what_is_said_is_understood_in_the_language_of_now(listen):
    stt = Stt("bonjour")

    said, _, _ = listen(stt, *[0] * 10, *spoken())

    assert [type(command) for command in said] == [Transcribing, Heard]
    assert said[1].text == "bonjour"
    assert said[1].ended_s == pytest.approx(30 * FRAME_S)
    assert stt.languages == ["fr"]


def test_two_utterances_are_told_in_turns(listen):
    said, _, _ = listen(Stt("one", "two"), *spoken(), *spoken())

    assert [type(command) for command in said] == [Transcribing, Heard] * 2
    assert words(said) == ["one", "two"]


def test_speech_that_the_end_of_the_file_cuts_is_understood(listen):
    said, _, _ = listen(Stt("half a"), *spoken(after=0))

    assert words(said) == ["half a"]


def test_noise_gives_empty_words(listen):
    said, _, _ = listen(Stt(""), *spoken())

    assert words(said) == [""]


@pytest.mark.parametrize("error", [EdgeVoxError("no model of this language"), RuntimeError("bug")])
def test_a_failing_speech_to_text_gives_empty_words_and_goes_on(listen, error, caplog):
    said, _, _ = listen(Stt(error, "again"), *spoken(), *spoken())

    assert words(said) == ["", "again"]
    assert "speech_to_text" in caplog.text


def test_while_muted_nothing_is_heard_and_no_level_is_told(listen):
    muted = threading.Event()

    said, events, _ = listen(
        Stt(), *[VOICE] * 10, muted.set, *spoken(), muted.clear, *[0] * 30, muted=muted.is_set
    )

    assert words(said) == []
    assert len([e for e in events if e.level > 0]) == 10 // 3


def test_the_level_is_told_ten_times_a_second(listen):
    _, events, _ = listen(Stt(), *[16384] * 3, *[0] * 28)

    assert len(events) == 10
    assert events[0].level == pytest.approx(0.5)


BARGE_IN = Interrupt("spoken over", motion=False, cause=Cause.BARGE_IN)


def test_short_speech_over_the_robot_holds_it_until_its_words_are_known(listen):
    said, _, _ = listen(Stt("mm-hm"), *[0] * 10, *spoken(), audible=lambda: 0.1)

    assert [type(command) for command in said] == [SpokenOver, Transcribing, Heard]
    assert said[-1].over


def test_longer_speech_over_the_robot_interrupts_it_before_its_words_are_known(listen):
    said, _, _ = listen(Stt("wait"), *[0] * 10, *spoken(50), audible=lambda: 0.1)

    assert said[:3] == [SpokenOver(), BARGE_IN, Transcribing()]
    assert not said[-1].over


def test_speech_beside_its_silence_holds_nothing(listen):
    said, _, _ = listen(Stt("hello"), *[0] * 10, *spoken())

    assert not said[-1].over
    assert SpokenOver() not in said


def test_who_holds_the_talk_button_interrupts_at_once(listen):
    said, _, _ = listen(Stt("mm-hm"), *[BUTTON] * 20, *[0] * 30, audible=lambda: 0.1)

    assert said[0] == BARGE_IN
    assert not said[-1].over


def test_who_is_muted_while_speaking_over_the_robot_has_interrupted_it(listen):
    muted = threading.Event()

    said, _, _ = listen(
        Stt(), *[VOICE] * 10, muted.set, *spoken(), audible=lambda: 0.1, muted=muted.is_set
    )

    assert said == [SpokenOver(), BARGE_IN]


def test_the_robot_is_held_with_the_first_frames_of_the_voice(listen):
    source = Script(*[0] * 10, *spoken(100))
    said_at = []
    listener = Listener(
        source,
        Vad(),
        Stt("wait"),
        submit=lambda command: said_at.append((type(command), source.count)),
        bus=Bus(),
        language=lambda: "en",
        muted=lambda: False,
        audible=lambda: 0.1,
    )
    listener.start()
    assert listener.wait_over(60)
    listener.close()

    assert said_at[0] == (SpokenOver, 10 + ONSET_FRAMES)
    assert ONSET_FRAMES * FRAME_S <= 0.2


def test_the_robots_own_voice_does_not_interrupt_it(listen):
    said, _, _ = listen(Stt(), *spoken(), audible=lambda: 0.5)

    assert said == []


def test_without_the_gate_the_robots_own_voice_does(listen):
    said, _, _ = listen(Stt("itself"), *spoken(50), audible=lambda: 0.5, echo="none")

    assert BARGE_IN in said


def test_with_a_wake_word_only_what_follows_it_in_the_same_breath_is_taken(listen):
    stt = Stt("we had lunch", "Hey Jarvis, go to the kitchen.")

    said, events, _ = listen(stt, *spoken(), *[VOICE] * 30, WAKE, *spoken(40), wakeword=Wake())

    assert words(said) == ["go to the kitchen."]
    assert WakeWordHeard("hey jarvis") in events


def test_after_the_wake_word_alone_the_next_utterance_is_taken_and_then_no_other(listen):
    stt = Stt("go to the kitchen", "we had lunch")

    said, _, _ = listen(stt, *[VOICE] * 20, WAKE, *[0] * 30, *spoken(), *spoken(), wakeword=Wake())

    assert words(said) == ["go to the kitchen"]


def test_the_wake_word_is_forgotten_after_a_while(listen):
    said, _, _ = listen(
        Stt("we had lunch"), *[VOICE] * 20, WAKE, *[0] * 300, *spoken(), wakeword=Wake()
    )

    assert words(said) == []


class Answers:
    """Awaits an answer all the time, and takes "yes"."""

    begun = 0

    def begins(self):
        self.begun += 1

    def awaits(self, began_s, ended_s):
        return began_s < ended_s

    def asked(self, ended_s):
        return True

    def takes(self, heard):
        return heard.text == "yes"


ADDRESSED = [*[VOICE] * 20, WAKE, *spoken()]


@pytest.mark.parametrize(
    ("words_then", "level", "counts"),
    [("yes", VOICE, True), ("we had lunch", VOICE, False), ("yes", VOICE // 2 - 1, False)],
)
def test_an_answer_by_the_same_person_needs_no_wake_word(listen, words_then, level, counts):
    stt = Stt("hey jarvis, go to the kitchen", words_then)

    said, _, _ = listen(
        stt,
        *[2 * one for one in ADDRESSED[:20]],
        *ADDRESSED[20:21],
        *[2 * one for one in ADDRESSED[21:]],
        *[2 * level] * 20,
        *[0] * 60,
        wakeword=Wake(),
        follow_up=Answers(),
    )

    assert words(said) == ["go to the kitchen"] + [words_then] * counts


def test_a_longer_sentence_may_follow_only_while_one_is_awaited(listen):
    long = spoken(100, after=60)

    said, _, _ = listen(
        Stt("hey jarvis, go", "yes"), *ADDRESSED, *long, wakeword=Wake(), follow_up=Answers()
    )
    assert words(said) == ["go", "yes"]

    said, _, _ = listen(Stt("hey jarvis, go"), *ADDRESSED, *long, wakeword=Wake())
    assert words(said) == ["go"]


def test_nothing_follows_before_anybody_spoke_to_it(listen):
    answers = Answers()
    said, _, _ = listen(Stt("yes"), *spoken(), wakeword=Wake(), follow_up=answers)
    assert answers.begun == 1

    assert words(said) == []


def test_a_stop_without_the_wake_word_is_heard(listen):
    said, _, _ = listen(Stt("no, stop!"), *spoken(), wakeword=Wake())

    assert said == [Heard("no, stop!", said[0].ended_s, said[0].stt_s, began_s=said[0].began_s)]


def test_long_talk_without_the_wake_word_is_not_even_looked_into(listen):
    stt = Stt()

    said, _, _ = listen(stt, *spoken(100), wakeword=Wake())

    assert said == []
    assert stt.heard == []


def test_with_a_wake_word_talk_does_not_interrupt_the_robot_but_the_wake_word_does(listen):
    said, _, _ = listen(
        Stt("lunch", "stop it"),
        *spoken(),
        WAKE,
        *spoken(),
        wakeword=Wake(),
        audible=lambda: 0.1,
    )

    interrupts = [c for c in said if isinstance(c, Interrupt)]
    assert interrupts[0] == Interrupt("heard the wake word", motion=False, cause=Cause.WAKE_WORD)


def test_a_frame_that_fails_is_survived_and_counted(listen, caplog):
    stt = Stt("after")

    class Fragile(Vad):
        calls = 0

        def probability(self, samples):
            self.calls += 1
            if self.calls == 3:
                raise RuntimeError("once")
            return super().probability(samples)

    bus, said = Bus(), []
    listener = Listener(
        Script(*[0] * 5, *spoken()),
        Fragile(),
        stt,
        submit=said.append,
        bus=bus,
        language=lambda: "en",
        muted=lambda: False,
        audible=lambda: 0.0,
        lossless=True,
    )
    listener.start()
    assert listener.wait_over(60)
    listener.close()

    assert words(said) == ["after"]
    assert listener.failed == 1
    assert "frame_unheard" in caplog.text


def test_closing_leaves_no_thread(listen):
    _, _, listener = listen(Stt("x"), *spoken())

    listener.close()

    assert not [
        t.name
        for t in threading.enumerate()
        if t.name in ("edgevox-listener", "edgevox-transcription")
    ]


class Watched(Stt):
    """Tells when it has begun to transcribe."""

    def __init__(self, *texts):
        super().__init__(*texts)
        self.begun = threading.Event()

    def transcribe(self, samples, language):
        self.begun.set()
        return super().transcribe(samples, language)


def test_words_are_found_out_while_the_silence_lasts_and_only_once(listen):
    stt = Watched("hello")
    early = []

    def in_the_silence():
        assert stt.begun.wait(60)
        early.append(True)

    said, _, _ = listen(stt, *[VOICE] * 20, *[0] * 10, in_the_silence, *[0] * 20)

    assert early
    assert words(said) == ["hello"]
    assert len(stt.heard) == 1


def test_who_speaks_on_after_a_pause_is_understood_whole(listen):
    stt = Watched("go to", "go to the kitchen")

    def in_the_silence():
        assert stt.begun.wait(60)

    said, _, _ = listen(stt, *[VOICE] * 20, *[0] * 10, in_the_silence, *spoken())

    assert words(said) == ["go to the kitchen"]
    assert stt.heard[1].size > stt.heard[0].size


def test_that_somebody_spoke_is_told_at_the_end_of_speech_not_of_the_guess(listen):
    told, begun = threading.Event(), threading.Event()

    class Slow(Stt):
        def transcribe(self, samples, language):
            begun.set()
            assert told.wait(60), "transcribing is told only after the words are known"
            return super().transcribe(samples, language)

    class Said(list):
        def append(self, command):
            super().append(command)
            if isinstance(command, Transcribing):
                told.set()

    def in_the_silence():
        assert begun.wait(60)

    steps = [*[VOICE] * 20, *[0] * 10, in_the_silence, *[0] * 20]
    said, _, _ = listen(Slow("hello"), *steps, said=Said())

    assert [type(command) for command in said] == [Transcribing, Heard]


def test_whoever_breaks_on_words_hears_what_is_said_next(listen, caplog):
    said, _, listener = listen(Stt("first", "second"), *spoken(), *spoken(), said=Refuses(Heard))

    assert words(said) == ["second"]
    assert listener.alive
    assert "command_untaken" in caplog.text


def test_whoever_breaks_on_hearing_that_somebody_spoke_still_gets_the_words(listen, caplog):
    said, _, listener = listen(Stt("stop"), *spoken(after=0), said=Refuses(Transcribing))

    assert [type(command) for command in said] == [Heard]
    assert listener.alive
    assert "command_untaken" in caplog.text


def test_and_gets_them_if_they_were_being_found_out_already(listen, caplog):
    said = Refuses(Transcribing)
    begun = threading.Event()

    class Slow(Stt):
        def transcribe(self, samples, language):
            begun.set()
            assert said.broke.wait(60)
            return super().transcribe(samples, language)

    def in_the_silence():
        assert begun.wait(60)

    listen(Slow("stop"), *[VOICE] * 20, *[0] * 10, in_the_silence, *[0] * 20, said=said)

    assert words(said) == ["stop"]
    assert "command_untaken" in caplog.text


def test_a_word_that_cannot_be_told_costs_no_utterance(listen, caplog):
    said, _, _ = listen(Stt("wait"), *spoken(), audible=lambda: 0.1, said=Refuses(SpokenOver))

    assert words(said) == ["wait"]
    assert "command_untaken" in caplog.text


def test_how_well_an_utterance_is_heard_is_told_before_its_words_are_known(listen):
    told = []

    class Slow(Stt):
        def transcribe(self, samples, language):
            assert told, "before anybody looks for words"
            return super().transcribe(samples, language)

    listen(Slow("yes"), *[80] * 40, *spoken(), follow_up=Answers(), on_utterance=told.append)

    assert all(one.began_s == pytest.approx(40 * FRAME_S) for one in told)
    assert told[-1].ended_s == pytest.approx(60 * FRAME_S)
    assert told[-1].stands_out_db == pytest.approx(20 * math.log10(VOICE / 80), abs=0.5)
    assert told[-1].woken_s is None
    assert told[-1].asked


def test_speech_without_the_wake_word_is_claimed_only_if_it_may_be_an_answer(listen):
    told = []

    listen(
        Stt("we had lunch", "go"), *spoken(), *ADDRESSED, wakeword=Wake(), on_utterance=told.append
    )

    assert told
    assert all(one.woken_s == pytest.approx(71 * FRAME_S) for one in told)
