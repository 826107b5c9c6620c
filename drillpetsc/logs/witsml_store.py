"""A log in a WITSML 1.4.1.1 store, read by polls: rows since the last one, as lines of a text table.

Calls, parameters and results are those of the WITSML store interface (STORE API 1.4.1, Energistics): WMLS_GetFromStore gets a
query and returns 1, or 2 if it has left out rows at the end, with a document; a negative number is an error.
"""

from __future__ import annotations

import base64
import netrc
import os
import re
from datetime import datetime
from http.client import HTTPException
from math import nan
from pathlib import Path
from urllib.error import HTTPError
from urllib.parse import SplitResult, parse_qsl, urlsplit, urlunsplit
from urllib.request import HTTPRedirectHandler, Request, build_opener
from xml.sax.saxutils import escape, quoteattr

from drillpetsc.case.importers.table import MAX_BYTES
from drillpetsc.case.importers.xml_tree import Element, xml_tree
from drillpetsc.errors import CaseError
from drillpetsc.logs.files import WITSML, DataTable, witsml_logs, witsml_table

FORM = "witsml:https://HOST/PATH?well=UID&wellbore=UID&log=UID"
USER, PASSWORD = "DRILLPETSC_WITSML_USER", "DRILLPETSC_WITSML_PASSWORD"
ANSWERS_WITHIN = 30.0  # seconds until a store must have answered
WHOLE, PART = 1, 2  # results of a call: everything, or the first rows of it
UIDS = {"well": "uidWell", "wellbore": "uidWellbore", "log": "uid"}
_ACTION = "http://www.witsml.org/action/120/Store.WMLS_GetFromStore"
_CALL = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<soap:Envelope xmlns:soap="http://schemas.xmlsoap.org/soap/envelope/"><soap:Body>'
    '<get:WMLS_GetFromStore xmlns:get="http://www.witsml.org/message/120"><WMLtypeIn>log</WMLtypeIn><QueryIn>{query}</QueryIn>'
    "<OptionsIn>returnElements=all</OptionsIn><CapabilitiesIn></CapabilitiesIn></get:WMLS_GetFromStore></soap:Body></soap:Envelope>"
)


class StoreError(Exception):
    """A call that gave no rows.  final: whether it makes no sense to try again, as with a wrong password."""

    def __init__(self, text: str, final: bool = False) -> None:
        super().__init__(text)
        self.final = final


class _Stay(HTTPRedirectHandler):
    """Do not follow a store that sends elsewhere: the password would go along."""

    def redirect_request(self, *_: object) -> None:
        return None


