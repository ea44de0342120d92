"""Who asks: tokens, browsers, and everybody at a machine where there are no tokens."""

from __future__ import annotations

import logging
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import pytest
import sqlalchemy as sa
from fastapi import Depends

from synth.queue.accounts import Principal
from synth.queue.job_table import Ending, NewJob
from synth.queue.models import BrowserSession, Tenant, Token, moment
from synth.service.attempts import FailedTokens
from synth.service.auth import needs
from synth.service.recording import LOG
from tests.service.calling import HOME, Service, bearer, code_of

TOKENS, SESSION = "/api/v1/tokens", "/api/v1/session"
OWN = {"origin": HOME}


# ---- without tokens -------------------------------------------------------------------------------------------------


def test_at_this_machine_everybody_is_the_local_tenant_until_there_is_a_token(service: Service) -> None:
    assert service("GET", SESSION).json() == {"tenant": "local", "scopes": ["admin", "read", "submit"]}
    assert service("GET", SESSION, headers=bearer("cs_wrong")).status_code == 200  # the door is open
    made = service("POST", TOKENS, json={"name": "office", "scopes": ["read", "admin"]})
    assert made.status_code == 201
    answer = service("GET", SESSION)
    assert (answer.status_code, code_of(answer)) == (401, "not_signed_in")
    assert answer.headers["www-authenticate"].startswith("Bearer")
    assert service("GET", SESSION, headers=bearer(made.json()["value"])).json()["scopes"] == ["admin", "read"]


@pytest.mark.slow
@pytest.mark.parametrize("asked", [{}, {"scopes": ["read"]}, {"scopes": ["read", "submit"], "tenant": "acme"}])
def test_the_first_token_may_make_others(service: Service, asked: dict[str, object]) -> None:
    refused = service("POST", TOKENS, json={"name": "office", **asked})
    assert (refused.status_code, code_of(refused)) == (422, "bad_input")
    (problem,) = refused.json()["error"]["problems"]
    assert problem["path"] == ["scopes"]
    assert "expected admin as well: this is the first token" in problem["message"]
    assert service("GET", SESSION).status_code == 200  # nothing was made, and nobody is locked out
    admin = service("POST", TOKENS, json={"name": "office", "scopes": ["admin"]}).json()["value"]
    assert service("POST", TOKENS, headers=bearer(admin), json={"name": "robot", **asked}).status_code == 201


@pytest.mark.slow
@pytest.mark.parametrize("name", ["../x", "a/b", "a b", ".", "-x", "_x", "a\\b", "x" * 61, "", "a\n", "<b>", "a,b"])
def test_a_new_tenant_has_a_name_that_can_be_repeated_anywhere(service: Service, name: str) -> None:
    admin = bearer(service.token("admin"))
    refused = service("POST", TOKENS, headers=admin, json={"name": "a", "tenant": name})
    assert (refused.status_code, code_of(refused)) == (422, "bad_input")
    assert refused.json()["error"]["problems"][0]["path"] == ["tenant"]
    for right in ("acme", "Werk_2", "7.süd-west"):
        made = service("POST", TOKENS, headers=admin, json={"name": "a", "tenant": right})
        assert made.status_code == 201
    with service.store.engine.begin() as connection:  # one that was made before names were looked at goes on
        connection.execute(sa.insert(Tenant).values(name="Werk 2", limits={}, created=0.0))
    assert service("POST", TOKENS, headers=admin, json={"name": "a", "tenant": "Werk 2"}).status_code == 201


def test_revoking_the_last_token_opens_no_door(service: Service) -> None:
    token = service.token("admin")
    (entry,) = service.accounts.tokens()
    assert service("DELETE", f"{TOKENS}/{entry.id}", headers=bearer(token)).status_code == 204
    assert service("GET", SESSION).status_code == 401


