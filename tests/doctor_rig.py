"""What the doctor's tests share: the levels, and a machine of which something is asked."""

from edgevox.apps.doctor.check import CheckVerdict, Situation
from edgevox.core.settings import check_settings
from edgevox.core.status import Level

OK, SKIPPED, WARNING, ERROR = Level.OK, Level.STALE, Level.WARN, Level.ERROR


def situation(agent="", refused="", environment=None, **settings):
    given = check_settings(settings)
    return Situation(given, environment or {}, agent, refused=refused)


def levels(said):
    return [one.level for one in ([said] if isinstance(said, CheckVerdict) else said)]
