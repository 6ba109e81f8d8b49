"""Hearing and speech by a server as people write them: aiohttp, forms, and sound in chunks."""

import asyncio
import io
import threading
import wave
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from aiohttp import web
from guards import HUNG_S
from speech_server import MODELS, TONE, wav_of

from edgevox.core.cancel import CancelToken
from edgevox.core.servers.address import Address
from edgevox.voice.audio import RATE_HZ
from edgevox.voice.remote.hearing import open_hearing_server
from edgevox.voice.remote.speaking import open_speaking_server

UNKNOWN = b"\xff" * 4
SOUND = np.arange(RATE_HZ, dtype=np.int16)


async def _models(_: web.Request) -> web.Response:
    return web.json_response(MODELS)


async def _hears(request: web.Request) -> web.Response:
    """Tells what came, as the transcript."""
    form = await request.post()
    with wave.open(io.BytesIO(form["file"].file.read())) as file:
        samples = file.getnframes()
    return web.json_response({"text": f"{form['model']} {form['language']} {samples}"})


async def _speaks(request: web.Request) -> web.StreamResponse:
    """A file whose length it does not know, in chunks that cut through samples."""
    assert (await request.json())["response_format"] == "wav"
    data = wav_of()
    data = data[:4] + UNKNOWN + data[8:40] + UNKNOWN + data[44:]
    response = web.StreamResponse(headers={"Content-Type": "audio/wav"})
    response.enable_chunked_encoding()
    await response.prepare(request)
    for at in range(0, len(data), 999):
        await response.write(data[at : at + 999])
    await response.write_eof()
    return response


@contextmanager
def _serving() -> Iterator[str]:
    """The address of the server, which runs on a thread of its own."""
    loop, url, up = asyncio.new_event_loop(), "", threading.Event()

    async def serve() -> web.AppRunner:
        nonlocal url
        app = web.Application()
        app.router.add_get("/v1/models", _models)
        app.router.add_post("/v1/audio/transcriptions", _hears)
        app.router.add_post("/v1/audio/speech", _speaks)
        runner = web.AppRunner(app)
        await runner.setup()
        site = web.TCPSite(runner, "127.0.0.1", 0)
        await site.start()
        url = "http://{}:{}".format(*runner.addresses[0])
        up.set()
        return runner

    def run() -> None:
        runner = loop.run_until_complete(serve())
        loop.run_forever()
        loop.run_until_complete(runner.cleanup())
        loop.close()

    thread = threading.Thread(target=run)
    thread.start()
    assert up.wait(HUNG_S)
    try:
        yield url
    finally:
        loop.call_soon_threadsafe(loop.stop)
        thread.join()


def test_a_form_is_read_and_a_sound_in_chunks_is_whole() -> None:
    with _serving() as url:
        address = Address(url, timeout_s=HUNG_S)
        hearing, speaking = open_hearing_server(address), open_speaking_server(address)
        heard = hearing.transcribe(SOUND, "de", "", CancelToken())
        chunks = list(speaking.speak("Hallo.", "de", CancelToken()))
        hearing.close()
        speaking.close()
    assert heard.text == f"Systran/faster-whisper-large-v3 de {SOUND.size}"
    assert np.array_equal(np.concatenate([one.samples for one in chunks]), TONE)
