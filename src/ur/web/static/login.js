// @ts-check
/** Logs in with the token of the link. It stands behind the `#`, so it is in no server's log. */

import { TEXTS } from "./texts.js";

async function logIn() {
  const message = /** @type {HTMLElement} */ (document.getElementById("message"));
  const token = location.hash.slice(1);
  history.replaceState(null, "", "/login");
  if (!token) {
    message.textContent = TEXTS.noToken;
    return;
  }
  message.textContent = TEXTS.loggingIn;
  try {
    const answer = await fetch("/login", { method: "POST", body: JSON.stringify({ token }) });
    if (answer.ok || (await fetch("/api/me")).ok) {
      location.replace("/");
      return;
    }
    message.textContent = TEXTS.loginFailed;
  } catch {
    message.textContent = TEXTS.loginOffline;
  }
}

addEventListener("hashchange", logIn); // another link was opened in this tab: the browser does not load the page again
logIn();
