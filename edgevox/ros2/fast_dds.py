"""How Fast DDS, the usual middleware of ROS 2, is set up before a node of ours is made.

By itself it hands messages of the same machine over in shared memory, and throws away what is for
a process that has not looked for a second: frozen, or starved of the processor. The sender tries
again with its next heartbeat, up to 3 s later; for so long a "stop" was lost. So our nodes ask to
be written to by UDP: the kernel keeps what arrives until they look. They still write to others in
shared memory.
"""

import os
from collections.abc import MutableMapping
from pathlib import Path

PROFILE = Path(__file__).with_name("fast_dds.xml")
READ_BY_FAST_DDS = "FASTRTPS_DEFAULT_PROFILES_FILE"
"""The variable that the Fast DDS of ROS 2 Jazzy reads."""
GIVEN = "FASTDDS_DEFAULT_PROFILES_FILE"
"""Its name from Fast DDS 3 on, and in our reference: it counts here, too."""
TRANSPORTS = "FASTDDS_BUILTIN_TRANSPORTS"
_WITH_UDP = ("", "DEFAULT", "UDPv4")


def choose_profile(environment: MutableMapping[str, str] = os.environ) -> None:
    """Have the next nodes of this process made with our profile, or with the one somebody gave.

    Somebody who chose transports without plain UDP gets what they chose, and no profile of ours.
    Must be called before the first node is made; other middlewares do not look at it.
    """
    if environment.get(READ_BY_FAST_DDS):
        return
    if given := environment.get(GIVEN):
        environment[READ_BY_FAST_DDS] = given
    elif environment.get(TRANSPORTS, "") in _WITH_UDP:
        environment[READ_BY_FAST_DDS] = str(PROFILE)