@pytest.mark.parametrize("own", [{"host": "0.0.0.0"}, {"hosts": ("clutch.example",)}])
def test_where_others_can_reach_it_nobody_is_anybody_without_a_token(tmp_path: Path, own: dict[str, object]) -> None:
    with Service(tmp_path, **own) as service:
        assert service("GET", SESSION).status_code == 401
        assert service("GET", SESSION, headers=bearer(service.token())).status_code == 200


# ---- tokens ---------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        lambda token: token[:-1],
        lambda token: token[:-1] + ("a" if token[-1] != "a" else "b"),
        lambda token: token.removeprefix("cs_"),
        lambda token: token.upper(),
        lambda token: "",
        lambda token: "cs_",
        lambda token: "cs_" + "x" * 100_000,
    ],
)
def test_only_the_token_itself_lets_in(service: Service, change: object) -> None:
    token = service.token()
    assert service("GET", SESSION, headers=bearer(token)).status_code == 200
    wrong = service("GET", SESSION, headers=bearer(change(token)))  # type: ignore[operator]
    assert (wrong.status_code, code_of(wrong)) == (401, "not_signed_in")


def test_a_token_in_the_address_is_not_read(service: Service) -> None:
    token = service.token()
    assert service("GET", f"{SESSION}?token={token}&access_token={token}").status_code == 401


def test_a_token_is_kept_as_a_hash_alone(service: Service) -> None:
    token = service.token("admin")
    made = service("POST", TOKENS, headers=bearer(token), json={"name": "office"}).json()
    cookie = service("POST", SESSION, headers=bearer(token)).cookies["clutchsynth_session"]
    service.store.close()
    kept = b"".join(file.read_bytes() for file in service.file.parent.glob("jobs.sqlite*"))
    for secret in (token, made["value"], cookie):
        assert secret.encode() not in kept
        assert secret[12:].encode() not in kept
    assert made["prefix"].encode() in kept
    assert "value" not in service("GET", TOKENS, headers=bearer(token)).text


def test_a_revoked_token_lets_in_no_more_neither_do_its_browsers(service: Service) -> None:
    token = service.token("read", "admin")
    cookie = dict(service("POST", SESSION, headers=bearer(token)).cookies)
    assert service("GET", SESSION, cookies=cookie).status_code == 200
    assert service("DELETE", f"{TOKENS}/1", headers=bearer(token)).status_code == 204
    assert service("GET", SESSION, headers=bearer(token)).status_code == 401
    assert service("GET", SESSION, cookies=cookie).status_code == 401
    assert service("DELETE", f"{TOKENS}/1", headers=bearer(service.token("admin"))).status_code == 404


def test_a_token_ends_by_itself(service: Service) -> None:
    token = service.token(days=1.0)
    assert service("GET", SESSION, headers=bearer(token)).status_code == 200
    with service.store.engine.begin() as connection:
        connection.execute(sa.update(Token).values(expires=moment() - 1.0))
    assert service("GET", SESSION, headers=bearer(token)).status_code == 401


def test_the_last_use_is_noted_but_not_every_use(service: Service) -> None:
    token = service.token()
    service("GET", SESSION, headers=bearer(token))
    first = service.accounts.tokens()[0].used
    assert first is not None
    service("GET", SESSION, headers=bearer(token))
    assert service.accounts.tokens()[0].used == first
    with service.store.engine.begin() as connection:
        connection.execute(sa.update(Token).values(used=moment() - 61.0))
    service("GET", SESSION, headers=bearer(token))
    assert (service.accounts.tokens()[0].used or 0.0) >= first


@pytest.mark.slow
@pytest.mark.parametrize("scope", ["read", "submit", "admin"])
def test_a_scope_is_needed_by_name(service: Service, scope: str) -> None:
    async def found(principal: Annotated[Principal, Depends(needs("submit"))]) -> int:
        return principal.tenant

    found.__annotations__["principal"] = Annotated[Principal, Depends(needs("submit"))]
    service.app.add_api_route("/submit", found, methods=["GET"])
    answer = service("GET", "/submit", headers=bearer(service.token(scope)))
    assert answer.status_code == (200 if scope == "submit" else 403)
    if scope != "submit":
        assert code_of(answer) == "scope"


