"""Server of the models over UM-Bridge, protocol 1.0 (Seelinger et al., J. Open Source Softw. 8, 4748, 2023).

The package's own server listens on every address of the machine, runs one process and answers a malformed request with
a page of HTML. This one listens where it is told, the local address by default, evaluates in worker processes, ends a
worker whose client went away or whose time is up, replaces one that dies, and answers every mistake in one line.
A page in a browser of the same machine cannot use it: requests must be JSON and name this machine as their host.
"""

import asyncio
import ipaddress
import json
import multiprocessing
import socket
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from asperity.foreign_text import shown
from asperity.models import MODELS, evaluate
from mesoscale.errors import InputError
from mesoscale.extras import needs

if TYPE_CHECKING:
    from aiohttp import web

LOCAL = "127.0.0.1"
PORT = 4242
"""The one that UM-Bridge's clients try first."""
TRIES = 3
"""Evaluations of one request, should its worker die."""
LARGEST_REQUEST = 1 << 20
MOST_WAITING = 256
LONGEST_S = 600.0
"""Of one evaluation."""
LONGEST_LINE = 1000


class WorkerDied(Exception):
    """The worker died at every try."""


class _Worker:
    """A process that evaluates one model at a time."""

    def __init__(self) -> None:
        # a fresh process: a fork would inherit the server's sockets and keep them open after it
        context = multiprocessing.get_context("spawn")
        self.pipe, there = context.Pipe()
        self.process = context.Process(target=_work, args=(there,), daemon=True)
        self.process.start()
        there.close()

    def evaluate(self, request: tuple[str, Any, Any]) -> Any:
        """Answer of the process, or its error; blocks."""
        self.pipe.send(request)
        return self.pipe.recv()

    def end(self) -> None:
        self.process.kill()
        self.process.join()


def _work(pipe: Connection) -> None:
    """What a worker process does until its server is gone."""
    while True:
        try:
            request = pipe.recv()
        except (EOFError, OSError, KeyboardInterrupt):
            return
        try:
            answer: Any = evaluate(*request)
        except (InputError, ArithmeticError, ValueError, MemoryError) as error:
            answer = error
        except KeyboardInterrupt:
            return
        except Exception as error:  # a fault of ours: the client is told in one line, too
            answer = ValueError(f"{type(error).__name__}: {error}")
        pipe.send(answer)


class Workers:
    """Processes that evaluate models; one that dies, or is ended with its request, is replaced."""

    def __init__(self, count: int) -> None:
        self.free: asyncio.Queue[_Worker] = asyncio.Queue()
        self.all = [_Worker() for _ in range(count)]
        self.threads = ThreadPoolExecutor(count)
        self.waiting = 0
        for worker in self.all:
            self.free.put_nowait(worker)

    async def run(self, name: str, parameters: Any, config: Any) -> list[list[float]]:
        """Evaluate in a worker.

        Raises
        ------
        InputError : see `evaluate`; or too many requests wait, or the evaluation takes too long.
        WorkerDied
        """
        if self.waiting >= MOST_WAITING:
            raise InputError(f"{MOST_WAITING} requests wait already; ask again later")
        self.waiting += 1
        try:
            worker = await self.free.get()
        finally:
            self.waiting -= 1
        try:
            for _ in range(TRIES):
                call = asyncio.get_running_loop().run_in_executor(
                    self.threads, worker.evaluate, (name, parameters, config)
                )
                try:
                    answer = await asyncio.wait_for(call, LONGEST_S)
                except TimeoutError:
                    worker = self._replaced(worker)
                    raise InputError(f"{name}: takes longer than {LONGEST_S:.0f} s; ask for less") from None
                except asyncio.CancelledError:  # the client went away
                    worker = self._replaced(worker)
                    raise
                except (EOFError, OSError):
                    worker = self._replaced(worker)
                    continue
                if isinstance(answer, Exception):
                    raise answer
                return answer
        finally:
            self.free.put_nowait(worker)
        raise WorkerDied

    def _replaced(self, worker: _Worker) -> _Worker:
        worker.end()
        self.all[self.all.index(worker)] = new = _Worker()
        return new

    def close(self) -> None:
        """End the processes."""
        for worker in self.all:
            worker.end()


class _Refused(Exception):
    """A request that is answered with an error of a kind of the protocol."""

    def __init__(self, kind: str, message: str) -> None:
        super().__init__(message)
        self.kind = kind


