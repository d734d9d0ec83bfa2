"""The site builds without a warning and without a network, and no link in it is broken."""

import re
import subprocess
import sys
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

from softfinger.provenance import PROJECT

DOCS = PROJECT / "docs"


class Page(HTMLParser):
    """What a page links to, what it loads, and the places within it that can be linked to."""

    def __init__(self, path):
        super().__init__()
        self.links, self.loads, self.places, self.headings = [], [], set(), []
        self.pictures_without_words = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        self.places.add(attrs.get("id"))
        if tag == "a" and attrs.get("href"):
            self.links.append(attrs["href"])
        if tag == "link" and attrs.get("rel") in {"stylesheet", "icon", "preload"}:
            self.loads.append(attrs["href"])
        if attrs.get("src"):
            self.loads.append(attrs["src"])
        if tag == "img" and not attrs.get("alt"):
            self.pictures_without_words.append(attrs["src"][:80])
        if re.fullmatch("h[1-6]", tag):
            self.headings.append(int(tag[1]))


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html"]
    done = subprocess.run(
        [*command, "-d", str(folder / "trees"), str(DOCS), str(folder / "html")],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    paths = [p for p in (folder / "html").rglob("*.html") if "_static" not in p.parts]
    return {path.resolve(): Page(path) for path in paths}


def find_broken(site):
    for path, page in site.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme in {"http", "https", "mailto"}:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.exists() or (
                parts.fragment and unquote(parts.fragment) not in site[target].places
            ):
                yield f"{path.name}: {link}"


def test_no_link_within_the_site_is_broken(site):
    assert list(find_broken(site)) == []


def test_a_broken_link_would_be_seen(site):
    page = next(iter(site.values()))
    page.links += ["no-such-page.html", "#no-such-place"]
    assert len(list(find_broken(site))) == 2
    del page.links[-2:]


def test_the_pages_load_nothing_from_a_network(site):
    for page in site.values():
        assert [load for load in page.loads if urlsplit(load).scheme in {"http", "https"}] == []


def test_every_page_has_one_title_and_words_for_its_pictures(site):
    for path, page in site.items():
        assert page.pictures_without_words == [], path
        assert page.headings.count(1) <= 1
        assert all(b - a <= 1 for a, b in pairwise(page.headings)), path


def test_generated_parts_are_there(site):
    words = {path.stem: re.sub("<[^>]*>", "", path.read_text(encoding="utf-8")) for path in site}
    assert "generated:" not in "".join(words.values())
    assert "joint_angle_covariance" in words["artifacts"]
    assert "propagation.c_p_truncation_sd" in words["configuration"]
    assert "second_retardation" in words["effects"]
    assert "softfinger rig record" in words["commands"]


def test_every_page_is_reached_from_the_first(site):
    first = next(path for path in site if path.name == "index.html")
    seen, waiting = set(), [first]
    while waiting:
        path = waiting.pop()
        if path in seen or path not in site:
            continue
        seen.add(path)
        waiting += [(path.parent / urlsplit(link).path).resolve() for link in site[path].links]
    sources = {p.relative_to(DOCS).with_suffix("") for p in DOCS.rglob("*.md")}
    root = first.parent
    assert sources <= {p.relative_to(root).with_suffix("") for p in seen if root in p.parents}


def test_an_index_does_not_slip_under_a_dotted_letter(site):
    # docutils sets \\dot{q}_v so; \\dot{q_v} is set well
    for path in site:
        text = path.read_text(encoding="utf-8")
        stacks = re.findall("<munderover>.*?</munderover>", text, re.DOTALL)
        assert [stack for stack in stacks if "˙" in stack or "¨" in stack] == [], path


def test_sources_name_no_machine():
    for path in Path(DOCS).rglob("*.md"):
        assert "/work/" not in path.read_text(encoding="utf-8"), path
