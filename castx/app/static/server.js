// What the page asks the server: by POST with the token of its address and the name of this window.
"use strict";

castx.server = (() => {
  const token = new URLSearchParams(location.search).get("token") ?? "";
  const named = () => {
    let name = sessionStorage.getItem("castx-window");
    if (name === null) {
      name = Array.from(crypto.getRandomValues(new Uint8Array(16)), (x) => x.toString(16).padStart(2, "0")).join("");
      sessionStorage.setItem("castx-window", name);
    }
    return name;
  };
  const window_ = named();
  let lost = () => {};

  const send = (action, asked, keepalive = false) => fetch(`/api/${action}`, {
    method: "POST", keepalive, body: JSON.stringify(asked),
    headers: { "Content-Type": "application/json", Authorization: `Bearer ${token}`, "Castx-Window": window_ },
  });

  // The answer; throws what castx says against it.
  const ask = async (action, asked = {}) => {
    let response;
    try {
      response = await send(action, asked);
    } catch {
      throw new Error("castx app does not answer: it has ended. Start it again, and open its new address.");
    }
    const answer = await response.json();
    if (response.status === 409) lost();
    if (!response.ok) throw new Error(answer.error);
    return answer;
  };

  window.addEventListener("pagehide", () => { send("leave", { window: window_ }, true).catch(() => {}); });

  return {
    ask, claim: (force) => ask("claim", { window: window_, force }),
    onLost: (act) => { lost = act; },
  };
})();

// Make an element: its class or attributes, then what is inside it; texts are never read as HTML.
castx.make = (name, attributes = {}, ...inside) => {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (key in made && key !== "list") made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...inside);
  return made;
};
castx.at = (id) => document.getElementById(id);
