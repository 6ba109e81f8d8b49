"""What the doctor's tests share: the grades, and a machine of which something is asked."""

from edgevox.apps.doctor.verdict import Grade, Situation, Verdict
from edgevox.core.settings import check_settings

OK, SKIPPED, WARNING, ERROR = Grade


def situation(agent="", refused="", environment=None, **settings):
    given = check_settings(settings)
    return Situation(given, environment or {}, agent, refused=refused)


def grades(said):
    return [one.grade for one in ([said] if isinstance(said, Verdict) else said)]
