"""The robot's own authority: browsers that took it believe the console, and nothing else of it."""

import asyncio
import ssl
from datetime import timedelta
from pathlib import Path

import aiohttp
import pytest

from edgevox.console import page_server
from edgevox.console.certificates import DAYS, RENEW_DAYS, CurrentTls, Tls, local_names, own_tls
from edgevox.console.console_server import tls_of
from edgevox.core.certificates import utc_now
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import check_settings
from tests.console_rig import console

NAMES = ("localhost", "robot.local", "127.0.0.1")


def test_a_browser_that_took_the_authority_believes_the_console(tmp_path: Path) -> None:
    tls = own_tls(tmp_path, NAMES)
    with console(tmp_path, tls) as rig:

        async def ask() -> bytes:
            assert tls.authority
            trusts = ssl.create_default_context(cafile=tls.authority)
            async with (
                aiohttp.ClientSession() as client,
                client.get(rig.server.url + "/ca.crt", ssl=trusts) as told,
            ):
                return await told.read()

        told = asyncio.run(ask())
    assert tls.authority
    assert told == tls.authority.read_bytes()
    assert b"PRIVATE" not in told


def test_how_to_trust_it_is_told_only_where_there_is_one(tmp_path: Path) -> None:
    async def status(url: str, trusts: ssl.SSLContext | bool) -> int:
        async with aiohttp.ClientSession() as client, client.get(f"{url}/ca", ssl=trusts) as told:
            return told.status

    tls = own_tls(tmp_path, NAMES)
    assert tls.authority
    with console(tmp_path, tls) as rig:
        trusts = ssl.create_default_context(cafile=tls.authority)
        assert asyncio.run(status(rig.server.url, trusts)) == 200
    with console(tmp_path) as rig:
        assert asyncio.run(status(rig.server.url, True)) == 404


def test_it_is_believed_by_nobody_else(tmp_path: Path) -> None:
    with console(tmp_path, own_tls(tmp_path, NAMES)) as rig:

        async def ask() -> None:
            async with aiohttp.ClientSession() as client, client.get(rig.server.url):
                pass

        with pytest.raises(aiohttp.ClientConnectorCertificateError):
            asyncio.run(ask())


def test_the_keys_are_the_robots_alone_and_stay(tmp_path: Path) -> None:
    first = own_tls(tmp_path, NAMES)
    kept = [(tmp_path / name).read_bytes() for name in ("ca.key", "console.key", "console.crt")]
    assert own_tls(tmp_path, NAMES) == first
    assert kept == [
        (tmp_path / name).read_bytes() for name in ("ca.key", "console.key", "console.crt")
    ]
    assert {(tmp_path / name).stat().st_mode & 0o777 for name in ("ca.key", "console.key")} == {
        0o600
    }


@pytest.mark.parametrize("days", [0, 390 - RENEW_DAYS + 1])
def test_a_certificate_is_made_anew_for_other_names_and_before_it_ends(
    tmp_path: Path, days: int
) -> None:
    tls = own_tls(tmp_path, NAMES)
    old, authority = tls.certificate.read_bytes(), (tmp_path / "ca.crt").read_bytes()
    names = NAMES if days else (*NAMES, "192.168.1.7")
    own_tls(tmp_path, names, lambda: utc_now() + timedelta(days=days))
    assert tls.certificate.read_bytes() != old
    assert (tmp_path / "ca.crt").read_bytes() == authority


@pytest.mark.parametrize("name", ["bank.example.com", "8.8.8.8"])
def test_the_authority_vouches_for_no_name_that_it_was_not_made_for(
    tmp_path: Path, name: str
) -> None:
    own_tls(tmp_path, NAMES)
    with pytest.raises(InvalidValue, match="console_names"):
        own_tls(tmp_path, (*NAMES, name))


