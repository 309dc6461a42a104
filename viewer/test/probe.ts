// Put into a page by the tests: pictures of what the graphics card cuts and of what the CPU cuts.
import {
  BufferAttribute, BufferGeometry, DoubleSide, Mesh, MeshBasicMaterial, Scene, WebGLRenderTarget,
} from "three";
import type { App } from "../src/app";

const app = (window as unknown as { hyperiso: App }).hyperiso;
const WIDTH = 400, HEIGHT = 300;

function drawn(scene: Scene): Uint8Array {
  const { renderer, camera } = app.view;
  const target = new WebGLRenderTarget(WIDTH, HEIGHT);
  const pixels = new Uint8Array(4 * WIDTH * HEIGHT);
  renderer.setRenderTarget(target as never);
  renderer.clear();
  renderer.render(scene as never, camera);
  renderer.readRenderTargetPixels(target as never, 0, 0, WIDTH, HEIGHT, pixels);
  renderer.setRenderTarget(null);
  target.dispose();
  return pixels;
}

/// The silhouettes: pixels covered by each cut, and by only one of them.
function compareMasks(): { gpu: number; cpu: number; differing: number } {
  const { uniforms, object } = app.surface;
  const outer = object.parent!;
  const gpuScene = new Scene();
  uniforms.mask.value = true;
  gpuScene.add(object as never);
  const gpu = drawn(gpuScene);
  uniforms.mask.value = false;
  outer.add(object);

  const triangles = app.slice();
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(triangles.positions.slice(0, 9 * triangles.count), 3));
  const mesh = new Mesh(geometry, new MeshBasicMaterial({ color: 0xffffff, side: DoubleSide }));
  mesh.frustumCulled = false;
  const cpuScene = new Scene();
  cpuScene.add(mesh);
  const cpu = drawn(cpuScene);

  const result = { gpu: 0, cpu: 0, differing: 0 };
  for (let i = 0; i < gpu.length; i += 4) {
    const onGpu = gpu[i]! > 0, onCpu = cpu[i]! > 0;
    result.gpu += Number(onGpu);
    result.cpu += Number(onCpu);
    result.differing += Number(onGpu !== onCpu);
  }
  app.view.render();
  return result;
}

/// What the picture is made of: a number that changes with it, and its mean colour where there is any.
function picture(): { sum: number; covered: number; mean: number[] } {
  app.view.render();
  const gl = app.view.renderer.getContext();
  const { drawingBufferWidth: width, drawingBufferHeight: height } = gl;
  const pixels = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  let sum = 0, covered = 0;
  const total = [0, 0, 0];
  for (let i = 0; i < pixels.length; i += 4) {
    sum = (sum * 31 + pixels[i]! + 7 * pixels[i + 1]! + 13 * pixels[i + 2]!) % 2147483647;
    if (pixels[i + 3] === 0) continue;
    ++covered;
    for (let k = 0; k < 3; ++k) total[k]! += pixels[i + k]!;
  }
  return { sum, covered, mean: total.map((x) => x / Math.max(1, covered)) };
}

function area(): number {
  const { positions: p, count } = app.slice();
  let total = 0;
  for (let at = 0; at < 9 * count; at += 9) {
    const u = [0, 1, 2].map((k) => p[at + 3 + k]! - p[at + k]!), v = [0, 1, 2].map((k) => p[at + 6 + k]! - p[at + k]!);
    total += Math.hypot(u[1]! * v[2]! - u[2]! * v[1]!, u[2]! * v[0]! - u[0]! * v[2]!, u[0]! * v[1]! - u[1]! * v[0]!) / 2;
  }
  return total;
}

Object.assign(window, { probe: { compareMasks, picture, area } });