def application(workers: Workers, host: str = LOCAL) -> "web.Application":
    """The routes of the protocol, for requests that name `host`, this machine or an address as theirs."""
    with needs("umbridge"):
        from aiohttp import web

    def answer(action: Callable[[dict[str, Any]], Any]) -> Callable[["web.Request"], Any]:
        async def handle(request: "web.Request") -> "web.Response":
            try:
                if request.content_type != "application/json":
                    raise _Refused("InvalidInput", "the request must say Content-Type: application/json")
                try:
                    content = json.loads(await request.text())
                except (ValueError, LookupError, RecursionError):  # LookupError: a charset that nobody knows
                    raise _Refused("InvalidInput", "the request is no JSON") from None
                if not isinstance(content, dict):
                    raise _Refused("InvalidInput", "the request must be a JSON object")
                result = action(content)
                return web.json_response(await result if asyncio.iscoroutine(result) else result)
            except _Refused as error:
                return _error(error.kind, str(error), 400)
            except InputError as error:
                return _error("InvalidInput", str(error), 400)
            except WorkerDied:
                return _error("WorkerDied", f"the worker died {TRIES} times at these inputs; is memory short?", 500)
            except (ArithmeticError, ValueError, MemoryError) as error:
                return _error("ModelError", f"{type(error).__name__}: {error}", 500)

        return handle

    def _error(kind: str, message: str, status: int) -> "web.Response":
        line = shown(" ".join(message.split()))[:LONGEST_LINE]
        return web.json_response({"error": {"type": kind, "message": line}}, status=status)

    @web.middleware
    async def checked(request: "web.Request", handler: Callable[..., Any]) -> "web.StreamResponse":
        # a page of a stranger may name a host of its own that leads here: its requests carry that name
        if not _is_ours(request.host, host):
            return _error("InvalidInput", f"Host: {request.host}: accepted is {host}, localhost or an address", 400)
        try:
            return await handler(request)
        except web.HTTPException as error:  # no such route, too large
            return _error("InvalidInput", error.reason, error.status)

    def chosen(content: dict[str, Any]) -> Any:
        name = content.get("name")
        if not isinstance(name, str) or name not in MODELS:
            raise _Refused("ModelNotFound", f"name = {name!r:.60}: no such model; accepted: {', '.join(MODELS)}")
        return MODELS[name]

    def sizes(content: dict[str, Any]) -> tuple[Any, Any]:
        model = chosen(content)
        return model, model.checked_config(content.get("config", {}))

    def output_sizes(content: dict[str, Any]) -> dict[str, Any]:
        model, config = sizes(content)
        return {"outputSizes": model.output_sizes(config)}

    def about(content: dict[str, Any]) -> dict[str, Any]:
        model = chosen(content)
        names = ("Evaluate", "Gradient", "ApplyJacobian", "ApplyHessian")
        return {
            "support": {name: name == "Evaluate" for name in names},
            "about": model.about,
            "inputs": [list(model.inputs)],
            "outputs": list(model.outputs),
            "config": list(model.config),
        }

    async def evaluated(content: dict[str, Any]) -> dict[str, Any]:
        model = chosen(content)
        return {"output": await workers.run(model.name, content.get("input"), content.get("config", {}))}

    async def info(_: "web.Request") -> "web.Response":
        return web.json_response({"protocolVersion": 1.0, "models": list(MODELS)})

    async def closed(_: "web.Application") -> None:
        workers.close()

    app = web.Application(client_max_size=LARGEST_REQUEST, middlewares=[checked])
    app.router.add_get("/Info", info)
    app.router.add_post("/ModelInfo", answer(about))
    app.router.add_post("/InputSizes", answer(lambda content: {"inputSizes": [len(sizes(content)[0].inputs)]}))
    app.router.add_post("/OutputSizes", answer(output_sizes))
    app.router.add_post("/Evaluate", answer(evaluated))
    app.on_cleanup.append(closed)
    return app


def _is_ours(named: str, host: str) -> bool:
    """Does a Host header name the host that is served, this machine, or an address?"""
    try:
        name = urlsplit(f"//{named}").hostname or ""
    except ValueError:
        return False
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return name in {"localhost", host.lower(), socket.gethostname().lower()}
    return True


def serve(host: str = LOCAL, port: int = PORT, workers: int = 1) -> None:
    """Serve until interrupted.

    Raises
    ------
    InputError : the address cannot be used.
    """
    with needs("umbridge"):
        from aiohttp import web
    try:
        app = application(Workers(workers), host)
        web.run_app(app, host=host, port=port, print=None, handler_cancellation=True)
    except OSError as error:
        raise InputError(f"{host}:{port}: cannot be used ({error.strerror}); choose another --port") from None
