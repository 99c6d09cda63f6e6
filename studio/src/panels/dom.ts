/** A few words for building the page. */

type Child = Node | string | null;
type Value = string | readonly (Node | string)[];

/** An element with classes (after dots), attributes and children. */
export function el<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  classes = "",
  children: readonly Child[] = [],
  attributes: Record<string, string> = {},
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  if (classes) element.className = classes;
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children.filter((c) => c !== null));
  return element;
}

/** A button that calls `press`. */
export function button(label: string, title: string, press: () => void, classes = ""): HTMLButtonElement {
  const made = el("button", classes, [label], { type: "button", title });
  made.addEventListener("click", press);
  return made;
}

/** One of several: buttons side by side. `mark` shows which is chosen. */
export function choice<T extends string>(
  label: string,
  options: readonly (readonly [value: T, text: string, title: string])[],
  press: (value: T) => void,
): { element: HTMLElement; mark: (value: T) => void } {
  const buttons = options.map(([value, text, title]) => button(text, title, () => press(value)));
  const element = el("div", "choice", buttons, { role: "group", "aria-label": label });
  const mark = (value: T) => {
    for (const [i, b] of buttons.entries()) b.setAttribute("aria-pressed", String(options[i][0] === value));
  };
  return { element, mark };
}

/** The panel at the top left: our name, what this is, and more. */
export function headed(classes: string, tagline: string, children: readonly Child[]): HTMLElement {
  const head = [el("h1", "", ["Crowdquilt"]), el("p", "tagline", [tagline])];
  return el("section", `${classes} panel`, [...head, ...children]);
}

/** Names on the left, values on the right. */
export function pairs(classes: string, rows: readonly (readonly [name: string, value: Value])[]): HTMLElement {
  return el("dl", classes, pairRows(rows));
}

export function pairRows(rows: readonly (readonly [name: string, value: Value])[]): HTMLElement[] {
  return rows.flatMap(([name, value]) => [el("dt", "", [name]), el("dd", "", [value].flat())]);
}

const NAMESPACE = "http://www.w3.org/2000/svg";

/** A small drawing from path data on a 16 x 16 field. */
export function icon(path: string): SVGSVGElement {
  const svg = document.createElementNS(NAMESPACE, "svg");
  svg.setAttribute("viewBox", "0 0 16 16");
  svg.setAttribute("aria-hidden", "true");
  const shape = document.createElementNS(NAMESPACE, "path");
  shape.setAttribute("d", path);
  svg.append(shape);
  return svg;
}