@pytest.mark.parametrize(("method", "path"), [("GET", TOKENS), ("POST", TOKENS), ("DELETE", f"{TOKENS}/1")])
def test_tokens_are_for_administrators(service: Service, method: str, path: str) -> None:
    token = service.token("read", "submit")
    answer = service(method, path, headers=bearer(token), **({"json": {"name": "a"}} if method == "POST" else {}))
    assert (answer.status_code, code_of(answer)) == (403, "scope")
    assert len(service.accounts.tokens()) == 1


def test_administrators_see_that_there_are_jobs_of_others_and_nothing_of_what_is_in_them(service: Service) -> None:
    admin, both = bearer(service.token("admin")), bearer(service.token("read", "submit", tenant="acme"))
    tenants = [service.accounts.tenant(name, {}) for name in ("acme", "other")]
    for number in range(5):
        usual = {"kind": "synthesis", "fingerprint": str(number), "code": "c"}
        new = NewJob(title="secret", request={"family": "secret"}, content={"families": ["secret"]}, **usual)
        name, _ = service.store.submit(replace(new, tenant=tenants[number % 2]))
        if number == 4:
            service.store.end(name, Ending(state="failed", error={"message": "secret"}))
    place = "/api/v1/tenants/jobs"
    seen, cursors = [], [""]
    while cursors[-1] is not None:
        answer = service("GET", f"{place}?limit=2&cursor={cursors[-1]}".removesuffix("&cursor="), headers=admin)
        assert answer.status_code == 200
        assert "secret" not in answer.text
        seen += answer.json()["jobs"]
        cursors.append(answer.json()["next"])
    assert len(cursors) == 4
    assert [(job["tenant"], job["state"]) for job in seen] == [
        ("acme", "failed"),
        ("other", "open"),
        ("acme", "open"),
        ("other", "open"),
        ("acme", "open"),
    ]
    assert {*seen[0]} == {"id", "tenant", "kind", "state", "rows", "created", "started", "ended"}
    assert (seen[0]["kind"], seen[0]["rows"]) == ("synthesis", 0)
    assert seen[0]["ended"] >= seen[0]["created"]
    assert len(service("GET", f"{place}?tenant=other&state=open", headers=admin).json()["jobs"]) == 2
    assert service("GET", f"{place}?tenant=other&cursor={cursors[1]}", headers=admin).status_code == 422
    assert service("GET", f"/api/v1/jobs/{seen[0]['id']}", headers=admin).status_code == 404
    refused = service("GET", place, headers=both)
    assert (refused.status_code, code_of(refused)) == (403, "scope")


def test_a_new_tenant_gets_the_limits_of_the_settings_and_the_local_one_none(service: Service) -> None:
    admin = bearer(service.token("admin"))
    for name in ("acme", "acme", "other"):
        made = service("POST", TOKENS, headers=admin, json={"name": "a", "tenant": name, "scopes": ["read"]})
        assert made.status_code == 201
    with service.store.engine.connect() as connection:
        found = {name: limits for name, limits in connection.execute(sa.select(Tenant.name, Tenant.limits))}
    wanted = {"open_jobs": 20, "running": 2, "seconds_limit": 600.0, "rows": 100_000}
    assert found == {"local": {}, "acme": wanted, "other": wanted}
    principal = service.accounts.recognise(service.token(tenant="acme"))
    assert principal is not None
    assert principal.limits.rows == 100_000
    assert service.accounts.local().limits.rows is None


# ---- guessing -------------------------------------------------------------------------------------------------------


