// Search, base switch, colours, menu. No library, no network; without this file every page can still be read.
"use strict";
(function () {
  const $ = (id) => document.getElementById(id);
  const up = document.body.dataset.up;
  const store = {
    get(key) { try { return localStorage.getItem(key) || ""; } catch (e) { return ""; } },
    set(key, value) { try { localStorage.setItem(key, value); } catch (e) { /* private windows may refuse */ } },
  };

  // Colours: as the computer has them, light, dark.
  const themes = { "": ["◐", "as the computer"], light: ["☀", "light"], dark: ["☾", "dark"] };
  const order = Object.keys(themes);
  function showTheme(name) {
    if (name) document.documentElement.dataset.theme = name; else delete document.documentElement.dataset.theme;
    $("theme").textContent = themes[name][0];
    $("theme").setAttribute("aria-label", "Colours: " + themes[name][1]);
    $("theme").title = "Colours: " + themes[name][1];
  }
  let theme = store.get("ur-theme");
  if (!(theme in themes)) theme = "";
  showTheme(theme);
  $("theme").addEventListener("click", () => {
    theme = order[(order.indexOf(theme) + 1) % order.length];
    store.set("ur-theme", theme);
    showTheme(theme);
  });

  // The menu of narrow screens.
  $("menu").addEventListener("click", () => {
    const open = document.body.classList.toggle("menu-open");
    $("menu").setAttribute("aria-expanded", String(open));
  });

  // The base switch: what is marked with cases is shown for those only.
  const here = document.body.dataset.casesHere.split(" ").filter(Boolean);
  const switch_ = $("base");
  function effective(key) {
    if (!key || !here.length || here.includes(key)) return key;
    const base = key.split(":")[0];
    return here.includes(base) ? base : "";
  }
  function showBase(key) {
    const chosen = effective(key);
    for (const each of document.querySelectorAll("[data-cases]"))
      each.classList.toggle("other-base", Boolean(chosen) && !each.dataset.cases.split(" ").includes(chosen));
    for (const each of document.querySelectorAll("[data-only]")) each.hidden = each.dataset.only !== chosen;
    for (const each of document.querySelectorAll("[data-not-on]"))
      each.classList.toggle("pale", Boolean(key) && each.dataset.notOn.split(" ").includes(key));
    document.body.dataset.base = chosen;
  }
  if (switch_) {
    const known = [...switch_.options].map((option) => option.value);
    switch_.value = known.includes(store.get("ur-base")) ? store.get("ur-base") : "";
    showBase(switch_.value);
    switch_.addEventListener("change", () => {
      store.set("ur-base", switch_.value);
      showBase(switch_.value);
    });
  }

  // Search.
  const input = $("search"), list = $("results"), found = $("found");
  const index = (window.UR_SEARCH || []).map(([title, page, kind, summary, words]) => ({
    title, page, kind, summary, words: words.split(" ").filter(Boolean),
    low: { title: title.toLowerCase(), summary: summary.toLowerCase(), words: words.toLowerCase() },
  }));
  let chosen = -1;
  function score(entry, term) {
    const { title, summary, words } = entry.low;
    if (title === term) return 100;
    if (title.startsWith(term)) return 60;
    if (title.split(/[_.\-]/).some((part) => part.startsWith(term))) return 50;
    if (title.includes(term)) return 40;
    if ((" " + words).includes(" " + term)) return 20;
    if (words.includes(term)) return 12;
    return summary.includes(term) ? 8 : 0;
  }
  function look(query) {
    const terms = query.toLowerCase().split(/\s+/).filter(Boolean);
    if (!terms.length) return [];
    const hits = [];
    for (const entry of index) {
      const scores = terms.map((term) => score(entry, term));
      if (Math.min(...scores) > 0) hits.push([scores.reduce((a, b) => a + b), entry]);
    }
    hits.sort((a, b) => b[0] - a[0] || (a[1].title < b[1].title ? -1 : 1));
    return hits.slice(0, 12).map(([, entry]) => ({ entry, word: matched(entry, terms) }));
  }
  function matched(entry, terms) {
    const term = terms.find((each) => !entry.low.title.includes(each) && !entry.low.summary.includes(each));
    return term ? entry.words.find((word) => word.toLowerCase().includes(term)) || "" : "";
  }
  function piece(name, className, text) {
    const element = document.createElement(name);
    element.className = className;
    element.textContent = text;
    return element;
  }
  function close() {
    list.hidden = true;
    chosen = -1;
    input.setAttribute("aria-expanded", "false");
    input.removeAttribute("aria-activedescendant");
  }
  function choose(number) {
    const items = list.querySelectorAll("[role=option]");
    if (!items.length) return;
    chosen = (number + items.length) % items.length;
    items.forEach((item, i) => item.setAttribute("aria-selected", String(i === chosen)));
    input.setAttribute("aria-activedescendant", items[chosen].id);
    items[chosen].scrollIntoView({ block: "nearest" });
  }
  function refresh() {
    const hits = look(input.value);
    list.replaceChildren(...hits.map(({ entry, word }, i) => {
      const item = piece("li", "", "");
      item.id = "result-" + i;
      item.setAttribute("role", "option");
      const link = piece("a", "", "");
      link.href = up + entry.page;
      link.tabIndex = -1;
      link.append(piece("b", "", entry.title), " ", piece("span", "kind", entry.kind));
      if (word) link.append(" ", piece("code", "", word));
      link.append(piece("span", "about", entry.summary));
      item.append(link);
      return item;
    }));
    if (input.value.trim() && !hits.length) list.replaceChildren(piece("li", "nothing", "Nothing is called like that."));
    found.textContent = input.value.trim() ? hits.length + " found" : "";
    close();
    if (input.value.trim()) {
      list.hidden = false;
      input.setAttribute("aria-expanded", "true");
      choose(0);
    }
  }
  input.addEventListener("input", refresh);
  input.addEventListener("focus", () => { if (input.value.trim() && list.hidden) refresh(); });
  input.addEventListener("keydown", (event) => {
    if (event.key === "ArrowDown") { event.preventDefault(); if (list.hidden) refresh(); else choose(chosen + 1); }
    else if (event.key === "ArrowUp") { event.preventDefault(); choose(chosen - 1); }
    else if (event.key === "Enter") {
      const item = list.hidden ? null : $("result-" + chosen);
      if (item) { event.preventDefault(); item.firstElementChild.click(); }
    } else if (event.key === "Escape") {
      event.preventDefault();
      if (list.hidden) { input.value = ""; input.blur(); } else close();
    } else if (event.key === "Tab") close();
  });
  document.addEventListener("click", (event) => { if (!event.target.closest(".search")) close(); });
  document.addEventListener("keydown", (event) => {
    const typing = event.target.closest("input, select, textarea");
    if (event.key === "/" && !typing && !event.ctrlKey && !event.metaKey && !event.altKey) {
      event.preventDefault();
      input.focus();
      input.select();
    } else if (event.key === "Escape" && document.body.classList.contains("menu-open")) $("menu").click();
  });
})();
