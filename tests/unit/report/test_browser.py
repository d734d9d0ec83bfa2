"""The page in a real browser, at the width of a phone and of a screen: `make browser`.

Chromium is the system's, Playwright drives it. Pictures of the page go to results/browser, to be
looked at.
"""

import csv
import re
import shutil
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from example_artifacts import gather
from test_layers import KINDS

from softfinger.provenance import PROJECT
from softfinger.report.page import render_report

sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

BROWSER = next((path for name in ("chromium", "google-chrome") if (path := shutil.which(name))), "")
PICTURES = PROJECT / "results/browser"
FLAGS = ["--no-sandbox", "--disable-quic", "--disable-background-networking", "--disable-sync"]
WIDTHS = {"phone": 360, "screen": 1400}

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not BROWSER, reason="no Chromium is installed"),
]


@pytest.fixture(scope="module")
def find_address(diagnosed, tmp_path_factory):
    """Address of the page of a kind."""
    folder = tmp_path_factory.mktemp("browser")

    @cache
    def find(kind):
        path = folder / f"{kind}.html"
        path.write_text(render_report(gather(KINDS[kind](diagnosed))), "utf-8")
        return path.as_uri()

    return find


@pytest.fixture(scope="module")
def address(find_address):
    return find_address("effect")


@pytest.fixture(scope="module")
def browser():
    with sync_api.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=BROWSER, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture(params=WIDTHS)
def view(request, browser, address):
    """An open page, and what it said and asked for."""
    page = browser.new_page(viewport={"width": WIDTHS[request.param], "height": 900})
    page.said, page.asked, page.width_name = [], [], request.param
    page.on("console", lambda message: page.said.append(message.text))
    page.on("pageerror", lambda error: page.said.append(str(error)))
    page.on("request", lambda asked: page.asked.append(asked.url.split(":")[0]))
    page.emulate_media(reduced_motion="reduce")
    page.goto(address)
    yield page
    page.close()


HOSTILE = (
    "<script>window.owned=1</script>",
    "<img src=x onerror=window.owned=1>",
    "'\"><svg onload=window.owned=1>",
    "<a href=javascript:window.owned=1>x</a>",
    "</style></script><script>window.owned=1</script>",
    "<iframe srcdoc='<script>parent.owned=1</script>'>",
)


def make_hostile(artifacts):
    """Names of the campaign, its trials, covariates and reasons that try to run code."""
    angles = artifacts["angles"]
    count = angles.sizes["trial"]
    names = [f"{HOSTILE[k % len(HOSTILE)]}{k}" for k in range(count)]
    columns = [f"{HOSTILE[k % len(HOSTILE)]}{k}" for k in range(angles.sizes["covariate"])]
    angles = angles.assign_coords(
        trial=np.array(names, dtype=object), covariate=np.array(columns, dtype=object)
    )
    reasons = np.array(HOSTILE, dtype=object)
    angles = angles.drop_dims("set_aside_trial").assign(
        set_aside_reason=("set_aside_trial", reasons)
    )
    angles = angles.assign_coords(set_aside_trial=reasons)
    return {"angles": angles.assign_attrs(campaign=HOSTILE[0])}


def test_no_name_runs_as_a_script(browser, artifacts, tmp_path):
    path = tmp_path / "hostile.html"
    path.write_text(render_report(gather(make_hostile(artifacts))), "utf-8")
    page = browser.new_page()
    asked, dialogs = [], []
    page.on("request", lambda request: asked.append(request.url.split(":")[0]))
    page.on("dialog", lambda dialog: dialogs.append(dialog.message))
    page.goto(path.as_uri())
    open_parts(page)
    page.wait_for_timeout(500)
    assert page.evaluate("typeof window.owned") == "undefined"
    assert page.evaluate("document.querySelectorAll('iframe, img[src=x], svg[onload]').length") == 0
    for link in page.query_selector_all("a[href^='javascript:']"):
        raise AssertionError(link.inner_text())
    assert set(asked) <= {"file", "data", "blob"}
    assert dialogs == []
    assert HOSTILE[0] in page.inner_text("body")
    page.close()


