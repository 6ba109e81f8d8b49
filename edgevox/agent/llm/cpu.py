"""What the processor of this machine can do, as ``/proc/cpuinfo`` says; psutil does not tell."""

import platform
from pathlib import Path

XLLAMACPP_NEEDS = frozenset({"avx2", "fma", "f16c", "bmi2"})
"""Its wheel for x86-64 is built for these; without them the process would end without a word."""


def missing_features(needed: frozenset[str], cpuinfo: str | None = None) -> frozenset[str]:
    """Those of an x86-64 processor's features that are not there; none where that is not known.

    `cpuinfo` is what stands in ``/proc/cpuinfo``.
    """
    if cpuinfo is None:
        if platform.machine() != "x86_64":
            return frozenset()
        try:
            cpuinfo = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
        except OSError:
            return frozenset()
    for line in cpuinfo.splitlines():
        name, _, flags = line.partition(":")
        if name.strip() == "flags":
            return needed - set(flags.split())
    return frozenset()
