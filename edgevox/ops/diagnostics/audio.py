"""The component `audio`: microphone and loudspeaker."""

from dataclasses import dataclass

from edgevox.ops.diagnostics.component import Component, Finding, Level, component


@dataclass(frozen=True, slots=True)
class Sound:
    """What is known of hearing and speaking. `ears` and `mouth` say what ails their threads.

    A trouble is why a device cannot be used; it is tried again by itself. `losing` is whether
    frames were dropped of late, `dropped` how many ever were.
    """

    source: str
    sink: str
    source_trouble: str = ""
    sink_trouble: str = ""
    ears: str = ""
    mouth: str = ""
    level: float | None = None
    muted: bool = False
    dropped: int = 0
    losing: bool = False


def audio(seen: Sound) -> Component:
    """A device that was asked for and is not there is an error, lost frames are a warning."""
    found = [
        Finding(Level.ERROR, f"{what}: {said}")
        for what, said in (
            ("ears", seen.ears),
            ("mouth", seen.mouth),
            ("microphone", seen.source_trouble),
            ("loudspeaker", seen.sink_trouble),
        )
        if said
    ]
    if seen.losing:
        found.append(Finding(Level.WARN, f"frames are dropped unheard, {seen.dropped} by now"))
    return component(
        "audio",
        found,
        well="muted" if seen.muted else "hears and speaks",
        source=seen.source,
        source_state="retrying" if seen.source_trouble else "open",
        sink=seen.sink,
        sink_state="retrying" if seen.sink_trouble else "open",
        level=seen.level,
        muted=seen.muted,
        dropped_frames=seen.dropped,
    )
