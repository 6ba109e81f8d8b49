"""What the policy permits, line by line, and whether its file can be read."""

from edgevox.agent.policy.explain import explain
from edgevox.agent.policy.format import read_policy_file
from edgevox.agent.policy.policy import local_time
from edgevox.agent.policy.policy_status import NO_FILE
from edgevox.apps.doctor.check import CheckVerdict, Facts, Situation, error, ok, warning
from edgevox.apps.policy_setup import known_names
from edgevox.core.errors import InvalidValue


def probe_policy(situation: Situation) -> Facts:
    """The policy in words, or why it cannot be read."""
    file = situation.settings.policy
    if file is None:
        return {"lines": None}
    try:
        policy = read_policy_file(file)
    except InvalidValue as wrong:
        return {"lines": None, "wrong": str(wrong)}
    closed = str(policy.limits.closed(local_time()))
    return {
        "lines": explain(policy),
        "unknown": sorted(policy.skills - known_names(())),
        "now": f"{local_time():%a %H:%M %Z}" if policy.limits.hours else "",
        "closed": closed,
    }


def judge_policy(facts: Facts, _: Situation) -> CheckVerdict | list[CheckVerdict]:
    """A broken file is an error: an agent does not start with it."""
    if wrong := facts.get("wrong"):
        return error(wrong, "correct it: with it no agent starts, and one that runs keeps the old")
    if facts["lines"] is None:
        return ok(f"{NO_FILE}, by every way in")
    said = [ok(line) for line in facts["lines"]]
    if facts["now"]:
        said.append(ok(f"it is {facts['now']}: it may {'not ' if facts['closed'] else ''}move"))
    if unknown := facts["unknown"]:
        found = f"no robot that comes with EdgeVox has the skill {', '.join(unknown)}"
        said.append(warning(found, "correct it, unless a robot of your own has it"))
    return said
