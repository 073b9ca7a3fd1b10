"""Checks that every relative link of a built book leads to a file and, if the link names an element, to this
element.

    python3 tests/tools/check_book.py target/book

Exits with 1 if a link is broken. `.ci/docs` runs this script after `mdbook build`. It needs only Python.
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """Collects the link targets and the element names of a page."""

    def __init__(self, text):
        super().__init__()
        self.targets, self.names = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id":
                self.names.add(value)
            elif name == "href" and tag == "a" or name == "src" and tag == "img":
                self.targets.append(value)


def main(folder):
    # The page for printing repeats all others, and the page 404 is shown for any address.
    paths = [path for path in folder.rglob("*.html") if path.name not in ("print.html", "404.html", "toc.html")]
    pages = {path.resolve(): Page(path.read_text(encoding="utf-8")) for path in paths}
    broken, count = [], 0
    for path, page in pages.items():
        for target in page.targets:
            parts = urlsplit(target)
            if parts.scheme or parts.netloc:
                continue
            count += 1
            file = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            named = pages.get(file)
            if not file.exists():
                broken.append(f"{path.name}: {target}: no such file")
            elif parts.fragment and named and unquote(parts.fragment) not in named.names:
                broken.append(f"{path.name}: {target}: no such element")
    print("\n".join(broken) or f"{count} links of {len(pages)} pages lead somewhere")
    return 1 if broken or not count else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
