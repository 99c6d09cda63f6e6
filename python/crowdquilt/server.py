"""The local server of the viewer, on the loopback address only: the built studio, a crowd and its report, or a set."""

from __future__ import annotations

import json
import socket
import threading
import webbrowser
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path

import uvicorn
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.middleware import Middleware
from starlette.middleware.trustedhost import TrustedHostMiddleware
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Mount, Route
from starlette.staticfiles import StaticFiles

from crowdquilt import check, report
from crowdquilt._core import Crowd, CrowdquiltError, PatchSet, World
from crowdquilt.world import holds_world

STUDIO = Path(__file__).parent / "studio_dist"
HOST = "127.0.0.1"
FRESH = {"Cache-Control": "no-store"}


def app(crowd: Path, opened: Callable[[], None] | None = None) -> Starlette:
    """The server's routes; `opened` is called once it listens."""
    is_set, is_world = holds_set(crowd), holds_world(crowd)
    # A bad file is told here, not in the browser.
    (PatchSet if is_set else World if is_world else Crowd).load(crowd)
    if not (STUDIO / "index.html").is_file():
        raise CrowdquiltError(f"{STUDIO}: the built studio is not there; `make studio` builds it")

    async def crowd_file(_request: Request) -> Response:
        data = await run_in_threadpool(crowd.read_bytes)
        return Response(data, media_type="application/octet-stream", headers=FRESH)

    async def report_file(_request: Request) -> Response:
        if is_set or is_world:
            return Response("only crowds have reports", status_code=404)
        data = await run_in_threadpool(report_of, crowd)
        return Response(data, media_type="application/json", headers=FRESH)

    @asynccontextmanager
    async def lifespan(_app: Starlette) -> AsyncIterator[None]:
        if opened:
            opened()
        yield

    return Starlette(
        routes=[
            Route("/data/crowd.crowd", crowd_file),
            Route("/data/report.json", report_file),
            Mount("/", StaticFiles(directory=STUDIO, html=True)),
        ],
        # A page elsewhere that resolves its own name to this machine must not read the crowd.
        middleware=[Middleware(TrustedHostMiddleware, allowed_hosts=[HOST, "localhost"])],
        lifespan=lifespan,
    )


def holds_set(path: Path) -> bool:
    """Whether a file is a patch set, told by its first bytes."""
    with path.open("rb") as file:
        return file.read(7) == b"CQPATCH"


def report_of(crowd: Path) -> bytes:
    """The report beside the crowd if it is about this crowd, else a new one."""
    beside = crowd.with_name("report.json")
    if beside.is_file() and beside.stat().st_mtime >= crowd.stat().st_mtime:
        return beside.read_bytes()
    found = Crowd.load(crowd)
    return json.dumps(report.build(found, check.check(found))).encode()


def serve(crowd: Path, port: int, open_browser: bool, say: Callable[[str], None]) -> None:
    """Serve until Ctrl-C."""
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((HOST, port))
        # Whoever follows the address as soon as it is told waits instead of being refused.
        listener.listen()
    except OSError as error:
        listener.close()
        raise CrowdquiltError(f"port {port}: {error.strerror}") from None
    url = f"http://{HOST}:{listener.getsockname()[1]}/"

    def opened() -> None:
        say(f"{crowd} is at {url}   (Ctrl-C ends)")
        if open_browser:
            threading.Thread(target=webbrowser.open, args=(url,), daemon=True).start()

    with listener:
        config = uvicorn.Config(app(crowd, opened), log_level="warning", lifespan="on", timeout_graceful_shutdown=1)
        uvicorn.Server(config).run(sockets=[listener])
