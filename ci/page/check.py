#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""check.py PAGE FOLDER...: whether a page of gyroakf is whole, and says what the results say.

PAGE is report.html, as it was written or as a browser made it; FOLDER holds the results.json of each of its recordings, in order.
Checked are: names without doubles, references that lead somewhere, headings in order, captions, scopes and labels, nothing from
outside, the curves and coefficients of the tables against results.json, texts of users that stay texts. Prints a line for every failure and as the
last line "N passed, N failed".
"""
import json
import pathlib
import re
import sys
from html.parser import HTMLParser

VOID = {"meta", "br", "link", "img", "hr", "input"}
SELF_CLOSED = "svg"


class Page(HTMLParser):
    """What stands in a page."""

    def __init__(self):
        super().__init__(convert_charrefs=True)
        self.elements = []      # (tag, attributes)
        self.ids = []
        self.cells = {}         # (recording, channel): texts of the cells of its tables
        self.headings = []
        self.open = []          # (tag, attributes)
        self.text = {}          # of title, h1, h2, h3, th, caption, figcaption: lists
        self.unlabeled = []
        self.recordings = 0
        self.channel = None
        self.unbalanced = []

    def handle_starttag(self, tag, attrs, closed=False):
        attributes = dict(attrs)
        self.elements.append((tag, attributes))
        if "id" in attributes:
            self.ids.append(attributes["id"])
        if "data-path" in attributes:
            self.recordings += 1
        if "data-channel" in attributes:
            self.channel = int(attributes["data-channel"])
        if tag in ("td", "th"):
            self.cells.setdefault((self.recordings - 1, self.channel), []).append("")
        if re.fullmatch("h[1-6]", tag):
            self.headings.append(int(tag[1]))
        self.text.setdefault(tag, []).append("")
        if tag not in VOID and not closed:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs, closed=True)

    def handle_endtag(self, tag):
        if not self.open or self.open[-1] != tag:
            self.unbalanced.append(f"</{tag}> at line {self.getpos()[0]}, open: {self.open[-3:]}")
        if tag in self.open:
            while self.open.pop() != tag:
                pass

    def handle_data(self, data):
        for tag in set(self.open):
            self.text[tag][-1] += data
            if tag in ("td", "th"):
                self.cells[self.recordings - 1, self.channel][-1] += data


def shown(value, digits):
    """A number as a cell has it."""
    return f"{value:.{digits}g}"


def main():
    path, folders = sys.argv[1], sys.argv[2:]
    source = pathlib.Path(path).read_text(encoding="utf-8")
    page = Page()
    page.feed(source)
    page.close()
    results = [json.loads((pathlib.Path(folder) / "results.json").read_text(encoding="utf-8")) for folder in folders]
    counts = [0, 0]

    def check(name, good, detail=""):
        counts[0 if good else 1] += 1
        if not good:
            print(f"FAILED: {path}: {name}: {str(detail)[:400]}")

    check("document type", source.lower().startswith("<!doctype html>"))
    check("elements are closed", not page.unbalanced and not page.open, page.unbalanced or page.open)
    doubles = sorted({i for i in page.ids if page.ids.count(i) > 1})
    check("names without doubles", not doubles, doubles)
    targets = set(page.ids)
    lost = [a for _, attributes in page.elements for k, a in attributes.items()
            if k in ("href", "xlink:href") and a.startswith("#") and a[1:] not in targets]
    lost += [name for name in re.findall(r"url\(#([^)]*)\)", source) if name not in targets]
    check("references lead somewhere", not lost, lost)
    jumps = [(a, b) for a, b in zip([0] + page.headings, page.headings) if b > a + 1]
    check("headings in order", page.headings.count(1) == 1 and not jumps, jumps)
    outside = [(tag, k, v) for tag, attributes in page.elements for k, v in attributes.items()
               if k in ("src", "href", "xlink:href", "action", "data") and re.match(r"(?i)\s*([a-z]+:|//)", v or "")]
    outside += [tag for tag, _ in page.elements if tag in ("iframe", "object", "embed", "link", "base", "form")]
    outside += re.findall(r"(?i)@import|url\(\s*['\"]?[a-z]+:", source)
    check("nothing from outside", not outside, outside)
    handlers = [k for _, attributes in page.elements for k in attributes if k.startswith("on")]
    check("one script, no handlers", not handlers and len([t for t, _ in page.elements if t == "script"]) == 1, handlers)
    check("language", any(tag == "html" and a.get("lang") for tag, a in page.elements))
    check("window", any(a.get("name") == "viewport" for _, a in page.elements))
    for tag in ("title", "h1", "h2", "h3", "caption"):
        check(f"{tag} has words", all(text.strip() for text in page.text.get(tag, [""])), page.text.get(tag))
    tables = [a for tag, a in page.elements if tag == "table"]
    check("tables have captions", tables and len(tables) == len(page.text["caption"]))
    check("heads have scopes", all("scope" in a for tag, a in page.elements if tag == "th"))
    drawings = [a for tag, a in page.elements if tag == "svg"]
    check("drawings have labels", all(a.get("role") == "img" and len(a.get("aria-label", "")) > 20 for a in drawings))
    check("labels and recordings", page.recordings == len(results), page.recordings)

    for i, result in enumerate(results):
        for c, channel in enumerate(result["channels"]):
            cells = set(page.cells.get((i, c), []))
            curve = (channel["allan"] or {}).get("input")
            if curve:
                wanted = {shown(x, digits) for key, digits in (("tau_s", 6), ("deviation", 6), ("lower", 4), ("upper", 4))
                          for x in curve[key]}
                check("the whole curve", wanted <= cells, sorted(wanted - cells)[:5])
            for key, value in (channel["filters"] or {}).items():
                if value:
                    check(f"variance of {key}", f"{value['variance']:.4e}" in cells, value["variance"])
            for term in "QNBKR":
                stated = ((channel["coefficients"] or {}).get("input") or {}).get(term)
                if stated and stated["value"] is not None:
                    found = (shown(stated["value"], 4) if stated["detected"] else "< " + shown(stated["upper_limit"], 3))
                    check("coefficient", any(cell.startswith(found) for cell in cells), found)
            name = channel["name"]
            check("channel's heading", f"Channel {name}".split() in [h.split() for h in page.text["h3"]], name)
    print(f"{counts[0]} passed, {counts[1]} failed")
    return 1 if counts[1] else 0


if __name__ == "__main__":
    sys.exit(main())
