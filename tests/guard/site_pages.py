# SPDX-License-Identifier: Apache-2.0
"""A built site needs no network, and its links lead to files and anchors that are there.

Usage: site_pages.py FOLDER. Prints one line per fault; exit code 1 if there is one.
"""
import html.parser
import pathlib
import urllib.parse

from report import report


class Page(html.parser.HTMLParser):
    def __init__(self, text: str):
        super().__init__()
        self.loads: list[str] = []
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.anchors.update(found[key] for key in ("id", "name") if found.get(key))
        if tag == "a" and found.get("href"):
            self.links.append(found["href"])
        for key in ("src", "href"):
            if tag in ("script", "img", "link", "iframe", "source") and found.get(key) and found.get("rel") != "canonical":
                self.loads.append(found[key])


def faults_of(root: pathlib.Path) -> list[str]:
    root = root.resolve()
    pages = {file: Page(file.read_text(encoding="utf-8")) for file in sorted(root.rglob("*.html"))}
    faults = [] if pages else [f"{root}: there is no page"]
    for file, page in pages.items():
        where = file.relative_to(root)
        faults += [f"{where}: loads {link} from the network" for link in page.loads if "//" in link and "data:" not in link]
        for link in page.links + page.loads:
            place, anchor = urllib.parse.urldefrag(link)
            if ":" in place or "//" in place:
                continue
            target = (file.parent / urllib.parse.unquote(place.split("?")[0])).resolve() if place else file
            if not target.is_file():
                faults.append(f"{where}: {link} leads nowhere")
            elif anchor and target in pages and urllib.parse.unquote(anchor) not in pages[target].anchors:
                faults.append(f"{where}: {link} has no such anchor")
    return faults


if __name__ == "__main__":
    report(faults_of, "every link of the site leads somewhere, and nothing comes from the network")
