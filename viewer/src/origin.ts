// Payloads that stand in the page itself: the only part of the viewer that knows this.
import { inflate } from "./bytes";
import type { Metadata } from "./metadata";

const nextFrame = () => new Promise((resolve) => setTimeout(resolve, 0));

/// The page's script runs before its data has been read: waits until `found` finds something, or all is read.
async function waitFor<T>(found: () => T | null): Promise<T | null> {
  for (;;) {
    // Before `found`: what has not been there while the page was read may be there now.
    const complete = document.readyState !== "loading";
    const result = found();
    if (result !== null || complete) return result;
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
}

export async function documentMetadata(): Promise<Metadata> {
  const last = () => document.querySelector("script.hyperiso-block") || document.readyState !== "loading";
  const element = await waitFor(() => (last() ? document.getElementById("hyperiso-metadata") : null));
  if (!element) throw new Error("this page holds no data");
  let metadata: Metadata;
  try {
    metadata = JSON.parse(element.textContent!) as Metadata;
  } catch {
    throw new Error("the description of the data is damaged");
  }
  if (metadata.format !== 1) throw new Error(`the data has format ${metadata.format}; this viewer reads format 1`);
  return metadata;
}

/// The blocks in their order, each as soon as it is read; frees the text of those that are done.
export async function* documentBlocks(count: number): AsyncGenerator<Uint8Array> {
  for (let block = 0; block < count; ++block) {
    const element = await waitFor(() => {
      const elements = document.querySelectorAll("script.hyperiso-block");
      // One that is still being read is the last; it is complete once something follows it.
      return elements.length > block + 1 || (document.readyState !== "loading" && elements.length > block)
        ? elements[block]! : null;
    });
    if (!element) throw new Error(`part ${block + 1} of ${count} of the data is missing: the file is cut short`);
    const text = element.textContent!;
    element.textContent = "";
    await nextFrame();
    try {
      yield await inflate(text);
    } catch {
      throw new Error(`part ${block + 1} of ${count} of the data is damaged`);
    }
  }
}
