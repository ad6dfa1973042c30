// Script of the report: light and dark, figures that zoom, the replay. Needs nothing from outside the page.
"use strict";

(() => {
  const root = document.documentElement;
  // The buttons are listed, and no server is known: plotly itself would offer to send the chart to its cloud.
  const still = { displaylogo: false, responsive: false, doubleClick: "reset", showTips: false,
    showSendToCloud: false, plotlyServerURL: "" };
  const flat = [["toImage"], ["zoom2d", "pan2d", "zoomIn2d", "zoomOut2d", "resetScale2d"]];
  const space = [["toImage"], ["zoom3d", "pan3d", "orbitRotation", "tableRotation", "resetCameraDefault3d"]];
  const drawn = new Map(); // plot element -> figure as stored, in the colours of the light page

  // Light and dark -------------------------------------------------------------------------------------------------

  const prefersDark = matchMedia("(prefers-color-scheme: dark)");
  const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : prefersDark.matches);

  function themeSwitch() {
    const button = document.getElementById("theme");
    const words = () => {
      button.textContent = isDark() ? "Light page" : "Dark page";
    };
    button.hidden = false;
    words();
    const repaint = () => {
      words();
      for (const [plot, figure] of drawn) paint(plot, figure);
    };
    button.addEventListener("click", () => {
      root.dataset.theme = isDark() ? "light" : "dark";
      repaint();
    });
    prefersDark.addEventListener("change", repaint);
  }

  const parse = (color) => {
    const hex = /^#(..)(..)(..)$/.exec(color);
    if (hex) return [...hex.slice(1).map((part) => parseInt(part, 16)), 1];
    const found = /^rgba\((.*)\)$/.exec(color);
    return found ? found[1].split(",").map(Number) : null;
  };

  const luminance = (parts) => {
    const linear = parts.slice(0, 3).map((part) => (part <= 10.3 ? part / 3295 : ((part / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
  };

  // A colour for the dark page: greys change places, ink becomes light, other colours only as light as they must be.
  function forDark(color, least = 0.15) {
    const parts = parse(color);
    if (!parts) return color;
    const rgb = parts.slice(0, 3);
    const lighter = (share) => rgb.map((part) => part + (255 - part) * share);
    let mixed = rgb;
    if (Math.max(...rgb) - Math.min(...rgb) < 26) mixed = rgb.map((part) => 230 - 0.8 * part);
    else if (luminance(rgb) < 0.06) mixed = lighter(0.7);
    else for (let share = 0; luminance(mixed) < least; share += 0.05) mixed = lighter(share);
    return `rgba(${mixed.map(Math.round).join(", ")}, ${parts[3]})`;
  }

  // Words need more contrast than lines: 4.5 to 1 on the dark page.
  function recolored(value, key, least) {
    if (Array.isArray(value)) return value.map((part) => recolored(part, key, least));
    if (value && typeof value === "object") {
      return Object.fromEntries(Object.entries(value).map(([name, part]) => [name, recolored(part, name, name === "font" ? 0.23 : least)]));
    }
    return typeof value === "string" && /color/i.test(key) ? forDark(value, least) : value;
  }

  function themed(figure) {
    const style = getComputedStyle(root);
    const ink = style.getPropertyValue("--ink").trim();
    const line = style.getPropertyValue("--line").trim();
    const paper = style.getPropertyValue("--paper").trim();
    const colored = isDark() ? recolored(figure, "") : figure;
    const layout = { ...colored.layout, paper_bgcolor: paper, plot_bgcolor: paper };
    layout.font = { family: getComputedStyle(document.body).fontFamily, size: 12, color: ink };
    layout.hoverlabel = { bgcolor: paper, bordercolor: line, font: { color: ink } };
    layout.modebar = { orientation: "h", bgcolor: "rgba(0,0,0,0)", color: style.getPropertyValue("--soft").trim(), activecolor: ink };
    for (const [key, axis] of Object.entries(layout)) {
      if (/^[xy]axis/.test(key)) layout[key] = { gridcolor: line, linecolor: line, showline: true, zeroline: false, ...axis };
    }
    if (layout.scene) {
      const axis = { gridcolor: line, color: ink, backgroundcolor: paper, showspikes: false, zeroline: false };
      layout.scene = { ...layout.scene, bgcolor: paper };
      for (const name of ["xaxis", "yaxis", "zaxis"]) layout.scene[name] = { ...axis, ...layout.scene[name] };
    }
    return { data: colored.data, layout };
  }

  // Keep what the reader has zoomed, turned or hidden when the colours change.
  function paint(plot, figure) {
    const { data, layout } = themed(figure);
    const now = plot._fullLayout;
    for (const key of Object.keys(layout)) {
      if (now && /^[xy]axis/.test(key)) layout[key] = { ...layout[key], range: [...now[key].range] };
    }
    if (now && now.scene) layout.scene.camera = plot.layout.scene.camera;
    layout.uirevision = "kept";
    const settings = { ...still, modeBarButtons: layout.scene ? space : flat };
    return Plotly.react(plot, data, layout, settings).then(() => reachable(plot));
  }

  // Figures --------------------------------------------------------------------------------------------------------

  const stored = (figure) => JSON.parse(figure.querySelector("script").textContent);

  function sized(layout, width) {
    const [wide, high, top] = layout.size;
    const height = Math.round((width * high) / wide) + top;
    const legend = { orientation: "h", x: 0, xanchor: "left", y: 1, yref: "container", yanchor: "top" };
    const made = { ...layout, width, height, legend, margin: { l: 0, r: 0, b: 0, t: top, pad: 0 }, dragmode: "zoom" };
    delete made.size;
    return made;
  }

  // On a narrow screen the picture stays: it can be enlarged with two fingers, and its words stay apart.
  const wideEnough = (figure) => figure.clientWidth >= 560;

  function show(figure) {
    if (figure.dataset.shown || !wideEnough(figure)) return;
    const plot = figure.querySelector(".plot");
    plot.hidden = false;
    if (!plot.clientWidth) return; // on paper the picture stays
    figure.dataset.shown = "yes";
    const { data, layout } = stored(figure);
    const made = { data, layout: sized(layout, plot.clientWidth) };
    drawn.set(plot, made);
    paint(plot, made).then(() => {
      figure.classList.add("live");
      plot.addEventListener("keydown", zoomByKey);
    });
  }

  function resize(plot, figure) {
    const holder = plot.closest("figure");
    if (!plot.hidden && !plot.clientWidth) return; // on paper
    if (figure.replay) figure.layout = { ...figure.layout, ...replaySize(figure.layout, plot.clientWidth) };
    else {
      plot.hidden = !wideEnough(holder);
      holder.classList.toggle("live", !plot.hidden);
      if (plot.hidden) return;
      figure.layout = sized({ ...figure.layout, size: stored(holder).layout.size }, plot.clientWidth);
    }
    paint(plot, figure);
  }

  // The buttons of a figure in the order of the tab key.
  function reachable(plot) {
    for (const button of plot.querySelectorAll(".modebar-btn")) {
      button.tabIndex = 0;
      button.setAttribute("role", "button");
      button.setAttribute("aria-label", button.dataset.title || "");
      button.onkeydown = (event) => {
        if (event.key === "Enter" || event.key === " ") {
          event.preventDefault();
          event.stopPropagation();
          button.click();
        }
      };
    }
  }

  function zoomByKey(event) {
    const plot = event.currentTarget;
    if (event.target !== plot) return;
    const steps = { "+": [0.1, 0.9], "=": [0.1, 0.9], "-": [-0.125, 1.125], ArrowLeft: [-0.1, 0.9], ArrowRight: [0.1, 1.1] };
    const step = steps[event.key];
    if (!step && event.key !== "0") return;
    event.preventDefault();
    const change = {};
    const original = drawn.get(plot).layout;
    for (const key of Object.keys(original)) {
      if (!/^[xy]axis/.test(key)) continue;
      const range = plot._fullLayout[key].range.map(Number);
      const at = (share) => range[0] + share * (range[1] - range[0]);
      if (!step) change[`${key}.range`] = [...original[key].range];
      else if (key.startsWith("x")) change[`${key}.range`] = step.map(at);
    }
    Plotly.relayout(plot, change);
  }

  function figures() {
    const charts = [...document.querySelectorAll("figure.chart")];
    const watch = new IntersectionObserver(
      (seen) => seen.filter((entry) => entry.isIntersecting).forEach((entry) => show(entry.target)),
      { rootMargin: "600px" },
    );
    charts.forEach((figure) => watch.observe(figure));
    let late;
    addEventListener("resize", () => {
      clearTimeout(late);
      late = setTimeout(() => {
        for (const [plot, figure] of drawn) resize(plot, figure);
      }, 200);
    });
  }

  // Replay ---------------------------------------------------------------------------------------------------------

  function floats(packed) {
    const bytes = Uint8Array.from(atob(packed.bdata), (letter) => letter.charCodeAt(0));
    return { values: new Float32Array(bytes.buffer), shape: packed.shape.split(", ").map(Number) };
  }

  // In the plane as high as what moves in it asks for, so that equal scales leave no empty sides.
  // The legend stands below the buttons, which take the right end of the first row.
  const BUTTONS = 26;

  function replaySize(layout, width) {
    const placed = (height, margin) => {
      const legend = { orientation: "h", x: 0, y: 1 - BUTTONS / height, yref: "container", yanchor: "top" };
      return { width, height, margin, legend };
    };
    if (layout.scene) return placed(560 + BUTTONS, { l: 0, r: 0, t: 56 + BUTTONS, b: 0 });
    const margin = { l: 64, r: 12, t: 56 + BUTTONS, b: 48 };
    const [across, up] = [layout.xaxis, layout.yaxis].map(({ range }) => range[1] - range[0]);
    const high = ((width - margin.l - margin.r) * up) / across;
    return placed(Math.min(Math.max(high, 240), 540) + margin.t + margin.b, margin);
  }

  function replay() {
    const figure = document.querySelector("figure.replay");
    if (!figure) return;
    const told = stored(figure);
    const points = floats(told.points);
    const modes = told.modes.map((mode) => ({ title: mode.title, ends: mode.ends.map(floats) }));
    const [frames, count, directions] = points.shape;
    const plot = figure.querySelector(".plot");
    const [play, scrub, speed, choice, readout] = ["play", "scrub", "speed", "choice", "readout"].map((name) =>
      figure.querySelector(`[data-part=${name}]`),
    );
    const last = told.time[frames - 1];
    const start = told.time[0];
    const moving = told.traces.map((trace, i) => (trace.take.length ? i : -1)).filter((i) => i >= 0);
    // `frame` is drawn, and the numbers are its own; `time` runs on while it plays.
    const state = { frame: 0, time: start, phase: 0, playing: false, mode: -1, before: 0, busy: false, late: false };
    let places = 3; // of the instants in seconds
    while (places < 6 && told.time.some((time) => Math.abs(Number(time.toFixed(places)) - time) > 1e-7)) places += 1;

    // Coordinates of all points: of a frame, or of a mode at its phase.
    function at() {
      if (state.mode >= 0) {
        const [rest, moved] = modes[state.mode].ends;
        const share = Math.sin(2 * Math.PI * state.phase);
        return (k) => rest.values[k] + share * (moved.values[k] - rest.values[k]);
      }
      const first = state.frame * count * directions;
      return (k) => points.values[first + k];
    }

    function nearest(time) {
      const after = told.time.findIndex((instant) => instant >= time);
      if (after < 1) return after < 0 ? frames - 1 : 0;
      return time - told.time[after - 1] < told.time[after] - time ? after - 1 : after;
    }

    function coordinates() {
      const value = at();
      const letters = ["x", "y", "z"].slice(0, directions);
      const update = Object.fromEntries(letters.map((letter) => [letter, []]));
      for (const i of moving) {
        letters.forEach((letter, d) => {
          update[letter].push(told.traces[i].take.map((point) => (point < 0 ? null : value(point * directions + d))));
        });
      }
      return update;
    }

    function say() {
      if (state.mode >= 0) {
        readout.textContent = `${modes[state.mode].title}; magnified, size arbitrary`;
        scrub.setAttribute("aria-valuetext", state.phase.toFixed(2));
        return;
      }
      const numbers = told.names.map((name, j) => `${name} ${String(told.values[state.frame][j]).replace("-", "\u2212")}`).join(", ");
      const instant = `${told.time[state.frame].toFixed(places)} s`;
      readout.textContent = `t = ${instant}: ${told.what} ${numbers} ${told.unit}`;
      scrub.setAttribute("aria-valuetext", instant);
    }

    function draw() {
      say();
      scrub.value = state.mode >= 0 ? state.phase : state.frame;
      state.late = state.busy;
      if (state.busy) return;
      state.busy = true;
      const update = coordinates();
      moving.forEach((i, j) => {
        for (const letter of Object.keys(update)) drawn.get(plot).data[i][letter] = update[letter][j];
      });
      Plotly.restyle(plot, update, moving).then(() => {
        state.busy = false;
        if (state.late) draw(); // what was asked for meanwhile
      });
    }

    function tick(now) {
      if (!state.playing) return;
      const passed = Math.min((now - state.before) / 1000, 0.2);
      state.before = now;
      const before = state.frame;
      if (state.mode >= 0) state.phase = (state.phase + passed / 2) % 1;
      else {
        state.time = Math.min(last, state.time + passed * Number(speed.value));
        state.frame = nearest(state.time);
        if (state.time === last) toggle();
      }
      if (state.mode >= 0 || state.frame !== before) draw();
      requestAnimationFrame(tick);
    }

    function toggle() {
      state.playing = !state.playing;
      play.textContent = state.playing ? "Pause" : "Play";
      play.setAttribute("aria-pressed", String(state.playing));
      if (!state.playing) return;
      if (state.mode < 0 && state.time >= last) goTo(0);
      state.before = performance.now();
      requestAnimationFrame(tick);
    }

    function goTo(frame) {
      state.frame = Math.min(frames - 1, Math.max(0, frame));
      state.time = told.time[state.frame];
    }

    function step(by) {
      if (state.playing) toggle();
      if (state.mode >= 0) state.phase = Math.min(1, Math.max(0, state.phase + by / 40));
      else goTo(state.frame + by);
      draw();
    }

    function ranges() {
      const mode = state.mode >= 0;
      Object.assign(scrub, { min: 0, max: mode ? 1 : frames - 1, step: mode ? 0.01 : 1 });
      scrub.setAttribute("aria-label", mode ? "Phase" : "Time");
      scrub.value = mode ? state.phase : state.frame;
      speed.disabled = mode;
    }

    modes.forEach((mode, i) => choice.add(new Option(mode.title, String(i))));
    choice.parentElement.hidden = !modes.length;
    ranges();
    play.addEventListener("click", toggle);
    scrub.addEventListener("input", () => {
      if (state.playing) toggle();
      if (state.mode >= 0) state.phase = Number(scrub.value);
      else goTo(Number(scrub.value));
      draw();
    });
    choice.addEventListener("change", () => {
      state.mode = Number(choice.value);
      state.phase = 0.25;
      ranges();
      draw();
    });
    figure.addEventListener("keydown", (event) => {
      if (event.target !== plot) return;
      const keys = { " ": toggle, ArrowRight: () => step(1), ArrowLeft: () => step(-1), Home: () => step(-frames), End: () => step(frames) };
      if (!keys[event.key]) return;
      event.preventDefault();
      keys[event.key]();
    });

    const kind = directions === 3 ? "scatter3d" : "scatter";
    const data = told.traces.map((trace) => ({ type: kind, ...trace }));
    const first = coordinates();
    moving.forEach((i, j) => Object.keys(first).forEach((letter) => (data[i][letter] = first[letter][j])));
    figure.classList.add("live");
    plot.hidden = false;
    const made = { data, replay: true, layout: { ...told.layout, ...replaySize(told.layout, plot.clientWidth) } };
    drawn.set(plot, made);
    paint(plot, made).then(say);
  }

  // Start ----------------------------------------------------------------------------------------------------------

  async function library() {
    const packed = document.getElementById("plotly").textContent;
    const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    const script = document.createElement("script");
    script.textContent = await new Response(stream).text();
    document.head.append(script);
  }

  themeSwitch();
  if (document.getElementById("plotly") && typeof DecompressionStream === "function") {
    library().then(() => {
      replay();
      figures();
      root.dataset.ready = "yes";
    });
  }
})();