def open_parts(page):
    page.evaluate("document.querySelectorAll('details').forEach(d => { d.open = true; })")


def test_nothing_is_said_on_the_console_and_nothing_is_asked_of_a_network(view):
    view.wait_for_timeout(500)
    assert view.said == []
    assert set(view.asked) <= {"file", "data", "blob"}


def test_every_figure_loads(view):
    images = view.locator("figure img")
    assert images.count() >= 18
    loaded = images.evaluate_all("all => all.map(i => i.complete && i.naturalWidth > 0)")
    assert all(loaded)


def test_links_lead_to_a_place_on_the_page(view):
    links = view.locator("a[href^='#']")
    places = links.evaluate_all("all => all.map(a => document.querySelector(a.hash) !== null)")
    assert len(places) > 12
    assert all(places)
    outside = view.locator("a:not([href^='#'])").evaluate_all("all => all.map(a => a.href)")
    assert outside == []
    view.locator("nav a").nth(7).click()
    top = "Math.abs(document.querySelector(location.hash).getBoundingClientRect().top) < 60"
    view.wait_for_function(top, timeout=5000)


def test_the_page_is_no_wider_than_the_window_and_no_words_overlap_its_edge(view):
    wide = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
    assert view.evaluate(wide) <= 0
    open_parts(view)
    assert view.evaluate(wide) <= 0
    beyond = view.locator("p, li, h1, h2, figure, .tile, .toolbar").evaluate_all(
        "all => all.filter(e => e.getBoundingClientRect().right > innerWidth + 1)"
        ".map(e => e.outerHTML.slice(0, 80))"
    )
    assert beyond == []


def test_tables_sort_by_keyboard_and_say_so(view):
    open_parts(view)
    head = view.locator("#table-trials th button").nth(1)
    head.focus()
    view.keyboard.press("Enter")
    view.keyboard.press("Space")
    column = view.locator("#table-trials th").nth(1)
    assert column.get_attribute("aria-sort") == "descending"
    values = view.locator("#table-trials tbody td:nth-child(2)").evaluate_all(
        "all => all.map(c => Number(c.dataset.value))"
    )
    assert values == sorted(values, reverse=True)


def test_tables_go_out_as_csv_in_full(view, tmp_path):
    open_parts(view)
    region = view.locator("div.scroller:has(#table-trials)")
    with view.expect_download() as waiting:
        region.locator("xpath=following-sibling::div[1]//button[text()='CSV']").click()
    waiting.value.save_as(tmp_path / "trials.csv")
    rows = list(csv.reader((tmp_path / "trials.csv").read_text().splitlines()))
    shown = view.locator("#table-trials tr").count()
    assert len(rows) == shown
    assert len({len(row) for row in rows}) == 1
    assert waiting.value.suggested_filename == "trials.csv"


def test_a_figure_enlarges_and_gives_the_keyboard_back(view):
    button = view.locator("figure .enlarge").first
    button.focus()
    view.keyboard.press("Enter")
    assert view.locator("dialog").evaluate("d => d.open")
    view.keyboard.press("Escape")
    assert not view.locator("dialog").evaluate("d => d.open")
    assert button.evaluate("b => b === document.activeElement")


def test_the_first_stop_of_the_keyboard_skips_to_the_report(view):
    view.keyboard.press("Tab")
    assert view.evaluate("document.activeElement.className") == "skip"
    view.keyboard.press("Enter")
    assert view.evaluate("location.hash") == "#main"


def test_a_screen_reader_finds_its_way(view):
    levels = view.locator("h1, h2, h3, h4").evaluate_all(
        "all => all.map(h => Number(h.tagName[1]))"
    )
    assert levels.count(1) == 1
    assert levels[0] == 1
    assert all(after - before <= 1 for before, after in pairwise(levels))
    words = view.locator("img").evaluate_all("all => all.map(i => i.alt)")
    assert all(len(word) > 10 for word in words)
    captions = view.locator("main table").evaluate_all(
        "all => all.map(t => t.caption ? t.caption.textContent.length : 0)"
    )
    assert all(length > 10 for length in captions)
    nameless = view.locator("button, [role=region]").evaluate_all(
        "all => all.filter(e => !(e.textContent.trim() || e.ariaLabel)).length"
    )
    assert nameless == 0
    assert view.locator("html").get_attribute("lang") == "en"


