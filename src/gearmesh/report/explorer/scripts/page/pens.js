// Two pens with the same strokes: one draws on a canvas, the other writes SVG for the export.

class CanvasPen {
  constructor(context) {
    this.context = context;
  }

  rect(x, y, width, height, colour) {
    this.context.fillStyle = colour;
    this.context.fillRect(x, y, width, height);
  }

  // A line through points (x0, y0, x1, y1, …); a point that is not a number lifts the pen.
  line(points, colour, width = 1, dash = []) {
    const { context } = this;
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.setLineDash(dash);
    context.beginPath();
    let down = false;
    for (let i = 0; i < points.length; i += 2) {
      const x = points[i], y = points[i + 1];
      if (x !== x || y !== y) down = false;
      else if (down) context.lineTo(x, y);
      else context.moveTo(x, y), down = true;
    }
    context.stroke();
  }

  dots(points, colour, size) {
    const { context } = this, half = size / 2;
    context.fillStyle = colour;
    for (let i = 0; i < points.length; i += 2) {
      context.fillRect(points[i] - half, points[i + 1] - half, size, size);
    }
  }

  // An open circle, a square, a diamond, or a triangle that points up or down.
  marker(shape, x, y, radius, stroke, fill) {
    const { context } = this;
    context.beginPath();
    if (shape === "circle") context.arc(x, y, radius, 0, 2 * Math.PI);
    else corners(shape, x, y, radius).forEach(([a, b], i) => i ? context.lineTo(a, b) : context.moveTo(a, b));
    context.closePath();
    context.setLineDash([]);
    context.fillStyle = fill;
    context.fill();
    context.strokeStyle = stroke;
    context.lineWidth = 1.5;
    context.stroke();
  }

  text(words, x, y, colour, { align = "left", baseline = "alphabetic", size = 12, turn = 0, bold = false } = {}) {
    const { context } = this;
    context.save();
    context.translate(x, y);
    context.rotate(turn * Math.PI / 180);
    context.fillStyle = colour;
    context.font = `${bold ? "600 " : ""}${size}px system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif`;
    context.textAlign = align;
    context.textBaseline = baseline;
    context.fillText(words, 0, 0);
    context.restore();
  }

  within(x, y, width, height, draw) {
    const { context } = this;
    context.save();
    context.beginPath();
    context.rect(x, y, width, height);
    context.clip();
    draw();
    context.restore();
  }
}

class SvgPen {
  constructor() {
    this.parts = [];
    this.clips = 0;
  }

  rect(x, y, width, height, colour) {
    this.parts.push(`<rect x="${short(x)}" y="${short(y)}" width="${short(width)}" height="${short(height)}" fill="${colour}"/>`);
  }

  line(points, colour, width = 1, dash = []) {
    let path = "", down = false;
    for (let i = 0; i < points.length; i += 2) {
      const x = points[i], y = points[i + 1];
      if (x !== x || y !== y) down = false;
      else path += `${down ? "L" : "M"}${short(x)} ${short(y)}`, down = true;
    }
    const dashes = dash.length ? ` stroke-dasharray="${dash.join(" ")}"` : "";
    this.parts.push(`<path d="${path}" fill="none" stroke="${colour}" stroke-width="${width}"${dashes}/>`);
  }

  dots(points, colour, size) {
    let path = "";
    for (let i = 0; i < points.length; i += 2) {
      path += `M${short(points[i] - size / 2)} ${short(points[i + 1] - size / 2)}h${size}v${size}h-${size}z`;
    }
    this.parts.push(`<path d="${path}" fill="${colour}"/>`);
  }

  marker(shape, x, y, radius, stroke, fill) {
    const look = `stroke="${stroke}" stroke-width="1.5" fill="${fill}"`;
    if (shape === "circle") this.parts.push(`<circle cx="${short(x)}" cy="${short(y)}" r="${radius}" ${look}/>`);
    else this.parts.push(`<path d="M${corners(shape, x, y, radius).map((p) => p.map(short).join(" ")).join("L")}z" ${look}/>`);
  }

  text(words, x, y, colour, { align = "left", baseline = "alphabetic", size = 12, turn = 0, bold = false } = {}) {
    const anchor = { left: "start", center: "middle", right: "end" }[align];
    const drop = { alphabetic: 0, middle: 0.35 * size, top: 0.8 * size }[baseline];
    const escaped = words.replace(/&/g, "&amp;").replace(/</g, "&lt;");
    this.parts.push(
      `<text transform="translate(${short(x)} ${short(y)}) rotate(${turn})" dy="${drop}" fill="${colour}" ` +
      `font-size="${size}" text-anchor="${anchor}"${bold ? ' font-weight="600"' : ""}>${escaped}</text>`,
    );
  }

  within(x, y, width, height, draw) {
    const name = `clip${this.clips++}`;
    this.parts.push(
      `<clipPath id="${name}"><rect x="${short(x)}" y="${short(y)}" width="${short(width)}" height="${short(height)}"/></clipPath>`,
      `<g clip-path="url(#${name})">`,
    );
    draw();
    this.parts.push("</g>");
  }

  document(width, height, background) {
    return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}" ` +
      `font-family="system-ui, 'DejaVu Sans', sans-serif"><rect width="100%" height="100%" fill="${background}"/>` +
      `${this.parts.join("\n")}</svg>`;
  }
}

function corners(shape, x, y, r) {
  if (shape === "diamond") return [[x, y - 1.3 * r], [x + 1.3 * r, y], [x, y + 1.3 * r], [x - 1.3 * r, y]];
  if (shape === "square") return [[x - r, y - r], [x + r, y - r], [x + r, y + r], [x - r, y + r]];
  const up = shape === "up" ? 1 : -1;
  return [[x, y - up * r], [x + r, y + up * 0.8 * r], [x - r, y + up * 0.8 * r]];
}

function short(x) {
  return Math.round(x * 100) / 100;
}
