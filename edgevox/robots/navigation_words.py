"""What people say to a robot that can drive somewhere: hassil templates and examples by skill.

A template matches whole sentences; an example is what no template catches and a model learns from.
"""

from edgevox.agent.skills import Example

_PLEASE = (
    "[hey] [robot] [please|now] "
    "[(could|can|would|will) you [please]|I (want|need|would like) you to|you (should|have to)]"
)
_MOVE = (
    "(go|drive|head|move|come|run|roll|travel|navigate|proceed|get|walk|return) "
    "[on|over|back|straight|quickly|slowly]"
)
_BRING = "(take|bring|drive|guide|lead) (me|us|yourself)"
_TO = "(to|into|toward|towards|in to|inside)"
_END = "[now|please|right now|for me|again]"
_POINT = "[the] [point|position|coordinates|location]"
_METRES = "[meters|metres|meter|metre|m]"
_IS = "[is|equals]"
_AND = "[and|comma]"

_X = f"x {_IS} {{x}} {_METRES}"
_Y = f"y {_IS} {{y}} {_METRES}"
_HALT = "(stop|halt|freeze|wait|stand still|hold on|stay|cancel|abort) [moving|driving|it|that]"
_AT_ONCE = "[now|right now|there|here|right there|please|immediately|at once]"
_POSITION = "(position|location|pose|place|coordinates|whereabouts)"
_TELL = "(what is|what's|how is|how's|check|tell me|give me|report|say|show)"
_POWER = "(battery|charge|power|energy)"

TO_ROOM = (
    f"{_PLEASE} {_MOVE} {_TO} [the] {{room}} {_END}",
    f"{_PLEASE} {_BRING} {_TO} [the] {{room}} {_END}",
    f"{_PLEASE} (visit|enter|look into|check on) [the] {{room}} {_END}",
    "(let's|let us) (go|drive|head|move) [over|back] (to|into) [the] {room} [now|please|again]",
    "(meet me|wait for me|I need you|come and see me|be) in [the] {room} [now|please]",
    "off to [the] {room} [you go|with you|now|please]",
)

TO_POINT = (
    f"{_PLEASE} {_MOVE} [to] {_POINT} {_X} {_AND} {_Y} {_END}",
    f"{_PLEASE} {_MOVE} to {_POINT} {{x}} {_AND} {{y}} {_END}",
)
TO_POINT_EXAMPLES = (
    Example("stand at two metres right and three metres up", {"x": 2.0, "y": 3.0}),
    Example("I want to see you at x 1.5 and y 4", {"x": 1.5, "y": 4.0}),
    Example("coordinates 6, 2, quickly", {"x": 6.0, "y": 2.0}),
    Example("park yourself where x is 4 and y is 1", {"x": 4.0, "y": 1.0}),
)

STOP = (
    f"{_PLEASE} {_HALT} {_AT_ONCE}",
    f"{_PLEASE} (stay|wait|stop|hold it) (where you are|right there|there|here) [please]",
    "(do not|don't) move [please|any more|any further]",
)
STOP_EXAMPLES = (
    Example("that is far enough"),
    Example("I changed my mind, never mind the drive"),
    Example("not so fast, stand still for a moment"),
    Example("leave it, do not go any further"),
)

WHERE = (
    "[please] [(tell|show) me] where (are you|you are) [right now|now|at the moment|at] [please]",
    "where have you (got to|gone)",
    f"{_TELL} your [current] {_POSITION} [now|please]",
    "[tell me] [in] (which|what) room (are you|you are) [in] [right now|now]",
)
WHERE_EXAMPLES = (
    Example("have you got lost?"),
    Example("I cannot see you, what place have you reached?"),
    Example("how far have you come?"),
    Example("what are your x and y?"),
)

BATTERY = (
    f"{_TELL} (your|the) [current] {_POWER} [level|charge|status|state|percentage] [now|please]",
    f"how (much|many percent) [of] [your] {_POWER} (do you have|have you got|is) [left]",
    "how (full|charged|empty|low) (is your battery|are you)",
    "battery [level|charge|status|percentage]",
    "do you (need (to charge|charging|power)|have enough (battery|power|charge)) [left]",
)
BATTERY_EXAMPLES = (
    Example("how long can you still drive?"),
    Example("are you running out of juice?"),
    Example("do we have to plug you in soon?"),
    Example("are you still full of energy?"),
)