def find_contrast(page, chosen):
    """Least contrast of words against what lies behind them, by WCAG's formula."""
    return page.locator(chosen).evaluate_all("""all => {
      const light = (c) => c.map((v) => v / 255)
        .map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4))
        .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
      const read = (text) => text.match(/[\\d.]+/g).map(Number);
      const behind = (e) => {
        for (; e; e = e.parentElement) {
          const colour = read(getComputedStyle(e).backgroundColor);
          if (colour.length < 4 || colour[3] > 0) return colour.slice(0, 3);
        }
        return [255, 255, 255];
      };
      return Math.min(...all.map((e) => {
        const pair = [light(read(getComputedStyle(e).color).slice(0, 3)), light(behind(e))];
        return (Math.max(...pair) + 0.05) / (Math.min(...pair) + 0.05);
      }));
    }""")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_words_stand_out_in_light_and_dark(view, scheme):
    view.emulate_media(color_scheme=scheme)
    chosen = "p, li, td, th, caption, figcaption, h1, h2, a, .mark, .badge, .tool, .detail"
    assert find_contrast(view, chosen) >= 4.5


SHOWN = ("effect", "unlisted", "diagnosis")


@pytest.fixture(params=[(w, s) for w in WIDTHS for s in ("light", "dark")], ids="-".join)
def window(request, browser):
    """An empty window of a width in a colour scheme."""
    width, scheme = request.param
    page = browser.new_page(viewport={"width": WIDTHS[width], "height": 900}, color_scheme=scheme)
    page.emulate_media(reduced_motion="reduce")
    page.label = f"{width}_{scheme}"
    yield page
    page.close()


@pytest.mark.parametrize("kind", SHOWN)
def test_every_link_opens_its_place(window, find_address, kind):
    window.goto(find_address(kind))
    hidden = window.evaluate("""async () => {
      const missed = [];
      for (const link of document.querySelectorAll("a[href^='#']")) {
        document.querySelectorAll("details").forEach((part) => { part.open = false; });
        link.click();
        await new Promise((done) => setTimeout(done, 20));
        const place = document.getElementById(link.hash.slice(1));
        if (!place.checkVisibility() || location.hash !== link.hash) missed.push(link.hash);
      }
      return missed;
    }""")
    assert hidden == []


@pytest.mark.parametrize("kind", SHOWN)
def test_every_figure_opens_and_the_page_stays_in_the_window(window, find_address, kind):
    window.goto(find_address(kind))
    open_parts(window)
    broken = window.evaluate("""() => [...document.querySelectorAll("figure .enlarge")]
      .filter((button) => {
        button.click();
        const dialog = document.querySelector("dialog");
        const image = dialog.querySelector("img");
        const good = dialog.open && image.alt && button.querySelector("img").naturalWidth > 0;
        dialog.close();
        return !good;
      }).map((button) => button.ariaLabel)""")
    assert broken == []
    wide = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
    assert window.evaluate(wide) <= 0


@pytest.mark.parametrize("kind", ["effect", "adequate", "unlisted"])
def test_the_first_layer_prints_on_two_pages(browser, find_address, kind):
    page = browser.new_page()
    page.goto(find_address(kind))
    PICTURES.mkdir(parents=True, exist_ok=True)
    made = page.pdf(path=PICTURES / f"{kind}.pdf", format="A4")
    page.evaluate("document.querySelector('.tools button:last-child').click()")
    whole = page.pdf(format="A4")
    page.close()
    assert count_pages(made) == 2
    assert count_pages(whole) > 6


def count_pages(pdf):
    return len(re.findall(rb"/Type\s*/Page\b", pdf))


@pytest.mark.parametrize("kind", SHOWN)
def test_pictures_to_look_at(window, find_address, kind):
    PICTURES.mkdir(parents=True, exist_ok=True)
    window.goto(find_address(kind))
    path = PICTURES / f"{kind}_{window.label}.png"
    window.screenshot(path=path, full_page=True)
    assert path.stat().st_size > 50_000
