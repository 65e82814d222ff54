// @ts-check
/** Loads the page again where one of its files did not arrive, as after a change of the network. It is loaded first. */

const PAUSE = 1000; // ms

/** @param {Event} event of an element; these do not bubble */
async function recover({ target }) {
  const parts = location.pathname === "/login" ? "script" : "script, link[rel=stylesheet]"; // a login may be under way
  if (!(target instanceof HTMLElement && target.matches(parts))) return;
  removeEventListener("error", recover, true);
  for (;;) {
    const box = document.querySelector("#empty, #message");
    if (box) box.textContent = "A part of this page did not arrive. It is loaded again as soon as its server answers.";
    box?.removeAttribute("hidden");
    await new Promise((done) => setTimeout(done, PAUSE));
    const answer = await fetch(target.getAttribute("src") ?? target.getAttribute("href") ?? "", { cache: "reload" }).catch(() => null);
    if (answer?.ok || answer?.status === 403) break; // 403: the session has ended, and the page leads to the login
  }
  location.reload();
}

addEventListener("error", recover, true);
