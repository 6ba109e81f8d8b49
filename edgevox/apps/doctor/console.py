"""The console's check: whether it can listen, which hosts reach it, and its certificate."""

import errno
import http.client
import os
import socket
import ssl
from datetime import UTC, datetime
from importlib.util import find_spec

from edgevox.apps.doctor.check import CheckVerdict, Facts, Situation, error, ok, skipped, warning
from edgevox.apps.health import reachable
from edgevox.core.errors import install_extra
from edgevox.core.settings import Settings

MODULES = ("aiohttp", "cryptography")
SOON_DAYS = 14
ANSWER_S = 3.0


def probe_console(situation: Situation) -> Facts:
    """Find the state of the console, if it is on."""
    settings = situation.settings
    if not settings.serves_console:
        return {"on": False}
    missing = [name for name in MODULES if find_spec(name) is None]
    if missing:
        return {"on": True, "missing": missing}
    from edgevox.console.console_server import is_loopback

    return {
        "on": True,
        "missing": [],
        "address": f"{settings.console_host}:{settings.console_port}",
        "listens": _why_not(settings.console_host, settings.console_port),
        "answers": _answers(settings),
        "loopback": is_loopback(settings.console_host),
        "tls": settings.console_tls,
        "certificate": _certificate(settings),
    }


def judge_console(facts: Facts, _: Situation) -> CheckVerdict | list[CheckVerdict]:
    """A console that cannot be reached, or that anybody can read along with, is told."""
    if not facts["on"]:
        return skipped("off", "--console, or EDGEVOX_CONSOLE=true (docs/console.md)")
    if facts["missing"]:
        return error(f"no {' and no '.join(facts['missing'])}", install_extra("console"))
    return [_judge_address(facts), *_judge_certificate(facts)]


def _judge_address(facts: Facts) -> CheckVerdict:
    address, why = facts["address"], facts["listens"]
    if why == os.strerror(errno.EADDRINUSE):
        if facts["answers"]:
            return ok(f"{address}: a console that runs answers there")
        return warning(
            f"{address} is taken, and no console answers there",
            "end the program that uses it, or set EDGEVOX_CONSOLE_PORT",
        )
    if why:
        return error(f"{address}: {why}", "set EDGEVOX_CONSOLE_HOST and EDGEVOX_CONSOLE_PORT")
    if facts["loopback"]:
        return ok(f"{address}: this machine only", "EDGEVOX_CONSOLE_HOST=0.0.0.0 lets phones in")
    if facts["tls"] == "off":
        return warning(
            f"{address} without encryption",
            "anyone on the network can take it over",
        )
    return ok(f"{address}: open to anyone with a code")


def _judge_certificate(facts: Facts) -> list[CheckVerdict]:
    found = facts["certificate"]
    if not found:
        return []
    if wrong := found.get("wrong"):
        return [error(wrong, "EDGEVOX_CONSOLE_CERTIFICATE and EDGEVOX_CONSOLE_KEY: files in PEM")]
    days = found["days"]
    said = f"certificate for {', '.join(found['names'])}, good for {days} days"
    if days < 0:
        return [error(said, "renew it: browsers reject it")]
    return [warning(said, "renew it") if days < SOON_DAYS else ok(said)]


def _why_not(host: str, port: int) -> str:
    """Return the reason why a console could not listen there; empty if it could."""
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        socket.create_server((host, port), family=family).close()
    except OSError as failed:
        known = failed.errno in errno.errorcode
        return os.strerror(failed.errno) if known and failed.errno else str(failed)
    return ""


def _answers(settings: Settings) -> bool:
    """Return whether a console answers there, whatever names its certificate has."""
    place = reachable(settings.console_host), settings.console_port
    if settings.console_tls == "off":
        asking = http.client.HTTPConnection(*place, timeout=ANSWER_S)
    else:
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
        context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
        asking = http.client.HTTPSConnection(*place, timeout=ANSWER_S, context=context)
    try:
        asking.request("GET", "/api/me")
        return asking.getresponse().status == http.client.UNAUTHORIZED
    except (OSError, http.client.HTTPException):
        return False
    finally:
        asking.close()


def _certificate(settings: Settings) -> Facts:
    """Return the names and remaining days of a site's certificate, or its fault."""
    certificate, secret = settings.console_certificate, settings.console_key
    if settings.console_tls != "files":
        return {}
    if not certificate or not secret:
        return {"wrong": "EDGEVOX_CONSOLE_TLS=files without both files"}
    from cryptography import x509
    from cryptography.hazmat.primitives.serialization import load_pem_private_key

    try:
        leaf = x509.load_pem_x509_certificate(certificate.expanduser().read_bytes())
        key = load_pem_private_key(secret.expanduser().read_bytes(), password=None)
    except OSError as failed:
        return {"wrong": f"{failed.filename}: {failed.strerror}"}
    except (ValueError, TypeError) as failed:
        return {"wrong": f"certificate or key: {failed}"}
    if key.public_key() != leaf.public_key():
        return {"wrong": "the key is that of another certificate"}
    try:
        names = leaf.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    except x509.ExtensionNotFound:
        return {"wrong": "the certificate has no names that browsers look at (subjectAltName)"}
    said = [str(one.value) for one in names]
    return {"names": said, "days": (leaf.not_valid_after_utc - datetime.now(UTC)).days}
