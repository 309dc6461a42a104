// The surface on the graphics card: uploaded once, cut anew in every frame by the vertex shader.
import {
  BufferAttribute, ClampToEdgeWrapping, DataTexture, DoubleSide, GLSL3, Group, InstancedBufferGeometry,
  LinearFilter, LineSegments, Matrix4, Mesh as ThreeMesh, NearestFilter, RawShaderMaterial, RedIntegerFormat,
  RGBAFormat, RGBAIntegerFormat, UnsignedByteType, UnsignedIntType, Vector2, Vector3, Vector4 as ThreeVector4,
} from "three";
import { mapTexels, paletteTexels } from "./colours";
import { type Frame, type LevelPlane, levelPlane } from "./frame";
import { CHUNK, type Mesh } from "./mesh";
import { fragmentShader, TEXTURE_WIDTH, vertexShader } from "./shader";
import { cutChunks } from "./slice";
import type { Space } from "./space";

function integerTexture(data: Uint32Array<ArrayBuffer>, channels: 1 | 4): DataTexture {
  const rows = Math.max(1, Math.ceil(data.length / channels / TEXTURE_WIDTH));
  const texels = new Uint32Array(rows * TEXTURE_WIDTH * channels);
  texels.set(data);
  const format = channels === 4 ? RGBAIntegerFormat : RedIntegerFormat;
  const texture = new DataTexture(texels, TEXTURE_WIDTH, rows, format, UnsignedIntType);
  texture.internalFormat = channels === 4 ? "RGBA32UI" : "R32UI";
  texture.minFilter = texture.magFilter = NearestFilter;
  texture.unpackAlignment = 4;
  texture.needsUpdate = true;
  return texture;
}

function colourTexture(texels: Uint8Array<ArrayBuffer>): DataTexture {
  const texture = new DataTexture(texels, texels.length / 4, 1, RGBAFormat, UnsignedByteType);
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.wrapS = texture.wrapT = ClampToEdgeWrapping;
  texture.needsUpdate = true;
  return texture;
}

function packedVertices(mesh: Mesh): Uint32Array<ArrayBuffer> {
  const packed = new Uint32Array(4 * mesh.vertexCount);
  for (let at = 0; at < packed.length; at += 4) {
    packed[at] = mesh.levels[at]! | (mesh.levels[at + 1]! << 16);
    packed[at + 1] = mesh.levels[at + 2]! | (mesh.levels[at + 3]! << 16);
    packed[at + 2] = (mesh.normals[at]! & 255) | ((mesh.normals[at + 1]! & 255) << 8) |
      ((mesh.normals[at + 2]! & 255) << 16) | ((mesh.normals[at + 3]! & 255) << 24);
  }
  return packed;
}

function chunkIndex(pattern: readonly number[]): BufferAttribute {
  const index = new Uint16Array(CHUNK * pattern.length);
  for (let i = 0; i < index.length; ++i)
    index[i] = 4 * Math.floor(i / pattern.length) + pattern[i % pattern.length]!;
  return new BufferAttribute(index, 1);
}

export class Surface {
  readonly object = new Group();
  private mesh!: Mesh;
  private vertices!: DataTexture;
  private chunkList!: DataTexture;
  private readonly faces = new InstancedBufferGeometry();
  private readonly edges = new InstancedBufferGeometry();
  private readonly opaque: ThreeMesh;
  private readonly layers: ThreeMesh[];
  private readonly wireframe: LineSegments;
  private readonly mapTexture = colourTexture(mapTexels("viridis", false));
  cutChunkCount = 0;
  readonly uniforms;

