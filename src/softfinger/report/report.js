"use strict";
// Everything here is a convenience: without it the page still holds every word, figure and number.

const make = (tag, attributes, ...children) => {
  const element = Object.assign(document.createElement(tag), attributes);
  element.append(...children);
  return element;
};

// light and dark by hand
const root = document.documentElement;
const prefersDark = matchMedia("(prefers-color-scheme: dark)");
const isDark = () => (root.dataset.theme || (prefersDark.matches ? "dark" : "light")) === "dark";
const toggle = make("button", { type: "button", className: "tool" });
const nameToggle = () => { toggle.textContent = isDark() ? "Light colours" : "Dark colours"; };
toggle.addEventListener("click", () => { root.dataset.theme = isDark() ? "light" : "dark"; nameToggle(); });
nameToggle();
prefersDark.addEventListener("change", nameToggle);
document.querySelector("nav").append(make("p", { className: "tools" }, toggle));

// where the reader is
const links = new Map([...document.querySelectorAll("nav a")].map((a) => [a.hash.slice(1), a]));
const watcher = new IntersectionObserver((entries) => {
  for (const entry of entries) {
    if (!entry.isIntersecting) continue;
    links.forEach((link) => link.removeAttribute("aria-current"));
    links.get(entry.target.id).setAttribute("aria-current", "true");
  }
}, { rootMargin: "-10% 0px -80% 0px" });
document.querySelectorAll("main section, details.part").forEach((part) => watcher.observe(part));

// a link into a folded part opens it
const reveal = () => {
  const target = location.hash && document.getElementById(location.hash.slice(1));
  if (!target) return;
  for (let part = target; part; part = part.parentElement) if (part.tagName === "DETAILS") part.open = true;
  target.scrollIntoView();
};
addEventListener("hashchange", reveal);
document.querySelectorAll("a[href^='#']").forEach((link) => link.addEventListener("click", () => setTimeout(reveal)));
reveal();

// paper gets the first layer alone, unless all is opened by hand
const parts = document.querySelectorAll("details");
if (document.querySelector(".referee")) {
  const all = make("button", { type: "button", className: "tool", textContent: "Open all parts, also to print" });
  all.addEventListener("click", () => {
    root.dataset.print = "all";
    parts.forEach((part) => { part.open = true; });
  });
  document.querySelector("nav .tools").append(all);
}

// figures enlarge
const view = make("div", { className: "view" });
const title = make("b", { id: "enlarged-title" });
const close = make("button", { type: "button", className: "tool", textContent: "Close" });
const dialog = make("dialog", {}, make("div", { className: "bar" }, title, close), view);
dialog.setAttribute("aria-labelledby", "enlarged-title");
document.body.append(dialog);
close.addEventListener("click", () => dialog.close());
document.querySelectorAll("figure img").forEach((image) => {
  const button = make("button", { type: "button", className: "enlarge" });
  button.setAttribute("aria-label", `Enlarge: ${image.dataset.title}. ${image.alt}`);
  image.replaceWith(button);
  button.append(image);
  button.addEventListener("click", () => {
    title.textContent = image.dataset.title;
    view.replaceChildren(image.cloneNode());
    dialog.showModal();
  });
});

// tables sort, copy and export; numbers go out in full, not as they are shown
const cellValue = (cell) => cell.dataset.value ?? cell.textContent.trim();
const tableRows = (table) => [...table.rows].map((row) => [...row.cells].map(
  (cell) => (cell.tagName === "TH" ? cell.dataset.label : cellValue(cell))));
const quote = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
const compare = (a, b) => {
  const [x, y] = [Number(a), Number(b)];
  return Number.isNaN(x) || Number.isNaN(y) ? a.localeCompare(b, "en", { numeric: true }) : x - y;
};

const sortBy = (table, head) => {
  const place = head.cellIndex;
  const down = head.getAttribute("aria-sort") === "ascending";
  const body = table.tBodies[0];
  const rows = [...body.rows].sort((a, b) =>
    (down ? -1 : 1) * compare(cellValue(a.cells[place]), cellValue(b.cells[place])));
  table.querySelectorAll("th").forEach((other) => other.removeAttribute("aria-sort"));
  head.setAttribute("aria-sort", down ? "descending" : "ascending");
  body.append(...rows);
};

const say = (button, word) => {
  const before = button.dataset.label;
  button.textContent = word;
  setTimeout(() => { button.textContent = before; }, 1500);
};

const copy = (text, button) => {
  const area = make("textarea", { value: text });
  button.after(area);
  area.select();
  // the asynchronous clipboard is closed to pages that are opened from disk in some browsers
  const done = document.execCommand("copy");
  area.remove();
  button.focus();
  say(button, done ? "Copied" : "Could not copy");
};

const save = (text, name) => {
  const link = make("a", { download: name, href: URL.createObjectURL(new Blob([text], { type: "text/csv" })) });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
};

document.querySelectorAll("table").forEach((table) => {
  table.querySelectorAll("th").forEach((head) => {
    const label = head.textContent.trim();
    head.dataset.label = label;
    if (table.classList.contains("checks") || !label) return;
    const button = make("button", { type: "button", textContent: label, title: "Sort by this column" });
    head.replaceChildren(button);
    button.addEventListener("click", () => sortBy(table, head));
  });
  const tool = (label, act) => {
    const button = make("button", { type: "button", className: "tool", textContent: label });
    button.dataset.label = label;
    button.setAttribute("aria-label", `${label}: table ${table.dataset.name.replaceAll("_", " ")}`);
    button.addEventListener("click", () => act(button));
    return button;
  };
  table.parentElement.after(make("div", { className: "toolbar" },
    tool("Copy", (button) => copy(tableRows(table).map((row) => row.join("\t")).join("\n"), button)),
    tool("CSV", () => save(`${tableRows(table).map((row) => row.map(quote).join(",")).join("\r\n")}\r\n`, `${table.dataset.name}.csv`))));
});
