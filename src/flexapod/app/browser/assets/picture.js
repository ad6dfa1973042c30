// The picture on the page of `flexapod view`: its camera, in the room that the panel leaves; a notice at its foot.
"use strict";

(look) => {
  const FOV = 50; // vertical, of the whole picture [deg]
  const MARGIN = 0.08; // of the room, on each side: for labels and the thickness of legs
  const LABEL = 130; // of the longest label [px]
  const NOTICE = 32; // height of the room that the notice takes [px]
  const NOTICED = "flexapod-software-rendering"; // kept by the browser once it was said

  const page = (window.flexapodPicture ??= { look: null, placed: null, room: "", panel: null });
  page.look = look;
  page.placed = null; // wherever the camera is now, it is placed anew
  page.room = "";
  if (!page.fit) start();
  page.fit();

  function start() {
    page.fit = fit;
    page.watch = new ResizeObserver(fit);
    page.watch.observe(window.__viserMutable.canvas);
    let rests = 0;
    page.moves = new MutationObserver(() => { // the panel gets its place late, and users move it
      clearTimeout(rests);
      rests = setTimeout(fit, 100);
    });
    if (document.getElementById("webgl-software-rendering")) notice();
  }

  // The panel, the picture behind it, and the largest of the rooms beside, above and below the panel.
  function rooms() {
    const panel = document.querySelector("[role=tablist]")?.closest(".mantine-Paper-root") || null;
    if (panel !== page.panel) {
      if (page.panel) page.watch.unobserve(page.panel);
      page.moves.disconnect();
      if (panel) {
        page.watch.observe(panel);
        page.moves.observe(panel, { attributes: true, attributeFilter: ["style", "class"] });
      }
      page.panel = panel;
    }
    const all = window.__viserMutable.canvas.getBoundingClientRect();
    const whole = { left: all.left, top: all.top, right: all.right, bottom: all.bottom };
    if (!panel) return { all, room: whole };
    const over = panel.getBoundingClientRect();
    const area = ({ left, top, right, bottom }) => Math.max(right - left, 0) * Math.max(bottom - top, 0);
    const found = [
      { ...whole, right: Math.min(over.left, whole.right) },
      { ...whole, left: Math.max(over.right, whole.left) },
      { ...whole, bottom: Math.min(over.top, whole.bottom) },
      { ...whole, top: Math.max(over.bottom, whole.top) },
    ];
    return { all, room: found.reduce((one, other) => (area(other) > area(one) ? other : one)) };
  }

  // Put the middle of the picture into the middle of the room, and the camera where all fits into the room, unless
  // somebody has moved it since.
  function fit() {
    const { camera, cameraControl: control } = window.__viserMutable;
    const { all, room } = rooms();
    if (page.notice?.isConnected) room.bottom -= NOTICE;
    const [width, height] = [room.right - room.left, room.bottom - room.top];
    const now = [all.width, all.height, room.left, room.top, width, height].map(Math.round).join();
    if (!control || now === page.room || Math.min(width, height) < 1) return;
    page.room = now;
    const middle = (low, high) => 0.5 * (low + high);
    const right = middle(room.left, room.right) - middle(all.left, all.right);
    const down = middle(room.top, room.bottom) - middle(all.top, all.bottom);
    camera.view = { enabled: true, fullWidth: 1, fullHeight: 1, width: 1, height: 1,
      offsetX: -right / all.width, offsetY: -down / all.height };
    if (stands(camera, control)) {
      place(camera, control, ...[width, height, Math.min(LABEL, 0.3 * width)].map((size) => size / all.height));
    }
    camera.updateProjectionMatrix();
    window.__viserMutable.requestRender();
    if (page.notice) {
      page.notice.style.left = `${room.left + 8}px`;
      page.notice.style.bottom = `${window.innerHeight - room.bottom - NOTICE + 4}px`;
      page.notice.style.maxWidth = `${width - 16}px`;
    }
  }

  // Whether the camera is where it was placed, or was not placed yet.
  function stands(camera, control) {
    if (!page.placed) return true;
    const at = (get) => get.call(control, camera.position.clone()).toArray();
    const now = [...at(control.getPosition), ...at(control.getTarget)];
    return now.every((value, i) => Math.abs(value - page.placed.at[i]) < 1e-4 * page.placed.distance);
  }

  // The camera looks along -`away`, as near as all points stay in a room of this width and height, in heights of the
  // picture: -a_i (z0 - z_i) <= x_i - x0 <= b_i (z0 - z_i), z towards the camera at (x0, y0, z0), and so for y. Points
  // with a label have room for it at their right.
  function place(camera, control, width, height, label) {
    const [w, ...turn] = window.__viserSceneTree.getState()[""].wxyz; // axes of the scene in those of the camera
    const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];
    const three = (p) => {
      const [one, two] = [cross(turn, p), cross(turn, cross(turn, p))];
      return p.map((value, i) => value + 2 * (w * one[i] + two[i]));
    };
    const dot = (one, other) => one.reduce((sum, value, i) => sum + value * other[i], 0);
    const unit = (vector) => vector.map((value) => value / Math.hypot(...vector));
    const back = unit(three(page.look.away));
    const side = unit(cross([0, 1, 0], back));
    const up = cross(back, side);
    const points = [...page.look.points, ...page.look.labelled].map(three);
    const [xs, ys, zs] = [side, up, back].map((axis) => points.map((point) => dot(point, axis)));
    const slope = 2 * Math.tan((FOV * Math.PI) / 360);
    const [across, upright] = [width, height].map((size) => slope * size * (0.5 - MARGIN));
    const right = points.map((_, i) => across - (i < page.look.points.length ? 0 : slope * label));
    // From where to where the camera may stand sideways at a distance.
    const span = (places, low, high, z0) => [
      Math.max(...places.map((x, i) => x - high(i) * (z0 - zs[i]))),
      Math.min(...places.map((x, i) => x + low(i) * (z0 - zs[i]))),
    ];
    const level = (z0) => span(xs, () => across, (i) => right[i], z0);
    const plumb = (z0) => span(ys, () => upright, () => upright, z0);
    const fits = (z0) => [level(z0), plumb(z0)].every(([low, high]) => low <= high);
    const nearest = Math.max(...zs);
    let [inside, far] = [nearest, nearest + 1e-6];
    while (!fits(far)) far = nearest + 2 * (far - nearest);
    for (let i = 0; i < 40; i++) {
      const middle = 0.5 * (inside + far);
      if (fits(middle)) far = middle;
      else inside = middle;
    }
    const depth = 0.5 * (Math.min(...zs) + nearest);
    const distance = far - depth;
    const [x, y] = [level(far), plumb(far)].map(([low, high]) => 0.5 * (low + high));
    const from = (z) => [0, 1, 2].map((i) => x * side[i] + y * up[i] + z * back[i]);
    const [eye, target] = [from(far), from(depth)];
    Object.assign(camera, { fov: FOV, near: Math.min(0.01, 0.02 * distance), far: Math.max(1000, 50 * distance) });
    camera.up.set(0, 1, 0);
    control.updateCameraUp();
    control.setPosition(...eye, false);
    control.setTarget(...target, false);
    page.placed = { at: [...eye, ...target], distance };
  }

  // Said once in a browser, small, in place of viser's notice, which the page hides.
  function notice() {
    if (remembered()) return;
    const words = document.createElement("div");
    words.className = "flexapod-notice";
    words.setAttribute("role", "status");
    words.textContent = "Drawn without a graphics card: the picture may be slow.";
    const close = document.createElement("button");
    close.textContent = "\u00d7";
    close.setAttribute("aria-label", "Close");
    close.addEventListener("click", () => {
      words.remove();
      fit();
    });
    words.append(close);
    document.body.append(words);
    page.notice = words;
  }

  function remembered() {
    try {
      const was = localStorage.getItem(NOTICED);
      localStorage.setItem(NOTICED, "said");
      return was !== null;
    } catch {
      return false; // a browser that keeps nothing is told each time
    }
  }
};