class WitsmlStore:
    """A log of a store.

    name: ``witsml:`` and the URL; user and password come from the environment, or from the user's netrc file.
    more: whether the last answer left rows out at its end; unsafe: whether a password goes over the net unencrypted.
    Raises CaseError for a name that is not understood.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        try:
            url = urlsplit(name.partition(":")[2])
            uids = dict(parse_qsl(url.query, strict_parsing=True)) if url.port != 0 else {}
        except ValueError as error:
            raise CaseError(at="--log", got=name, want=FORM, hint=str(error)) from None
        if url.username is not None or url.password is not None:
            raise CaseError(
                at="--log", got="a URL with a user name", want=FORM,
                hint=f"the name is written to the results: set {USER} and {PASSWORD}, or use the netrc file",
            )  # fmt: skip
        if url.scheme not in ("http", "https") or not url.hostname or set(uids) != set(UIDS):
            raise CaseError(at="--log", got=name, want=FORM)
        self._url, self._uids = urlunsplit((url.scheme, url.netloc, url.path, "", "")), uids
        self._headers = {"Content-Type": "text/xml; charset=utf-8", "SOAPAction": f'"{_ACTION}"'}
        password = _password(url)
        if password is not None:
            self._headers["Authorization"] = "Basic " + base64.b64encode(":".join(password).encode()).decode()
        self.unsafe = password is not None and url.scheme == "http"
        self._open = build_opener(_Stay).open
        self.more = False

    def rows_from(self, index: str, unit: str) -> DataTable | None:
        """The rows from an index on, as the log writes it, or from the beginning if it is empty; None without any.

        unit: of the index.  Raises StoreError if the store does not answer as it should.
        """
        root = self._called(self._query(index, unit))
        try:
            logs = witsml_logs(root, Path(self.name))
            if not logs:
                raise StoreError(
                    f"the store has no log {self._uids['log']}, or does not show it to this user"
                )
            log = logs[0]
            kind, way = log.word("indexType"), log.word("direction")
            if way == "decreasing" or kind not in ("", "date time", "measured depth"):
                raise StoreError(
                    f"the index of the log is {kind} {way}: only date time and measured depth that increase are read",
                    True,
                )
            return witsml_table(log, Path(self.name))
        except CaseError as error:
            raise StoreError(" ".join(str(error).split())[:300], True) from None

    def _query(self, index: str, unit: str) -> str:
        own = " ".join(f"{key}={quoteattr(self._uids[word])}" for word, key in UIDS.items())
        start = f"<startDateTimeIndex>{escape(index)}</startDateTimeIndex>"
        if _is_number(index):
            start = f"<startIndex uom={quoteattr(unit)}>{index}</startIndex>"
        start = start if index else ""
        return f'<logs xmlns="{WITSML}" version="1.4.1.1"><log {own}>{start}</log></logs>'

    def _called(self, query: str) -> Element:
        """The document that the store returns for a query."""
        body = _CALL.format(query=escape(query)).encode()
        try:
            with self._open(Request(self._url, body, self._headers), timeout=ANSWERS_WITHIN) as answer:
                raw = answer.read(MAX_BYTES + 1)
        except HTTPError as error:
            if error.code in (401, 403):
                raise StoreError(
                    f"the store refuses the user (HTTP {error.code}): set {USER} and {PASSWORD}", True
                ) from None
            raw = error.read(MAX_BYTES) if error.code == 500 else b""  # which has the fault
            if not raw.lstrip().startswith(b"<"):
                raise StoreError(f"HTTP {error.code} {error.reason}", 300 <= error.code < 400) from None
        except (OSError, HTTPException) as error:
            raise StoreError(
                f"no answer: {getattr(error, 'reason', None) or error or type(error).__name__}"
            ) from None
        return self._document(raw)

    def _document(self, raw: bytes) -> Element:
        if len(raw) > MAX_BYTES:
            raise StoreError(f"an answer of more than {MAX_BYTES // 10**6} MB")
        try:
            body = xml_tree(raw, Path(self.name)).first("Body")
            answer = next(iter(body.children), None) if body is not None else None
            if answer is None or answer.name == "Fault":
                raise StoreError(
                    "a fault: "
                    + (answer.word("faultstring")[:200] if answer is not None else "an empty answer")
                )
            result, said = answer.word("Result"), answer.word("SuppMsgOut")[:200]
            if result not in (str(WHOLE), str(PART)):
                raise StoreError(f"the store answers {result or 'nothing'}: {said or 'without a reason'}")
            self.more = result == str(PART)
            document = answer.first("XMLout")
            return xml_tree((document.text if document is not None else "").strip().encode(), Path(self.name))
        except CaseError as error:
            raise StoreError("an answer that is not XML: " + " ".join(str(error.got).split())[:100]) from None


def place_of(index: str) -> float:
    """A number by which indices are ordered: depth, or seconds; nan for a text that is neither."""
    try:
        return (
            float(index)
            if _is_number(index)
            else datetime.fromisoformat(index.replace("Z", "+00:00")).timestamp()
        )
    except ValueError:
        return nan


def _is_number(index: str) -> bool:
    return re.fullmatch(r"[+-]?[\d.]+([eE][+-]?\d+)?", index) is not None


def _password(url: SplitResult) -> tuple[str, str] | None:
    """User and password for a host, None if none is known.  Raises CaseError for a netrc file that cannot be read."""
    user = os.environ.get(USER)
    if user is not None:
        return user, os.environ.get(PASSWORD, "")
    file = Path(os.environ.get("NETRC", Path.home() / ".netrc"))
    if not file.is_file():
        return None
    try:
        found = netrc.netrc(str(file)).authenticators(url.hostname or "")
    except (OSError, netrc.NetrcParseError) as error:
        raise CaseError(
            at="--log", got=str(file), want="a netrc file that can be read", hint=str(error)
        ) from None
    return None if found is None else (found[0], found[2] or "")
