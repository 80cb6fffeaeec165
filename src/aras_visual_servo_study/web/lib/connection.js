// The socket to the run: what comes in goes to the model, what the page asks for gets its answer as a promise.
const text = new TextDecoder();

export class Connection {
  constructor(model) {
    this.model = model;
    this.number = 0;
    this.waiting = new Map();
    this.pause_ms = 250;
  }

  open() {
    const address = new URL("socket", location.href);
    address.protocol = address.protocol === "https:" ? "wss:" : "ws:";
    this.socket = new WebSocket(address);
    this.socket.binaryType = "arraybuffer";
    this.socket.onopen = () => { this.pause_ms = 250; this.model.emit("connection", "open"); };
    this.socket.onmessage = (event) => this.take(event.data);
    this.socket.onclose = () => {
      for (const { reject } of this.waiting.values()) reject(new Error("the run cannot be reached"));
      this.waiting.clear();
      this.model.emit("connection", "closed");
      setTimeout(() => this.open(), this.pause_ms);
      this.pause_ms = Math.min(4000, 2 * this.pause_ms);
    };
  }

  take(data) {
    if (typeof data === "string") {
      const message = JSON.parse(data);
      if (message.type === "about") this.model.about_is(message);
      else if (message.type === "set") this.model.values_are(message.values, message.waiting, message.ends);
      else if (message.type === "servo") this.model.emit("servo", message);
      else if (message.type === "answer") this.answered(message);
      return;
    }
    const size = new DataView(data).getUint32(0, true);
    const head = JSON.parse(text.decode(new Uint8Array(data, 4, size)));
    const image = data.byteLength > 4 + size ? new Blob([new Uint8Array(data, 4 + size)], { type: "image/jpeg" }) : null;
    if (head.type === "goal") this.model.goal_is(head, image);
    else {
      this.socket.send(String(head.number));   // seen: the run sends no more than a page can take
      this.model.now_is(head, image);
    }
  }

  answered(message) {
    const waiting = this.waiting.get(message.id);
    this.waiting.delete(message.id);
    if (!waiting) return;
    if (message.ok) waiting.resolve(message);
    else waiting.reject(Object.assign(new Error(message.faults.join("\n")), { faults: message.faults }));
  }

  /** Asks for something; the promise is kept with the answer, or broken with the reason. */
  ask(request) {
    return new Promise((resolve, reject) => {
      if (this.socket.readyState !== WebSocket.OPEN) { reject(new Error("the run cannot be reached")); return; }
      const id = ++this.number;
      this.waiting.set(id, { resolve, reject });
      this.socket.send(JSON.stringify({ ...request, id }));
    });
  }
}
