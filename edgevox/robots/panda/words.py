"""What people say to an arm at a table: hassil templates and examples by skill.

A template matches whole sentences; an example is what no template catches and a model learns from.
"""

from edgevox.agent.skills import Example

_PLEASE = (
    "[hey] [robot] [please|now] "
    "[(could|can|would|will) you [please]|I (want|need|would like) you to|you (should|have to)]"
)
_END = "[now|please|right now|for me|again]"
_METRES = "[meters|metres|meter|metre|m]"
_IS = "[is|equals]"
_AND = "[and|comma]"
_THE = "[the|a|that|this]"
_HAND = "[(your|the)] (hand|gripper|fingers|claw)"
_YOUR_HAND = "(your|the) (hand|gripper|arm|end effector|fingers)"

GRASP = (
    (
        f"{_PLEASE} (pick up|pick|grab|grasp|take|get|lift|lift up|fetch|hold|seize|grip|clutch|"
        "snatch|collect|nab|scoop up|retrieve|clasp|clamp|raise|catch|get ahold of|pinch|hoist) "
        f"[hold of|up|on to|onto] {_THE} {{object}} {_END}"
    ),
    (
        f"{_PLEASE} (pick up|take|grab|hold) {_THE} {{object}} "
        f"(in|with) your (hand|gripper|claw) {_END}"
    ),
    f"{_PLEASE} (get|wrap|close) your (claw|hand|gripper|fingers) (around|round|on) {{object}}",
    f"{_PLEASE} (pick|lift|take) {_THE} {{object}} up {_END}",
)
GRASP_EXAMPLES = (
    Example("could I see the red cube from closer?", {"object": "red_cube"}),
    Example("that blue thing there, lift it for me", {"object": "blue_cube"}),
    Example("I would like to have the green block in the air", {"object": "green_cube"}),
)

_PUT = (
    "(put|place|drop|set|lay|move|bring|stack|stick|throw|deliver|carry|pop|chuck|bung|shove|stash|"
    "deposit|shift|transfer|dump|toss|slide|rest|plonk|sling|lob|tuck|slip|plop|insert|tip|"
    "store|park|sit|position|balance|pile|return|release|file|sort|toss|fling|bin|pitch|hand)"
)
_INTO = "(in|into|inside|inside of|on|onto|on top of|over|to|in to|on to|at)"
_ONTO = "(in|into|inside|on|onto|on top of)"
PLACE = (
    f"{_PLEASE} {_PUT} {_THE} {{object}} [down|back] {_INTO} [the] {{target}} {_END}",
    f"{_PLEASE} (put|set|lay|place) {_THE} {{object}} (down|back|aside|away) {_END}",
    f"{_PLEASE} (put|set|lay) (down|back) {_THE} {{object}} {_END}",
    f"(I|we) (want|would like|need) {_THE} {{object}} {_ONTO} [the] {{target}} {_END}",
)
PLACE_EXAMPLES = (
    Example("tidy the red cube away to the left", {"object": "red_cube", "target": "left_bin"}),
    Example(
        "the blue one belongs in the bin on the right",
        {"object": "blue_cube", "target": "right_bin"},
    ),
    Example("build a tower: green over red", {"object": "green_cube", "target": "red_cube"}),
    Example("leave what you hold in the left box", {"object": "it", "target": "left_bin"}),
)

RELEASE = (
    f"{_PLEASE} open {_HAND} {_END}",
    f"{_PLEASE} (let go|let it go|let go of it|release|release it|drop it|ungrip|let loose) {_END}",
    f"{_PLEASE} (loosen|relax|undo|free|unclench|unclamp) your (grip|grasp|fingers|hand) {_END}",
    f"{_PLEASE} (let it loose|set it free) {_END}",
    f"[would you|do you] mind letting (go|it go|go of it|go of that) {_END}",
    f"{_PLEASE} (unclench|spread|part|widen) [your|the] (hand|gripper|fingers|claw|jaws) {_END}",
    "(hand|gripper|claw|jaws|fingers) (open|wide|apart)",
    (
        f"{_PLEASE} (let go of|release|drop) (the|that|this) "
        f"[red|green|blue] (cube|block|object|thing|one) {_END}"
    ),
)
RELEASE_EXAMPLES = (
    Example("you can stop holding that"),
    Example("give it to me, loosen your grip"),
)

HOME = (
    (
        f"{_PLEASE} (go|move|return|come|drive|get) [back] [to] [the|your] "
        f"(home|home position|ready position|start position|rest position|starting position) {_END}"
    ),
    f"{_PLEASE} (go|move|get) (back to rest|to rest|out of the way) {_END}",
    (
        f"{_PLEASE} (go|move|return|bring|drive|send|park|retract|command|retreat|fold|reset) "
        "[your|the] [arm|hand|gripper|claw|yourself] [back] [to|at|in] [the|your|its] [home] "
        "(home|rest|parking|neutral|starting|ready|default|initial) "
        f"[position|pose|configuration|state|posture|place] {_END}"
    ),
    f"[arm|hand|gripper] home [position|pose] {_END}",
    f"(homing|home) [the|your] (arm|yourself) {_END}",
)
HOME_EXAMPLES = (
    Example("fold yourself back to where you began"),
    Example("make room, I want to get at the table"),
)

