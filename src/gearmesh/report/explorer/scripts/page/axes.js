// A frame: a rectangle of pixels with two axes.

class Frame {
  constructor(x, y, width, height, xRange, yRange) {
    Object.assign(this, { x, y, width, height, xRange, yRange });
  }

  toX(value) {
    const [low, high] = this.xRange;
    return this.x + (value - low) / (high - low) * this.width;
  }

  toY(value) {
    const [low, high] = this.yRange;
    return this.y + this.height - (value - low) / (high - low) * this.height;
  }

  fromX(pixel) {
    const [low, high] = this.xRange;
    return low + (pixel - this.x) / this.width * (high - low);
  }

  fromY(pixel) {
    const [low, high] = this.yRange;
    return low + (this.y + this.height - pixel) / this.height * (high - low);
  }

  holds(x, y) {
    return x >= this.x && x <= this.x + this.width && y >= this.y && y <= this.y + this.height;
  }

  // Pixels of points whose coordinates `xOf` and `yOf` return for 0 … count − 1.
  points(count, xOf, yOf) {
    const found = new Float64Array(2 * count);
    for (let i = 0; i < count; i++) {
      found[2 * i] = this.toX(xOf(i));
      found[2 * i + 1] = this.toY(yOf(i));
    }
    return found;
  }

  // Bands of contact loss and inverse mesh across the axis of y, which is `along`.
  regions(pen, theme, backlash, along = "y") {
    const range = along === "y" ? this.yRange : this.xRange;
    const bands = [[-backlash, 0, theme.loss], [-Infinity, -backlash, theme.inverse]];
    pen.rect(this.x, this.y, this.width, this.height, theme.normal);
    for (const [from, to, colour] of bands) {
      const low = Math.max(from, range[0]), high = Math.min(to, range[1]);
      if (!(low < high)) continue;
      if (along === "y") pen.rect(this.x, this.toY(high), this.width, this.toY(low) - this.toY(high), colour);
      else pen.rect(this.toX(low), this.y, this.toX(high) - this.toX(low), this.height, colour);
    }
  }

  axes(pen, theme, { xLabel = "", yLabel = "", xNumbers = true } = {}) {
    const bottom = this.y + this.height, right = this.x + this.width;
    for (const tick of ticks(...this.xRange, Math.max(2, this.width / 75))) {
      const x = this.toX(tick);
      pen.line([x, bottom, x, bottom + 4], theme.soft);
      if (xNumbers) pen.text(label(tick), x, bottom + 7, theme.soft, { align: "center", baseline: "top", size: 11 });
    }
    for (const tick of ticks(...this.yRange, Math.max(2, this.height / 38))) {
      const y = this.toY(tick);
      pen.line([this.x - 4, y, this.x, y], theme.soft);
      pen.text(label(tick), this.x - 7, y, theme.soft, { align: "right", baseline: "middle", size: 11 });
    }
    pen.line([this.x, this.y, right, this.y, right, bottom, this.x, bottom, this.x, this.y], theme.soft);
    if (xLabel) pen.text(xLabel, this.x + this.width / 2, bottom + 23, theme.ink, { align: "center", baseline: "top" });
    if (yLabel) pen.text(yLabel, this.x - 44, this.y + this.height / 2, theme.ink, { align: "center", baseline: "top", turn: -90 });
  }
}

function ticks(low, high, most) {
  const rough = (high - low) / most, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((multiple) => multiple * power >= rough);
  const found = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) found.push(i * step);
  return found;
}

function label(tick) {
  return String(+tick.toFixed(10)).replace("-", "−");
}

// A range that holds all finite values of some arrays, with room at both ends.
function rangeOf(arrays, room = 0.06) {
  let low = Infinity, high = -Infinity;
  for (const array of arrays) {
    for (const value of array) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (!(low < high)) [low, high] = low === high ? [low - 0.5, high + 0.5] : [0, 1];
  const margin = room * (high - low);
  return [low - margin, high + margin];
}

function readTheme() {
  const style = getComputedStyle(document.documentElement), theme = {};
  for (const name of ["page", "ink", "soft", "line", "blue", "red", "grey", "normal", "loss", "inverse", "accent"]) {
    theme[name] = style.getPropertyValue(`--${name}`).trim();
  }
  theme.of = (variant) => ({
    material: theme.blue, lubricant: theme.red, both: theme.ink, conservative: theme.grey,
  })[readVariant(variant).symbol];
  return theme;
}
