/** The one typed event bus. `Events` maps a name to its payload. */
export class Bus<Events> {
  private readonly listeners: { [K in keyof Events]?: Set<(payload: Events[K]) => void> } = {};

  /** Calls `listener` at every `name`; returns a function that stops it. */
  on<K extends keyof Events>(name: K, listener: (payload: Events[K]) => void): () => void {
    const set = this.listeners[name] ?? new Set();
    this.listeners[name] = set;
    set.add(listener);
    return () => set.delete(listener);
  }

  emit<K extends keyof Events>(name: K, payload: Events[K]): void {
    for (const listener of this.listeners[name] ?? []) listener(payload);
  }
}
