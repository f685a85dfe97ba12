"""Server of the models over UM-Bridge, protocol 1.0 (Seelinger et al., J. Open Source Softw. 8,
4748, 2023).

`umbridge.serve_models` listens on every address of the machine, has no place for checks, lets
clients name shared memory to be read, and answers a malformed request with a page of HTML. This one
listens where it is told, evaluates in worker processes, and answers every mistake in one line. A
page in a browser of the same machine cannot use it: requests must be JSON and name this machine as
their host.
"""

import asyncio
import ipaddress
import json
import logging
import multiprocessing
import socket
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from asperity.guards.foreign_text import shown
from asperity.models import INPUTS, MODELS
from mesoscale.errors import InputError
from mesoscale.extras import needs

if TYPE_CHECKING:
    from aiohttp import web

TRIES = 3
"""Evaluations of one request, should its worker die."""
LONGEST_S = 600.0
"""Of one evaluation."""
BODY_S = 30.0
"""In which a request must have come: one whose stated length never comes would hold its connection
for ever.
"""


class _Worker:
    """A process that evaluates one model at a time."""

    def __init__(self) -> None:
        # a fresh process: a fork would inherit the server's sockets and keep them open after it
        context = multiprocessing.get_context("spawn")
        self.pipe, far_end = context.Pipe()
        self.process = context.Process(target=_work, args=(far_end,), daemon=True)
        self.process.start()
        far_end.close()

    def evaluate(self, request: tuple[str, Any, Any]) -> Any:
        """Answer of the process, or its error; blocks."""
        self.pipe.send(request)
        return self.pipe.recv()


def _work(pipe: Connection) -> None:
    """What a worker process does until its server is gone."""
    try:
        while True:
            name, parameters, config = pipe.recv()
            try:
                pipe.send(MODELS[name](parameters, config))
            except InputError as error:
                pipe.send(error)
            except Exception as error:  # a fault of ours: the client is told in one line, too
                pipe.send(RuntimeError(f"{type(error).__name__}: {error}"))
    except (EOFError, OSError, KeyboardInterrupt):
        return


class Workers:
    """Processes that evaluate models; one that dies, or is ended with its request, is replaced."""

    def __init__(self, count: int) -> None:
        self.free: asyncio.Queue[_Worker] = asyncio.Queue()
        self.threads = ThreadPoolExecutor(count)
        for _ in range(count):
            self.free.put_nowait(_Worker())

    async def evaluate(self, *request: Any) -> list[list[float]]:
        """Evaluate a model by its name, parameters and configuration in a worker.

        Raises
        ------
        InputError : see `asperity.models.ServedModel`; or the evaluation takes too long.
        RuntimeError : a fault of the model, or its worker died at every try.
        """
        worker = await self.free.get()
        try:
            for _ in range(TRIES):
                call = asyncio.get_running_loop().run_in_executor(
                    self.threads, worker.evaluate, request
                )
                try:
                    answer = await asyncio.wait_for(call, LONGEST_S)
                except (EOFError, OSError, asyncio.CancelledError) as error:
                    # it died, takes too long (TimeoutError is an OSError), or its client went away
                    worker.process.kill()
                    worker = _Worker()
                    if isinstance(error, TimeoutError):
                        raise InputError(
                            f"{request[0]}: takes longer than {LONGEST_S:.0f} s; ask for less"
                        ) from None
                    if isinstance(error, asyncio.CancelledError):
                        raise
                    continue
                if isinstance(answer, Exception):
                    raise answer
                return answer
        finally:
            self.free.put_nowait(worker)
        raise RuntimeError(f"the worker died {TRIES} times at these inputs; is memory short?")


def _refused(kind: str, message: str, status: int = 400) -> "web.Response":
    from aiohttp import web

    line = shown(" ".join(message.split()))[:1000]
    return web.json_response({"error": {"type": kind, "message": line}}, status=status)


