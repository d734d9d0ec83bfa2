"""The page in a real browser: every figure loads, nothing is said on the console, tools work."""

import json
import re
import shutil
import subprocess

import pytest

BROWSER = next((path for name in ("chromium", "google-chrome") if (path := shutil.which(name))), "")
FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--enable-logging=stderr",
    "--virtual-time-budget=3000",
    "--dump-dom",
]
PROBE = """
addEventListener("load", () => {
  const images = [...document.querySelectorAll("figure img")];
  const table = document.querySelector("#table-trials");
  const sort = table.querySelectorAll("th button")[4];
  sort.click(); sort.click();
  document.querySelector("figure .enlarge").click();
  const inside = (a) => document.querySelector(a.hash);
  document.title = JSON.stringify({
    images: images.length,
    loaded: images.filter((image) => image.complete && image.naturalWidth > 0).length,
    flagged: [...table.tBodies[0].rows].map((row) => Number(row.cells[4].dataset.value)),
    sorted: table.querySelector("[aria-sort]").getAttribute("aria-sort"),
    enlarged: document.querySelector("dialog").open,
    broken: [...document.querySelectorAll("a[href^='#']")].filter((a) => !inside(a)).length,
    wide: document.documentElement.scrollWidth - document.documentElement.clientWidth,
  });
});
"""

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not BROWSER, reason="no Chromium is installed"),
]


def browse(page, folder, width):
    """Open a page and return what it writes on the console, and its document afterwards."""
    (folder / "page.html").write_text(page, encoding="utf-8")
    command = [BROWSER, *FLAGS, f"--user-data-dir={folder}/profile", f"--window-size={width},900"]
    done = subprocess.run(
        [*command, (folder / "page.html").as_uri()], capture_output=True, text=True, check=True
    )
    return [line for line in done.stderr.splitlines() if "CONSOLE" in line], done.stdout


def test_the_console_stays_silent_and_the_script_may_run(page, tmp_path):
    console, document = browse(page, tmp_path, 1280)
    assert console == []
    assert "Dark colours" in document


@pytest.mark.parametrize("width", [500, 1280])
def test_figures_load_and_tools_work(page, tmp_path, width):
    # the page's own policy forbids foreign scripts, so the probe takes the policy's place
    open_page = re.sub(r"<meta http-equiv=[^>]+>", "", page)
    probed = open_page.replace("</body>", f"<script>{PROBE}</script></body>")
    console, document = browse(probed, tmp_path, width)
    seen = json.loads(re.search(r"<title>(.*?)</title>", document)[1].replace("&quot;", '"'))
    assert console == []
    assert seen["loaded"] == seen["images"] == 14
    assert seen["sorted"] == "descending"
    assert seen["flagged"] == sorted(seen["flagged"], reverse=True)
    assert seen["flagged"][0] > 0
    assert seen["enlarged"]
    assert seen["broken"] == 0
    assert seen["wide"] <= 0
