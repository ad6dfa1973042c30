// Script of the page of `flexapod view`, sent to the browser when a study is opened: what viser's page lacks.
"use strict";

(title) => {
  document.title = title;
  if (window.flexapodPage) return; // another study on the same page
  window.flexapodPage = true;

  const LEFT = "\u2003"; // as in typed.py: the text of a field that was left
  const style = document.createElement("style");
  style.textContent = `
    [data-mantine-color-scheme=light] { --mantine-color-dimmed: #5c636a !important; }
    [data-mantine-color-scheme=dark] { --mantine-color-dimmed: #a6a7ab !important; --flexapod-soft: #b0b0b0;
      --flexapod-good: #7fc99c; --flexapod-warning: #e0b04c; --flexapod-error: #ff8a80; }
    .mantine-Button-root { --button-bg: #005aa0 !important; --button-hover: #004a85 !important; }
    .mantine-Button-root[style*="gray"] { --button-bg: #566069 !important; --button-hover: #454d55 !important; }
    .mantine-Button-root[style*="red"] { --button-bg: #b3261e !important; --button-hover: #93201a !important; }
    .mantine-Slider-root + .mantine-NumberInput-root { display: none; }
    .flexapod-below { margin: -0.5em 0 0.4em; }
    .mantine-Paper-root[style*="position: fixed"] { width: 100% !important; max-height: 55% !important; }
    .mantine-Paper-root[style*="position: fixed"] [style*="width: 20em"] { width: 100% !important; }
    .flexapod-notice { position: fixed; left: 8px; bottom: 8px; z-index: 5; display: flex; align-items: center;
      padding: 0.1em 0.2em 0.1em 0.6em; border-left: 3px solid #e8590c; font-size: 0.75rem;
      color: var(--mantine-color-text); background: var(--mantine-color-body); }
    .flexapod-notice button { padding: 0 0.5em; border: 0; background: none; color: inherit; cursor: pointer;
      font-size: 1.1rem; line-height: 1.4; }
    [role="button"]:focus-visible, canvas:focus-visible { outline: 2px solid #005aa0; outline-offset: -2px; }`;
  document.head.append(style);

  // Keys --------------------------------------------------------------------------------------------------------

  // viser moves the camera by keys wherever the focus is; here only while it is on the picture.
  const MOVES = /^(Key[WASDQE]|Arrow(Up|Down|Left|Right))$/;
  const isPicture = (part) => part instanceof HTMLCanvasElement && /three/.test(part.dataset.engine || "");
  document.body.addEventListener("keydown", (event) => {
    if (MOVES.test(event.code) && !isPicture(event.target)) event.stopPropagation();
  });
  document.addEventListener("pointerdown", (event) => {
    if (isPicture(event.target)) event.target.focus({ preventScroll: true });
    else if (isPicture(document.activeElement)) document.activeElement.blur();
  }, true);

  // Fields ------------------------------------------------------------------------------------------------------

  const setText = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value").set;
  const isField = (part) => part instanceof HTMLInputElement && part.dataset.flexapod === "field";

  // What somebody is writing, and where: nobody else puts a text in its place before the field is left. An answer to
  // what was written before may still be on its way.
  let writing = null;

  // Tell the server that a field was left: it reads the text at once, and answers with the text to show, the value
  // before where the field is empty. viser drops what is sent within 50 ms of something else: it is told again then.
  function tell(field, text, times = 1) {
    writing = null;
    const told = text + LEFT.repeat(times); // another text each time, or nobody is told
    setText.call(field, told);
    field.dispatchEvent(new Event("input", { bubbles: true }));
    if (times < 5) setTimeout(() => {
      if (field.isConnected && field.value === told) tell(field, text, times + 1);
    }, 400);
  }

  document.addEventListener("focusin", ({ target }) => {
    if (isField(target)) target.dataset.before = target.value.trim();
  });
  document.addEventListener("focusout", ({ target }) => {
    const text = isField(target) ? target.value.trim() : "";
    if (isField(target) && (!text || text !== target.dataset.before)) tell(target, text);
  });
  document.addEventListener("input", ({ isTrusted, target }) => {
    if (!isTrusted || !isField(target)) return;
    const text = target.value.replaceAll(LEFT, "");
    if (text !== target.value) setText.call(target, text); // somebody writes on
    writing = { field: target, text };
  }, true);
  new MutationObserver(() => {
    if (!writing || writing.field !== document.activeElement || writing.field.value === writing.text) return;
    setText.call(writing.field, writing.text);
    writing.field.dispatchEvent(new Event("input", { bubbles: true }));
  }).observe(document.body, { attributes: true, attributeFilter: ["value"], subtree: true });
  document.addEventListener("keydown", ({ key, target }) => {
    if (!isField(target) || !["Enter", "Escape"].includes(key)) return;
    tell(target, key === "Enter" ? target.value.trim() : "");
  }, true);

  // Names -------------------------------------------------------------------------------------------------------

  const ICONS = { adjustments: "Settings of the page", "arrow-back": "Back from the settings", minus: "Fold away" };
  const named = (button) => {
    const icon = button.querySelector("svg")?.classList.value.match(/tabler-icon-([a-z-]+)/)?.[1];
    return button.closest(".mantine-Notification-root") ? "Close" : ICONS[icon] || icon || "Button";
  };

  // Labels that belong to no input, sliders and folders without a name or a place among the keys, wrong words.
  function mend() {
    let name = ""; // of the field above
    for (const label of document.querySelectorAll("label[for]")) {
      const row = label.parentElement.parentElement.parentElement;
      const thumb = row.querySelector("[role=slider]");
      name = label.textContent || name;
      if (thumb) {
        thumb.setAttribute("aria-label", name);
        row.classList.add("flexapod-below");
      } else if (!document.getElementById(label.htmlFor)) {
        const field = row.querySelector("input[type=text], input:not([type])");
        if (!field) continue;
        field.id = label.htmlFor;
        field.dataset.flexapod = "field";
        field.autocomplete = "off";
      }
    }
    for (const arrow of document.querySelectorAll(".tabler-icon-chevron-up, .tabler-icon-chevron-down")) {
      const head = arrow.parentElement;
      if (head.closest("button, .mantine-Input-wrapper")) continue;
      head.setAttribute("aria-expanded", String(arrow.classList.contains("tabler-icon-chevron-up")));
      if (head.role === "button") continue;
      head.role = "button";
      head.tabIndex = 0;
      head.addEventListener("keydown", (event) => {
        if (event.target !== head || !["Enter", " "].includes(event.key)) return;
        event.preventDefault();
        head.click();
      });
    }
    for (const picture of document.querySelectorAll("canvas[data-engine]")) {
      if (!isPicture(picture) || picture.tabIndex === 0) continue;
      picture.tabIndex = 0;
      picture.setAttribute("role", "img");
      picture.setAttribute("aria-label", "The picture: arrow keys turn it, W, A, S, D, Q and E move it");
    }
    for (const button of document.querySelectorAll("button:not([aria-label])")) {
      if (!button.textContent.trim()) button.setAttribute("aria-label", named(button));
    }
    for (const bar of document.querySelectorAll(".mantine-Progress-section:not([aria-label])")) {
      const what = bar.closest(".mantine-Notification-root") ? "upload" : "simulation";
      bar.setAttribute("aria-label", `Progress of the ${what}`);
    }
    for (const words of document.querySelectorAll(".mantine-Notification-description")) {
      if (words.firstChild?.data === "File uploaded successfully.") {
        words.firstChild.data = "Sent. The tab Files says whether it is taken.";
      }
    }
    window.flexapodPicture?.fit(); // the panel may be another one
  }

  let waits = false;
  const later = () => {
    if (waits) return;
    waits = true;
    setTimeout(() => {
      waits = false;
      mend();
    }, 50);
  };
  new MutationObserver(later).observe(document.body, { childList: true, subtree: true });
  mend();
};
