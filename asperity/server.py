"""Server of the models over UM-Bridge, protocol 1.0 (Seelinger et al., J. Open Source Softw. 8, 4748, 2023).

The package's own server listens on every address of the machine, runs one process and answers a malformed request with
a page of HTML. This one listens where it is told, the local address by default, evaluates in worker processes, replaces
a worker that dies, and answers every mistake in one line of JSON.
"""

import asyncio
import json
import multiprocessing
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import TYPE_CHECKING, Any

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


class Workers:
    """Processes that evaluate models; a pool that broke is replaced."""

    def __init__(self, count: int) -> None:
        self.count = count
        self.pool = self._new()

    def _new(self) -> ProcessPoolExecutor:
        # fresh processes: a fork would inherit the server's sockets and keep them open after it
        return ProcessPoolExecutor(self.count, mp_context=multiprocessing.get_context("spawn"))

    async def run(self, name: str, parameters: Any, config: Any) -> list[list[float]]:
        """Evaluate in a worker.

        Raises
        ------
        InputError : see `evaluate`.
        BrokenProcessPool : the worker died at every try.
        """
        for attempt in range(TRIES):
            pool = self.pool
            try:
                return await asyncio.get_running_loop().run_in_executor(pool, evaluate, name, parameters, config)
            except BrokenProcessPool:
                if self.pool is pool:
                    pool.shutdown(wait=False)
                    self.pool = self._new()
                if attempt == TRIES - 1:
                    raise
        raise AssertionError

    def close(self) -> None:
        """End the processes."""
        self.pool.shutdown(wait=False, cancel_futures=True)


class _Refused(Exception):
    """A request that is answered with an error of a kind of the protocol."""

    def __init__(self, kind: str, message: str) -> None:
        super().__init__(message)
        self.kind = kind


def application(workers: Workers) -> "web.Application":
    """The routes of the protocol."""
    with needs("umbridge"):
        from aiohttp import web

    def answer(action: Callable[[dict[str, Any]], Any]) -> Callable[["web.Request"], Any]:
        async def handle(request: "web.Request") -> "web.Response":
            try:
                try:
                    content = json.loads(await request.text())
                except (ValueError, RecursionError):
                    raise _Refused("InvalidInput", "the request is no JSON") from None
                if not isinstance(content, dict):
                    raise _Refused("InvalidInput", "the request must be a JSON object")
                result = action(content)
                return web.json_response(await result if asyncio.iscoroutine(result) else result)
            except _Refused as error:
                return _error(error.kind, str(error), 400)
            except InputError as error:
                return _error("InvalidInput", str(error), 400)
            except BrokenProcessPool:
                return _error("WorkerDied", f"the worker died {TRIES} times at these inputs; is memory short?", 500)
            except (ArithmeticError, ValueError, MemoryError) as error:
                return _error("ModelError", f"{type(error).__name__}: {' '.join(str(error).split())}", 500)

        return handle

    def _error(kind: str, message: str, status: int) -> "web.Response":
        return web.json_response({"error": {"type": kind, "message": message}}, status=status)

    def chosen(content: dict[str, Any]) -> Any:
        name = content.get("name")
        if name not in MODELS:
            raise _Refused("ModelNotFound", f"name = {name!r}: no such model; accepted: {', '.join(MODELS)}")
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

    app = web.Application(client_max_size=LARGEST_REQUEST)
    app.router.add_get("/Info", info)
    app.router.add_post("/ModelInfo", answer(about))
    app.router.add_post("/InputSizes", answer(lambda content: {"inputSizes": [len(sizes(content)[0].inputs)]}))
    app.router.add_post("/OutputSizes", answer(output_sizes))
    app.router.add_post("/Evaluate", answer(evaluated))
    app.on_cleanup.append(closed)
    return app


def serve(host: str = LOCAL, port: int = PORT, workers: int = 1) -> None:
    """Serve until interrupted.

    Raises
    ------
    InputError : the address cannot be used.
    """
    with needs("umbridge"):
        from aiohttp import web
    try:
        web.run_app(application(Workers(workers)), host=host, port=port, print=None)
    except OSError as error:
        raise InputError(f"{host}:{port}: cannot be used ({error.strerror}); choose another --port") from None
