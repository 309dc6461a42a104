// Camera, its controls, the outline of the domain, and the labels drawn over the picture.
import {
  BufferAttribute, BufferGeometry, Color, LineBasicMaterial, LineSegments, OrthographicCamera, PerspectiveCamera,
  Scene, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { axisOf, dot, type Frame } from "./frame";
import { outline } from "./slice";
import { readable, type Space } from "./space";
import type { Surface } from "./surface";

export type StandardView = "home" | "front" | "right" | "top";

const DIRECTIONS: Record<StandardView, [number, number, number]> = {
  home: [0.95, -1.65, 0.95],
  front: [0, -1, 0],
  right: [1, 0, 0],
  top: [0, -0.0001, 1],
};

export interface Palette {
  line: string;
  text: string;
  background: [string, string];
}

export class SceneView {
  readonly scene = new Scene();
  readonly renderer: WebGLRenderer;
  readonly perspective = new PerspectiveCamera(30, 1, 0.01, 100);
  readonly orthographic = new OrthographicCamera(-1, 1, 1, -1, -50, 100);
  camera: PerspectiveCamera | OrthographicCamera = this.perspective;
  readonly controls: OrbitControls;
  private readonly outline = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ transparent: true }));
  private readonly labels: CanvasRenderingContext2D;
  private requested = 0;
  private frame: Frame | null = null;
  palette: Palette = { line: "#888", text: "#ccc", background: ["#111", "#222"] };
  showAxes = true;
  marker: { point: Vector3; text: string } | null = null;
  afterRender: (milliseconds: number) => void = () => {};

  constructor(
    private readonly stage: HTMLElement, canvas: HTMLCanvasElement, labelCanvas: HTMLCanvasElement,
    private readonly legend: HTMLElement,
    private readonly space: Space, private readonly surface: Surface,
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, powerPreference: "high-performance" });
    this.renderer.setClearColor(0, 0);
    this.labels = labelCanvas.getContext("2d")!;
    this.scene.add(this.outline, surface.object);
    this.outline.frustumCulled = false;
    for (const camera of [this.perspective, this.orthographic]) camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.rotateSpeed = 0.9;
    this.controls.zoomToCursor = true;
    this.controls.minDistance = 0.1;
    this.controls.maxDistance = 30;
    this.controls.addEventListener("change", () => this.request());
    this.look("home");
    new ResizeObserver(() => this.resize()).observe(stage);
    this.resize();
  }

  private radius(): number {
    const shown = this.space.dimension === 3 || !this.frame ? this.space.half : [0, 1, 2].map((row) =>
      this.frame![row]!.reduce((sum, x, k) => sum + Math.abs(x) * this.space.half[k]!, 0));
    return Math.hypot(shown[0]!, shown[1]!, shown[2]!) || 1;
  }

  look(view: StandardView): void {
    const aspect = this.stage.clientWidth / Math.max(1, this.stage.clientHeight);
    const narrow = Math.min(1, aspect * 1.05);
    const distance = (this.radius() * 1.06) / Math.sin((this.perspective.fov * Math.PI) / 360) / narrow;
    const direction = new Vector3(...DIRECTIONS[view]).normalize();
    this.controls.target.set(0, 0, 0);
    this.camera.position.copy(direction.multiplyScalar(distance));
    this.orthographic.zoom = 1;
    this.fitOrthographic();
    this.controls.update();
    this.request();
  }

  pose(): number[] {
    return [...this.camera.position.toArray(), ...this.controls.target.toArray()];
  }
  setPose(pose: readonly number[]): void {
    this.camera.position.fromArray(pose as number[], 0);
    this.controls.target.fromArray(pose as number[], 3);
    this.fitOrthographic();
    this.controls.update();
    this.request();
  }
  dolly(factor: number): void {
    const arm = this.camera.position.clone().sub(this.controls.target).multiplyScalar(factor);
    this.camera.position.copy(this.controls.target).add(arm);
    if (this.camera === this.orthographic) this.orthographic.zoom /= factor;
    this.fitOrthographic();
    this.controls.update();
    this.request();
  }

  setProjection(projection: "perspective" | "orthographic"): void {
    const next = projection === "perspective" ? this.perspective : this.orthographic;
    this.surface.uniforms.orthographic.value = next === this.orthographic;
    if (next !== this.camera) {
      next.position.copy(this.camera.position);
      this.camera = next;
      this.controls.object = next;
      this.orthographic.zoom = 1;
      this.fitOrthographic();
      this.controls.update();
    }
    this.request();
  }

  /// The orthographic camera shows what the perspective one does at the target.
  private fitOrthographic(): void {
    const distance = this.camera.position.distanceTo(this.controls.target);
    const height = distance * Math.tan((this.perspective.fov * Math.PI) / 360);
    const aspect = this.perspective.aspect;
    Object.assign(this.orthographic, { left: -height * aspect, right: height * aspect, top: height, bottom: -height });
    this.orthographic.updateProjectionMatrix();
  }

  private resize(): void {
    const width = Math.max(1, this.stage.clientWidth), height = Math.max(1, this.stage.clientHeight);
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.labels.canvas.width = width * ratio;
    this.labels.canvas.height = height * ratio;
    this.labels.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.perspective.aspect = width / height;
    this.perspective.updateProjectionMatrix();
    this.fitOrthographic();
    this.request();
  }

  setFrame(frame: Frame, offset: number): void {
    this.frame = frame;
    this.surface.setPlane(frame, offset);
    const segments = new Float32Array(outline(this.space, frame, offset));
    this.outline.geometry.dispose();
    this.outline.geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(segments, 3));
    this.outline.visible = this.showAxes && segments.length > 0;
    this.request();
  }

  request(): void {
    if (!this.requested) this.requested = requestAnimationFrame(() => this.render());
  }

  render(): void {
    if (this.requested) cancelAnimationFrame(this.requested);
    this.requested = 0;
    const start = performance.now();
    const material = this.outline.material;
    material.color = new Color(this.palette.line);
    material.opacity = 0.55;
    this.outline.visible = this.showAxes;
    this.renderer.render(this.scene, this.camera);
    this.drawLabels();
    this.afterRender(performance.now() - start);
  }

  /// Where a point of the picture is on the stage, in CSS pixels.
  project(point: Vector3): [number, number] {
    const p = point.clone().project(this.camera);
    return [((p.x + 1) / 2) * this.stage.clientWidth, ((1 - p.y) / 2) * this.stage.clientHeight];
  }

  private drawLabels(): void {
    const { labels } = this;
    labels.clearRect(0, 0, this.stage.clientWidth, this.stage.clientHeight);
    if (this.frame && this.showAxes) {
      labels.fillStyle = this.palette.text;
      const across = axisOf(this.frame);
      if (this.space.dimension === 3) this.drawAxes([0, 1, 2]);
      else if (across >= 0) this.drawAxes([0, 1, 2].map((row) => axisAlong(this.frame![row]!)));
      else this.drawGizmo();
    }
    if (this.marker) this.drawMarker(this.marker.point, this.marker.text);
  }

  /// Ticks along the edges of the domain's box that lie outermost on the screen.
  private drawAxes(axes: number[]): void {
    if (axes.some((k) => k < 0)) return this.drawGizmo();
    const half = axes.map((k) => this.space.half[k]!);
    const sign = axes.map((k, row) => Math.sign(this.frame![row]![k]!));
    const centre = this.project(new Vector3());
    axes.forEach((k, row) => {
      let best: { score: number; corner: Vector3 } | null = null;
      for (let bits = 0; bits < 4; ++bits) {
        const corner = new Vector3();
        [0, 1, 2].filter((i) => i !== row).forEach((i, at) =>
          corner.setComponent(i, ((bits >> at) & 1 ? 1 : -1) * half[i]!));
        const begin = this.project(corner.clone().setComponent(row, -half[row]!));
        const end = this.project(corner.clone().setComponent(row, half[row]!));
        const length = Math.hypot(end[0] - begin[0], end[1] - begin[1]) || 1;
        const across = [(begin[1] - end[1]) / length, (end[0] - begin[0]) / length] as const;
        // How far beside the middle the edge runs: below it rather than above, left of it rather than right.
        const side = (centre[0] - begin[0]) * across[0] + (centre[1] - begin[1]) * across[1];
        const favour = side * (Math.abs(across[0]) > 0.8 ? Math.sign(across[0]) : -Math.sign(across[1]));
        const score = Math.abs(side) + 0.6 * favour;
        if (!best || score > best.score) best = { score, corner };
      }
      this.drawTicks(k, row, best!.corner, half[row]! * sign[row]!, centre);
    });
  }

  private drawTicks(k: number, row: number, corner: Vector3, half: number, centre: [number, number]): void {
    const at = (scene: number) => this.project(corner.clone().setComponent(row, scene));
    const begin = at(-half), end = at(half);
    const length = Math.hypot(end[0] - begin[0], end[1] - begin[1]);
    if (length < 24) return;
    const middle: [number, number] = [(begin[0] + end[0]) / 2, (begin[1] + end[1]) / 2];
    let across: [number, number] = [-(end[1] - begin[1]) / length, (end[0] - begin[0]) / length];
    if ((middle[0] - centre[0]) * across[0] + (middle[1] - centre[1]) * across[1] < 0) across = [-across[0], -across[1]];
    const axis = this.space.axes[k]!;
    const step = niceStep(axis.maximum - axis.minimum, Math.max(2, Math.min(6, Math.floor(length / 50))));
    const { labels } = this;
    labels.textAlign = "center";
    labels.textBaseline = "middle";
    labels.font = "11.5px system-ui, sans-serif";
    labels.strokeStyle = this.palette.line;
    const direction = Math.sign(half) || 1;
    for (let i = Math.ceil(axis.minimum / step - 1e-9); i * step <= axis.maximum + 1e-9 * step; ++i) {
      const [x, y] = at(direction * this.space.scene(k, i * step));
      labels.beginPath();
      labels.moveTo(x, y);
      labels.lineTo(x + 4 * across[0], y + 4 * across[1]);
      labels.stroke();
      labels.globalAlpha = 0.75;
      const text = readable(i * step, step);
      const away = 8 + (Math.abs(across[0]) * labels.measureText(text).width) / 2;
      // Labels at the ends move inwards, or those of two axes would meet at a corner.
      const inward = Math.max(0, 12 - Math.hypot(x - begin[0], y - begin[1])) - Math.max(0, 12 - Math.hypot(x - end[0], y - end[1]));
      labels.fillText(text, x + away * across[0] + (inward * (end[0] - begin[0])) / length, y + 14 * across[1] + (inward * (end[1] - begin[1])) / length);
      labels.globalAlpha = 1;
    }
    labels.font = "600 13px system-ui, sans-serif";
    const name = this.space.label(k);
    const clear = 30 + (Math.abs(across[0]) * labels.measureText(name).width) / 2;
    const margin = labels.measureText(name).width / 2 + 4;
    const within = (x: number) => Math.max(margin, Math.min(this.stage.clientWidth - margin, x));
    const beside = middle[0] + clear * across[0];
    const upper = begin[1] < end[1] ? begin : end;
    // Where it has no room beside the numbers of an upright axis, it stands above the axis.
    if (within(beside) !== beside && Math.abs(across[0]) > 0.8) labels.fillText(name, within(upper[0]), upper[1] - 10);
    else labels.fillText(name, within(beside), middle[1] + 36 * across[1]);
  }

  /// For oblique planes: in which directions of the picture the axes run.
  private drawGizmo(): void {
    const { labels } = this;
    const origin: [number, number] = [58, this.stage.clientHeight - 58];
    const centre = this.project(new Vector3());
    const scale = this.project(new Vector3(0, 0, 0).add(new Vector3(0.01, 0, 0).applyQuaternion(this.camera.quaternion)));
    const pixel = 0.01 / Math.max(1e-6, Math.hypot(scale[0] - centre[0], scale[1] - centre[1]));
    labels.textAlign = "center";
    labels.textBaseline = "middle";
    labels.font = "600 12px system-ui, sans-serif";
    this.space.axes.forEach((axis, k) => {
      const direction = new Vector3(...([0, 1, 2].map((row) => this.frame![row]![k]!) as [number, number, number]));
      const [x, y] = this.project(direction.multiplyScalar(38 * pixel));
      const dx = x - centre[0], dy = y - centre[1];
      labels.strokeStyle = this.palette.text;
      labels.lineWidth = 1.5;
      labels.beginPath();
      labels.moveTo(...origin);
      labels.lineTo(origin[0] + dx, origin[1] + dy);
      labels.stroke();
      labels.lineWidth = 1;
      const length = Math.hypot(dx, dy) || 1;
      labels.fillText(axis.name, origin[0] + dx + (10 * dx) / length, origin[1] + dy + (10 * dy) / length);
    });
  }

  private drawMarker(point: Vector3, text: string): void {
    const { labels } = this;
    const [x, y] = this.project(point);
    labels.strokeStyle = labels.fillStyle = this.palette.text;
    labels.beginPath();
    labels.arc(x, y, 5, 0, 2 * Math.PI);
    labels.stroke();
    const lines = text.split("\n");
    labels.font = "12px system-ui, sans-serif";
    labels.textAlign = "left";
    labels.textBaseline = "middle";
    const width = Math.max(...lines.map((line) => labels.measureText(line).width)) + 20;
    const height = 17 * lines.length + 12;
    // Beside the point, to the right or to the left, or below it where neither has room.
    const { clientWidth, clientHeight } = this.stage;
    const beside = [x + 12, x - 12 - width].find((one) => one >= 4 && one + width + 4 <= clientWidth);
    const left = beside ?? Math.max(4, Math.min(x - width / 2, clientWidth - width - 4));
    const wanted = Math.max(4, Math.min(beside === undefined ? y + 12 : y - height / 2, clientHeight - height - 4));
    const { offsetLeft, offsetTop, offsetWidth, offsetHeight } = this.legend; // which lies above it
    const hidden = left < offsetLeft + offsetWidth && left + width > offsetLeft && wanted < offsetTop + offsetHeight && wanted + height > offsetTop;
    const top = !hidden ? wanted : offsetTop > height + 8 ? offsetTop - height - 4 : offsetTop + offsetHeight + 4;
    labels.fillStyle = this.palette.background[0];
    labels.globalAlpha = 0.92;
    labels.beginPath();
    labels.roundRect(left, top, width, height, 7);
    labels.fill();
    labels.globalAlpha = 1;
    labels.fillStyle = this.palette.text;
    lines.forEach((line, i) => labels.fillText(line, left + 10, top + 15 + 17 * i));
  }

  /// The picture with its labels and background.
  picture(caption: string): HTMLCanvasElement {
    this.render();
    const source = this.renderer.domElement;
    const canvas = document.createElement("canvas");
    canvas.width = source.width;
    canvas.height = source.height;
    const context = canvas.getContext("2d")!;
    const gradient = context.createLinearGradient(0, 0, 0, canvas.height);
    this.palette.background.forEach((colour, i) => gradient.addColorStop(i, colour));
    context.fillStyle = gradient;
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.drawImage(source, 0, 0);
    context.drawImage(this.labels.canvas, 0, 0);
    const ratio = source.width / this.stage.clientWidth;
    context.font = `600 ${15 * ratio}px system-ui, sans-serif`;
    context.fillStyle = this.palette.text;
    context.textBaseline = "bottom";
    context.fillText(caption, 14 * ratio, canvas.height - 12 * ratio);
    return canvas;
  }
}

function axisAlong(row: readonly number[]): number {
  const axis = row.findIndex((x) => Math.abs(Math.abs(x) - 1) < 1e-6);
  return dot(row, row) > 0 ? axis : -1;
}

/// A round step of which `count` or fewer fit into `range`.
function niceStep(range: number, count: number): number {
  const rough = range / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * ([1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999) ?? 10);
}
