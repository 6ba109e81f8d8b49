"""Not hearing oneself: what a microphone hears of the robot's own voice is no speech.

Half duplex with a measured threshold: while the robot speaks, a frame counts only if it is louder,
by a margin, than the echo of what plays now. How much of it comes back (the coupling, from about
-6 dB for a loudspeaker beside the microphone to -30 dB across a room) is learnt as it speaks; the
first guess is the loudest. So a person near the microphone, or who raises their voice, interrupts
it, and it never answers itself.

Why not an echo canceller: it needs the very samples that the loudspeaker plays, in step with its
clock, which only a sound card of this machine could give (a ROS 2 speaker, a file or another
process cannot), and the packages that bring one are not kept (``pyaec``, ``speexdsp``,
``webrtc-audio-processing``), build from source with a compiler (``aec-audio-processing``) or bring
a whole conferencing client (``livekit``). Where full duplex is wanted, let the sound server do it,
which has both signals: PipeWire's or PulseAudio's ``module-echo-cancel`` makes a default
microphone of it, and `echo` is then ``none``.
"""

from collections import deque
from collections.abc import Callable

from edgevox.voice.audio import FRAME_S, Samples
from edgevox.voice.level import rms

TAIL_S = 0.25
"""The echo goes on for so long after the sound: the delay of sound card and room."""
MARGIN = 2.5
"""8 dB: by so much a voice must exceed the echo that is expected. With 6 dB the robot interrupted
itself 6 times in 18 simulated rooms, with 8 dB never."""
LOUDEST = 0.5
"""-6 dB: the coupling that is assumed before it has been heard."""
WEAKEST = 0.02
"""-34 dB: the least coupling that is believed; below it the room's own noise is measured."""
LEARNS_FROM = 0.7
"""Only what plays at least so loud, relative to the loudest of late, tells the coupling: where it
plays quietly, the echo of the louder sound before and the room's noise are heard."""
FALLS_S = 1.0
RISES_S = 0.2
"""How fast a weaker and a stronger coupling are learnt, as time constants."""
RISES_THROUGH_S = 1.0
"""The same for sound that passes the gate: it is probably a person's."""
LOUD_S = 5.0
"""The loudest of late is forgotten with this time constant."""
OPEN_S = 0.13
"""After a frame that passed, the next ones pass too: a voice dips between syllables."""


class EchoGate:
    """Decides for each frame whether it may be somebody else's voice.

    `audible` says how loud the robot plays now, root mean square. With `shut` False all passes.
    """

    def __init__(self, audible: Callable[[], float], *, shut: bool = True) -> None:
        self._audible = audible
        self._shut = shut
        self._played: deque[float] = deque(maxlen=round(TAIL_S / FRAME_S))
        self._loudest = 0.0
        self._open = 0
        self.coupling = LOUDEST

    @property
    def playing(self) -> bool:
        """Whether the robot, or its echo, may be audible."""
        return any(self._played)

    def passes(self, samples: Samples) -> bool:
        """Take the next frame; False if it may be echo."""
        self._played.append(self._audible())
        played = max(self._played)
        self._open = max(0, self._open - 1)
        if not played or not self._shut:
            return True
        heard = rms(samples)
        through = heard > MARGIN * self.coupling * played
        self._loudest = max(played, self._loudest * (1 - FRAME_S / LOUD_S))
        if played >= LEARNS_FROM * self._loudest:
            self._learn(min(heard / played, 1.0), through)
        if through:
            self._open = round(OPEN_S / FRAME_S)
        return through or self._open > 0

    def _learn(self, ratio: float, through: bool) -> None:
        rises_s = RISES_THROUGH_S if through else RISES_S
        constant_s = FALLS_S if ratio < self.coupling else rises_s
        learnt = self.coupling + FRAME_S / constant_s * (ratio - self.coupling)
        self.coupling = max(WEAKEST, learnt)
