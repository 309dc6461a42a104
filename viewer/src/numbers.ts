// Boxes for numbers that are used together.

const numberIn = (input: HTMLInputElement): number => (input.value.trim() === "" ? NaN : Number(input.value));

export interface Numbers {
  inputs: readonly HTMLInputElement[];
  note: HTMLElement; // where it stands what is wrong
  inForce(): number[];
  text(value: number): string;
  use(values: number[]): string; // what would be right, or nothing
}

/// What is refused stays in its box while the reader is among these boxes, since another of them may make it right; it
/// is marked, and the note says why. When the reader leaves, or by Escape, the boxes show again what is in force.
/// Returns what makes them show it: for changes from elsewhere.
export function useNumbers({ inputs, note, inForce, text, use }: Numbers): () => void {
  const unmark = (): void => inputs.forEach((input) => input.removeAttribute("aria-invalid"));
  const show = (): void => {
    inForce().forEach((value, i) => (inputs[i]!.value = text(value)));
    unmark();
  };
  const isOther = (target: EventTarget | null): boolean => !inputs.includes(target as HTMLInputElement);
  for (const input of inputs) {
    input.setAttribute("aria-describedby", note.id);
    input.addEventListener("change", () => {
      // A box shows fewer digits than a number has: where nothing was typed, the number counts.
      const values = inForce().map((value, i) => (inputs[i]!.value === text(value) ? value : numberIn(inputs[i]!)));
      const empty = inputs.filter((_, i) => !Number.isFinite(values[i]));
      note.textContent = empty.length ? "This needs a number." : use(values);
      if (note.textContent === "") return show();
      unmark();
      for (const one of empty.length ? empty : [input]) one.setAttribute("aria-invalid", "true");
    });
    input.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      note.textContent = "";
      show();
    });
    input.addEventListener("focusin", (event) => {
      if (isOther(event.relatedTarget)) note.textContent = "";
    });
    // The note stays: it says why the box has just changed.
    input.addEventListener("focusout", (event) => {
      if (isOther(event.relatedTarget)) show();
    });
  }
  return () => {
    note.textContent = "";
    show();
  };
}