def test_a_machine_that_has_another_name_by_now_keeps_its_authority(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    settings = check_settings({"console_tls": "own", "console_names": "robot.local"})
    monkeypatch.setattr("socket.gethostname", lambda: "a1b2c3")
    first = tls_of(settings, tmp_path)
    assert first
    assert first.authority
    kept = first.authority.read_bytes()
    monkeypatch.setattr("socket.gethostname", lambda: "d4e5f6")

    now = tls_of(settings, tmp_path)

    assert now
    assert CurrentTls(now).context
    assert first.authority.read_bytes() == kept


def test_this_machine_has_names_that_a_certificate_can_bear(tmp_path: Path) -> None:
    names = local_names(("robot.local",))
    assert {"localhost", "127.0.0.1", "robot.local"} <= set(names)
    assert own_tls(tmp_path, names).certificate.exists()


def test_over_tls_the_cookie_is_for_this_host_alone_and_a_stop_gets_through(
    tmp_path: Path,
) -> None:
    tls = own_tls(tmp_path, NAMES)
    with console(tmp_path, tls) as rig:

        async def press() -> str:
            assert tls.authority
            trusts = ssl.create_default_context(cafile=tls.authority)
            url, headers = rig.server.url, {"Origin": rig.server.url}
            code, _ = rig.server.offer_code()
            jar = aiohttp.CookieJar(unsafe=True)
            async with aiohttp.ClientSession(cookie_jar=jar) as client:
                async with client.post(
                    url + "/api/pair", json={"code": code.code}, headers=headers, ssl=trusts
                ) as told:
                    cookie = told.headers["Set-Cookie"]
                async with client.ws_connect(url + "/ws", headers=headers, ssl=trusts) as socket:
                    await socket.send_str('{"id": 1, "type": "stop"}')
                    assert await asyncio.to_thread(rig.stop.engaged.wait, 30)
            return cookie

        cookie = asyncio.run(press())
    assert cookie.startswith("__Host-edgevox=")
    assert "Secure" in cookie
    assert "Path=/" in cookie
    assert "Domain" not in cookie


async def _shown(port: int, tls: Tls) -> bytes:
    """The certificate that whoever comes now is shown."""
    trusts = ssl.create_default_context(cafile=tls.authority)
    _, writer = await asyncio.open_connection("127.0.0.1", port, ssl=trusts)
    shown: bytes = writer.get_extra_info("ssl_object").getpeercert(binary_form=True)
    writer.transport.abort()
    return shown


def test_it_is_renewed_while_it_runs_and_who_is_there_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(page_server, "RENEW_LOOK_S", 0.01)
    held = [utc_now() - timedelta(days=DAYS - RENEW_DAYS + 1)]
    tls = own_tls(tmp_path, NAMES, lambda: held[0])
    with console(tmp_path, tls) as rig:

        async def stay() -> None:
            url = rig.server.url
            headers = {"Origin": url, "Cookie": f"__Host-edgevox={rig.cookie()['edgevox']}"}
            trusts = ssl.create_default_context(cafile=tls.authority)
            async with (
                aiohttp.ClientSession(headers=headers) as client,
                client.ws_connect(url + "/ws", ssl=trusts) as socket,
            ):
                old = await _shown(rig.server.port, tls)
                held[0] = utc_now()
                async with asyncio.timeout(30):
                    while await _shown(rig.server.port, tls) == old:
                        await asyncio.sleep(0.01)
                await socket.send_str('{"id": 1, "type": "stop"}')
                assert await asyncio.to_thread(rig.stop.engaged.wait, 30)

        asyncio.run(stay())


def test_files_that_do_not_fit_each_other_are_not_taken(tmp_path: Path) -> None:
    tls = own_tls(tmp_path / "one", NAMES)
    other = own_tls(tmp_path / "two", NAMES)
    current = CurrentTls(Tls(tls.certificate, tls.key))
    before = current.context
    tls.certificate.write_bytes(other.certificate.read_bytes())
    with pytest.raises(InvalidValue, match="console_certificate"):
        current.look()
    assert current.context is before
    tls.key.write_bytes(other.key.read_bytes())
    assert current.look()
    assert not current.look()
    assert current.context is not before


def test_an_authority_that_was_replaced_is_refused_at_a_renewal_and_stays(tmp_path: Path) -> None:
    tls = own_tls(tmp_path, NAMES)
    for kind in ("crt", "key"):
        (tmp_path / f"ca.{kind}").write_bytes((tmp_path / f"console.{kind}").read_bytes())
    put = (tmp_path / "ca.crt").read_bytes()
    with pytest.raises(InvalidValue, match="console_folder"):
        tls.renew()
    assert (tmp_path / "ca.crt").read_bytes() == put
