"use strict";
(() => {
  const SVG = "http://www.w3.org/2000/svg";
  const DASHES = ["", "7 4", "2 3", "9 3 2 3", "12 4", "4 2", "1 4", "6 2 1 2"];
  const SHAPES = ["circle", "square", "diamond", "up", "down"];
  const KEYS = "Plot. Plus and minus zoom, arrows move, 0 shows all.";

  const made = (name, attributes, parent, text) => {
    const element = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    if (parent) parent.append(element);
    return element;
  };
  const html = (name, parent, text, klass) => {
    const element = document.createElement(name);
    if (text !== undefined) element.textContent = text;
    if (klass) element.className = klass;
    if (parent) parent.append(element);
    return element;
  };
  const shown = (value) => {
    if (value === 0) return "0";
    const size = Math.abs(value);
    return size >= 1e5 || size < 1e-3 ? value.toExponential(2) : String(Number(value.toPrecision(4)));
  };

  /* Places of ticks between two ends; on a logarithmic axis all are exponents. */
  const ticks = (low, high, log, room) => {
    if (log) {
      const found = [];
      const fine = high - low < 3 ? [1, 2, 5] : [1];
      const every = Math.max(1, Math.ceil((high - low) / Math.max(1, room)));
      for (let k = Math.floor(low); k <= Math.ceil(high); k += every) {
        for (const digit of fine) {
          const place = k + Math.log10(digit);
          if (place >= low - 1e-9 && place <= high + 1e-9) found.push(place);
        }
      }
      if (found.length > 1) return found;
    }
    const raw = (high - low) / Math.max(2, room);
    const power = 10 ** Math.floor(Math.log10(raw));
    const step = power * [1, 2, 5, 10].find((m) => m * power >= raw * 0.999);
    const found = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
    return found;
  };

  const shape = (kind, x, y) => {
    const r = 3.5;
    if (kind === "circle") return `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0z`;
    if (kind === "square") return `M${x - r} ${y - r}h${2 * r}v${2 * r}h${-2 * r}z`;
    if (kind === "diamond") return `M${x} ${y - 5}l5 5l-5 5l-5 -5z`;
    if (kind === "up") return `M${x} ${y - 4.5}l4.5 8h-9z`;
    return `M${x} ${y + 4.5}l4.5 -8h-9z`;
  };

  let count = 0;

  class Plot {
    constructor(data, parent) {
      this.data = data;
      this.hidden = new Set();
      this.clip = `clip-${++count}`;
      this.root = html("div", parent, undefined, "plot");
      html("h3", this.root, data.title);
      const beside = html("div", this.root, undefined, "beside");
      this.keys = html("div", beside, undefined, "keys");
      this.frame = html("div", beside, undefined, "drawing");
      this.svg = made("svg", { tabindex: "0", role: "img", "aria-label": `${data.title}. ${KEYS}` }, this.frame);
      this.readout = html("div", this.root, undefined, "readout");
      this.tools();
      this.home = this.whole();
      this.view = { ...this.home };
      this.listen();
      this.draw();
      new ResizeObserver(() => this.draw()).observe(this.frame);
    }

    static lined(curve) {
      return curve.style !== "points" && curve.style !== "stated";
    }

    static dotted(curve) {
      return curve.style.includes("points") || curve.style === "stated";
    }

    tools() {
      const row = html("div", this.root, undefined, "tools");
      for (const [text, label, act] of [
        ["+", "Zoom in", () => this.zoom(0.6)],
        ["\u2212", "Zoom out", () => this.zoom(1 / 0.6)],
        ["All", "Show all", () => this.reset()],
      ]) {
        const button = html("button", row, text, "act");
        button.type = "button";
        button.setAttribute("aria-label", `${label}: ${this.data.title}`);
        button.addEventListener("click", act);
      }
      const curves = this.data.curves;
      if (curves.length === 1 && curves[0].name.toLowerCase() === this.data.title.toLowerCase()) return;
      curves.forEach((curve, k) => {
        const button = html("button", this.keys, undefined, "key");
        button.type = "button";
        button.setAttribute("aria-pressed", "true");
        const sample = made("svg", { viewBox: "0 0 32 12", "aria-hidden": "true" }, button);
        if (Plot.lined(curve)) this.line(sample, "M0 6H32", curve, k);
        if (Plot.dotted(curve)) this.dots(sample, [[16, 6]], curve, k);
        html("span", button, curve.name);
        button.addEventListener("click", () => {
          const off = this.hidden.delete(k) ? "true" : (this.hidden.add(k), "false");
          button.setAttribute("aria-pressed", off);
          this.draw();
        });
      });
    }

    /* Ends of all data with some room around, or those that the axis sets. */
    whole() {
      const ends = {};
      for (const way of ["x", "y"]) {
        const axis = this.data[way];
        let low = Infinity;
        let high = -Infinity;
        for (const curve of this.data.curves) {
          for (const value of curve[way]) {
            if (value === null || (axis.log && value <= 0)) continue;
            const place = axis.log ? Math.log10(value) : value;
            low = Math.min(low, place);
            high = Math.max(high, place);
          }
        }
        if (!(low <= high)) [low, high] = [0, 1];
        const room = (high - low || Math.abs(high) || 1) * (way === "y" ? 0.06 : 0.02);
        const fixed = (value) => (axis.log ? Math.log10(value) : value);
        ends[`${way}0`] = axis.least === null ? low - room : fixed(axis.least);
        ends[`${way}1`] = axis.most === null ? high + room : fixed(axis.most);
      }
      return ends;
    }

    place(x, y) {
      const { x: ax, y: ay } = this.data;
      if (x === null || y === null || (ax.log && x <= 0) || (ay.log && y <= 0)) return null;
      const v = this.view;
      const u = ((ax.log ? Math.log10(x) : x) - v.x0) / (v.x1 - v.x0);
      const w = ((ay.log ? Math.log10(y) : y) - v.y0) / (v.y1 - v.y0);
      return [this.left + u * this.wide, this.top + (1 - w) * this.high];
    }

    draw() {
      const width = Math.max(240, this.frame.clientWidth);
      const height = Math.round(Math.min(420, Math.max(240, 0.58 * width)));
      Object.assign(this, { width, height, left: 62, top: 10, wide: width - 76, high: height - 58 });
      this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
      this.svg.replaceChildren();
      const v = this.view;
      const clip = made("clipPath", { id: this.clip }, made("defs", {}, this.svg));
      const frame = { x: this.left, y: this.top, width: this.wide, height: this.high };
      made("rect", frame, clip);
      for (const at of ticks(v.x0, v.x1, this.data.x.log, this.wide / 70)) {
        const x = this.left + ((at - v.x0) / (v.x1 - v.x0)) * this.wide;
        made("line", { class: "grid", x1: x, x2: x, y1: this.top, y2: this.top + this.high }, this.svg);
        const text = shown(this.data.x.log ? 10 ** at : at);
        made("text", { x, y: this.top + this.high + 16, "text-anchor": "middle" }, this.svg, text);
      }
      for (const at of ticks(v.y0, v.y1, this.data.y.log, this.high / 45)) {
        const y = this.top + (1 - (at - v.y0) / (v.y1 - v.y0)) * this.high;
        made("line", { class: "grid", y1: y, y2: y, x1: this.left, x2: this.left + this.wide }, this.svg);
        const text = shown(this.data.y.log ? 10 ** at : at);
        made("text", { x: this.left - 6, y: y + 4, "text-anchor": "end" }, this.svg, text);
      }
      made("rect", { ...frame, class: "frame" }, this.svg);
      const label = { x: this.left + this.wide / 2, y: height - 8, "text-anchor": "middle" };
      made("text", label, this.svg, this.data.x.label);
      const side = `translate(13 ${this.top + this.high / 2}) rotate(-90)`;
      made("text", { transform: side, "text-anchor": "middle" }, this.svg, this.data.y.label);
      this.layer = made("g", { "clip-path": `url(#${this.clip})` }, this.svg);
      this.data.curves.forEach((curve, k) => this.hidden.has(k) || this.curve(curve, k));
      this.over = made("g", {}, this.svg);
      this.hand = made("line", { class: "hand", y1: this.top, y2: this.top + this.high }, this.layer);
      this.point(this.at);
    }

    /* A cursor at a value of the x axis; without a value it is out of sight. */
    point(x) {
      this.at = x;
      if (!this.hand) return;
      const place = x === undefined ? -10 : this.left + ((x - this.view.x0) / (this.view.x1 - this.view.x0)) * this.wide;
      this.hand.setAttribute("x1", place);
      this.hand.setAttribute("x2", place);
    }

    curve(curve, k) {
      const places = curve.x.map((x, n) => this.place(x, curve.y[n]));
      if (Plot.lined(curve)) {
        let path = "";
        let down = false;
        for (const place of places) {
          if (place) path += `${down ? "L" : "M"}${place[0].toFixed(2)} ${place[1].toFixed(2)}`;
          down = Boolean(place);
        }
        this.line(this.layer, path || "M0 0", curve, k);
      }
      if (Plot.dotted(curve)) this.dots(this.layer, places.filter(Boolean), curve, k);
    }

    line(parent, path, curve, k) {
      const dash = curve.style === "dashed" ? "7 4" : curve.style === "line" ? DASHES[k % 8] : "";
      const given = { d: path, class: `curve k${k % 8}` };
      made("path", dash ? { ...given, "stroke-dasharray": dash } : given, parent);
    }

    dots(parent, places, curve, k) {
      if (curve.style === "stated") {
        const cross = places.map(([x, y]) => `M${x - 5} ${y - 5}l10 10m0 -10l-10 10`).join("");
        made("path", { d: cross || "M0 0", class: "stated" }, parent);
        return;
      }
      const kind = SHAPES[k % SHAPES.length];
      const path = places.map(([x, y]) => shape(kind, x, y)).join("");
      made("path", { d: path || "M0 0", class: `mark f${k % 8}` }, parent);
    }

    zoom(factor, at) {
      const v = this.view;
      const [u, w] = at || [0.5, 0.5];
      const x = v.x0 + u * (v.x1 - v.x0);
      const y = v.y0 + w * (v.y1 - v.y0);
      const next = {
        x0: x + (v.x0 - x) * factor, x1: x + (v.x1 - x) * factor,
        y0: y + (v.y0 - y) * factor, y1: y + (v.y1 - y) * factor,
      };
      const tiny = (a, b, c, d) => b - a < 1e-6 * (d - c) || b - a > 1e3 * (d - c);
      const h = this.home;
      if (tiny(next.x0, next.x1, h.x0, h.x1) || tiny(next.y0, next.y1, h.y0, h.y1)) return;
      this.view = next;
      this.draw();
    }

    move(u, w) {
      const v = this.view;
      const [dx, dy] = [u * (v.x1 - v.x0), w * (v.y1 - v.y0)];
      this.view = { x0: v.x0 + dx, x1: v.x1 + dx, y0: v.y0 + dy, y1: v.y1 + dy };
      this.draw();
    }

    reset() {
      this.view = { ...this.home };
      this.draw();
    }

    /* Where a pointer is, as shares of the axes. */
    share(event) {
      const box = this.svg.getBoundingClientRect();
      const scale = this.width / box.width;
      const u = ((event.clientX - box.left) * scale - this.left) / this.wide;
      const w = 1 - ((event.clientY - box.top) * scale - this.top) / this.high;
      const held = (value) => Math.min(1, Math.max(0, value));
      return [held(u), held(w)];
    }

    listen() {
      this.svg.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        const act = {
          "+": () => this.zoom(0.6), "=": () => this.zoom(0.6), "-": () => this.zoom(1 / 0.6),
          0: () => this.reset(), Escape: () => this.reset(),
          ArrowLeft: () => this.move(-0.2, 0), ArrowRight: () => this.move(0.2, 0),
          ArrowUp: () => this.move(0, 0.2), ArrowDown: () => this.move(0, -0.2),
        }[event.key];
        if (act) {
          event.preventDefault();
          act();
        }
      });
      this.svg.addEventListener("wheel", (event) => {
        if (!event.ctrlKey && document.activeElement !== this.svg) return;
        event.preventDefault();
        this.zoom(event.deltaY < 0 ? 0.8 : 1.25, this.share(event));
      }, { passive: false });
      this.svg.addEventListener("dblclick", () => this.reset());
      this.svg.addEventListener("pointerdown", (event) => {
        if (event.button !== 0 || event.pointerType === "touch") return;
        this.from = this.share(event);
        this.svg.setPointerCapture(event.pointerId);
      });
      this.svg.addEventListener("pointermove", (event) => {
        const here = this.share(event);
        if (this.from) this.box(here);
        else this.near(here);
      });
      this.svg.addEventListener("pointerup", (event) => {
        const from = this.from;
        this.from = null;
        if (!from) return;
        const to = this.share(event);
        const [u0, u1] = [from[0], to[0]].sort((a, b) => a - b);
        const [w0, w1] = [from[1], to[1]].sort((a, b) => a - b);
        if (u1 - u0 > 0.02 && w1 - w0 > 0.02) {
          const v = this.view;
          const [sx, sy] = [v.x1 - v.x0, v.y1 - v.y0];
          this.view = { x0: v.x0 + u0 * sx, x1: v.x0 + u1 * sx, y0: v.y0 + w0 * sy, y1: v.y0 + w1 * sy };
        }
        this.draw();
      });
      this.svg.addEventListener("pointerleave", () => {
        this.readout.textContent = "";
        if (this.over) this.over.replaceChildren();
      });
    }

    box([u, w]) {
      const [x0, x1] = [this.from[0], u].sort((a, b) => a - b);
      const [y0, y1] = [this.from[1], w].sort((a, b) => a - b);
      this.over.replaceChildren();
      made("rect", {
        class: "box", x: this.left + x0 * this.wide, y: this.top + (1 - y1) * this.high,
        width: (x1 - x0) * this.wide, height: (y1 - y0) * this.high,
      }, this.over);
    }

    near([u, w]) {
      const at = [this.left + u * this.wide, this.top + (1 - w) * this.high];
      let best = null;
      this.data.curves.forEach((curve, k) => {
        if (this.hidden.has(k)) return;
        curve.x.forEach((x, n) => {
          const place = this.place(x, curve.y[n]);
          if (!place) return;
          const far = Math.hypot(place[0] - at[0], place[1] - at[1]);
          if (!best || far < best.far) best = { far, place, curve, n };
        });
      });
      this.over.replaceChildren();
      if (!best || best.far > 40) {
        this.readout.textContent = "";
        return;
      }
      made("circle", { class: "dot", cx: best.place[0], cy: best.place[1], r: 6 }, this.over);
      const { curve, n } = best;
      this.readout.textContent =
        `${curve.name}: ${this.data.x.label} ${shown(curve.x[n])}, ${this.data.y.label} ${shown(curve.y[n])}`;
    }
  }

  for (const figure of document.querySelectorAll("figure[data-plots]")) {
    const data = JSON.parse(document.getElementById(figure.dataset.plots).textContent);
    for (const plot of data) new Plot(plot, figure);
  }

  const SPEEDS = [["1:1", 1], ["1:10", 10], ["1:30", 30], ["1:100", 100], ["1:300", 300]];
  const SLOW = 30;

  /* Bodies through a window; up is up. */
  class View {
    constructor(data, parent) {
      this.bodies = data.bodies;
      const [x0, y0, x1, y1] = data.window;
      const box = html("div", parent, undefined, "plot view");
      html("h3", box, data.title);
      const wide = x1 - x0;
      this.letter = wide / 40;
      box.style.flex = `${wide / (y1 - y0)} 1 ${14 * wide / (y1 - y0)}rem`;
      const names = data.labels.map((label) => label.text).join(", ");
      const frame = { viewBox: `${x0} ${-y1} ${wide} ${y1 - y0}`, role: "img", "aria-label": `${data.title}: ${names}` };
      const svg = made("svg", frame, box);
      this.paths = data.bodies.map((body) => made("path", { class: `body ${body.kind}` }, svg));
      this.labels = data.labels.map((label) => ({
        ...label,
        line: made("line", { class: "leader" }, svg),
        word: made("text", { x: label.x, y: -label.y }, svg, label.text),
      }));
      const length = [50, 20, 10, 5, 2, 1].find((size) => size <= wide / 5);
      const [left, low] = [x0 + wide / 60, -y0 - wide / 60];
      made("path", { class: "scale", d: `M${left} ${low - wide / 60}V${low}h${length}v${-wide / 60}` }, svg);
      made("text", { class: "length", x: left + length + wide / 60, y: low }, svg, `${length} mm`);
      new ResizeObserver(() => {
        this.letter = (12 * wide) / Math.max(240, svg.clientWidth);
        svg.style.fontSize = `${this.letter}px`;
        if (this.now) this.show(...this.now);
      }).observe(box);
    }

    show(frame, share) {
      this.now = [frame, share];
      const mixed = (rows) => {
        const row = rows[Math.min(frame, rows.length - 1)];
        const next = rows[Math.min(frame + 1, rows.length - 1)];
        return row.map((value, k) => value + share * (next[k] - value));
      };
      this.bodies.forEach((body, n) => {
        const x = mixed(body.x);
        const y = mixed(body.y);
        const path = this.paths[n];
        let d = "";
        if (body.kind === "joint") d = `M${x[0] - 0.6} ${-y[0]}a.6 .6 0 1 0 1.2 0a.6 .6 0 1 0 -1.2 0z`;
        else x.forEach((value, k) => { d += `${k ? "L" : "M"}${value.toFixed(3)} ${(-y[k]).toFixed(3)}`; });
        path.setAttribute("d", d);
        if (body.level.length) {
          const level = body.level[Math.min(frame, body.level.length - 1)];
          path.setAttribute("fill-opacity", (0.08 + 0.8 * level).toFixed(3));
        }
      });
      for (const { x, y, body, points, line } of this.labels) {
        const mean = (row) => points.reduce((sum, k) => sum + row[k], 0) / points.length;
        const [toX, toY] = [mean(mixed(this.bodies[body].x)), mean(mixed(this.bodies[body].y))];
        const from = toY > y ? y + 0.9 * this.letter : y - 0.3 * this.letter;
        for (const [key, value] of [["x1", x], ["y1", -from], ["x2", toX], ["y2", -toY]]) line.setAttribute(key, value.toFixed(3));
      }
    }
  }

  class Film {
    constructor(data, parent) {
      this.times = data.times;
      this.span = data.times[data.times.length - 1];
      this.at = this.times[Math.floor(this.times.length / 8)];
      this.slow = SLOW;
      this.controls(data, parent);
      const stage = html("div", parent, undefined, "views");
      this.views = data.views.map((view) => new View(view, stage));
      this.fold = html("details", parent);
      html("summary", this.fold, `Curves: ${data.plots.map((plot) => plot.title).join("; ")}`);
      const strips = html("div", this.fold, undefined, "strips");
      this.plots = data.plots.map((plot) => new Plot(plot, strips));
      this.show();
      new IntersectionObserver(([entry]) => { this.seen = entry.isIntersecting; }).observe(stage);
      if (!matchMedia("(prefers-reduced-motion: reduce)").matches) this.play();
    }

    controls(data, parent) {
      const row = html("div", parent, undefined, "controls");
      this.button = html("button", row, "Play");
      this.button.type = "button";
      this.button.addEventListener("click", () => (this.playing ? this.stop() : this.play()));
      const label = html("label", row, "Time ");
      this.slider = html("input", label);
      this.slider.type = "range";
      this.slider.min = 0;
      this.slider.max = data.times.length - 1;
      this.slider.step = 1;
      this.slider.addEventListener("input", () => {
        this.stop();
        this.at = this.times[Number(this.slider.value)];
        this.show();
      });
      this.clock = html("span", row, "", "clock");
      const speed = html("label", row, "Speed ");
      const choice = html("select", speed);
      for (const [name, slow] of SPEEDS) {
        const option = html("option", choice, name);
        option.value = slow;
        option.selected = slow === SLOW;
      }
      choice.addEventListener("change", () => { this.slow = Number(choice.value); });
    }

    play() {
      this.playing = true;
      this.button.textContent = "Pause";
      let before;
      const step = (now) => {
        if (!this.playing) return;
        if (before !== undefined) this.at = (this.at + (now - before) / this.slow) % this.span;
        before = now;
        if (this.seen) this.show();
        requestAnimationFrame(step);
      };
      requestAnimationFrame(step);
    }

    stop() {
      this.playing = false;
      this.button.textContent = "Play";
    }

    show() {
      let frame = 0;
      while (frame < this.times.length - 2 && this.times[frame + 1] <= this.at) frame++;
      const share = (this.at - this.times[frame]) / (this.times[frame + 1] - this.times[frame]);
      for (const view of this.views) view.show(frame, share);
      for (const plot of this.plots) plot.point(this.at);
      this.slider.value = frame + Math.round(share);
      this.slider.setAttribute("aria-valuetext", `${this.at.toFixed(1)} ms`);
      this.clock.textContent = `${this.at.toFixed(1)} of ${this.span.toFixed(1)} ms`;
    }
  }

  for (const figure of document.querySelectorAll("figure[data-film]")) {
    new Film(JSON.parse(document.getElementById(figure.dataset.film).textContent), figure);
  }

  /* Sorting: a button in each heading; pressing it again reverses the order. */
  const valued = (cell) =>
    cell.dataset.sort === undefined ? cell.textContent.trim().toLowerCase() : Number(cell.dataset.sort);
  const compared = (a, b) => {
    if (typeof a === typeof b) return a < b ? -1 : a > b ? 1 : 0;
    return typeof a === "number" ? -1 : 1;
  };
  for (const table of document.querySelectorAll("table.sortable")) {
    const heads = [...table.tHead.rows[0].cells];
    heads.forEach((head, k) => {
      const button = html("button", undefined, head.textContent.trim());
      button.type = "button";
      head.replaceChildren(button);
      head.setAttribute("aria-sort", "none");
      button.addEventListener("click", () => {
        const up = head.getAttribute("aria-sort") !== "ascending";
        for (const other of heads) other.setAttribute("aria-sort", "none");
        head.setAttribute("aria-sort", up ? "ascending" : "descending");
        const rows = [...table.tBodies[0].rows];
        rows.sort((a, b) => (up ? 1 : -1) * compared(valued(a.cells[k]), valued(b.cells[k])));
        table.tBodies[0].append(...rows);
      });
    });
  }

  /* Paper has no folds. */
  const folds = document.getElementsByTagName("details");
  let shut = [];
  addEventListener("beforeprint", () => {
    shut = [...folds].filter((fold) => !fold.open);
    for (const fold of shut) fold.open = true;
  });
  addEventListener("afterprint", () => { for (const fold of shut) fold.open = false; });

  const theme = document.getElementById("theme");
  theme.hidden = false;
  theme.addEventListener("click", () => {
    const root = document.documentElement;
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    const now = root.dataset.theme || (dark ? "dark" : "light");
    root.dataset.theme = now === "dark" ? "light" : "dark";
  });
})();
