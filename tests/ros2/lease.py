"""When the middleware gives up a process that was killed: after the lease that this one asked for.

Fast DDS asks for 20 s by itself. A process that a test kills asks for less, and all else about its
end is the same: the others learn of it by the same clock of theirs, only sooner.
"""

from pathlib import Path

SHORT_LEASE = {"FASTRTPS_DEFAULT_PROFILES_FILE": str(Path(__file__).with_name("short_lease.xml"))}
"""The environment of a process that will be killed."""
LEASE_S = 4.0
