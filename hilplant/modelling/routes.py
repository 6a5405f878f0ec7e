"""The page's requests: what changes the model, what computes something of it, what takes long."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from starlette.requests import Request
from starlette.responses import JSONResponse, PlainTextResponse, Response
from starlette.routing import Route

from hilplant.failure import Failure
from hilplant.modelling.answers import Answers
from hilplant.modelling.long_answers import LongAnswers
from hilplant.modelling.long_work import plain
from hilplant.modelling.opening import with_library_part, with_part
from hilplant.modelling.recordings import kept
from hilplant.modelling.session import ModellingSession
from hilplant.web.threads import in_thread

Asked = dict[str, Any]
Handler = Callable[[Asked], Any]


def routes(session: ModellingSession) -> list[Route]:
    """Return the routes of a page that works on a session."""
    answers, longer = Answers(session), LongAnswers(session)
    changing: dict[str, Handler] = {
        "edit": lambda asked: session.change(
            asked["version"], lambda model: model.with_value(tuple(asked["location"]), asked["value"])
        ),
        "text": lambda asked: session.change(
            asked["version"], lambda model: model.with_text(asked["file"], asked["text"])
        ),
        "part": lambda asked: session.change(
            asked["version"], lambda model: with_library_part(model, asked["part"], asked["name"])
        ),
        "readings": lambda asked: session.change(
            asked["version"], lambda model: with_part(model, "motor", longer.motor_text(asked["name"]))
        ),
        "open": lambda asked: session.open(asked["version"], asked["bench"]),
        "undo": lambda _: session.step(-1),
        "redo": lambda _: session.step(1),
        "save": lambda asked: session.save(Path(asked["folder"]), bool(asked.get("overwrite"))),
        "accept": lambda asked: session.accept(asked["version"], longer.identified_parts()),
        "network": lambda asked: session.with_network(asked["version"], *longer.trained_files(asked)),
    }
    found = [Route("/model", _asked(lambda _: session.shown()), methods=["GET"])]
    found += [Route(f"/{name}", _asked(_then(how, session.shown)), methods=["POST"]) for name, how in changing.items()]
    found += [
        Route(f"/{name}", _asked(how), methods=["POST"]) for name, how in (answers.computing | longer.asked_for).items()
    ]
    return [
        *found,
        Route("/zip", _file(lambda _: ("wiper.zip", session.model.zipped())), methods=["GET"]),
        Route("/product", _file(lambda query: longer.product(query["work"], query["name"])), methods=["GET"]),
        Route("/upload", _upload(session), methods=["POST"]),
    ]


def _then(how: Handler, shown: Callable[[], Any]) -> Handler:
    def both(asked: Asked) -> Any:
        how(asked)
        return shown()

    return both


def _asked(how: Handler) -> Callable[[Request], Any]:
    """Answer a request with JSON, in a thread: what is computed holds up no other request."""

    async def answer(request: Request) -> Response:
        try:
            body = await request.body()
            asked = json.loads(body) if body else {}
            if not isinstance(asked, dict):
                raise Failure("a request is an object")
            return JSONResponse(plain(await in_thread(how, asked)))
        except Failure as error:
            return PlainTextResponse(str(error), 422)
        except (KeyError, TypeError, ValueError) as error:
            return PlainTextResponse(f"the request is not understood: {type(error).__name__} {error}", 400)

    return answer


def _file(how: Callable[[Any], tuple[str, bytes]]) -> Callable[[Request], Any]:
    async def answer(request: Request) -> Response:
        try:
            name, content = await in_thread(how, request.query_params)
        except (Failure, KeyError) as error:
            return PlainTextResponse(str(error), 404)
        head = {"content-disposition": f'attachment; filename="{name}"'}
        return Response(content, media_type="application/octet-stream", headers=head)

    return answer


def _upload(session: ModellingSession) -> Callable[[Request], Any]:
    async def answer(request: Request) -> Response:
        try:
            path = kept(session.recordings, request.query_params.get("name", ""), await request.body())
        except Failure as error:
            return PlainTextResponse(str(error), 422)
        return JSONResponse({"name": path.name})

    return answer