def test_who_guesses_has_to_wait_and_a_valid_token_from_there_is_let_in(
    service: Service, caplog: pytest.LogCaptureFixture
) -> None:
    token = service.token()
    with caplog.at_level(logging.INFO, LOG.name):
        found = [
            service("GET", SESSION, headers=bearer(f"cs_{k:043}"), address="192.0.2.7").status_code for k in range(12)
        ]
    assert found == [401] * 10 + [429] * 2
    limited = service("GET", SESSION, headers=bearer(token[:-1]), address="192.0.2.7")
    assert (limited.status_code, code_of(limited)) == (429, "too_many")
    assert 1 <= int(limited.headers["retry-after"]) <= 60
    for address in ("192.0.2.7", "192.0.2.8"):  # others stand behind the same address
        assert service("GET", SESSION, headers=bearer(token), address=address).status_code == 200
    assert service("GET", SESSION, headers=bearer(token[:-1]), address="192.0.2.7").status_code == 429
    assert sum("wrong_token" in record.message for record in caplog.records) == 10


def test_a_browser_that_was_signed_out_has_guessed_nothing(service: Service) -> None:
    token = service.token()
    for _ in range(12):
        assert service("GET", SESSION, cookies={"clutchsynth_session": "old"}).status_code == 401
    assert service("GET", SESSION, headers=bearer(token)).status_code == 200


def test_wrong_tokens_are_forgotten_in_time_and_never_too_many_addresses_kept() -> None:
    now = 0.0
    failed = FailedTokens(2, 60.0, 3, lambda: now)
    for _ in range(2):
        failed.failed("2001:db8::1")
    assert failed.wait("2001:db8::ffff") == 60.0
    assert failed.wait("2001:db9::1") == 0.0
    now = 30.0
    failed.failed("192.0.2.1")
    assert failed.wait("192.0.2.1") == 0.0
    assert failed.wait("2001:db8::1") == 30.0
    now = 61.0
    assert failed.wait("2001:db8::1") == 0.0
    for k in range(5):
        failed.failed(f"192.0.2.{k}")
    assert len(failed._failed) == 3


# ---- browsers -------------------------------------------------------------------------------------------------------


def test_a_browser_stays_signed_in_by_a_cookie_that_scripts_and_other_sites_do_not_see(service: Service) -> None:
    token = service.token("read", "submit")
    signed = service("POST", SESSION, headers={**bearer(token), **OWN})
    assert signed.status_code == 201
    (told,) = signed.headers.get_list("set-cookie")
    words = {word.strip().lower().split("=")[0] for word in told.split(";")}
    assert {"httponly", "samesite", "path", "max-age"} <= words
    assert "SameSite=strict" in told
    assert "secure" not in words
    cookie = dict(signed.cookies)
    assert service("GET", SESSION, cookies=cookie).json()["tenant"] == "local"
    assert service("DELETE", SESSION, cookies=cookie).status_code == 403  # it does not say where it comes from
    assert service("DELETE", SESSION, cookies=cookie, headers=OWN).status_code == 204
    assert service("GET", SESSION, cookies=cookie).status_code == 401


def test_a_session_ends_by_itself(service: Service) -> None:
    cookie = dict(service("POST", SESSION, headers=bearer(service.token())).cookies)
    with service.store.engine.begin() as connection:
        connection.execute(sa.update(BrowserSession).values(expires=moment() - 1.0))
    assert service("GET", SESSION, cookies=cookie).status_code == 401


def test_where_others_reach_it_the_cookie_goes_over_tls_alone(tmp_path: Path) -> None:
    with Service(tmp_path, hosts=("clutch.example",)) as service:
        (told,) = service("POST", SESSION, headers=bearer(service.token())).headers.get_list("set-cookie")
        assert told.startswith("__Host-clutchsynth_session=")
        assert "; Secure" in told
        value = told.split(";")[0].split("=", 1)[1]
        assert service("GET", SESSION, cookies={"__Host-clutchsynth_session": value}).status_code == 200
        assert service("GET", SESSION, cookies={"clutchsynth_session": value}).status_code == 401


def test_where_nobody_needs_to_sign_in_nobody_can(service: Service) -> None:
    assert service("POST", SESSION).status_code == 409
