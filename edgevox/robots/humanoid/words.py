"""What people say to a robot that walks: hassil templates and examples by skill.

A template matches whole sentences; an example is what no template catches and a model learns from.
"""

from edgevox.agent.skills import Example

_PLEASE = (
    "[hey] [robot] [please|now] "
    "[(could|can|would|will) you [please]|I (want|need|would like) you to|you (should|have to)]"
)
_END = "[now|please|right now|for me|again]"
_WALK = (
    "(walk|go|move|step|come|march|head|run|pace|stride|stroll|shuffle|trot|jog|proceed|travel|"
    "advance|edge|inch|hop|plod|scoot|get|take yourself|take it|bring yourself|move yourself) "
    "[on|over|straight|slowly|carefully]"
)
_AHEAD = (
    "(forward|forwards|ahead|straight ahead|straight on|straight|onward|onwards|further forward|"
    "towards me|closer|nearer)"
)
_TO_THE_FRONT = "(to me|in front|to the front|up)"
_BACK = "(backward|backwards|back|in reverse|rearward|rearwards)"
_TO_THE_REAR = "(behind|to the rear|away from me)"
_BY = "[by|for|about|another|a distance of]"
_METRES = "(meters|metres|meter|metre|m)"
_A_METRE = "[[by] (a|another|one) (meter|metre)]"
_TURN = (
    "(turn|rotate|spin|pivot|swing|swivel|yaw|twist|veer|revolve|wheel|angle|twirl|turning|swing) "
    "[yourself] [around|round]"
)
_LEFT = (
    "[to|on|toward|towards] [the|your] (left|counterclockwise|counter clockwise|anticlockwise|"
    "left hand side|left side)"
)
_RIGHT = "[to|on|toward|towards] [the|your] (right|clockwise|right hand side|right side)"
_DEGREES = "(degrees|degree|°)"
_TELL = (
    "(what is|what's|what are|tell (me|us)|give (me|us)|report|say|state|show|"
    "let me know|print|log)"
)
_POSITION = "(position|location|pose|place|coordinates|whereabouts|heading|orientation)"
_HALT = "(stop|halt|freeze|wait|hold on|cancel|abort) [moving|walking|turning|it|that]"
_AT_ONCE = "[now|right now|there|here|right there|please|immediately|at once]"

_RETREAT = "(back up|back off|back away|retreat|reverse|withdraw)"


def _walking(way: str, far: str) -> tuple[str, ...]:
    return (
        f"{_PLEASE} {_WALK} {way} {_BY} {{distance}} {_METRES} {_END}",
        f"{_PLEASE} {_WALK} {_BY} {{distance}} {_METRES} [to the] {way} {_END}",
        f"{_PLEASE} {_WALK} {way} {_A_METRE} {_END}",
        f"{_PLEASE} {_WALK} (a|another) (meter|metre) {way} {_END}",
        f"{_PLEASE} {_WALK} {far} {_BY} {{distance}} {_METRES} {_END}",
        f"{_PLEASE} {_WALK} {_BY} {{distance}} {_METRES} {far} {_END}",
    )


def _turning(way: str) -> tuple[str, ...]:
    return (
        f"{_PLEASE} {_TURN} {way} [by|about|another] {{degrees}} {_DEGREES} {_END}",
        f"{_PLEASE} {_TURN} [by|about|another] {{degrees}} {_DEGREES} {way} {_END}",
        f"{_PLEASE} {_TURN} {way} {_END}",
        f"{_PLEASE} (make|take|do) a {way} [turn] {_END}",
        f"{_PLEASE} (face|look) {way} {_END}",
        f"[another|make it|about] {{degrees}} {_DEGREES} to (the|your) {way} {_END}",
        f"{way} [by|about|another] {{degrees}} {_DEGREES} {_END}",
    )


FORWARD = (
    *_walking(_AHEAD, _TO_THE_FRONT),
    f"{_PLEASE} (walk|march|step) {{distance}} {_METRES} {_END}",
    f"{_PLEASE} advance {_BY} {{distance}} {_METRES} {_END}",
    f"[another|about] {{distance}} {_METRES} [further] (forward|forwards) {_END}",
    f"(forward|forwards) {_BY} {{distance}} {_METRES} {_END}",
)
FORWARD_EXAMPLES = (
    Example("come two metres closer to me", {"distance": 2.0}),
    Example("I would like you three metres further up", {"distance": 3.0}),
    Example("take two steps forward", {"distance": 0.8}),
    Example("keep going straight, a metre and a half will do", {"distance": 1.5}),
)

