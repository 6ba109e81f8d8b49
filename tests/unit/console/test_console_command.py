"""`edgevox-console`, and how the settings become a console."""

from pathlib import Path

import pytest

from edgevox.apps.console_command import main
from edgevox.apps.folders import console_folder
from edgevox.console.certificates import console_url
from edgevox.console.console_server import is_loopback, open_console, tls_of
from edgevox.console.context import ConsoleContext
from edgevox.console.sessions import Pairing, Role, Sessions
from edgevox.core.bus import Bus
from edgevox.core.controls import Controls
from edgevox.core.errors import InvalidValue
from edgevox.core.motion.interlock import Interlock
from edgevox.core.settings import Settings, check_settings
from tests.console_rig import NotedStop


def test_a_code_is_made_that_lets_in_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["--console-folder", str(tmp_path), "pair", "--viewer"]) == 0
    told = capsys.readouterr().out
    code = told.partition("#pair=")[2].partition("\n")[0]
    assert "https://127.0.0.1:8443/#pair=" in told
    pairing = Pairing(tmp_path)
    assert [pairing.redeem(code), pairing.redeem(code)] == [Role.VIEWER, None]


def test_who_is_in_is_listed_and_shown_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sessions = Sessions(tmp_path)
    one, cookie = sessions.begin(Role.OPERATOR, "Firefox Android", "10.0.0.7")
    two, _ = sessions.begin(Role.VIEWER, "Safari iPhone", "10.0.0.8")
    folder = ["--console-folder", str(tmp_path)]
    assert main([*folder, "list"]) == 0
    listed = capsys.readouterr().out
    assert one.id in listed
    assert "Safari iPhone" in listed
    assert cookie.partition(".")[2] not in listed
    assert main([*folder, "revoke", one.id]) == 0
    assert sessions.of_cookie(cookie) is None
    assert sessions.all() == [two]
    assert main([*folder, "revoke", one.id]) == 2
    assert main([*folder, "revoke", "--all"]) == 0
    assert sessions.all() == []


def test_the_authority_is_printed_without_its_key_and_made_anew_when_asked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = ["--console-folder", str(tmp_path), "ca"]
    told = [main(folder), main(folder), main([*folder, "--new"])]
    assert told == [0, 0, 0]
    shown = capsys.readouterr().out.split("-----BEGIN CERTIFICATE-----")[1:]
    assert shown[0] == shown[1] != shown[2]
    assert "PRIVATE" not in "".join(shown)


@pytest.mark.parametrize(
    ("given", "field"),
    [
        ({"console_tls": "off", "console_host": "192.168.1.7"}, "console_tls"),
        ({"console_tls": "off", "console_host": "robot.local"}, "console_tls"),
        ({"console_tls": "files"}, "console_tls"),
        ({"console_names": "not a name é"}, "console_names"),
    ],
)
def test_what_would_not_be_safe_is_refused(
    tmp_path: Path, given: dict[str, object], field: str
) -> None:
    with pytest.raises(InvalidValue) as refused:
        tls_of(check_settings(given), tmp_path)
    assert refused.value.field == field


@pytest.mark.parametrize(
    "given",
    [{"console_tls": "off"}, {"console_tls": "off", "console_host": "::", "console_plain": True}],
)
def test_plain_is_for_loopback_or_where_it_is_asked_for(
    tmp_path: Path, given: dict[str, object]
) -> None:
    assert tls_of(check_settings(given), tmp_path) is None


def test_a_port_that_is_taken_and_a_bad_certificate_name_their_settings(tmp_path: Path) -> None:
    bus, interlock = Bus(), Interlock()
    controls = Controls(bus, language="en", voices=lambda _: ())
    context = ConsoleContext(
        "robot", bus, interlock, print, controls, NotedStop(interlock), lambda _: {}, dict,
    )  # fmt: skip
    bad = tmp_path / "bad.pem"
    bad.write_text("nothing")
    files = {"console_tls": "files", "console_certificate": bad, "console_key": bad}
    with pytest.raises(InvalidValue, match="console_certificate"):
        open_console(context, check_settings(files), tmp_path)


def test_the_folder_is_the_settings_or_among_the_users_state(tmp_path: Path) -> None:
    assert console_folder(check_settings({"console_folder": tmp_path})) == tmp_path
    state = console_folder(Settings(), {"XDG_STATE_HOME": "/state"})
    assert state == Path("/state/edgevox/console")


def test_loopback_is_known() -> None:
    assert [is_loopback(one) for one in ("127.0.0.2", "::1", "localhost", "::")] == [
        True, True, True, False,
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("host", "names", "shown"),
    [
        ("127.0.0.1", "robot.local", "127.0.0.1"),
        ("0.0.0.0", "robot.local, 10.0.0.7", "robot.local"),  # noqa: S104
        ("::", "fd00::7", "[fd00::7]"),
    ],
)
def test_the_address_has_the_first_name_where_it_listens_everywhere(
    host: str, names: str, shown: str
) -> None:
    assert console_url(host, 8443, True, names) == f"https://{shown}:8443"
