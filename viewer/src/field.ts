// A field whose surfaces a worker extracts, as the page uses it.
import type { Mesh } from "./mesh";
import type { Metadata } from "./metadata";
import type { Order, Reply } from "./worker";

declare const WORKER_SOURCE: string;

export class FieldSource {
  private readonly worker: Worker;
  private running = false;
  private wanted: { isovalue: number; resolve: (mesh: Mesh | null) => void; reject: (error: Error) => void } | null = null;
  private answer: ((reply: Reply) => void) | null = null;
  private failure: Error | null = null; // of the module or the samples
  /// Told how far the extraction that runs has come, 0 to 1.
  onProgress: (share: number) => void = () => {};

  constructor(private readonly metadata: Metadata, module: Uint8Array) {
    const address = URL.createObjectURL(new Blob([WORKER_SOURCE], { type: "text/javascript" }));
    this.worker = new Worker(address);
    URL.revokeObjectURL(address);
    this.worker.addEventListener("message", (event) => {
      const reply = event.data as Reply;
      if (reply.kind === "progress") this.onProgress(reply.share);
      else this.receive(reply);
    });
    this.worker.addEventListener("error", (event) => {
      event.preventDefault();
      this.receive({ kind: "failed", message: event.message || "this browser does not run the extraction" });
    });
    this.send({ kind: "open", module, metadata });
  }

  private send(order: Order): void {
    this.worker.postMessage(order);
  }
  private receive(reply: Reply): void {
    if (this.answer) this.answer(reply);
    else if (reply.kind === "failed") this.failure = new Error(reply.message);
    this.answer = null;
  }
  private ask(order: Order): Promise<Reply> {
    return new Promise((resolve, reject) => {
      if (this.failure) return reject(this.failure);
      this.answer = (reply) => (reply.kind === "failed" ? reject(new Error(reply.message)) : resolve(reply));
      this.send(order);
    });
  }

  /// The samples of the next layers.
  add(count: number, bytes: Uint8Array): void {
    this.send({ kind: "layers", count, bytes });
  }

  /// How many samples lie in each of so many even parts of their range; call before surfaces are asked for.
  async histogram(bins: number): Promise<{ counts: number[]; low: number; high: number }> {
    const { origin, step } = this.metadata.samples!;
    const reply = await this.ask({ kind: "histogram", bins });
    if (reply.kind !== "histogram") throw new Error("the worker gave no histogram");
    return { counts: reply.counts, low: origin + step * reply.low, high: origin + step * reply.high };
  }

  /// The surface; null if another has been asked for since, before this one's turn came.
  surface(isovalue: number): Promise<Mesh | null> {
    return new Promise((resolve, reject) => {
      this.wanted?.resolve(null);
      this.wanted = { isovalue, resolve, reject };
      if (!this.running) void this.run();
    });
  }
  private async run(): Promise<void> {
    this.running = true;
    while (this.wanted) {
      const { isovalue, resolve, reject } = this.wanted;
      this.wanted = null;
      try {
        const reply = await this.ask({ kind: "extract", isovalue: this.code(isovalue) });
        resolve(reply.kind === "mesh" ? reply.mesh : null);
      } catch (error) {
        reject(error as Error);
      }
    }
    this.running = false;
  }

  /// An isovalue among the codes of the samples. The page's own is met exactly.
  private code(isovalue: number): number {
    const { origin, step, isovalue: own } = this.metadata.samples!;
    if (isovalue === this.metadata.isovalue) return own;
    const code = (isovalue - origin) / step;
    return Math.abs(code - Math.round(code)) < 1e-6 ? Math.round(code) : code;
  }

  /// The values that isovalues can have: those of the samples.
  range(): [number, number] {
    const { origin, step, narrow, special } = this.metadata.samples!;
    return [origin, origin + step * (narrow ? 255 : special ? 65532 : 65535)];
  }
}