BACKWARD = (
    *_walking(_BACK, _TO_THE_REAR),
    f"{_PLEASE} {_RETREAT} {_BY} {{distance}} {_METRES} {_END}",
    f"[another|about] {{distance}} {_METRES} (backward|backwards) {_END}",
    f"(backward|backwards) {_BY} {{distance}} {_METRES} {_END}",
    f"{_PLEASE} {_RETREAT} {_END}",
)
BACKWARD_EXAMPLES = (
    Example("give me two metres of space", {"distance": 2.0}),
    Example("you are too close, half a metre away from me please", {"distance": 0.5}),
    Example("take one step back", {"distance": 0.4}),
    Example("in reverse please, for three metres", {"distance": 3.0}),
)

LEFT = _turning(_LEFT)
LEFT_EXAMPLES = (
    Example("what is on your left side? look there", {"degrees": 90.0}),
    Example("a bit more to the left, 20 degrees or so", {"degrees": 20.0}),
    Example("45 degrees counterclockwise, my friend", {"degrees": 45.0}),
    Example("go once full circle to your left", {"degrees": 360.0}),
)

RIGHT = _turning(_RIGHT)
RIGHT_EXAMPLES = (
    Example("the window is on your right, face it", {"degrees": 90.0}),
    Example("slightly to the right, 15 degrees", {"degrees": 15.0}),
    Example("60 degrees clockwise, quickly", {"degrees": 60.0}),
    Example("make half a circle to your right", {"degrees": 180.0}),
)

AROUND = (
    f"{_PLEASE} (turn|spin|swing|face) (around|round|about) {_END}",
    f"{_PLEASE} (turn|face|look) (the other way|backwards|back) [around|round] {_END}",
    f"{_PLEASE} (make|do|take) [a] (0.5|half|u|you) [-] turn {_END}",
    f"{_PLEASE} {_TURN} [by] 180 [degrees] [around|round] {_END}",
    f"{_PLEASE} (do|make|take|pull) [a|an] (180|about turn|about face) {_END}",
    f"180 [degrees] (turn|round|around|turn round|turn around) {_END}",
    f"[a] 0.5 [-] (turn|rotation|circle) {_END}",
    f"{_PLEASE} (face|look|turn to) [in] the (opposite|other) (way|direction|side) {_END}",
    f"{_PLEASE} (show me your back|turn your back|look behind you|reverse direction) {_END}",
    "(right about|about) (face|turn) [now|please]",
)
AROUND_EXAMPLES = (
    Example("reverse your direction"),
    Example("look the other way, behind you"),
    Example("you are facing the wrong way"),
)

STAND = (
    f"{_PLEASE} (stand|get|rise) [back] up [again] {_END}",
    f"{_PLEASE} (get|get back|stand|be) on your feet [again] {_END}",
    f"[back] [up] on your (feet|legs) [again] {_END}",
    f"[up] (up you get|up you come|upsy daisy|get up|rise) {_END}",
    f"{_PLEASE} (pick|get) yourself [back] up [again] {_END}",
    f"{_PLEASE} stand [up] [still|straight|upright|tall|there|here] {_END}",
    f"{_PLEASE} (straighten|come) [yourself] up [straight|right] {_END}",
    f"{_PLEASE} (stay|keep) standing {_END}",
)
STAND_EXAMPLES = (
    Example("you fell over, up you go"),
    Example("do not lie there, rise and shine"),
    Example("just remain upright for a moment"),
    Example("on your feet, soldier"),
)

STOP = (
    f"{_PLEASE} {_HALT} {_AT_ONCE}",
    f"{_PLEASE} (stay|wait|stop|hold it) (where you are|right there|there|here) [please]",
    "(do not|don't) move [please|any more|any further]",
)
STOP_EXAMPLES = (
    Example("that is far enough"),
    Example("not so fast, not one step more"),
    Example("I changed my mind, do not go on"),
)

WHERE = (
    "[please] [(tell|show) me] where (are you|you are) [right now|now|at the moment|at] [please]",
    f"{_TELL} your [current] {_POSITION} [now|please]",
    "(which|what) (way|direction) are you (facing|looking) [now]",
    "how far have you (walked|gone|come)",
    "(did|have) you (fall|fell|fallen|tip|tipped|topple|toppled|trip) [over|down]",
    "are you [still] (standing|ok|okay|on your feet)",
    "where (are you|did you|do you) (standing|stand|end up|finish|walk to) [now]",
    "[tell me] (your|the) [current] (x and y|heading|orientation|pose)",
    "whereabouts are you [now]",
)
WHERE_EXAMPLES = (
    Example("have you got lost?"),
    Example("still on your feet, are you?"),
    Example("what are your x and y?"),
)
