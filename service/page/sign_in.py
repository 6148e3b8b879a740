"""`/page/sign-in`: where a browser shows its key, once; plain HTML, before anything else."""

from pathlib import Path
from typing import Annotated

from fastapi import APIRouter, Form, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from jinja2 import Environment, FileSystemLoader

from service.api.access import AccessError, who_asks
from service.page.page_headers import PLACE
from service.page.sessions import COOKIE, LASTS_S
from service.page.visitor import SIGN_IN, parts_of, sessions_of
from service.store.keys import Scope

router = APIRouter(prefix=PLACE, include_in_schema=False)

HERE = Path(__file__).parent
_templates = Environment(loader=FileSystemLoader(HERE), autoescape=True)


@router.get("/sign-in", response_class=HTMLResponse)
def ask_for_key() -> HTMLResponse:
    """Ask for a key."""
    return _form()


@router.post("/sign-in")
async def show_key(request: Request, key: Annotated[str, Form(max_length=200)] = "") -> Response:
    """Begin a session with a key that is good; tries are slowed down as they are by the API."""
    address = request.client.host if request.client else ""
    try:
        await who_asks(parts_of(request), address, key.strip(), Scope.READ)
    except AccessError as error:
        return _form(str(error), status=401)
    sessions = sessions_of(request)
    sessions.end(request.cookies.get(COOKIE))
    answer = RedirectResponse(f"{PLACE}/", status_code=303)
    answer.set_cookie(
        COOKIE,
        sessions.begin(key.strip()),
        max_age=int(LASTS_S),
        path=PLACE,
        httponly=True,
        samesite="strict",
        secure=request.url.scheme == "https",
    )
    return answer


@router.post("/sign-out")
def sign_out(request: Request) -> RedirectResponse:
    """End the session."""
    sessions_of(request).end(request.cookies.get(COOKIE))
    answer = RedirectResponse(SIGN_IN, status_code=303)
    answer.delete_cookie(COOKIE, path=PLACE)
    return answer


def _form(trouble: str = "", *, status: int = 200) -> HTMLResponse:
    page = _templates.get_template("sign_in.html.j2").render(
        trouble=trouble, style=(HERE / "style.css").read_text(encoding="utf-8")
    )
    return HTMLResponse(page, status_code=status, headers={"Cache-Control": "no-store"})
