"""Tenants, tokens and browsers, on both databases."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import pytest

from synth.errors import InputError
from synth.queue.accounts import Accounts, TenantLimits
from synth.queue.database import Database


@pytest.fixture
def accounts(database: str) -> Iterator[Accounts]:
    """Yield the accounts of an empty database."""
    with Database(database) as opened:
        yield Accounts(opened)


def test_a_token_is_recognised_until_it_is_revoked(accounts: Accounts) -> None:
    assert not accounts.any_token()
    tenant = accounts.tenant("acme", {"running": 3})
    made = accounts.make_token("office", tenant, ["submit", "read"], 1.0)
    found = accounts.recognise(made.value)
    assert found is not None
    assert (found.tenant, found.tenant_name, found.token) == (tenant, "acme", made.id)
    assert found.scopes == {"read", "submit"}
    assert found.limits == TenantLimits(running=3)
    assert found.used is None
    accounts.note_use(made.id)
    again = accounts.recognise(made.value)
    assert again is not None
    assert again.used == pytest.approx(0.0, abs=5.0)
    (entry,) = accounts.tokens()
    assert (entry.name, entry.prefix, entry.scopes) == ("office", made.value[3:11], ("read", "submit"))
    assert accounts.any_token() is accounts.any_valid() is True
    assert accounts.revoke(made.id)
    assert not accounts.revoke(made.id)
    assert accounts.recognise(made.value) is None
    assert accounts.any_token()
    assert not accounts.any_valid()


def test_tokens_that_begin_alike_are_told_apart(accounts: Accounts, monkeypatch: pytest.MonkeyPatch) -> None:
    ends = iter(["1" * 35, "2" * 35])
    monkeypatch.setattr("secrets.token_urlsafe", lambda count: "same_beg" + next(ends))
    first, second = (accounts.make_token(name, 1, ["read"], None) for name in ("first", "second"))
    assert first.prefix == second.prefix
    found = [accounts.recognise(made.value) for made in (first, second)]
    assert [principal.token for principal in found if principal] == [first.id, second.id]


def test_a_browser_is_whoever_has_signed_in(accounts: Accounts) -> None:
    made = accounts.make_token("a", 1, ["read"], None)
    cookie = accounts.sign_in(made.id, 1.0)
    found = accounts.browser(cookie)
    assert found is not None
    assert found.token == made.id
    assert accounts.browser(cookie + "x") is None
    assert accounts.browser("x" * 100_000) is None
    accounts.sign_out(cookie)
    assert accounts.browser(cookie) is None
    over = accounts.sign_in(made.id, -1.0)
    assert accounts.browser(over) is None


def test_a_tenant_is_made_once_however_many_ask(accounts: Accounts) -> None:
    found: list[int] = []
    threads = [threading.Thread(target=lambda: found.append(accounts.tenant("new", {}))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4
    assert len(set(found)) == 1


@pytest.mark.parametrize("name", ["", " ", "x" * 61, "a\nb", "a\x00b"])
def test_names_can_be_shown(accounts: Accounts, name: str) -> None:
    with pytest.raises(InputError, match="a name of at most 60 letters, digits"):
        accounts.tenant(name, {})
    with pytest.raises(InputError, match="a name of at most 60 letters"):
        accounts.make_token(name, 1, ["read"], None)


@pytest.mark.parametrize("name", ["../x", "a b", "a/b", "-a", "_a", "."])
def test_a_new_tenant_has_a_name_of_letters_and_digits(accounts: Accounts, name: str) -> None:
    with pytest.raises(InputError, match=r"digits, -, _ or \., the first a letter or digit"):
        accounts.tenant(name, {})
    assert accounts.tenant("Werk-2.süd_x", {}) > 1


@pytest.mark.parametrize("scopes", [[], ["write"], ["read", "all"]])
def test_scopes_are_those_that_there_are(accounts: Accounts, scopes: list[str]) -> None:
    with pytest.raises(InputError, match="one or more of read, submit, admin"):
        accounts.make_token("a", 1, scopes, None)


def test_a_token_is_found_by_its_number_or_its_beginning(accounts: Accounts) -> None:
    made = accounts.make_token("a", 1, ["read"], None)
    for beginning in (str(made.id), made.prefix, made.prefix[:5], f"cs_{made.prefix}"):
        assert accounts.find(beginning).id == made.id
    for wrong in ("", "cs_", "?", "999"):
        with pytest.raises(InputError, match="TOKEN"):
            accounts.find(wrong)
