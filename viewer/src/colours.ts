// Colour maps as a few colours between which is interpolated, and the palette of labels.

export const COLOUR_MAPS: Record<string, readonly string[]> = {
  viridis: ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"],
  magma: ["#1d1147", "#51127c", "#832681", "#b73779", "#e75263", "#fc8961", "#fec488", "#fcfdbf"],
  cividis: ["#00224e", "#123570", "#3b496c", "#575d6d", "#707173", "#8a8678", "#a59c74", "#c3b369", "#fee838"],
  "blue to red": ["#2b5cc4", "#5e8fe0", "#9fc0ec", "#dfe3e8", "#f1b79c", "#de7459", "#b52a3a"],
  rainbow: ["#4454c4", "#3f9bdb", "#38c8a4", "#8fd14f", "#ecc23f", "#ee7f3b", "#c6303e"],
  grey: ["#2a2d33", "#f2f3f5"],
};

export type Rgb = [number, number, number]; // 0..1

export function rgb(hex: string): Rgb {
  return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255) as Rgb;
}

function mapColour(name: string, reversed: boolean, share: number): Rgb {
  const stops = COLOUR_MAPS[name] ?? COLOUR_MAPS["viridis"]!;
  const place = Math.max(0, Math.min(1, reversed ? 1 - share : share)) * (stops.length - 1);
  const i = Math.min(Math.floor(place), stops.length - 2);
  const a = rgb(stops[i]!), b = rgb(stops[i + 1]!);
  return a.map((x, k) => x + (place - i) * (b[k]! - x)) as Rgb;
}

export function mapGradient(name: string, reversed: boolean): string {
  const stops = [...(COLOUR_MAPS[name] ?? COLOUR_MAPS["viridis"]!)];
  return `linear-gradient(to right, ${(reversed ? stops.reverse() : stops).join(", ")})`;
}

/// RGBA bytes of a map with 256 steps.
export function mapTexels(name: string, reversed: boolean): Uint8Array<ArrayBuffer> {
  const texels = new Uint8Array(4 * 256);
  for (let i = 0; i < 256; ++i)
    texels.set([...mapColour(name, reversed, i / 255).map((x) => Math.round(255 * x)), 255], 4 * i);
  return texels;
}

const PALETTE_SIZE = 64;

/// Colours that can be told apart, the first ones best: hues a golden angle apart, in rounds of different
/// lightness.
export function labelColour(label: number): string {
  const i = label % PALETTE_SIZE;
  const hue = (212 + i * 137.508) % 360;
  const lightness = [56, 46, 66][Math.floor(i / 3) % 3]!;
  return hslHex(hue, [68, 58, 62][i % 3]!, lightness);
}

function hslHex(hue: number, saturation: number, lightness: number): string {
  const s = saturation / 100, l = lightness / 100;
  const channel = (n: number) => {
    const k = (n + hue / 30) % 12;
    return l - s * Math.min(l, 1 - l) * Math.max(-1, Math.min(k - 3, 9 - k, 1));
  };
  return "#" + [0, 8, 4].map((n) => Math.round(255 * channel(n)).toString(16).padStart(2, "0")).join("");
}

export function paletteTexels(): Uint8Array<ArrayBuffer> {
  const texels = new Uint8Array(4 * PALETTE_SIZE);
  for (let i = 0; i < PALETTE_SIZE; ++i)
    texels.set([...rgb(labelColour(i)).map((x) => Math.round(255 * x)), 255], 4 * i);
  return texels;
}
