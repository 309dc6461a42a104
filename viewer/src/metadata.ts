// What a page says about its surface; written by src/view/page.cpp.

export interface AxisMetadata {
  name: string;
  unit: string;
  samples: number; // 0: not on a grid
  minimum: number;
  maximum: number;
  origin: number; // coordinate = origin + level * scale
  scale: number;
  coordinates?: number[]; // of the samples, where they are uneven
}

export type AttributeMetadata =
  | { name: string; kind: "scalar"; minimum: number; maximum: number }
  | { name: string; kind: "label"; labels: number[] };

export interface Track {
  id: number;
  start_time: number;
  end_time: number;
  start_type?: string;
  end_type?: string;
  parents?: number[];
  children?: number[];
  max_volume?: number;
  simplified?: boolean; // too small or too short to be shown
  volumes?: [time: number, volume: number][]; // at the steps
}

export interface TrackEvent {
  time: number;
  type: string;
  position: number[];
  in: number[];
  out: number[];
  delta_euler?: number;
  simplified?: boolean;
}

export interface Tracking {
  regions: boolean; // tracked is what the surface bounds
  tracks: Track[];
  events: TrackEvent[];
}

/// Samples as whole numbers; src/view/sample_codes.hpp. The data are then the module, `blocks` parts of so many
/// layers, and, if there are attributes, those of all vertices of the surface at the page's isovalue.
export interface SamplesMetadata {
  band: boolean; // only those that the surface at the page's isovalue needs
  narrow: boolean;
  special: boolean;
  inside: "above" | "below";
  method: number;
  firstClass: number;
  origin: number; // value = origin + code * step
  step: number;
  isovalue: number; // as a code
  axes: { count: number; first: number; origin: number; spacing: number; coordinates?: number[] }[];
  blocks: number[];
  world?: { linear: number[]; offset: number[] };
}

export interface Metadata {
  format: 1;
  title: string;
  field: string;
  part: string; // of the field that is shown, "t = 0.5 s"; empty: all of it
  dimension: 3 | 4;
  simplexDimension: 2 | 3;
  time: boolean; // the last axis is time
  levels?: boolean; // the last axis is the isovalue: the surface is an interval volume lifted by it
  axes: AxisMetadata[];
  vertices: number;
  simplices: number;
  attributes: AttributeMetadata[];
  colourBy: string;
  notes: string[];
  blocks?: { vertices: number; simplices: number }[]; // of a page that holds the surface
  samples?: SamplesMetadata; // of one that holds samples, and the module that extracts from them
  isovalue?: number;
  tracking?: Tracking;
}

/// The samples' coordinates along an axis, ascending; empty if it has none.
export function samplesOf(axis: AxisMetadata): number[] {
  if (axis.coordinates) return [...axis.coordinates].sort((a, b) => a - b);
  if (axis.samples < 2) return [];
  const step = (axis.maximum - axis.minimum) / (axis.samples - 1);
  return Array.from({ length: axis.samples }, (_, i) => axis.minimum + i * step);
}
