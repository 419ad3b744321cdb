"""A page read again: its text, its tables and its figures, as a program finds them in the HTML."""

from __future__ import annotations

import json
from html.parser import HTMLParser
from typing import Any

VOID = {"meta", "br", "hr", "input"}


class PageReader(HTMLParser):
    """What stands on a page.

    `figures` are those of plotly by the titles above them, `tables` rows of cells by the sections that they are in,
    `links` what is linked to, `anchors` what can be linked to, and `sources` other files that the page asks for.
    """

    def __init__(self, html: str) -> None:
        super().__init__()
        self.text = ""
        self.figures: dict[str, dict[str, Any]] = {}
        self.tables: dict[str, list[list[list[str]]]] = {}
        self.links: list[str] = []
        self.anchors: list[str] = []
        self.sources: list[str] = []
        self._open: list[tuple[str, dict[str, str]]] = []
        self._section = self._title = ""
        self.feed(html)
        self.close()
        assert not self._open, "what is opened is closed"
        assert len(self.anchors) == len(set(self.anchors))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {key: value or "" for key, value in attrs}
        assert tag not in ("link", "img", "iframe", "object", "base")
        assert not any(name.startswith("on") for name in given)
        self.sources += [given["src"]] if "src" in given else []
        self.links += [given["href"]] if "href" in given else []
        self.anchors += [given["id"]] if "id" in given else []
        if tag == "section":
            self._section = given["id"]
        elif tag == "table":
            self.tables.setdefault(self._section, []).append([])
        elif tag == "tr":
            self.tables[self._section][-1].append([])
        elif tag in ("td", "th"):
            self.tables[self._section][-1][-1].append("")
        elif tag == "h3":
            self._title = ""
        if tag not in VOID:
            self._open.append((tag, given))

    def handle_endtag(self, tag: str) -> None:
        assert self._open.pop()[0] == tag

    def handle_data(self, data: str) -> None:
        tags = [tag for tag, _ in self._open]
        if "script" in tags:
            if self._open[-1][1].get("type") == "application/json":
                self.figures[self._title] = json.loads(data)
        elif "style" not in tags:
            self.text += data
            if {"td", "th"} & set(tags):
                self.tables[self._section][-1][-1][-1] += data
            if "h3" in tags:
                self._title += data


def traces(figure: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """The traces of a figure by their names."""
    return {trace.get("name", ""): trace for trace in figure["data"]}