def _malformed(
    handler: Any, request: Any, status: int = 500, exc: Any = None, message: str | None = None
) -> Any:
    """Answer of aiohttp's connections to what is no HTTP, in place of its plain text; see
    `serve`.
    """
    if request.writer.output_size > 0:
        raise ConnectionError("the answer has begun: another cannot be sent")
    if status < 500:
        answer = _refused("InvalidInput", f"the request is no HTTP: {message}", status)
    else:
        handler.log_exception("Error handling request", exc_info=exc)
        answer = _refused("ModelError", "a fault of the server", status)
    answer.force_close()
    return answer


def _by_client(record: logging.LogRecord) -> bool:
    """Whether a record of the log is to be kept: none of a request that its client broke off or
    garbled.
    """
    from aiohttp import web

    error = record.exc_info[1] if record.exc_info else None
    return not isinstance(error, web.RequestPayloadError)


def application(workers: Workers, host: str) -> "web.Application":
    """The routes of the protocol, for requests that name `host`, this machine or an address as
    theirs.
    """
    from aiohttp import web

    @web.middleware
    async def in_one_line(
        request: "web.Request", handler: Callable[..., Any]
    ) -> "web.StreamResponse":
        # a page of a stranger may name a host of its own that leads here: its requests carry that
        # name
        if not _is_ours(request.host, host):
            return _refused(
                "InvalidInput", f"Host: {request.host}: accepted is {host}, localhost or an address"
            )
        try:
            return await handler(request)
        except web.HTTPException as error:  # no such route, too large
            return _refused("InvalidInput", error.reason, error.status)
        except InputError as error:
            return _refused("InvalidInput", str(error))
        except RuntimeError as error:
            return _refused("ModelError", str(error), 500)

    async def info(_: "web.Request") -> "web.Response":
        return web.json_response({"protocolVersion": 1.0, "models": list(MODELS)})

    async def answer(request: "web.Request") -> "web.Response":
        if request.content_type != "application/json":
            raise InputError("the request must say Content-Type: application/json")
        try:
            content = json.loads(await asyncio.wait_for(request.text(), BODY_S))
        except TimeoutError:
            raise InputError(
                f"the request did not come within {BODY_S:.0f} s; is its Content-Length right?"
            ) from None
        except web.RequestPayloadError:
            raise InputError(
                "the request cannot be decoded; send it as it is, in good chunks"
            ) from None
        except (ValueError, LookupError, RecursionError):
            # LookupError: a charset that nobody knows
            raise InputError("the request is no JSON") from None
        if not isinstance(content, dict):
            raise InputError("the request must be a JSON object")
        if not isinstance(name := content.get("name"), str) or name not in MODELS:
            raise InputError(f"name = {name!r:.60}: no such model; accepted: {', '.join(MODELS)}")
        config = MODELS[name].checked_config(content.get("config", {}))
        match request.path:
            case "/ModelInfo":
                derivatives = dict.fromkeys(("Gradient", "ApplyJacobian", "ApplyHessian"), False)
                result: dict[str, Any] = {"support": {"Evaluate": True, **derivatives}}
            case "/InputSizes":
                result = {"inputSizes": [len(INPUTS)]}
            case "/OutputSizes":
                result = {"outputSizes": MODELS[name].output_sizes(config)}
            case _:
                result = {"output": await workers.evaluate(name, content.get("input"), config)}
        return web.json_response(result)

    app = web.Application(middlewares=[in_one_line])
    app.router.add_get("/Info", info)
    for path in ("/ModelInfo", "/InputSizes", "/OutputSizes", "/Evaluate"):
        app.router.add_post(path, answer)
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


def serve(host: str, port: int, workers: int) -> None:
    """Serve until interrupted.

    Raises
    ------
    InputError : the address cannot be used.
    """
    with needs("umbridge"):
        from aiohttp import web
    # aiohttp has no setting for either: its pages of plain text, and stacks of what clients garbled
    web.RequestHandler.handle_error = _malformed  # pyright: ignore[reportAttributeAccessIssue]
    logging.getLogger("aiohttp.server").addFilter(_by_client)
    try:
        web.run_app(
            application(Workers(workers), host),
            host=host,
            port=port,
            print=None,
            handler_cancellation=True,
        )
    except OSError as error:
        raise InputError(
            f"{host}:{port}: cannot be used ({error.strerror}); choose another --port"
        ) from None
