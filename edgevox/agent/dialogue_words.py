"""What people say about the conversation itself: hassil templates, in English.

Other languages have theirs in the table `dialogue` of their phrasebooks.
"""

_ROBOT = "[hey] [robot] [please] [(can|could) you] [tell me]"
_NOW = "[right now|now|just now|at the moment|there|here] [please]"
_ASK = "[please|now|and|then]"
_END = "[please|now]"

DOING = (
    f"{_ROBOT} what (are you|you are) (doing|up to|busy with|working on) {_NOW}",
    f"{_ROBOT} what is your (task|goal|job) {_NOW}",
    f"{_ROBOT} are you (busy|doing (something|anything)) {_NOW}",
)
WHY = (
    (
        f"{_ROBOT} why (did you|you did|have you|are you) "
        "(do|done|doing|go|gone|going|drive|driven|driving|walk|walked|walking|turn|turned|turning|"
        "move|moved|moving|come|take|taken|taking) [to] [that|this|it|there|here|away|back]"
    ),
    f"{_ROBOT} what made you (do|go) (that|this|it|there|here)",
    f"{_ROBOT} who (told|asked) you [to (do|go) (that|this|it|there|here)|that]",
)
HEARD = (
    f"{_ROBOT} what (did you|you) (hear|heard|understand|understood) [me say|last] {_NOW}",
    f"{_ROBOT} what did I [just] (say|ask|ask you|ask for|tell you) [last] {_NOW}",
    f"{_ROBOT} what have I [just] (said|asked|told you) {_NOW}",
    f"{_ROBOT} did you hear (me|that|what I said)",
)
CAN = (
    f"{_ROBOT} what (can you|you can|are you able to) do [here|for me|for us|now] [please]",
    f"{_ROBOT} what are your (skills|abilities|commands)",
    f"{_ROBOT} what can I (say|ask|ask you|ask for|ask you for|tell you|tell you to do) [here]",
    "[please] (list|tell me|name) your (skills|abilities|commands) [please]",
)

AGAIN = (
    f"{_ASK} (again|once more|once again|1 more time|the same again|same again) {_END}",
    f"{_ASK} do (that|it|this|the same) (again|once more|once again|1 more time) {_END}",
    f"{_ASK} repeat [that|it|this] [once more|1 more time|again] {_END}",
)
BACK = (
    f"{_ASK} (go|drive|come|head|move|get|travel) back [there|again] {_END}",
    (
        f"{_ASK} (go|drive|come|head|move|get|travel|return|back) [back] "
        f"[to] where you (were|were before|came from|started|have been) [before] {_END}"
    ),
)
FURTHER = (
    f"{_ASK} (further|farther|a (bit|little) [bit] (more|further|farther)|some more) {_END}",
    f"{_ASK} (go|walk|turn|move) (a (bit|little)|on a bit) (more|further|farther) {_END}",
    f"{_ASK} ((go|walk|turn|move) (further|farther)|keep going|carry on) {_END}",
)
OTHER = (
    (
        f"{_ASK} [take|get|grab|pick|pick up|use|go to|drive to|to|in|into] the other "
        f"(one|1|room|place|cube|block|bin|box) [too|as well|also|instead] {_END}"
    ),
)
ALSO = (
    f"[and|now|then] [also] [the] {{value}} (too|as well|also) {_END}",
    f"[and|now] also [the] {{value}} {_END}",
    f"[and|now|do] [do] the same (with|for|to) [the] {{value}} {_END}",
)
