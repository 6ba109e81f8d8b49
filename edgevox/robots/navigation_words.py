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
_STROLL = (
    "(amble|bob|buzz|coast|cruise|dart|dash|dawdle|drift|duck|glide|goto|hasten|hop|hurry|hustle|"
    "journey|jog|jump|land|make|march|meander|mosey|nip|pass|patrol|plod|pop|push|race|roam|rush|"
    "sail|saunter|scamper|scoot|scurry|scuttle|set|shift|shoot|shuffle|skip|slide|slip|sneak|speed|"
    "spin|sprint|start|step|stroll|swing|tootle|toddle|trot|trundle|tour|turn|wander|wheel|whizz|"
    "wind|zip|zoom)"
)
_ALONG = "[yourself] [on|over|back|along|off|out|down|up|across|round|around|through|by|your way]"
_THERE = "(to|into|toward|towards|in to|inside|in|for|by|past|via|at)"
_BRING = (
    "(take|bring|drive|guide|lead|get|move|steer|wheel|roll|drag|haul|send|dispatch) "
    "(me|us|yourself|your self|your wheels|your base|the base)"
)
_WANTED = "(wanted|needed|required|expected|missed|due)"
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
_POSITION = (
    "(position|location|pose|place|coordinates|whereabouts|x and y|fix|waypoint|"
    "position on the map|coordinates on the map|present position|exact position|exact location)"
)
_TELL = (
    "(what is|what's|what are|how is|how's|check|tell (me|us)|give (me|us)|report|say|state|show|"
    "confirm|log|print|let me know|read out|share|send)"
)
_POWER = "(battery|charge|power|energy)"

TO_ROOM = (
    (
        f"{_PLEASE} (({_MOVE}|{_BRING}) {_TO}|{_STROLL} {_ALONG} {_THERE}|"
        f"(set (off|out|sail|course)|make (your way|tracks)|be off) {_TO}|"
        f"(get|haul|move|plant|park) your (self|wheels|backside|bum) {_THERE}|"
        "visit|enter|look into|look in on|check on|reach|check out|"
        "(do|make) (a|the) (round|rounds|tour) of|(start|begin|finish|end) (with|in|at)) "
        f"[the] {{room}} {_END}"
    ),
    "(let's|let us) (go|drive|head|move) [over|back] (to|into) [the] {room} [now|please|again]",
    (
        "(meet me|join (me|us)|find (me|us)|wait for (me|us)|I (need|want) you|"
        f"come and see (me|us)|be|report|show up|appear) {_THERE} [the] {{room}} [now|please]"
    ),
    (
        f"(you are|you're|your presence is) {_WANTED} [over|down|up|back] (in|at) "
        f"[the] {{room}} {_END}"
    ),
    "[to] [the] {room} (next|with you|now please|please now|at once|right away|right now|pronto)",
    "(destination|target|waypoint|goal|navigation goal) [is] [the] {room}",
    "off to [the] {room} [you go|with you|now|please]",
)

_GO_TO = f"({_MOVE} to|{_BRING} to|{_STROLL} {_ALONG} to|[map] (coordinates|waypoint|destination))"
TO_POINT = (
    f"{_PLEASE} {_MOVE} [to] {_POINT} {_X} {_AND} {_Y} {_END}",
    f"{_PLEASE} {_GO_TO} [map] {_POINT} ({_X} {_AND} {_Y}|{{x}} {_AND} {{y}}) {_END}",
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
    "[tell me] [in|at] (which|what) (part|spot|place|point|end) (are you|you are) [in|at] [now]",
    "where (abouts|on earth|exactly|in the world|the hell) are you [now]",
    "whereabouts are you [now]",
    "where (did|do) you (go|get to|wander off to|stand|find yourself) [now]",
    "where are you (hiding|parked|standing|located|these days)",
    "[please] (tell|let) (me|us) [know] where you (are|have got to|have gone|got to) [now|please]",
    "where (are we|have you landed|did you end up|did they put you) [now]",
)
WHERE_EXAMPLES = (
    Example("have you got lost?"),
    Example("I cannot see you, what place have you reached?"),
    Example("how far have you come?"),
    Example("what is your x and y on the map?"),
)

BATTERY = (
    f"{_TELL} (your|the) [current] {_POWER} [level|charge|status|state|percentage] [now|please]",
    f"how (much|many percent) [of] [your] {_POWER} (do you have|have you got|is) [left]",
    "how (full|charged|empty|low) (is your battery|are you)",
    "how much (juice|power|energy|charge|battery) (is|have you got|do you have|remains) [left]",
    "how long (can you|will you|before you) (last|go|run|keep going) [on this charge|for] [now]",
    "how is your (juice|battery|charge|energy|power) [doing|holding up|looking|level|levels]",
    "(are you|is your battery) [fully|still|nearly|almost] (charged|full|empty|low|flat|dead)",
    "(are you|is the battery) (running low|running out|low on power|out of juice|out of power)",
    "[tell me] [what] (percent|percentage|level) (is|are) (your battery|you) [on|at]",
    "battery [level|charge|status|percentage|check|report|state|remaining|life]",
    "do you (need (to charge|charging|power)|have enough (battery|power|charge)) [left]",
)
BATTERY_EXAMPLES = (
    Example("how long can you still drive?"),
    Example("are you running out of juice?"),
    Example("do we have to plug you in soon?"),
    Example("are you still full of energy?"),
)
