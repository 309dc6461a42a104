// A page that opens a .glb with three.js' own loader and says which nodes with something to draw are shown.
import { AnimationMixer, Box3, Mesh, LineSegments, Line, Object3D, Vector3 } from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";

declare global { interface Window { glb: unknown } }

function bytesOf(base64: string): ArrayBuffer {
  return Uint8Array.from(atob(base64), (character) => character.charCodeAt(0)).buffer;
}

const isDrawn = (object: Object3D) => object instanceof Mesh || object instanceof LineSegments || object instanceof Line;

window.glb = {
  /// The vertices drawn at `time`, in the world, as they are moved.
  async points(base64: string, time: number) {
    const gltf = await new GLTFLoader().parseAsync(bytesOf(base64), "");
    const mixer = new AnimationMixer(gltf.scene);
    for (const clip of gltf.animations) mixer.clipAction(clip).play();
    mixer.setTime(time);
    gltf.scene.updateMatrixWorld(true);
    const points: number[][] = [];
    gltf.scene.traverse((object) => {
      if (!(object instanceof Mesh) || new Vector3().setFromMatrixScale(object.matrixWorld).length() === 0) return;
      for (let vertex = 0; vertex < object.geometry.attributes["position"].count; ++vertex)
        points.push(object.getVertexPosition(vertex, new Vector3()).applyMatrix4(object.matrixWorld).toArray());
    });
    return points;
  },
  /// The frames shown at each of `times`, in seconds: their names, extras, bounds in the world, drawn parts.
  async shown(base64: string, times: number[]) {
    const gltf = await new GLTFLoader().parseAsync(bytesOf(base64), "");
    const mixer = new AnimationMixer(gltf.scene);
    for (const clip of gltf.animations) mixer.clipAction(clip).play();
    return times.map((time) => {
      mixer.setTime(time);
      gltf.scene.updateMatrixWorld(true);
      const frames = new Map<string, { name: string; time: number; parts: string[]; low: number[]; high: number[]; weights: number[] }>();
      gltf.scene.traverse((object) => {
        if (!isDrawn(object)) return;
        const scale = new Vector3().setFromMatrixScale(object.matrixWorld);
        if (scale.length() === 0) return;
        let frame: Object3D = object;
        while (!frame.name.startsWith("frame") && frame.parent) frame = frame.parent;
        const box = new Box3().setFromObject(object, true);
        const known = frames.get(frame.name) ?? { name: frame.name, time: frame.userData["time"], parts: [],
          low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity], weights: [] };
        known.parts.push(object.name);
        known.low = box.min.toArray().map((x, k) => Math.min(x, known.low[k]!));
        known.high = box.max.toArray().map((x, k) => Math.max(x, known.high[k]!));
        known.weights.push(...((object as Mesh).morphTargetInfluences ?? []));
        frames.set(frame.name, known);
      });
      return [...frames.values()];
    });
  },
};
