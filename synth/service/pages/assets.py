"""Scripts, styles and pictures of the pages, under an address that changes with their content."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from types import MappingProxyType

from fastapi import APIRouter, Request, Response

from synth.results.drawings import report
from synth.service.api.asking import tag_of, tagged
from synth.service.errors import not_found
from synth.ui import ui_files

router = APIRouter()
MEDIA = MappingProxyType(
    {"css": "text/css; charset=utf-8", "js": "text/javascript; charset=utf-8", "svg": "image/svg+xml"}
)
FOR_GOOD = "public, max-age=31536000, immutable"
EXPLORER = "explorer"  # folder of the modules that draw a front
EXPLORER_MODULE = f"{EXPLORER}/explorer.js"


@dataclass(frozen=True)
class Asset:
    """A file that pages load."""

    content: bytes
    media: str
    etag: str


@cache
def assets() -> Mapping[str, Asset]:
    """Return all files that pages load, by their names below :func:`static_place`."""
    texts = {path.name: path.read_bytes() for path in (files("synth.service.pages") / "static").iterdir()}
    texts |= {name: text.encode() for name, text in ui_files().items()}
    texts |= {f"{EXPLORER}/{name}": text.encode() for name, text in _explorer().items()}
    return MappingProxyType(
        {
            name: Asset(content, MEDIA[name.rsplit(".", 1)[-1]], tag_of(content))
            for name, content in sorted(texts.items())
            if name.rsplit(".", 1)[-1] in MEDIA
        }
    )


def _explorer() -> Mapping[str, str]:
    """Return the modules that draw a front, where the reports bring some."""
    load = report("explorer_files")
    return {} if load is None else load()


@cache
def static_place() -> str:
    """Return the address below which all files stand: another one as soon as any of them is another."""
    digest = hashlib.sha256()
    for name, asset in assets().items():
        digest.update(f"{name}\n{asset.etag}\n".encode())
    return f"/static/{digest.hexdigest()[:16]}"


@router.get("/static/{digest}/{name:path}")
async def read_asset(request: Request, digest: str, name: str) -> Response:
    """Give a file; a page that was loaded from an earlier server gets the present one."""
    found = assets().get(name)
    if found is None:
        raise not_found()
    current = static_place().endswith(f"/{digest}")
    headers = {"Cache-Control": FOR_GOOD} if current else {}
    return tagged(request, found.content, found.media, found.etag, headers)
