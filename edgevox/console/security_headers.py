"""What every answer tells the browser to forbid, and whether a request comes from the own page."""

from urllib.parse import urlsplit

from aiohttp import web

_POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self' blob: data:",
        "connect-src 'self'",
        "media-src 'self' blob:",
        "manifest-src 'self'",
        "worker-src 'self'",
        "form-action 'self'",
        "base-uri 'none'",
        "frame-ancestors 'none'",
    )
)
HEADERS = {
    "Content-Security-Policy": _POLICY,
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "microphone=(self), camera=(), geolocation=()",
    "Server": "edgevox",
}


async def add_headers(_request: web.Request, response: web.StreamResponse) -> None:
    """Put them on an answer that is about to leave."""
    response.headers.update(HEADERS)
    response.headers.setdefault("Cache-Control", "no-cache")


def is_own_origin(request: web.BaseRequest) -> bool:
    """Whether a page of this server asks: its `Origin` is there, and is the host it asks."""
    try:
        origin = urlsplit(request.headers.get("Origin", ""))
    except ValueError:  # half an address
        return False
    return origin.scheme in ("http", "https") and origin.netloc.lower() == request.host.lower()
