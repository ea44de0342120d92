"""A server with a stream that only ends when it is told: run as a program, with a folder and a port as arguments."""

from __future__ import annotations

import sys
from collections.abc import AsyncIterator
from pathlib import Path

from starlette.responses import StreamingResponse

from synth.service.serve import ServiceServer, listening, server_config
from tests.service.calling import Service


def main(folder: Path) -> None:
    with Service(folder, header_timeout=1.0, idle_connections=50) as service:

        async def beats() -> AsyncIterator[str]:
            yield ": begun\n\n"
            await service.context.ending.wait()
            yield "retry: 2000\n\n"

        async def stream() -> StreamingResponse:
            return StreamingResponse(beats(), media_type="text/event-stream")

        service.app.add_api_route("/stream", stream, methods=["GET"])
        listener = listening("127.0.0.1", 0)
        port = listener.getsockname()[1]
        config = server_config(service.app, service.settings)
        ServiceServer(config, service.context, lambda: print(port, flush=True), lambda: None).run([listener])


if __name__ == "__main__":
    main(Path(sys.argv[1]))
