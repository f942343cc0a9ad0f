"""The network line to the simulated control: it can be cut, go dead without a word, and be slow."""

from __future__ import annotations

import asyncio
from contextlib import suppress

_CHUNK = 65536


class FaultyLine:
    """Passes connections on from ``port`` to the server's own; what is done to it is done to all of them."""

    def __init__(self, host: str, port: int, server_port: int) -> None:
        self.host, self.port, self._server_port = host, port, server_port
        self.delay = 0.0
        """Seconds that everything takes on its way to the control."""
        self._dead = False
        self._open: set[asyncio.StreamWriter] = set()
        self._tasks: set[asyncio.Task[None]] = set()
        self._server: asyncio.Server | None = None

    async def start(self) -> None:
        """Listen; port 0 becomes the one that was free."""
        self._server = await asyncio.start_server(self._pass_on, self.host, self.port)
        self.port = self._server.sockets[0].getsockname()[1]

    def refuse(self) -> None:
        """Reset all connections and take no more, until :meth:`start`."""
        if self._server is not None:
            self._server.close()
        self.cut()

    async def stop(self) -> None:
        """Close everything."""
        self.refuse()
        for task in list(self._tasks):
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    def cut(self) -> None:
        """Reset all connections; new ones are taken."""
        self._dead = False
        for writer in list(self._open):
            writer.transport.abort()

    def die(self) -> None:
        """Nothing comes through any more, and nobody is told: half-open connections. New ones are taken again."""
        self._dead = True

    async def _pass_on(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._dead = False
        try:
            to_reader, to_writer = await asyncio.open_connection(self.host, self._server_port)
        except OSError:
            writer.transport.abort()
            return
        both = (writer, to_writer)
        self._open.update(both)
        alive = [True]
        for source, target, delayed in ((reader, to_writer, True), (to_reader, writer, False)):
            task = asyncio.create_task(self._pump(source, target, both, alive, delayed))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)

    async def _pump(
        self,
        source: asyncio.StreamReader,
        target: asyncio.StreamWriter,
        both: tuple[asyncio.StreamWriter, ...],
        alive: list[bool],
        delayed: bool,
    ) -> None:
        """One direction of a connection."""
        with suppress(OSError):
            while data := await source.read(_CHUNK):
                if self._dead:
                    alive[0] = False
                if not alive[0]:
                    continue  # swallowed, on this connection for good
                if delayed and self.delay > 0.0:
                    await asyncio.sleep(self.delay)
                target.write(data)
                await target.drain()
        for writer in both:
            self._open.discard(writer)
            writer.transport.abort()
