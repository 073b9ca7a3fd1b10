  // The frame of the picture: everything that stands, with room to move it.
  frame() {
    const xs = [], ys = [];
    const note = ([x, y]) => (xs.push(x), ys.push(y));
    this.cell.equipment.forEach(({ footprint: [cx, cy, w, h] }, k) => {
      for (const [i, j] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
        const [x, y] = turned([cx + (i * w) / 2, cy + (j * h) / 2], this.answer.placements[k][3]);
        note([this.answer.placements[k][0] + x, this.answer.placements[k][1] + y]);
      }
    });
    const [cx, cy, w, h] = this.cell.base_footprint;
    note([this.answer.base[0] + cx - w, this.answer.base[1] + cy - h]);
    note([this.answer.base[0] + cx + w, this.answer.base[1] + cy + h]);
    (this.cell.fence || []).forEach(note);
    const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const box = this.element.getBoundingClientRect();
    const shape = box.width / Math.max(box.height, 1) || 1;
    const margin = 0.16 * Math.max(x1 - x0, y1 - y0) + 120;
    let [width, height] = [x1 - x0 + 2 * margin, y1 - y0 + 2 * margin];
    if (width / height < shape) width = height * shape; else height = width / shape;
    const held = this.box;
    // Kept while everything stays inside: nothing jumps under the hand.
    const inside = held && x0 > held[0] && x1 < held[0] + held[2] && y0 > held[1] && y1 < held[1] + held[3];
    const same = held && Math.abs(held[2] / held[3] - shape) < 0.01 * shape;
    if (!(inside && same)) {
      this.box = [(x0 + x1 - width) / 2, (y0 + y1 - height) / 2, width, height];
      const [x, y, w, h] = this.box;
      this.element.setAttribute("viewBox", `${x} ${-y - h} ${w} ${h}`);
      this.unit = w / Math.max(box.width, 1);
      this.ground();
    }
  }

  // Lines every half metre, keep-out boxes, the fence.
  ground() {
    const [x, y, w, h] = this.box;
    const step = 500;
    let lines = "";
    for (let k = Math.ceil(x / step); k * step < x + w; k++) lines += `<path class="grid" d="M${k * step} ${-y}V${-y - h}"/>`;
    for (let k = Math.ceil(y / step); k * step < y + h; k++) lines += `<path class="grid" d="M${x} ${-k * step}H${x + w}"/>`;
    for (const [x0, y0, x1, y1] of this.cell.keep_out) {
      lines += `<rect class="keepout" x="${x0}" y="${-y1}" width="${x1 - x0}" height="${y1 - y0}"/>`;
    }
    if (this.cell.fence) lines += `<polygon class="fence" points="${this.cell.fence.map(([a, b]) => `${a},${-b}`).join(" ")}"/>`;
    // Numbers alone come here: no text of the cell is ever read as markup.
    this.layers[0].innerHTML = lines;
  }

  // How far the arm reaches at the height of the work.
  reached(outlines) {
    const paths = new Set(outlines.map((of) => of.map((o) => `M${o.map(([x, y]) => `${x} ${-y}`).join("L")}Z`).join("")));
    this.layers[2].innerHTML = [...paths].filter(Boolean).map((d) => `<path class="reach" d="${d}"/>`).join("");
  }

  // Draws an answer: where things stand, and the map.
  draw(answer) {
    this.answer = answer;
    if (!this.held) this.frame();
    this.pieces.forEach((piece, k) => {
      if (this.held && this.rides(k, this.held.index)) return;
      piece.at = answer.placements[k];
      this.place(piece.group, piece.at);
      this.label(piece, piece.at);
    });
    this.place(this.base, answer.base);
    const all = answer.operations.flatMap((o) => o.nodes.value.filter((v) => v !== null));
    const [low, high] = [all.reduce((a, b) => Math.min(a, b), Infinity), all.reduce((a, b) => Math.max(a, b), -Infinity)];
    const longest = Math.max(0, ...answer.operations.map((o) => o.nodes.error.reduce((a, e) => (e ? Math.max(a, Math.hypot(e[0], e[1])) : a), 0)));
    const raw = longest > 0 ? Math.min(34 * this.unit, 1.6 * Math.min(...answer.operations.map(spacing))) / longest : 1;
    const digit = 10 ** Math.floor(Math.log10(raw));
    const enlarged = Math.max(Math.floor(raw / digit), 1) * digit;
    this.layers[3].innerHTML = answer.operations.map((o) => this.nodes(o, low, high, enlarged)).join("");
    this.legend(low, high, enlarged);
  }

  rides(k, under) {
    return k === under || (this.cell.equipment[k].on !== null && this.rides(this.cell.equipment[k].on, under));
  }

  nodes(operation, low, high, enlarged) {
    const { nodes, best } = operation;
    // Signs of a fixed size, but no larger than the nodes are apart.
    const u = Math.min(this.unit, spacing(operation) / 11);
    const width = high - low || 1;
    let out = "";
    nodes.at.forEach(([x, y], k) => {
      const at = `${x} ${-y}`;
      if (nodes.value[k] !== null) {
        const fill = colour((nodes.value[k] - low) / width);
        const [ex, ey] = [nodes.error[k][0] * enlarged, -nodes.error[k][1] * enlarged];
        const size = (5 * u) / Math.max(Math.hypot(ex, ey), 5 * u);
        const head = (turn) => [size * (Math.cos(turn) * ex - Math.sin(turn) * ey), size * (Math.sin(turn) * ex + Math.cos(turn) * ey)];
        const [[ax, ay], [bx, by]] = [head(2.7), head(-2.7)];
        const n = (v) => v.toFixed(1);
        out += `<path class="arrow" stroke="${fill}" d="M${at}l${n(ex)} ${n(ey)}l${n(ax)} ${n(ay)}m${n(-ax)} ${n(-ay)}l${n(bx)} ${n(by)}"/>`;
        out += `<circle class="dot" cx="${x}" cy="${-y}" r="${3.6 * u}" fill="${fill}"/>`;
      } else out += glyphMarkup(nodes.status[k], x, -y, 4.4 * u);
    });
    const place = best ? nodes.ij.findIndex(([i, j]) => i === best[0] && j === best[1]) : -1;
    if (place >= 0) out += `<circle class="best" cx="${nodes.at[place][0]}" cy="${-nodes.at[place][1]}" r="${9 * this.unit}"/>`;
    return out;
  }

  legend(low, high, enlarged) {
    const unit = this.answer.unit;
    const key = $("key");
    if (!this.scale) {
      const bar = svg("svg", { width: 120, height: 12 });
      for (let k = 0; k < 40; k++) bar.append(svg("rect", { x: k * 3, y: 0, width: 3.2, height: 12, fill: colour(k / 39) }));
      this.scale = make("span");
      this.arrows = make("span");
      this.signs = make("span", { className: "signs" });
      const colours = make("span", {}, bar, " ", this.scale);
      key.append(colours, this.arrows,
        this.signs,
        legendItem('<circle class="best" r="5.5" stroke-width="2"/>', "spot"),
        legendItem('<path class="reach" d="M-8 0H8"/>', "reach"));
    }
    const seen = new Set(this.answer.operations.flatMap((o) => o.nodes.status));
    const signs = Object.keys(NODE_SIGNS).filter((name) => seen.has(name) && NODE_SIGNS[name].glyph);
    this.signs.replaceChildren(...signs.map((name) => legendItem(glyphMarkup(name, 0, 0, 4.4), NODE_SIGNS[name].label)));
    this.scale.textContent = low <= high ? `${error(low)} to ${error(high)} ${unit}` : "no node can be used";
    this.arrows.textContent = low <= high ? `arrows: error in x and y, ${+enlarged.toPrecision(2)} times` : "";
  }

  // Tells of the node under the pointer.
  point(e) {
    if (!this.answer || !this.unit) return;
    const [x, y] = this.at(e);
    let [near, found] = [9 * this.unit, null];
    for (const o of this.answer.operations) {
      o.nodes.at.forEach((p, k) => {
        const far = Math.hypot(p[0] - x, p[1] - y);
        if (far < near) [near, found] = [far, [o, k]];
      });
    }
    if (!found) return this.told(`x ${short(x, 0)}, y ${short(y, 0)} mm`);
    const [o, k] = found;
    const { nodes } = o;
    const value = nodes.value[k];
    const what = value !== null
      ? `${error(value)} ${this.answer.unit}; error x ${error(nodes.error[k][0])}, y ${error(nodes.error[k][1])}, z ${error(nodes.error[k][2])} mm`
      : nodes.reasons[nodes.why[k]] || nodes.status[k];
    this.told(`${o.name} (${nodes.ij[k].join(", ")}): ${what}`);
  }

  told(text) {
    $("hover").textContent = text;
  }
}