_X = f"x {_IS} {{x}} {_METRES}"
_Y = f"y {_IS} {{y}} {_METRES}"
_Z = f"z {_IS} {{z}} {_METRES}"
_GO = (
    f"(go|move|reach|travel|come) [{_YOUR_HAND}] [over|up|down|out|yourself] "
    "[to] [the] [point|position|coordinates|location]"
)
_BRING_HAND = (
    "(position|bring|drive|send|move|set|steer|guide|raise|lower|hover|swing) "
    "[your|the] [hand|gripper|arm|end effector|fingers|claw|tcp|tool|tip|fingertips]"
)
_POINT = "[the|that] [point|position|coordinates|location]"
MOVE = (
    f"{_PLEASE} {_GO} {_X} {_AND} {_Y} {_AND} {_Z} {_END}",
    f"{_PLEASE} {_GO} {{x}} {_AND} {{y}} {_AND} {{z}} {_METRES} {_END}",
    f"{_PLEASE} {_BRING_HAND} [to|at|over] {_POINT} {_X} {_AND} {_Y} {_AND} {_Z} {_END}",
    f"{_PLEASE} {_BRING_HAND} [to|at|over] {_POINT} {{x}} {_AND} {{y}} {_AND} {{z}} {_END}",
)
MOVE_EXAMPLES = (
    Example("I want your fingertips at x 0.5, y 0.2, z 0.4", {"x": 0.5, "y": 0.2, "z": 0.4}),
    Example("at 0.4 0 0.3, hover", {"x": 0.4, "y": 0.0, "z": 0.3}),
)

_HALT = "(stop|halt|freeze|wait|hold still|hold on|stay|cancel|abort) [moving|it|that]"
STOP = (
    f"{_PLEASE} {_HALT} [now|right now|there|here|right there|please|immediately|at once]",
    "(do not|don't) move [please|any more|any further]",
)
STOP_EXAMPLES = (
    Example("that is far enough"),
    Example("I changed my mind, never mind the cube"),
)

_TELL = (
    "(what is|what's|what are|tell (me|us)|give (me|us)|report|say|state|show|"
    "let me know|print|log)"
)
WHERE = (
    f"[please] [(tell|show) me] where (is|are) {_YOUR_HAND} [right now|now|at the moment] [please]",
    "[please] [tell me] where are you [right now|now|at the moment|at] [please]",
    f"{_TELL} (your|the) [current] [hand|gripper|arm] (position|pose|coordinates|location) [now]",
    "[tell me] what (are you holding|do you hold|is in your hand|have you got) [now|right now]",
    (
        "(have you got|do you have|are you holding|are you carrying|is there|are you gripping) "
        "(anything|something|a cube|a block) "
        "[still] [in|between] [your|the] [hand|gripper|claw|fingers|grip|grasp]"
    ),
    "is your (hand|gripper|claw) (empty|full)",
    "whereabouts (is|are) {_YOUR_HAND} [now]".replace("{_YOUR_HAND}", _YOUR_HAND),
)
WHERE_EXAMPLES = (
    Example("how high are your fingers?"),
    Example("have you still got something in your grip?"),
)

LIST = (
    "[please] [tell me] what (do|can) you see [now|there|here|on the table|in front of you]",
    "[please] [tell me] what (is|lies|have you got) on [the|your] table [now]",
    (
        "[please] [tell me] (what|which) (objects|things|cubes|blocks) (are there|do you see|"
        "can you see|do you know|are on the table|are in front of you)"
    ),
    (
        "[please] (list|describe|name|show me|tell me about) [all|all of] [the] "
        "(objects|things|cubes|blocks|scene|table)"
    ),
    "[please] [tell me] where are the (objects|things|cubes|blocks) [now]",
    "what (have we|have you|do we|do you) (got|have) (on|there on) [the|your] table [now]",
    (
        "(which|what|how many) (cubes|blocks|objects|things|items) "
        "(do you|can you|have you) (have|got)"
    ),
    "what is (there|lying|sitting|left|around) [on] [the|your] [table|desk|bench|worktop] [now]",
    "what is (in front of|before|around) you [now]",
    "how many (cubes|blocks|objects|things) are (there|on the table|left) [now]",
    "[please] (look at|scan|inspect|survey) the (table|desk|scene|bench) [now]",
)
LIST_EXAMPLES = (
    Example("is there anything on the desk?"),
    Example("has the green cube been sorted already?"),
)
