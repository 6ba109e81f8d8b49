"""What microphones hear of what is said: in rooms, by microphones of some colour, in noise.

In PyTorch and of many at once, where the training is: processors are busy with what is said.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch.nn.functional import interpolate
from torch.nn.utils.rnn import pad_sequence

from edgevox.voice.audio import FULL_SCALE, RATE_HZ
from training.acoustics import Half
from training.acoustics.noises import noise
from training.acoustics.rooms import rooms

ROOMS = 60
LEVEL_DB = (-42, -12)
"""How loud the voice is, of full scale."""
QUIET_DB = (-90, -60)
"""How loud noise is of full scale where it is quiet."""
CUT_SHARE, CUT_SAMPLES = 0.3, (400, 3000)
"""Of so many rooms only the beginning is left."""
TWICE_SHARE, CHANGES_SHARE, BACKWARDS_SHARE = 0.15, 0.3, 0.3
"""So often there is a second noise, and a noise changes its loudness, and is heard backwards."""
_PIECE, _VOICED = RATE_HZ // 50, 10**-2.5
_NOTHING = 1e-9


@dataclass(frozen=True, slots=True)
class Place:
    """Which share is heard in a room and which in quiet; else voices are so many dB above noise."""

    room_share: float
    quiet_share: float
    snr_db: tuple[float, float]


def noise_to_train(kinds: Sequence[str], seconds: float, seed: int, number: int) -> torch.Tensor:
    """The noise of this number, (samples,), of each kind in turn."""
    kind = kinds[number % len(kinds)]
    return torch.from_numpy(noise(kind, seconds, seed + number, Half.TRAIN)).float()


def as_samples(sounds: torch.Tensor) -> torch.Tensor:
    """As a microphone gives them: int16, clipped; full scale is 1."""
    return (FULL_SCALE * sounds).clamp(-FULL_SCALE, FULL_SCALE - 1).to(torch.int16)


class Surroundings:
    """Puts what is said into one of these noises (noises, samples), and a share into rooms to train
    with. What it draws follows PyTorch's own seed.
    """

    def __init__(self, place: Place, noises: torch.Tensor) -> None:
        self._place, self._noises, self._on = place, noises, noises.device
        responses = [torch.from_numpy(room.response()).float() for room in rooms(Half.TRAIN, ROOMS)]
        here = torch.ones(1)  # no room
        self._responses = pad_sequence([here, *responses], batch_first=True).to(self._on)

    @torch.no_grad()
    def heard(self, tracks: torch.Tensor) -> torch.Tensor:
        """What microphones hear of these tracks (tracks, samples), whatever their loudness: as
        long as they are, int16. Of silence only noise is heard.
        """
        many = len(tracks)
        level = 10 ** (self._between(*LEVEL_DB, many) / 20)
        speech = self._elsewhere(tracks.float())
        speech = speech * (level / (_voiced_power(speech) + _NOTHING).sqrt())[:, None]
        quiet = 10 ** (self._between(*QUIET_DB, many) / 20)
        above = level / 10 ** (self._between(*self._place.snr_db, many) / 20)
        rustle = torch.where(self._some(self._place.quiet_share, many), quiet, above)
        second = self._some(TWICE_SHARE, many) * self._between(0.3, 1, many)
        noise = self._noise(*tracks.shape) + second[:, None] * self._noise(*tracks.shape)
        return as_samples(speech + rustle[:, None] * noise)

    def _elsewhere(self, tracks: torch.Tensor) -> torch.Tensor:
        samples = tracks.shape[1]
        size = 1 << (samples + self._responses.shape[1]).bit_length()
        response = torch.fft.rfft(self._response(len(tracks)), size)
        spectrum = torch.fft.rfft(tracks, size) * response * self._colour(len(tracks), size)
        return torch.fft.irfft(spectrum, size)[:, :samples]

    def _response(self, many: int) -> torch.Tensor:
        """That of a room, of which now and then only the beginning is left, or of none."""
        which = torch.randint(1, len(self._responses), (many,), device=self._on)
        found = self._responses[which * self._some(self._place.room_share, many)]
        at = torch.arange(found.shape[1], device=self._on)
        fading = torch.exp(-at / self._between(*CUT_SAMPLES, many)[:, None])
        found = torch.where(self._some(CUT_SHARE, many)[:, None], found * fading, found)
        return found / found.square().sum(1, keepdim=True).sqrt()

    def _colour(self, many: int, size: int) -> torch.Tensor:
        """A tilt and a hump, as microphones and mouths differ."""
        hertz = torch.fft.rfftfreq(size, 1 / RATE_HZ, device=self._on)
        octaves = (hertz.clamp(min=60) / 1000).log2()
        tilt, high, at = (
            self._between(*some, many)[:, None] for some in ((-3, 3), (-6, 6), (-2, 3))
        )
        hump = high * torch.exp(-(((octaves - at) / 0.7) ** 2))
        return 10 ** ((tilt * octaves + hump) / 20)

    def _noise(self, many: int, samples: int) -> torch.Tensor:
        """Some of them, from somewhere, now and then with a change of loudness."""
        which = torch.randint(len(self._noises), (many, 1), device=self._on)
        first = torch.randint(self._noises.shape[1] - samples, (many, 1), device=self._on)
        at = torch.arange(samples, device=self._on).expand(many, -1)
        backwards = self._some(BACKWARDS_SHARE, many)[:, None]
        found = self._noises[which, first + torch.where(backwards, at.flip(1), at)]
        points = 10 ** (self._between(-10, 4, many * 5).view(many, 1, 5) / 20)
        changing = interpolate(points, samples, mode="linear", align_corners=True)[:, 0]
        return torch.where(self._some(CHANGES_SHARE, many)[:, None], found * changing, found)

    def _between(self, least: float, most: float, many: int) -> torch.Tensor:
        return torch.empty(many, device=self._on).uniform_(least, most)

    def _some(self, share: float, many: int) -> torch.Tensor:
        return torch.rand(many, device=self._on) < share


def _voiced_power(sounds: torch.Tensor) -> torch.Tensor:
    """What `acoustics.mixing.voiced_power` finds in each of these (sounds, samples)."""
    power = sounds.unfold(1, _PIECE, _PIECE).square().mean(2)
    voiced = power >= power.amax(1, keepdim=True) * _VOICED
    return (power * voiced).sum(1) / voiced.sum(1)