  constructor(mesh: Mesh, private readonly space: Space) {
    this.uniforms = {
      vertices: { value: null as DataTexture | null },
      simplices: { value: null as DataTexture | null },
      chunks: { value: null as DataTexture | null },
      simplexCount: { value: 0 },
      corners: { value: 0 },
      scale: { value: new ThreeVector4(...space.scale) },
      shift: { value: new ThreeVector4(...space.shift) },
      frame: { value: new Matrix4() },
      plane: { value: new ThreeVector4() },
      planeOffset: { value: 0 },
      colourMode: { value: 0 },
      colourAxis: { value: new ThreeVector4() },
      colourRange: { value: new Vector2(0, 1) },
      solid: { value: new Vector3(0.35, 0.6, 0.86) },
      colourMap: { value: this.mapTexture },
      palette: { value: colourTexture(paletteTexels()) },
      opacity: { value: 1 },
      clip: { value: new ThreeVector4(0, 0, 0, 1) },
      boxLow: { value: new Vector3(-9, -9, -9) },
      boxHigh: { value: new Vector3(9, 9, 9) },
      highlight: { value: -1 },
      section: { value: new ThreeVector4() },
      sectionOffset: { value: 0 },
      sectionMode: { value: 0 },
      sectionColour: { value: new Vector3(1, 0.7, 0.2) },
      orthographic: { value: false },
      mask: { value: false },
    };
    this.faces.setIndex(chunkIndex([0, 1, 2, 0, 2, 3]));
    this.edges.setIndex(chunkIndex([0, 1, 1, 2, 2, 3, 3, 0]));
    this.opaque = new ThreeMesh(this.faces, this.material({ side: 0 }));
    this.layers = [1, 2].map((side) => new ThreeMesh(this.faces, this.material({ side, transparent: true })));
    this.wireframe = new LineSegments(this.edges, this.material({ wire: 1, transparent: true }));
    for (const object of [this.opaque, ...this.layers, this.wireframe]) {
      object.frustumCulled = false;
      this.object.add(object);
    }
    this.layers.forEach((layer, i) => (layer.renderOrder = 1 + i));
    this.wireframe.renderOrder = 3;
    this.setOpacity(1);
    this.setWireframe(false, 1);
    this.replace(mesh);
  }

  /// Another surface instead, in the same space; the plane and the attribute are to be set again.
  replace(mesh: Mesh): void {
    const { uniforms } = this;
    for (const uniform of [uniforms.vertices, uniforms.simplices, uniforms.chunks]) uniform.value?.dispose();
    this.mesh = mesh;
    uniforms.vertices.value = this.vertices = integerTexture(packedVertices(mesh), 4);
    uniforms.simplices.value = integerTexture(mesh.simplices as Uint32Array<ArrayBuffer>, 4);
    uniforms.chunks.value = this.chunkList = integerTexture(new Uint32Array(Math.max(1, mesh.boxes.length / 8)), 1);
    uniforms.simplexCount.value = mesh.simplexCount;
    uniforms.corners.value = mesh.corners;
  }

  private material(options: { side?: number; wire?: number; transparent?: boolean }): RawShaderMaterial {
    return new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader,
      fragmentShader,
      uniforms: { ...this.uniforms, side: { value: options.side ?? 0 }, wire: { value: options.wire ?? 0 } },
      side: DoubleSide,
      forceSinglePass: true,
      transparent: options.transparent ?? false,
      depthWrite: !options.transparent,
      polygonOffset: !options.wire,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    });
  }

  /// Shows the cut by a hyperplane of the scene.
  setPlane(frame: Frame, offset: number): void {
    const { uniforms } = this;
    uniforms.frame.value.set(...frame[0], ...frame[1], ...frame[2], ...frame[3]).transpose();
    const plane: LevelPlane = levelPlane(this.space, frame, offset);
    uniforms.plane.value.set(...plane.normal);
    uniforms.planeOffset.value = plane.offset;
    uniforms.section.value.set(...frame[3]);
    uniforms.sectionOffset.value = offset;
    const chunks = this.chunkList.image.data as Uint32Array;
    if (this.mesh.corners === 4) {
      this.cutChunkCount = cutChunks(this.mesh, plane, chunks);
    } else {
      this.cutChunkCount = this.mesh.boxes.length / 8;
      for (let chunk = 0; chunk < this.cutChunkCount; ++chunk) chunks[chunk] = chunk;
    }
    this.chunkList.needsUpdate = true;
    this.faces.instanceCount = this.edges.instanceCount = this.cutChunkCount;
    this.object.visible = this.cutChunkCount > 0;
  }

  /// Of each vertex what it is coloured by, a label or a number of 16 bits, and its track.
  setValues(values: ArrayLike<number> | null, tracks: ArrayLike<number> | null): void {
    const packed = this.vertices.image.data as Uint32Array;
    for (let vertex = 0; vertex < this.mesh.vertexCount; ++vertex)
      packed[4 * vertex + 3] = ((values ? values[vertex]! & 0xffff : 0) << 16) | (tracks ? tracks[vertex]! : 0);
    this.vertices.needsUpdate = true;
  }

  setMap(name: string, reversed: boolean): void {
    (this.mapTexture.image.data as Uint8Array).set(mapTexels(name, reversed));
    this.mapTexture.needsUpdate = true;
  }

  setOpacity(opacity: number): void {
    this.uniforms.opacity.value = opacity;
    this.opaque.visible = opacity >= 1;
    for (const layer of this.layers) layer.visible = opacity < 1;
  }

  setWireframe(shown: boolean, brightness: number): void {
    this.wireframe.visible = shown;
    (this.wireframe.material as RawShaderMaterial).uniforms["wire"]!.value = brightness;
  }
}

