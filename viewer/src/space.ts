// Coordinates. The *scene* has four axes (three in R^3) whose ranges lie around 0 and reach to 1 or less:
// axes with the same unit keep their proportions, all others are stretched to -1..1.
import type { AxisMetadata, Metadata } from "./metadata";

export type Vector4 = [number, number, number, number];

// Beyond this ratio of lengths a common scale would make the shorter axis invisible.
const MOST_UNEQUAL = 12;

export class Space {
  readonly axes: AxisMetadata[];
  readonly scale: Vector4 = [0, 0, 0, 0]; // scene = level * scale + shift
  readonly shift: Vector4 = [0, 0, 0, 0];
  readonly half: Vector4 = [0, 0, 0, 0]; // the domain is -half..half in the scene
  readonly unit: Vector4 = [1, 1, 1, 1]; // length of 1 in the scene, in the axis's own unit
  readonly timeAxis: number; // -1: no axis is time

  constructor(metadata: Metadata) {
    this.axes = metadata.axes;
    this.timeAxis = metadata.time ? metadata.dimension - 1 : -1;
    const halfLength = (k: number) => (this.axes[k]!.maximum - this.axes[k]!.minimum) / 2 || 1;
    this.axes.forEach((axis, k) => {
      const alike = this.axes.map((_, i) => i).filter((i) =>
        (i === this.timeAxis) === (k === this.timeAxis) && this.axes[i]!.unit === axis.unit);
      const lengths = alike.map(halfLength);
      const longest = Math.max(...lengths);
      this.unit[k] = longest / Math.min(...lengths) > MOST_UNEQUAL ? halfLength(k) : longest;
      this.half[k] = halfLength(k) / this.unit[k]!;
      this.scale[k] = axis.scale / this.unit[k]!;
      this.shift[k] = (axis.origin - this.centre(k)) / this.unit[k]!;
    });
  }

  get dimension(): number {
    return this.axes.length;
  }
  private centre(k: number): number {
    return (this.axes[k]!.minimum + this.axes[k]!.maximum) / 2;
  }
  /// Of a position in the scene, the axis's own coordinate; and back.
  coordinate(k: number, scene: number): number {
    return this.centre(k) + scene * this.unit[k]!;
  }
  scene(k: number, coordinate: number): number {
    return (coordinate - this.centre(k)) / this.unit[k]!;
  }
  /// "x (m)"
  label(k: number): string {
    const { name, unit } = this.axes[k]!;
    return unit ? `${name} (${unit})` : name;
  }
}

/// A number for people, with as many digits as a step of `step` needs, but no more than seven in all.
export function readable(value: number, step: number): string {
  if (!Number.isFinite(value)) return String(value);
  const digits = Math.min(8, Math.max(0, Math.ceil(-Math.log10(Math.abs(step) || 1) - 0.001)));
  const magnitude = Math.abs(value);
  if (magnitude < Math.abs(step) / 100) return (0).toFixed(digits);
  if (magnitude !== 0 && (magnitude >= 1e6 || magnitude < 1e-4)) return value.toPrecision(4).replace(/\.?0+e/, "e");
  const text = value.toFixed(digits);
  return Number(text) === 0 ? (0).toFixed(digits) : text;
}
