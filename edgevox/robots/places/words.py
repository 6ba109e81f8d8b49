"""What people say of places that a robot is to remember: hassil templates and examples by skill.

A template matches whole sentences; an example is what no template catches and a model learns from.
What may be any name stands behind words that nobody says otherwise; behind "this is" only what the
phrasebooks know as places.
"""

from edgevox.agent.skills import Example

_PLEASE = "[hey] [robot] [please|now] [(could|can|would|will) you [please]|I (want|need) you to]"
_KEEP = "(remember|save|store|memorise|memorize|learn)"
_HERE = "(this|the) (place|spot|point|position|location|corner|room|area)"
_MY = "(the|my|our|your)"
_END = "[now|please|from now on]"
_DROP = "(forget|delete|remove|erase)"
_PLACES = "(places|locations|spots|rooms)"
_KNOWN = "[[that] you (know|remember)] [please]"

REMEMBER = (
    f"{_PLEASE} {_KEEP} ({_HERE}|here|where you are) as [the|a|my|our] {{name}} {_END}",
    f"{_PLEASE} ({_KEEP}|mark|note) (this|{_HERE}) as [the|a|my|our] {{place:name}} {_END}",
    f"{_PLEASE} (call|name) {_HERE} [the|a|my|our] {{name}} {_END}",
    f"{_PLEASE} (call|name) this {_MY} {{name}} {_END}",
    f"{_HERE} is (called|named) [the|my|our] {{name}} {_END}",
    f"({_HERE}|this|here) is {_MY} {{place:name}} {_END}",
)
REMEMBER_EXAMPLES = (
    Example("learn that this spot is where we keep the bikes", {"name": "bike stand"}),
    Example("keep in mind, right here is our sample shelf", {"name": "sample shelf"}),
)

FORGET = (
    f"{_PLEASE} {_DROP} [about] [the (place|spot|location)] [called] [the|my|our] {{room}} {_END}",
    f"{_PLEASE} {_DROP} [the] {{room}} from your (memory|places|map) {_END}",
)

LIST = (
    f"[please] [tell me] (which|what) {_PLACES} (do you|can you|you) (know|remember|have) {_END}",
    f"[please] [tell me] (which|what) {_PLACES} can you (go|drive) to {_END}",
    f"[please] (list|name|show me|tell me) [all] [of] (the|your) {_PLACES} {_KNOWN}",
    "where can you (go|drive) [to]",
)
LIST_EXAMPLES = (Example("have you got a list of places in your head?"),)
