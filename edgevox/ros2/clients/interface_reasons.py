"""Why an interface of the robot did not do what was asked, in the languages of the robot."""

from edgevox.agent.reasons import in_words
from edgevox.core.language_files import CODES, language_file
from edgevox.core.reason import Reason


def interface_reason(code: str, *, what: str) -> Reason:
    """The reason of this code; `what` is the interface, by its name.

    A language whose file lacks it says it in English.
    """
    tables = {one: language_file(one).get("interfaces", {}) for one in CODES}
    sentences = {one: table[code] for one, table in tables.items() if code in table}
    values = {"what": what.strip("~/").replace("_", " ").replace("/", " ")}
    return Reason(in_words(sentences["en"], values), code, values, sentences)
